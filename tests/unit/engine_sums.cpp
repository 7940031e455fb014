// Sums over particles do not depend on the order of the terms, and are as exact as sums one after another.
#include <gtest/gtest.h>
#include <omp.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "engine/reproducible_sum.hpp"

namespace barchan {
namespace {

std::vector<double> values_over_decades(std::size_t n, double decades, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> size(-decades, 0.0), sign(-1.0, 1.0);
  std::vector<double> values(n);
  for (double& v : values) v = std::copysign(std::pow(10.0, size(random)), sign(random));
  return values;
}

double sum(const std::vector<double>& v) {
  return reproducible_sum(v.size(), [&](std::size_t k) { return v[k]; });
}

/// Neumaier's sum in long double.
long double exact(const std::vector<double>& v) {
  long double total = 0.0L, rest = 0.0L;
  for (const double x : v) {
    const long double next = total + x;
    rest += std::abs(total) >= std::abs(x) ? (total - next) + x : (x - next) + total;
    total = next;
  }
  return total + rest;
}

TEST(ReproducibleSum, AnyOrderGivesTheSameBits) {
  for (const std::size_t n : {1u, 2u, 3u, 7u, 255u, 256u, 257u, 5000u, 100000u})
    for (const double decades : {0.5, 3.0, 12.0, 40.0}) {
      std::vector<double> v = values_over_decades(n, decades, 3);
      const double first = sum(v);
      std::mt19937 random(7);
      for (int turn = 0; turn < 5; ++turn) {
        std::shuffle(v.begin(), v.end(), random);
        EXPECT_EQ(sum(v), first) << n << " values over " << decades << " decades";
      }
      const double largest = largest_of(v.data(), n);
      EXPECT_NEAR(first, static_cast<double>(exact(v)),
                  1e-17 * static_cast<double>(n) * largest + 1e-16 * std::abs(first));
    }
}

TEST(ReproducibleSum, CancelsExactly) {
  std::vector<double> v = values_over_decades(4000, 10.0, 5);
  const std::size_t n = v.size();
  for (std::size_t k = 0; k < n; ++k) v.push_back(-v[k]);
  EXPECT_EQ(sum(v), 0.0);
  v.push_back(1e-9);
  EXPECT_NEAR(sum(v), 1e-9, 1e-22) << "8001 terms: below 2^-75 of the largest each";
}

TEST(ReproducibleSum, MeanIsTheSameOnAnyNumberOfThreadsAndInAnyOrder) {
  const int threads = omp_get_max_threads();
  for (const std::size_t n : {1u, 7u, 4097u, 39999u}) {
    std::vector<double> v = values_over_decades(n, 6.0, 11);
    const double mean = reproducible_mean(v.data(), n);
    EXPECT_EQ(mean, sum(v) / static_cast<double>(n));
    std::mt19937 random(2);
    for (const int t : {1, 2, 3}) {
      omp_set_num_threads(t);
      std::shuffle(v.begin(), v.end(), random);
      EXPECT_EQ(reproducible_mean(v.data(), n), mean) << n << " values, " << t << " threads";
    }
  }
  omp_set_num_threads(threads);
}

TEST(ReproducibleSum, TellsWhatIsNotFinite) {
  std::vector<double> v(1000, 1.0);
  v[700] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(std::isnan(sum(v)));
  EXPECT_TRUE(std::isnan(reproducible_mean(v.data(), v.size())));
  v[700] = std::numeric_limits<double>::infinity();
  EXPECT_FALSE(std::isfinite(sum(v)));
  EXPECT_EQ(sum({}), 0.0);
  EXPECT_EQ(sum(std::vector<double>(5, 0.0)), 0.0);
}

}  // namespace
}  // namespace barchan
