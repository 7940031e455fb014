#include "models/coupling/gusts.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace barchan {
namespace {

constexpr double intensity = 0.38, viscosity = 1.5e-5, u_star = 0.25, size = 0.6;
constexpr std::size_t nodes = 300;

TEST(Gusts, HaveTheirMeanDeviationAndSkewness) {
  Gusts gusts(intensity, viscosity, u_star, 0.0, size, nodes);
  double sum = 0, squares = 0, cubes = 0;
  int count = 0;
  for (int step = 0; step < 4000; ++step) {
    gusts.blow(0.013 * step);
    for (int k = 0; k < 60; ++k, ++count) {
      const double g = gusts.at(0.01 * k);
      ASSERT_GT(g, -1.0);
      sum += g;
      squares += g * g;
      cubes += g * g * g;
    }
  }
  const double mean = sum / count, deviation = std::sqrt(squares / count - mean * mean);
  EXPECT_NEAR(mean, 0.0, 0.02);
  EXPECT_NEAR(deviation, intensity, 0.03);
  EXPECT_NEAR(cubes / count / std::pow(deviation, 3), 1.1, 0.3);  // 3 I + I^3 = 1.19 of the exponential
}

/// What is here now is 10 u* t farther a little later.
TEST(Gusts, AreCarriedAtTenFrictionVelocities) {
  Gusts now(intensity, viscosity, u_star, 0.0, size, nodes), later(intensity, viscosity, u_star, 0.0, size, nodes);
  const double t = 2e-3;
  double best = -1, best_way = 0;
  for (int j = -10; j <= 30; ++j) {
    const double way = 0.05 * j * 10 * u_star * t;
    double product = 0;
    for (int step = 0; step < 200; ++step) {
      now.blow(0.11 * step);
      later.blow(0.11 * step + t);
      for (int k = 0; k < 60; ++k) product += now.at(0.01 * k) * later.at(0.01 * k + way);
    }
    if (product > best) best = product, best_way = way;
  }
  EXPECT_NEAR(best_way / t, 10 * u_star, 2 * u_star);
}

TEST(Gusts, RepeatThemselvesBeyondThePeriodicSides) {
  Gusts gusts(intensity, viscosity, u_star, -0.1, size, nodes);
  gusts.blow(0.3);
  for (const double x : {-0.1, 0.0, 0.2, 0.499}) {
    EXPECT_NEAR(gusts.at(x), gusts.at(x + size), 1e-9);
    EXPECT_NEAR(gusts.at(x), gusts.at(x - size), 1e-9);
  }
}

}  // namespace
}  // namespace barchan
