// Air by height: its steady profiles, its books, and how amounts are spread over its cells.
#include "models/column/air_column.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <random>

#include "measure/decay.hpp"

namespace barchan {
namespace {

constexpr double air_density = 1.2, nu = 1.5e-5;

/// Steps that grow until the air rests.
void settle(AirColumn& column, AirProfile& p, double stress) {
  const AirColumn::Load nothing(p.cells());
  double dt = 1e-5;
  for (int k = 0; k < 150; ++k, dt = std::min(1.3 * dt, 1e4)) column.advance(dt, stress, nothing);
}

TEST(AirColumn, LaminarShearIsLinear) {
  AirProfile p = AirColumn::grid(0.5, 0.502, 0.52, 1e-3);
  AirColumn column({air_density, nu, MixingLength::none, Slip::no_slip}, p);
  settle(column, p, 1e-3);
  for (std::size_t k = 0; k < p.cells(); ++k)
    EXPECT_NEAR(p.speed[k], 1e-3 / (air_density * nu) * (0.5 * (p.face[k] + p.face[k + 1]) - 0.5), 1e-9) << k;
  for (const double stress : p.stress) EXPECT_NEAR(stress, 1e-3, 1e-12);
}

/// l and U of the steady equations by a fine explicit integration.
struct Reference {
  std::vector<double> y, speed, length;
  Reference(double u_star, double top, double seed) {
    double l = seed, u = 0.0;
    const double dy = 2e-7;
    for (double at = 0.0; at < top; at += dy) {
      y.push_back(at);
      speed.push_back(u);
      length.push_back(l);
      // nu u' + l^2 u'^2 = u*^2
      const double slope = 2.0 * u_star * u_star / (nu + std::sqrt(nu * nu + 4.0 * l * l * u_star * u_star));
      u += dy * slope;
      l += dy * 0.4 * (1.0 - std::exp(-std::sqrt(u * l / (7.0 * nu))));
    }
  }
  double at(double height) const { return speed[static_cast<std::size_t>(std::lround(height / 2e-7))]; }
};

TEST(AirColumn, TurbulentWindIsThatOfTheEquations) {
  const double u_star = 0.4;
  AirProfile p = AirColumn::grid(0.0, 0.01, 0.1, 6e-5);
  AirColumn column({air_density, nu, MixingLength::duran, Slip::no_slip}, p);
  settle(column, p, air_density * u_star * u_star);
  const Reference exact(u_star, 0.1, 1e-15);
  // 0.21 mm: the middle of the fourth cell, beside the wall the speed of a cell is that of its middle.
  for (const double y : {2.1e-4, 1e-3, 5e-3, 2e-2, 8e-2}) {
    const double u = column.mean_speed(0.99 * y, 1.01 * y);
    EXPECT_NEAR(u / exact.at(y), 1.0, 0.01) << y;
  }
  // Far from the wall it is logarithmic: u = (u*/0.4) ln y + ...
  const double slope = (exact.at(0.08) - exact.at(0.02)) / std::log(4.0),
               ours = (column.mean_speed(0.0792, 0.0808) - column.mean_speed(0.0198, 0.0202)) / std::log(4.0);
  EXPECT_NEAR(ours / (u_star / 0.4), 1.0, 0.02);
  EXPECT_NEAR(slope / (u_star / 0.4), 1.0, 0.02);
  // The constant of the law of the wall is that of a smooth one, 5 to 5.5 (Pope 2000, 7.43).
  const double constant = exact.at(0.02) / u_star - 2.5 * std::log(0.02 * u_star / nu);
  EXPECT_NEAR(constant, 5.2, 0.6);
}

/// What goes in through the top and out through bottom and grains is what the air has more.
TEST(AirColumn, BooksAreClosedForAnyStep) {
  AirProfile p = AirColumn::grid(0.0, 0.01, 0.05, 1e-4);
  AirColumn column({air_density, nu, MixingLength::duran, Slip::no_slip}, p);
  std::mt19937 random(4);
  std::uniform_real_distribution<double> one(0.0, 1.0);
  AirColumn::Load load(p.cells());
  double lost = 0.0;
  for (const double dt : {1e-5, 1e-4, 1e-2, 1e-5, 1.0, 1e-4}) {
    for (std::size_t k = 0; k < p.cells(); ++k) {
      load.pull[k] = 1e-3 * one(random);
      load.rate[k] = k % 3 == 0 ? 10.0 * one(random) : 0.0;
      load.owed[k] = 1e-7 * one(random);
      lost += load.owed[k];
    }
    column.advance(dt, 0.1, load);
    lost += std::accumulate(p.given.begin(), p.given.end(), 0.0);
    EXPECT_NEAR(column.momentum() + lost - p.boundary, 0.0, 1e-13 + 1e-12 * lost) << dt;
    for (const double u : p.speed) EXPECT_LT(std::abs(u), 100.0);
  }
}

/// A strong drag and a long step: the air comes to rest in the grains and does not swing beyond.
TEST(AirColumn, StrongDragIsStable) {
  AirProfile p = AirColumn::grid(0.0, 0.01, 0.05, 1e-4);
  AirColumn column({air_density, nu, MixingLength::duran, Slip::no_slip}, p);
  std::fill(p.speed.begin(), p.speed.end(), 3.0);
  column.integrate_speed();
  AirColumn::Load load(p.cells());
  for (int k = 0; k < 5; ++k) {
    for (std::size_t c = 0; c < 100; ++c) {
      load.rate[c] = 50.0;  // 400 times the air's own inertia in this step
      load.pull[c] = load.rate[c] * p.speed[c];
    }
    column.advance(1e-3, 0.0, load);
    for (std::size_t c = 0; c < 90; ++c) {
      EXPECT_LT(p.speed[c], 0.01) << c;
      EXPECT_GT(p.speed[c], -1e-6) << c;
    }
  }
}

TEST(AirColumn, SpreadsAndAveragesWithTheSameWeights) {
  AirProfile p = AirColumn::grid(0.1, 0.105, 0.2, 3e-4);
  AirColumn column({air_density, nu, MixingLength::none, Slip::no_slip}, p);
  std::mt19937 random(7);
  std::uniform_real_distribution<double> one(0.0, 1.0);
  for (double& u : p.speed) u = one(random);
  column.integrate_speed();
  AirColumn::Spread spread(p.cells());
  std::vector<double> sums(p.cells());
  for (int k = 0; k < 2000; ++k) {
    const double low = 0.1 + 0.0995 * one(random) * one(random), high = std::min(low + 1e-3 * one(random) + 1e-6, 0.2);
    spread.clear();
    spread.add(column, low, high, 2.5);
    spread.gather(column, sums);
    double total = 0.0, weighted = 0.0, brute = 0.0;
    for (std::size_t c = 0; c < p.cells(); ++c) {
      total += sums[c];
      weighted += sums[c] * p.speed[c];
      brute += p.speed[c] * std::max(0.0, std::min(high, p.face[c + 1]) - std::max(low, p.face[c]));
    }
    ASSERT_NEAR(total, 2.5, 1e-9);
    ASSERT_NEAR(weighted / 2.5, column.mean_speed(low, high), 1e-7);
    ASSERT_NEAR(brute / (high - low), column.mean_speed(low, high), 1e-7);
  }
  for (const auto& [low, high] : {std::pair{0.05, 0.07}, {0.25, 0.26}, {0.0999, 0.1001}, {0.1999, 0.2002}}) {
    spread.clear();
    spread.add(column, low, high, 1.0);
    spread.gather(column, sums);
    EXPECT_NEAR(std::accumulate(sums.begin(), sums.end(), 0.0), 1.0, 1e-12) << "what lies outside is not lost";
  }
  EXPECT_EQ(column.mean_speed(0.05, 0.09), 0.0);
  EXPECT_NEAR(column.mean_speed(0.21, 0.22), p.speed.back(), 1e-12);
}

TEST(AirColumn, FindsTheCellOfEveryHeight) {
  AirProfile p = AirColumn::grid(-1.0, -0.9, 1.0, 7e-3);
  AirColumn column({air_density, nu, MixingLength::none, Slip::no_slip}, p);
  for (std::size_t k = 0; k < p.cells(); ++k)
    for (const double share : {0.001, 0.5, 0.999})
      EXPECT_EQ(column.cell_at(p.face[k] + share * (p.face[k + 1] - p.face[k])), k);
  EXPECT_EQ(column.cell_at(-2.0), 0u);
  EXPECT_EQ(column.cell_at(2.0), p.cells() - 1);
}

TEST(Decay, FindsAnExponentialAndItsUncertainty) {
  std::mt19937 random(2);
  std::normal_distribution<double> noise(0.0, 1.0);
  int inside = 0;
  for (int trial = 0; trial < 200; ++trial) {
    std::vector<double> y, q, e;
    for (int k = 0; k < 60; ++k) {
      y.push_back(1e-3 * k);
      const double exact = 5.0 * std::exp(-y.back() / 0.01);
      e.push_back(0.05 * exact);
      q.push_back(exact + e.back() * noise(random));
    }
    const Decay d = decay(y, q, e);
    ASSERT_NEAR(d.height, 0.01, 3e-4);
    ASSERT_NEAR(d.at_zero, 5.0, 0.25);
    inside += std::abs(d.height - 0.01) < d.error;
  }
  EXPECT_NEAR(inside / 200.0, 0.68, 0.1) << "one standard error holds two of three";
  EXPECT_EQ(decay({1, 2}, {1, 0.5}, {0.1, 0.1}).height, 0.0);
  EXPECT_EQ(decay({1, 2, 3}, {1, 2, 3}, {0.1, 0.1, 0.1}).height, 0.0) << "what grows does not decay";
}

}  // namespace
}  // namespace barchan
