// [[forcing]] hold = "bulk-speed": the mean velocity stays to the bit of the arithmetic, and what holds it is what the
// walls take.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "physics/drive.hpp"
#include "physics/small_scenes.hpp"

namespace barchan {
namespace {

using testing::report;
using testing::value;

double mean_velocity(const PhaseParticles& p, int axis) {
  double sum = 0;
  for (std::size_t k = 0; k < p.size(); ++k) sum += p.column(Field::velocity, axis)[k];
  return sum / static_cast<double>(p.size());
}

const std::string held_channel = small::channel + R"toml(
[[forcing]]
phase = "water"
hold = "bulk-speed"
)toml";

// Walls rub, and gravity pulls along the channel besides; only periodic axes are held. Without the hold the mean is
// 1e-3 of its start away after 200 steps.
TEST(BulkSpeed, IsHeldAlongPeriodicAxes) {
  const auto free = small::simulation(small::channel), held = small::simulation(held_channel);
  const double before = mean_velocity(held->phases()[0], 0);
  EXPECT_GT(before, 1.9);
  double worst = 0, across = 0;
  for (int k = 0; k < 200; ++k) {
    free->step(1.0);
    held->step(1.0);
    worst = std::max(worst, std::abs(mean_velocity(held->phases()[0], 0) / before - 1));
    across = std::max(across, std::abs(mean_velocity(held->phases()[0], 1)));
  }
  report("bulk speed, largest error", worst, 1e-12);
  EXPECT_LE(worst, 1e-12);
  EXPECT_GT(std::abs(mean_velocity(free->phases()[0], 0) / before - 1), 1e-3);
  EXPECT_GT(across, 1e-4) << "across the channel nothing is held";
}

/// Plane Poiseuille flow of mean velocity 1 in a channel of height 1, nu = 0.1, 32 spacings across.
const std::string poiseuille = R"toml(
spacing = 0.03125
[domain]
size = [0.5, 1]
periodic = ["x"]
[phases.water]
kind = "fluid"
density = 2
viscosity = 0.1
sound-speed = 15
[phases.floor]
kind = "wall"
[interactions]
kernel = "wendland-c2"
water-water = 2.6
water-floor = 2.6
[[fill]]
phase = "floor"
shape = { sides = ["bottom", "top"], layers = 3 }
[[fill]]
phase = "water"
shape = "the-rest"
velocity = ["6*y*(1 - y)", 0]
[[forcing]]
phase = "water"
hold = "bulk-speed"
[time]
end = 10
largest-speed = 1.5
)toml";

// At steady state the acceleration is the stress of both walls over the mass, 12 nu U/H^2 = 1.2 m/s2 (Batchelor 1967,
// section 4.2).
TEST(BulkSpeed, TakesTheWallStressOverTheMass) {
  for (const std::string scheme : {"consistent", "plain"}) {
    const auto run =
        small::simulation(poiseuille, {"phases.water.scheme=" + scheme,
                                       "interactions.water-water=" + std::string(scheme == "plain" ? "3.0" : "2.6")});
    double sum = 0;
    int rows = 0;
    while (run->time() < 2.0) {  // the slowest mode decays in H^2/(pi^2 nu) = 1
      run->step(1.0);
      if (run->time() < 1.5) continue;
      sum += value(*run, "water_held_acceleration_x [m/s2]");
      ++rows;
    }
    const double bulk = value(*run, "water_mean_vx [m/s]"), expected = 12 * 0.1 * bulk;
    const double error = sum / rows / expected - 1;
    report("held acceleration over 12 nu U/H^2 less 1, " + scheme, error, 0.01);
    EXPECT_NEAR(error, 0.0, 0.01) << scheme;
  }
}

// A fluid that is not held has no such column, and the pass does not run.
TEST(BulkSpeed, CostsNothingWhereNothingIsHeld) {
  for (const bool holds : {false, true}) {
    const auto run = small::simulation(holds ? held_channel : small::channel);
    run->step(1.0);
    const auto names = run->history_columns();
    EXPECT_EQ(std::find(names.begin(), names.end(), "water_held_acceleration_x [m/s2]") != names.end(), holds);
    for (std::size_t k = 0; k < run->seconds().size(); ++k)
      if (run->seconds()[k].first == "bulk speed") { EXPECT_EQ(run->executed()[k] > 0, holds); }
  }
}

// A body of four particles flies with one speed: its mean is that speed, and every frame has half the kernel radius.
TEST(HistoryAndFrames, HaveTheMeanSpeedAndTheSmoothingLengthAsTheyAre) {
  const std::string four = R"toml(
spacing = 0.1
[domain]
size = [2, 2]
[phases.body]
kind = "elastic"
density = 1000
young = 1e5
poisson = 0.3
[interactions]
body-body = 1.6
[[fill]]
phase = "body"
shape = { box = { min = [0.5, 0.5], max = [0.7, 0.7] } }
velocity = [0.75, 0]
[time]
end = 0.1
)toml";
  const auto run = small::simulation("precision = \"double\"\n" + four);
  ASSERT_EQ(run->phases()[0].size(), 4U);
  EXPECT_DOUBLE_EQ(value(*run, "body_mean_vx [m/s]"), 0.75);
  const Frame frame = run->frame(0);
  const auto length = std::find_if(frame.fields.begin(), frame.fields.end(),
                                   [](const FrameField& f) { return f.name == "smoothing_length"; });
  ASSERT_NE(length, frame.fields.end());
  ASSERT_EQ(length->values.size(), 4U);
  for (const double h : length->values) EXPECT_DOUBLE_EQ(h, 0.5 * 1.6 * 0.1) << "half the radius of body-body";
}

}  // namespace
}  // namespace barchan
