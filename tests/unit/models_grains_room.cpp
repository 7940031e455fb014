// Spheres that overlap at the start are refused whatever their sizes, on all sides, in both orders of fills and across
// a periodic side.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "base/errors.hpp"
#include "checks/reader.hpp"
#include "simulation/simulation.hpp"
#include "start/generate.hpp"

namespace barchan::sphere_room_test {
namespace {

/// A small sphere of 0.01 m and a large one of 0.5 m over a bed of small ones, in a domain of 1 m with periodic left
/// and right sides.
std::string two_sizes(const Vec3& small, const Vec3& large, bool large_first) {
  const auto fill = [](const std::string& phase, const Vec3& x) {
    return "[[fill]]\nphase = \"" + phase + "\"\nshape = { points = [[" + std::to_string(x[0]) + ", " +
           std::to_string(x[1]) + "]] }\n";
  };
  const std::string a = fill("small", small), b = fill("large", large);
  return R"toml(dimensions = 2
spacing = 0.01
[domain]
size = [1, 1]
periodic = ["x"]
gravity = [0, -9.81]
[phases.small]
kind = "grains"
density = 2500
diameter = 0.01
[phases.large]
kind = "grains"
density = 2500
diameter = 0.5
[interactions]
small-small = { law = "linear" }
small-large = { law = "linear" }
large-large = { law = "linear" }
[time]
end = 0.001
largest-speed = 1
[[fill]]
phase = "small"
shape = { box = { min = [0, 0], max = [1, 0.2] } }
)toml" + (large_first ? b + a : a + b);
}

bool is_refused(const std::string& text) {
  const Scene scene = parse_scene(text, "room.toml");
  const std::vector<ParticleBlock> blocks = generate(scene);
  try {
    Simulation(scene, make_plan(scene, blocks), blocks);
  } catch (const SceneError& error) {
    EXPECT_NE(std::string(error.what()).find("overlaps fill."), std::string::npos) << error.what();
    return true;
  }
  return false;
}

TEST(StartOfSpheres, RefusesOverlapsOfUnequalSizesOnAllSides) {
  for (const Vec3& large : {Vec3{0.5, 0.5, 0.0}, Vec3{0.1, 0.5, 0.0}})
    for (const bool large_first : {true, false})
      for (int k = 0; k < 12; ++k)
        for (const double overlap : {0.2, -0.2}) {
          const double angle = (k + 0.3) * std::numbers::pi / 6.0, r = 0.255 - overlap * 0.01;
          Vec3 small = large + r * Vec3{std::cos(angle), std::sin(angle), 0.0};
          small[0] -= std::floor(small[0]);
          EXPECT_EQ(is_refused(two_sizes(small, large, large_first)), overlap > 0.0) << k << " " << large[0];
        }
}

}  // namespace
}  // namespace barchan::sphere_room_test
