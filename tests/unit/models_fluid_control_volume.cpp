// The force on a wall by a control volume: fields whose force is known, on a lattice and on disturbed particles.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "models/fluid/control_volume.hpp"
#include "start/random.hpp"

namespace barchan {
namespace {

constexpr double dx = 0.1, radius = 0.55, mu = 0.3, density = 2.0;

Layout room(int dimensions, double half) {
  Layout layout;
  layout.dimensions = dimensions;
  layout.domain.low = {-half, -half, -half};
  layout.domain.high = {half, half, half};
  return layout;
}

/// A disc or a ball about the place 0 in the middle of a lattice.
PhaseParticles body(int dimensions) {
  std::vector<Vec3> places;
  const int n = 8;
  for (int i = -n; i <= n; ++i)
    for (int j = -n; j <= n; ++j)
      for (int k = dimensions == 3 ? -n : 0; k <= (dimensions == 3 ? n : 0); ++k)
        if (const Vec3 x{i * dx, j * dx, k * dx}; norm(x) < radius) places.push_back(x);
  PhaseParticles wall("wall", dimensions, places.size(), 1.0, 0);
  wall.add(Field::position);
  for (std::size_t q = 0; q < places.size(); ++q)
    for (int d = 0; d < dimensions; ++d) wall.column(Field::position, d)[q] = places[q][static_cast<std::size_t>(d)];
  return wall;
}

struct Fields {
  Vec3 v{}, a{};
  double p = 0.0;
};

/// The force by a fluid with these fields outside of the body; particles off their places by a part of a spacing.
template <class F>
Vec3 force(int dimensions, double disturbed, F&& fields) {
  const double half = 2.6;
  const ControlVolume volume(body(dimensions), dx, room(dimensions, half));
  EXPECT_TRUE(volume.there());
  std::vector<ControlVolume::Share> shares;
  Random random(1);
  const int n = static_cast<int>(half / dx);
  for (int i = -n; i <= n; ++i)
    for (int j = -n; j <= n; ++j)
      for (int k = dimensions == 3 ? -n : 0; k <= (dimensions == 3 ? n : 0); ++k) {
        Vec3 x{i * dx, j * dx, k * dx};
        if (norm(x) < radius) continue;
        for (int d = 0; d < dimensions; ++d)
          x[static_cast<std::size_t>(d)] += disturbed * dx * random.uniform(-1.0, 1.0);
        if (!volume.near(x)) continue;
        const Fields f = fields(x);
        shares.push_back(volume.share(x, f.v, f.a, density * std::pow(dx, dimensions), density, f.p, mu));
      }
  return ControlVolume::force(shares);
}

/// A fluid at rest under gravity lifts the body by its weight in fluid.
TEST(ControlVolume, AFluidAtRestLifts) {
  for (const int dimensions : {2, 3}) {
    const double g = 9.81;
    const std::size_t places = body(dimensions).size();
    const double weight = density * g * static_cast<double>(places) * std::pow(dx, dimensions);
    const Vec3 lift = force(dimensions, 0.0, [&](const Vec3& x) {
      return Fields{{}, {0.0, g, 0.0}, -density * g * x[1] + 100.0};  // a = 0 less gravity; 100 Pa that lift nothing
    });
    EXPECT_NEAR(lift[1] / weight, 1.0, 1e-3) << dimensions;
    EXPECT_NEAR(lift[0] / weight, 0.0, 1e-9) << dimensions;
  }
}

/// A force F at the place 0 in a viscous fluid in the plane, without inertia: v = [F ln(1/r) + (F.x) x/r2]/(4 pi mu),
/// p = F.x/(2 pi r2). What the fluid does to any body about the place is -F. Pressure and friction give half each.
TEST(ControlVolume, AStokesletHasItsForce) {
  const auto flow = [](const Vec3& x) {
    const double r2 = dot(x, x), factor = 1.0 / (4.0 * std::numbers::pi * mu);
    return Fields{
        factor * (Vec3{-0.5 * std::log(r2), 0.0, 0.0} + (x[0] / r2) * x), {}, x[0] / (2.0 * std::numbers::pi * r2)};
  };
  const Vec3 regular = force(2, 0.0, flow), disturbed = force(2, 0.2, flow);
  EXPECT_NEAR(regular[0], -1.0, 0.002);
  EXPECT_NEAR(regular[1], 0.0, 1e-9);
  EXPECT_NEAR(disturbed[0], -1.0, 0.03);
}

/// In space: v = [F/r + (F.x) x/r3]/(8 pi mu), p = F.x/(4 pi r3).
TEST(ControlVolume, AStokesletInSpaceHasItsForce) {
  const Vec3 found = force(3, 0.0, [](const Vec3& x) {
    const double r = norm(x), factor = 1.0 / (8.0 * std::numbers::pi * mu);
    return Fields{
        factor * (Vec3{1.0 / r, 0.0, 0.0} + (x[0] / (r * r * r)) * x), {}, x[0] / (4.0 * std::numbers::pi * r * r * r)};
  });
  EXPECT_NEAR(found[0], -1.0, 0.002);
}

/// Fluid that accelerates with a uniform gradient of pressure pushes as if the body were of fluid: -V grad p.
TEST(ControlVolume, AUniformGradientPushes) {
  const double gradient = 3.0, volume = static_cast<double>(body(2).size()) * dx * dx;
  const Vec3 push = force(2, 0.0, [&](const Vec3& x) {
    return Fields{{5.0, -2.0, 0.0}, {-gradient / density, 0.0, 0.0}, gradient * x[0]};
  });
  EXPECT_NEAR(push[0] / (-gradient * volume), 1.0, 1e-3);
  EXPECT_NEAR(push[1] / (gradient * volume), 0.0, 1e-3) << "a uniform stream rubs nothing";
}

TEST(ControlVolume, IsNotThereWhereItWouldLeaveTheDomain) {
  EXPECT_FALSE(ControlVolume(body(2), dx, room(2, 1.8)).there());
  EXPECT_TRUE(ControlVolume(body(2), dx, room(2, 2.0)).there());
}

/// The weight is one at the body, nothing at its end, and its derivatives are those of its differences.
TEST(ControlVolume, HasTheSlopesOfItsWeight) {
  const ControlVolume volume(body(3), dx, room(3, 2.6));
  EXPECT_NEAR(volume.at({radius, 0.0, 0.0}).w, 1.0, 1e-3);
  EXPECT_NEAR(volume.at({1.9, 0.0, 0.0}).w, 0.0, 1e-5);
  const double h = 1e-4;
  for (const Vec3& x : {Vec3{0.9, 0.31, 0.42}, Vec3{-0.7, 0.9, 0.1}, Vec3{0.33, -0.5, -1.1}}) {
    const ControlVolume::Weight at = volume.at(x);
    for (std::size_t d = 0; d < 3; ++d) {
      Vec3 above = x, below = x;
      above[d] += h;
      below[d] -= h;
      const ControlVolume::Weight up = volume.at(above), down = volume.at(below);
      EXPECT_NEAR(at.slope[d], (up.w - down.w) / (2.0 * h), 1e-4);
      for (std::size_t e = 0; e < 3; ++e)
        EXPECT_NEAR(at.bend[d][e], (up.slope[e] - down.slope[e]) / (2.0 * h), 2e-2) << d << e;
    }
  }
}

}  // namespace
}  // namespace barchan
