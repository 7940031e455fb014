// Sides through which fluids flow: lanes, what stands beyond a side at the start, sums in any order.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "models/fluid/flow_lanes.hpp"
#include "physics/small_scenes.hpp"

namespace barchan {
namespace flow_zones {
namespace {

TEST(FlowLanes, TheNearestIsThatOfALoopOverAll) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> place(0.0, 1.0);
  for (const bool periodic : {false, true}) {
    std::vector<Vec3> places;
    for (int k = 0; k < 300; ++k) places.push_back({9.0, place(random), place(random)});
    const Vec3 periods{0.0, periodic ? 1.0 : 0.0, 0.0};
    const FlowLanes lanes(places, 0, 0.06, periods);
    for (int k = 0; k < 500; ++k) {
      const Vec3 x{-4.0, 1.2 * place(random) - 0.1, place(random)};
      std::size_t nearest = 0;
      double least = 1e300;
      for (std::size_t lane = 0; lane < places.size(); ++lane) {
        double y = x[1] - places[lane][1];
        if (periodic) y -= std::round(y);
        const double r2 = y * y + std::pow(x[2] - places[lane][2], 2);
        if (r2 < least) {
          least = r2;
          nearest = lane;
        }
      }
      EXPECT_EQ(lanes.nearest(x), nearest);
    }
  }
}

TEST(FlowLanes, SumsDoNotDependOnTheOrder) {
  std::mt19937 random(5);
  std::normal_distribution<double> value(0.0, 0.1);
  std::vector<double> values(1000);
  for (double& v : values) v = value(random);
  LaneSum first, second;
  double plain = 0.0;
  for (const double v : values) {
    first.add(v);
    plain += v;
  }
  std::shuffle(values.begin(), values.end(), random);
  for (const double v : values) second.add(v);
  EXPECT_EQ(first.parts, second.parts);
  EXPECT_NEAR(first.value(), plain, 1e-7);
}

const char* const channel = R"toml(
spacing = 0.1
[domain]
size = [1, 0.5]
[phases.air]
kind = "fluid"
density = 1
sound-speed = 10
[phases.wall]
kind = "wall"
[interactions]
air-air = 2.1
air-wall = 2.1
[[fill]]
phase = "wall"
shape = { sides = ["bottom", "top"] }
[[fill]]
phase = "air"
shape = "the-rest"
perturb = 0.3
velocity = [1, 0]
[[inflow]]
phase = "air"
side = "left"
velocity = [1, 0]
[[outflow]]
phase = "air"
side = "right"
layer = 0.5
[time]
end = 1
)toml";

TEST(FlowEnds, ContinueTheLastRowsOfFluidAndWalls) {
  const Scene scene = parse_scene(channel, "test.toml");
  const auto blocks = make_particles(scene);
  // Beyond the left 4 rows, beyond the right 5 of the layer and 4; undisturbed, a spacing apart.
  const auto beyond = [&](std::size_t phase, double from, double to) {
    return std::count_if(blocks[phase].position.begin(), blocks[phase].position.end(),
                         [&](const Vec3& x) { return x[0] > from && x[0] < to; });
  };
  EXPECT_EQ(beyond(0, -0.4, 0.0), 4 * 5);
  EXPECT_EQ(beyond(0, 1.0, 1.9), 9 * 5);
  EXPECT_EQ(beyond(0, -9.0, 9.0), (10 + 4 + 9) * 5);
  EXPECT_EQ(beyond(1, -0.4, 0.0), 4 * 6);
  EXPECT_EQ(beyond(1, -9.0, 9.0), (10 + 4 + 9) * 6);
  for (const Vec3& x : blocks[0].position) {
    if (x[0] < 0.0) { EXPECT_NEAR(std::remainder(x[0] / 0.1 - 0.5, 1.0), 0.0, 1e-9); }
  }
}

TEST(FlowEnds, ParticlesBeyondSidesAreInNoFrameAndNoRow) {
  const Scene scene = parse_scene(channel, "test.toml");
  const auto blocks = make_particles(scene);
  Simulation s(scene, make_plan(scene, blocks), blocks);
  const Frame frame = s.frame(0);
  for (std::size_t k = 0; k < frame.id.size(); ++k) {
    EXPECT_GE(frame.points[3 * k], 0.0);
    EXPECT_LE(frame.points[3 * k], 1.0);
  }
  const HistoryRow row = s.history();
  EXPECT_NEAR(row.values[HistoryRow::momentum_x], 0.5, 1e-3);  // of the domain alone: 50 particles
}

}  // namespace
}  // namespace flow_zones
}  // namespace barchan
