// Where air comes between a wall at rest and the water that leaves it (models/walls/ventilation.hpp): a gate lets
// through what potential flow says, a jet clears the edge of its pipe, and a sheet falls off a roof.
#include <cmath>
#include <string>

#include "physics/drive.hpp"
#include "physics/small_scenes.hpp"

namespace barchan {
namespace {

using testing::report;
using testing::run_to;

/// Water in a tank of 0.5 m behind a gate, four spacings thick, 0.25 m deep over a slot of five.
const std::string gate = R"toml(
dimensions = 2
spacing = 0.01
[domain]
origin = [-0.5, 0]
size = [0.8, 0.4]
gravity = [0, -9.81]
open = ["right"]
[phases.water]
kind = "fluid"
density = 1000
viscosity = 1e-6
sound-speed = 25
[phases.floor]
kind = "wall"
slip = "free-slip"
[phases.gate]
kind = "wall"
slip = "free-slip"
[interactions]
water-water = 2.1
water-floor = 2.1
water-gate = 2.1
[[fill]]
phase = "gate"
shape = { box = { min = [0, 0.05], max = [0.04, 0.4] } }
[[fill]]
phase = "floor"
shape = { sides = ["bottom", "left"] }
[[fill]]
phase = "water"
shape = { box = { min = [-0.5, 0], max = [0, 0.25] } }
pressure = "hydrostatic"
[time]
end = 1
largest-speed = 2.5
)toml";

/// What is left of the gate (m2).
double behind(const Simulation& run) {
  const auto& p = run.phases()[0];
  double area = 0.0;
  for (std::size_t k = 0; k < p.size(); ++k) area += p.column(Field::position, 0)[k] < 0.0 ? 1e-4 : 0.0;
  return area;
}

/// Potential flow with a contraction C of 0.60 (von Mises 1917), from a layer that a long wave has lowered until
/// u h = C a sqrt(2 g (h + u^2/2g - C a)), u = 2 (sqrt(g H) - sqrt(g h)) (Stoker 1957, section 10.8); the wave comes
/// back from the end of the tank after 0.65 s. With suction 1.28 of it came through.
TEST(Ventilation, AGateLetsThroughWhatPotentialFlowSays) {
  constexpr double g = 9.81, depth = 0.25, contracted = 0.60 * 0.05;
  double low = 0.0, high = depth, flow = 0.0;
  for (int k = 0; k < 60; ++k) {
    const double h = 0.5 * (low + high), u = 2.0 * (std::sqrt(g * depth) - std::sqrt(g * h));
    flow = u * h;
    const double head = h + u * u / (2.0 * g) - contracted;
    const bool too_much = head < 0.0 || flow > contracted * std::sqrt(2.0 * g * head);
    (too_much ? low : high) = h;
  }
  const auto simulation = small::simulation(gate);
  run_to(*simulation, 0.25);
  const double before = behind(*simulation);
  run_to(*simulation, 0.5);
  const double error = std::abs((before - behind(*simulation)) / (0.25 * flow) - 1.0);
  report("discharge through a slot of five spacings/potential flow, error", error, 0.06);
  EXPECT_LE(error, 0.06);
}

/// A jet of 1 m/s out of a pipe seven spacings wide.
const std::string pipe = R"toml(
dimensions = 2
spacing = 0.005
[domain]
origin = [-0.1, -0.2]
size = [0.3, 0.3]
gravity = [0, -9.81]
open = ["right", "bottom"]
[phases.water]
kind = "fluid"
density = 1000
viscosity = 1e-6
sound-speed = 30
[phases.below]
kind = "wall"
slip = "free-slip"
[phases.above]
kind = "wall"
slip = "free-slip"
[interactions]
water-water = 2.1
water-below = 2.1
water-above = 2.1
[[fill]]
phase = "below"
shape = { box = { min = [-0.1, -0.2], max = [0, 0] } }
[[fill]]
phase = "above"
shape = { box = { min = [-0.1, 0.035], max = [0, 0.1] } }
[[fill]]
phase = "water"
shape = { box = { min = [-0.1, 0], max = [0, 0.035] } }
velocity = [1, 0]
[[inflow]]
phase = "water"
side = "left"
velocity = [1, 0]
[time]
end = 1
largest-speed = 3
)toml";

/// Drawn to the wall by suction it was 19 spacings below the parabola of its mean speed.
TEST(Ventilation, AJetClearsTheEdgeOfItsPipe) {
  const auto simulation = small::simulation(pipe);
  double height = 0.0, count = 0.0;
  for (const double time : {0.4, 0.45, 0.5}) {
    run_to(*simulation, time);
    const auto& p = simulation->phases()[0];
    for (std::size_t k = 0; k < p.size(); ++k) {
      if (std::abs(p.column(Field::position, 0)[k] - 0.1) > 0.005) continue;
      height += p.column(Field::position, 1)[k];
      count += 1.0;
    }
  }
  ASSERT_GT(count, 20.0);
  const double off = std::abs(height / count - (0.0175 - 0.5 * 9.81 * 0.01)) / 0.005;
  report("middle of the jet 0.1 m from the pipe beside free fall, spacings", off, 2.0);
  EXPECT_LE(off, 2.0);
}

/// Water two spacings thick under a roof.
const std::string sheet = R"toml(
dimensions = 2
spacing = 0.01
[domain]
size = [0.3, 0.3]
gravity = [0, -9.81]
[phases.water]
kind = "fluid"
density = 1000
viscosity = 1e-6
sound-speed = 20
[phases.roof]
kind = "wall"
slip = "free-slip"
[interactions]
water-water = 2.1
water-roof = 2.1
[[fill]]
phase = "roof"
shape = { sides = ["top"] }
[[fill]]
phase = "water"
shape = { box = { min = [0.1, 0.28], max = [0.2, 0.3] } }
[time]
end = 0.2
largest-speed = 2
)toml";

TEST(Ventilation, ASheetFallsOffARoof) {
  const auto simulation = small::simulation(sheet);
  const auto mean = [&] {
    const auto& p = simulation->phases()[0];
    double height = 0.0;
    for (std::size_t k = 0; k < p.size(); ++k) height += p.column(Field::position, 1)[k];
    return height / static_cast<double>(p.size());
  };
  const double start = mean();
  run_to(*simulation, 0.15);
  const double error = std::abs((start - mean()) / (0.5 * 9.81 * 0.15 * 0.15) - 1.0);
  report("way of a sheet that falls off a roof/free fall, error", error, 0.05);
  EXPECT_LE(error, 0.05);
}

}  // namespace
}  // namespace barchan
