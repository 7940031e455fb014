// Distributions of diameters: the moments of what is drawn are those that the distribution states.
#include <gtest/gtest.h>

#include <cmath>

#include "scene/scene.hpp"
#include "start/sphere_sizes.hpp"

namespace barchan {
namespace sphere_sizes {
namespace {

constexpr int many = 200000;

struct Drawn {
  double cube = 0.0;                    // mean of (d/mean)^3
  double least = 1e300, largest = 0.0;  // m
  std::vector<double> diameters;
};

Drawn drawn(const SphereSize& size) {
  Random random(7);
  Drawn d;
  for (int k = 0; k < many; ++k) {
    const double share = relative_diameter(size, random);
    d.cube += share * share * share / many;
    d.least = std::min(d.least, share * size.mean);
    d.largest = std::max(d.largest, share * size.mean);
    d.diameters.push_back(share * size.mean);
  }
  return d;
}

/// Share of the mass in spheres smaller than a diameter.
double passes(const Drawn& d, double diameter) {
  double all = 0.0, below = 0.0;
  for (const double x : d.diameters) {
    all += x * x * x;
    if (x < diameter) below += x * x * x;
  }
  return below / all;
}

TEST(SphereSizes, ASieveCurveIsWhatPasses) {
  SphereSize size;
  size.mean = 2.5e-4;
  size.sieve = {{1e-4, 0.0}, {2e-4, 0.3}, {3e-4, 0.8}, {5e-4, 1.0}};
  const Drawn d = drawn(size);
  for (const auto& [diameter, share] : size.sieve) EXPECT_NEAR(passes(d, diameter), share, 0.01) << diameter;
  EXPECT_NEAR(passes(d, 2.5e-4), 0.55, 0.01) << "linear between two sieves";
  EXPECT_NEAR(d.cube, size.mean_cube(), 0.02 * size.mean_cube());
  EXPECT_GE(d.least, size.least() * (1.0 - 1e-12));
  EXPECT_LE(d.largest, size.largest() * (1.0 + 1e-12));
  EXPECT_EQ(size.least(), 1e-4);
}

TEST(SphereSizes, TwoSizesHaveNoneBetween) {
  SphereSize size;
  size.mean = 2e-4;
  size.sieve = {{1.9e-4, 0.0}, {2e-4, 0.5}, {4e-4, 0.5}, {4.1e-4, 1.0}};
  const Drawn d = drawn(size);
  for (const double x : d.diameters) EXPECT_TRUE(x < 2.0001e-4 || x > 3.9999e-4) << x;
  EXPECT_NEAR(passes(d, 3e-4), 0.5, 0.01);
}

TEST(SphereSizes, ALogNormalDistributionHasItsMedianAndItsWidth) {
  SphereSize size;
  size.mean = 3e-4;
  size.log_normal = 0.3;
  const Drawn d = drawn(size);
  int below = 0;
  double squares = 0.0;
  for (const double x : d.diameters) {
    below += x < size.mean ? 1 : 0;
    squares += std::pow(std::log(x / size.mean), 2) / many;
  }
  EXPECT_NEAR(below, 0.5 * many, 0.01 * many);
  EXPECT_NEAR(std::sqrt(squares), 0.3 * 0.8796, 0.003) << "a normal distribution cut at two deviations";
  EXPECT_NEAR(d.cube, size.mean_cube(), 0.01 * size.mean_cube());
  EXPECT_NEAR(d.largest, size.mean * std::exp(0.6), 1e-3 * size.mean);
}

TEST(SphereSizes, AnEvenSpreadIsDrawnAsEver) {
  SphereSize size;
  size.mean = 1e-3;
  size.spread = 0.2;
  Random one(3), other(3);
  for (int k = 0; k < 100; ++k) EXPECT_EQ(relative_diameter(size, one), other.uniform(0.8, 1.2));
  EXPECT_EQ(size.mean_cube(), 1.0 + 0.2 * 0.2);
  EXPECT_NEAR(size.quantile(0.25), 0.9, 1e-15);
}

}  // namespace
}  // namespace sphere_sizes
}  // namespace barchan
