// The viscous stress at a free surface, for velocity fields of which it is known.
#include "models/fluid/fluid_stress.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace barchan {
namespace {

template <int Dim>
using Matrix = std::array<std::array<double, Dim>, Dim>;

FluidParameters viscous(double layer_share) {
  FluidParameters q{};
  q.stressed = true;
  q.surface_viscosity = 2.0;
  q.layer_share = layer_share;
  q.per_top_row = 1.25;
  return q;
}

/// Inwards along -y, as at the top of a fluid.
constexpr std::array<double, 2> inwards{0.0, -0.4};

TEST(SurfaceStress, OfAShearHoldsTheTopRowBack) {
  for (const double share : {0.0, 0.7, 1.0}) {
    const FluidParameters q = viscous(share);
    const auto s =
        surface_stress<2, double>(Matrix<2>{{{0.0, 3.0}, {0.0, 0.0}}}, {}, inwards, 0.5, 0.0, q);  // mu du/dy = 3
    EXPECT_NEAR(s.drag[0], 2.0 * q.per_top_row * 0.5 * 3.0 * inwards[1], 1e-14) << share;
    EXPECT_NEAR(s.drag[1], 0.0, 1e-14) << share;
    EXPECT_NEAR(s.normal, 0.0, 1e-14) << share;
  }
}

TEST(SurfaceStress, OfAStretchingIsAPressure) {
  for (const double share : {0.0, 0.4}) {
    const auto s =
        surface_stress<2, double>(Matrix<2>{{{1.5, 0.0}, {0.0, -1.5}}}, {}, inwards, 1.0, 0.0, viscous(share));
    EXPECT_NEAR(s.normal, (1.0 + share) * 2.0 * -1.5, 1e-14);
    EXPECT_NEAR(s.drag[0], 0.0, 1e-14);
    EXPECT_NEAR(s.drag[1], 0.0, 1e-14);
  }
}

TEST(SurfaceStress, OfATurningFluidIsNone) {
  const auto s = surface_stress<2, double>(Matrix<2>{{{0.0, 3.0}, {-3.0, 0.0}}}, {}, inwards, 1.0, 0.0, viscous(0.0));
  EXPECT_NEAR(s.drag[0], 0.0, 1e-14);
  EXPECT_NEAR(s.normal, 0.0, 1e-14);
}

/// Of a potential flow the whole share leaves no stress along the surface: all of it acts as pressure.
TEST(SurfaceStress, OfAPotentialFlowMayActAsPressure) {
  const Matrix<3> flux{{{0.8, 0.3, -0.4}, {0.3, -1.5, 0.6}, {-0.4, 0.6, 0.7}}};
  const std::array<double, 3> n{0.2, -0.3, 0.1};
  const auto none = surface_stress<3, double>(flux, {}, n, 1.0, 0.0, viscous(1.0));
  for (const double d : none.drag) EXPECT_NEAR(d, 0.0, 1e-14);
  const auto all = surface_stress<3, double>(flux, {}, n, 1.0, 0.0, viscous(0.0));
  EXPECT_NEAR(none.normal, 2.0 * all.normal, 1e-14);
  double across = 0.0, size = 0.0;
  for (std::size_t d = 0; d < 3; ++d) {
    across += all.drag[d] * n[d];
    size += all.drag[d] * all.drag[d];
  }
  EXPECT_NEAR(across, 0.0, 1e-14);
  EXPECT_GT(size, 0.1);
}

TEST(SurfaceStress, IsZeroAwayFromTheSurface) {
  const auto s = surface_stress<2, double>(Matrix<2>{{{1.5, 3.0}, {2.0, -1.0}}}, {}, inwards, 0.0, 0.0, viscous(0.3));
  EXPECT_EQ(s.normal, 0.0);
  EXPECT_EQ(s.drag[0], 0.0);
  EXPECT_EQ(s.drag[1], 0.0);
}

}  // namespace
}  // namespace barchan
