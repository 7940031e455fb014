// Synthetic turbulence: its stress, its divergence, its length.
#include <gtest/gtest.h>

#include <cmath>

#include "models/fluid/inflow_fluctuations.hpp"

namespace barchan {
namespace {

constexpr double air_density = 1.2;

Fluctuations given(double shear) {
  Fluctuations f;
  f.length = 0.1;
  f.rms = {0.5, 0.3, 0.4};
  f.shear_stress = shear;
  return f;
}

/// <u'u'>, <v'v'>, <w'w'>, <u'v'> over a long line against what was asked.
TEST(InflowFluctuations, HaveTheStressThatIsAsked) {
  for (const int dimensions : {2, 3}) {
    const Fluctuations f = given(0.1);
    const InflowFluctuations field(f, air_density, dimensions, {});
    double uu = 0.0, vv = 0.0, ww = 0.0, uv = 0.0, mean = 0.0;
    const int n = 40000;
    for (int k = 0; k < n; ++k) {
      const Vec3 u = field({0.037 * k, 0.0, 0.0});
      uu += u[0] * u[0] / n;
      vv += u[1] * u[1] / n;
      ww += u[2] * u[2] / n;
      uv += u[0] * u[1] / n;
      mean += u[0] / n;
    }
    EXPECT_NEAR(uu, 0.25, 0.03 * 0.25) << dimensions;
    EXPECT_NEAR(vv, 0.09, 0.03 * 0.09) << dimensions;
    EXPECT_NEAR(ww, dimensions == 3 ? 0.16 : 0.0, 0.03 * 0.16) << dimensions;
    EXPECT_NEAR(-air_density * uv, 0.1, 0.01) << dimensions;
    EXPECT_NEAR(mean, 0.0, 0.02) << dimensions;
  }
}

TEST(InflowFluctuations, HaveNoDivergence) {
  for (const int dimensions : {2, 3}) {
    const InflowFluctuations field(given(0.1), air_density, dimensions, {});
    const double h = 1e-4;
    for (int k = 0; k < 50; ++k) {
      const Vec3 x{0.31 * k, 0.17 * k, 0.23 * k};
      double divergence = 0.0, size = 0.0;
      for (std::size_t d = 0; d < static_cast<std::size_t>(dimensions); ++d) {
        Vec3 above = x, below = x;
        above[d] += h;
        below[d] -= h;
        const double slope = (field(above)[d] - field(below)[d]) / (2.0 * h);
        divergence += slope;
        size += std::abs(slope);
      }
      EXPECT_LT(std::abs(divergence), 1e-4 * size + 1e-5) << dimensions;
    }
  }
}

/// The integral of the longitudinal correlation, over fields of many seeds: two points r apart, r from 0 to 8 lengths.
TEST(InflowFluctuations, HaveTheLengthThatIsAsked) {
  for (const int dimensions : {2, 3}) {
    Fluctuations f;
    f.length = 0.1;
    f.rms = {1.0, 1.0, 1.0};
    const int seeds = 400;
    double integral = 0.0;
    const double step = 0.005;
    for (int seed = 1; seed <= seeds; ++seed) {
      f.seed = static_cast<unsigned>(seed);
      const InflowFluctuations field(f, air_density, dimensions, {});
      const double here = field({0.0, 0.0, 0.0})[0];
      for (int k = -80; k <= 80; ++k) integral += 0.5 * step * here * field({k * step, 0.0, 0.0})[0] / seeds;
    }
    EXPECT_NEAR(integral / 0.1, 1.0, 0.15) << dimensions;
  }
}

/// Across a periodic axis the field repeats.
TEST(InflowFluctuations, RepeatAcrossAPeriod) {
  const InflowFluctuations field(given(0.0), air_density, 2, {0.0, 0.7, 0.0});
  for (int k = 0; k < 10; ++k) {
    const Vec3 a = field({0.1 * k, 0.2, 0.0}), b = field({0.1 * k, 0.9, 0.0});
    EXPECT_NEAR(a[0], b[0], 1e-10);
    EXPECT_NEAR(a[1], b[1], 1e-10);
  }
}

}  // namespace
}  // namespace barchan
