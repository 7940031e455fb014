// Eddies: the pair's viscosity is the logarithmic mean, the distance to the ground that of a search through everything.
#include "passes/eddies.hpp"

#include <gtest/gtest.h>

#include <random>

namespace barchan {
namespace {

TEST(PairViscosity, IsTheLogarithmicMean) {
  EXPECT_DOUBLE_EQ(pair_viscosity(2.0, 2.0), 4.0);
  for (const double ratio : {1.5, 3.0, 5.0}) {
    const double exact = (ratio - 1.0) / std::log(ratio);
    EXPECT_NEAR(pair_viscosity(1.0, std::sqrt(ratio)) / exact, 1.0, ratio > 3.0 ? 3e-3 : 6e-4) << ratio;
  }
}

TEST(EddyViscosity, SolvesItsEquation) {
  // phi = (nu + nu_t)|S|, nu_t = l^2 |S|
  const double nu = 1e-5, length = 2e-3, shear = 300.0, nu_t = length * length * shear;
  EXPECT_NEAR(eddy_viscosity(nu, length, (nu + nu_t) * shear), nu_t, 1e-12);
}

TEST(LogLaw, IsFollowedAboveAQuarterOfASpacing) {
  EXPECT_DOUBLE_EQ(log_law_friction(0.01, 1e-4, 1e-3), std::pow(0.4 / std::log(100.0), 2));
  EXPECT_DOUBLE_EQ(log_law_friction(0.0, 1e-4, 1e-3), log_law_friction(2.5e-4, 1e-4, 1e-3));
}

/// A floor of the domain, a periodic x, and a heap of grains with one in flight.
TEST(GroundDistance, IsThatOfASearchThroughEverything) {
  const double dx = 0.02;
  Bounds bounds{2, {0, 0, 0}, {1, 0.6, 0}, {true, false, false}};
  Sides sides;
  sides.low[1] = 0.0;
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  std::vector<Vec3> grains;
  for (int k = 0; k < 20; ++k)
    for (int j = 0; j < 8; ++j) grains.push_back({0.93 + k * dx - (k > 3 ? 1.0 : 0.0), 0.01 + j * dx, 0});
  PhaseParticles sand("sand", PhaseKind::grains, 2, grains.size() + 1, 1.0, 0);
  for (const Field f : {Field::position, Field::velocity}) sand.add(f);
  for (std::size_t k = 0; k <= grains.size(); ++k)
    for (int d = 0; d < 2; ++d)
      sand.column(Field::position, d)[k] = k < grains.size() ? grains[k][static_cast<std::size_t>(d)] : 0.45;
  GroundDistance ground(bounds, sides, dx, true);
  const PhaseParticles* phases[] = {&sand};
  ground.refresh(phases);
  double worst = 0.0;
  for (int k = 0; k < 4000; ++k) {
    const Vec3 x{uniform(random), 0.6 * uniform(random), 0};
    double naive = x[1];
    for (const Vec3& g : grains) {
      double r = x[0] - g[0];
      r -= std::round(r);
      naive = std::min(naive, std::hypot(r, x[1] - g[1]) - 0.5 * dx);
    }
    worst = std::max(worst, std::abs(ground.distance(x) - std::max(naive, 0.0)));
  }
  EXPECT_LT(worst, 0.05 * dx) << "and the grain in flight is no ground";
}

}  // namespace
}  // namespace barchan
