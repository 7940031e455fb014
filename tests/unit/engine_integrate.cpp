// The parts of a step of one phase, on a few particles by hand.
#include "engine/integrate.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "engine/hold_inside.hpp"
#include "engine/means.hpp"
#include "engine/reproducible_sum.hpp"

namespace barchan {
namespace {

/// Particles with a position, velocity and acceleration of their own, by number and axis.
PhaseParticles some(int dimensions, std::size_t n, std::initializer_list<Field> more = {}) {
  PhaseParticles p("some", dimensions, n, 2.0, 0);
  for (const Field field : {Field::position, Field::velocity, Field::acceleration}) p.add(field);
  for (const Field field : more) p.add(field);
  for (int d = 0; d < dimensions; ++d)
    for (std::size_t k = 0; k < n; ++k) {
      const auto i = static_cast<double>(k), axis = static_cast<double>(d);
      p.column(Field::position, d)[k] = 0.1 * i + axis;
      p.column(Field::velocity, d)[k] = 1.0 + 0.5 * i - 2.0 * axis;
      p.column(Field::acceleration, d)[k] = (k % 2 == 0 ? 3.0 : -4.5) + axis;
    }
  return p;
}

TEST(Steps, DriftFollowsTheVelocityAndTheShift) {
  for (const int dimensions : {2, 3}) {
    PhaseParticles p = some(dimensions, 5, {Field::shift_velocity});
    PhaseParticles before = some(dimensions, 5);
    for (int d = 0; d < dimensions; ++d) p.column(Field::shift_velocity, d)[3] = 10.0 + d;
    kick_and_drift(p, 0.5, 0.25, nullptr);
    for (int d = 0; d < dimensions; ++d)
      for (std::size_t k = 0; k < 5; ++k) {
        const double v = before.column(Field::velocity, d)[k] + 0.5 * before.column(Field::acceleration, d)[k];
        EXPECT_NEAR(p.column(Field::velocity, d)[k], v, 1e-14);
        EXPECT_NEAR(p.column(Field::position, d)[k],
                    before.column(Field::position, d)[k] + 0.25 * (v + (k == 3 ? 10.0 + d : 0.0)), 1e-14);
      }
  }
}

TEST(Steps, TheLargestAccelerationMayBeNegative) {
  for (const int dimensions : {2, 3}) {
    PhaseParticles p = some(dimensions, 9);
    p.column(Field::acceleration, 1)[4] = -50.0;
    EXPECT_EQ(kick(p, 0.1), 50.0);
    p.column(Field::acceleration, 0)[7] = std::numeric_limits<double>::quiet_NaN();
    EXPECT_TRUE(std::isinf(kick(p, 0.1)));
  }
}

TEST(Steps, SidesStopWhatMovesOutwardsOnly) {
  PhaseParticles p = some(2, 4);
  double *x = p.column(Field::position, 0), *v = p.column(Field::velocity, 0);
  const double places[] = {-0.5, -0.5, 2.5, 2.5}, speeds[] = {-1.0, 1.0, -1.0, 1.0};
  std::copy(places, places + 4, x);
  std::copy(speeds, speeds + 4, v);
  Sides sides;
  sides.low[0] = 0.0;
  sides.high[0] = 2.0;
  sides.margin = 0.1;
  hold_inside(p, sides);
  const double kept[] = {0.0, 1.0, -1.0, 0.0}, put[] = {0.1, 0.1, 1.9, 1.9};
  for (std::size_t k = 0; k < 4; ++k) {
    EXPECT_EQ(v[k], kept[k]) << k;
    EXPECT_NEAR(x[k], put[k], 1e-15) << k;
  }
  EXPECT_EQ(p.column(Field::position, 1)[3], 0.1 * 3 + 1.0) << "an axis without sides";
}

TEST(Steps, AHeldMeanVelocityIsReached) {
  PhaseParticles p = some(2, 7);
  BulkHold hold;
  hold.axes = {true, false, false};
  hold.velocity = {12.0, 0.0, 0.0};
  const double dt = 0.05;
  const double other = reproducible_mean(p.column(Field::acceleration, 1), 7);
  hold_bulk_velocity(p, hold, dt);
  double sum = 0.0;
  for (std::size_t k = 0; k < 7; ++k) sum += p.column(Field::velocity, 0)[k] + dt * p.column(Field::acceleration, 0)[k];
  EXPECT_NEAR(sum / 7.0, 12.0, 1e-12);
  EXPECT_EQ(reproducible_mean(p.column(Field::acceleration, 1), 7), other);
}

TEST(Means, OfAFewValues) {
  const std::array<double, 3> values{1.0, 2.0, 6.0};
  EXPECT_EQ(reproducible_mean(values.data(), 3), 3.0);
}

}  // namespace
}  // namespace barchan
