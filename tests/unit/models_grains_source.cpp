// Grains that enter: what is drawn has the flux, heights, speeds and angles that the scene states.
#include "models/grains/grain_source.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <numbers>

#include "base/errors.hpp"
#include "checks/reader.hpp"
#include "output/series.hpp"

namespace barchan {
namespace grain_source {
namespace {

Scene scene_with(const std::string& keys, int dimensions = 2) {
  return parse_scene("dimensions = " + std::to_string(dimensions) + R"toml(
spacing = 1e-3
[domain]
size = )toml" + (dimensions == 2 ? "[0.2, 0.4]" : "[0.2, 0.4, 0.05]") +
                         R"toml(
[phases.sand]
kind = "grains"
density = 2000
diameter = { mean = 1e-3, spread = 0.3 }
[interactions]
sand-sand = { law = "linear" }
[[fill]]
phase = "sand"
shape = { points = [)toml" +
                         (dimensions == 2 ? "[0.1, 0.1]" : "[0.1, 0.1, 0.02]") +
                         R"toml(] }
[[influx]]
phase = "sand"
)toml" + keys + R"toml(
[time]
end = 1
largest-speed = 1
)toml",
                     "test.toml");
}

struct Moments {
  double mean = 0.0, spread = 0.0;
};
template <class Value>
Moments moments(const Arrivals& arrivals, Value&& value) {
  constexpr std::int64_t n = 40000;
  double sum = 0.0, squares = 0.0;
  for (std::int64_t k = 0; k < n; ++k) {
    const double x = value(arrivals(k));
    sum += x;
    squares += x * x;
  }
  const double mean = sum / static_cast<double>(n);
  return {mean, std::sqrt(squares / static_cast<double>(n) - mean * mean)};
}

const std::string drawn =
    "side = \"right\"\nflux = 0.03\nabove = 0.1\ndecay-height = 0.02\nspeed = 2\nspeed-spread = 0.3\nangle = "
    "20\nangle-spread = 5";

TEST(Arrivals, HaveTheFluxAndTheDistributionsOfTheScene) {
  for (const int dimensions : {2, 3}) {
    const Scene scene = scene_with(drawn, dimensions);
    const double slab = dimensions == 2 ? 1e-3 : 1.0, width = dimensions == 2 ? 1.0 : 0.05;
    const Arrivals arrivals(scene, 0, slab);
    using Grain = Arrivals::Grain;
    const double wait = moments(arrivals, [](const Grain& g) { return g.wait; }).mean;
    const double mass = moments(arrivals, [&](const Grain& g) { return arrivals.mass_of(g.radius); }).mean;
    EXPECT_NEAR(mass / wait, 0.03 * width, 0.02 * 0.03 * width);
    EXPECT_NEAR(mass, 2000.0 * std::numbers::pi / 6.0 * 1e-9 * 1.09 / slab, 0.02 * mass);
    const Moments height = moments(arrivals, [](const Grain& g) { return g.height - 0.1 - g.radius; });
    EXPECT_NEAR(height.mean, 0.02, 4e-4);
    EXPECT_NEAR(height.spread, 0.02, 6e-4);
    const Moments speed = moments(arrivals, [](const Grain& g) { return -g.velocity[0]; });
    EXPECT_NEAR(speed.mean, 2.0, 0.01);
    EXPECT_NEAR(speed.spread, 0.3, 0.01);
    const Moments angle = moments(
        arrivals, [](const Grain& g) { return std::atan2(g.velocity[1], -g.velocity[0]) * 180.0 / std::numbers::pi; });
    EXPECT_NEAR(angle.mean, 20.0, 0.1);
    EXPECT_NEAR(angle.spread, 5.0, 0.1);
    for (std::int64_t k = 0; k < 1000; ++k) {
      const Grain g = arrivals(k), again = arrivals(k);
      EXPECT_GE(g.radius, 0.35e-3);
      EXPECT_LE(g.radius, 0.65e-3);
      EXPECT_LT(norm(g.velocity), arrivals.fastest() * 1.1);
      EXPECT_EQ(g.height, again.height);
      EXPECT_EQ(g.wait, again.wait);
    }
  }
}

TEST(Arrivals, OfAFileAreDrawnBySpeedThroughTheSide) {
  Frame frame;
  frame.domain = {0, 0.2, 0, 0.4, 0, 0};
  frame.phase_names = {"sand"};
  frame.phase_kinds = {"grains"};
  // Inwards at 1 and 3 m/s; outwards; below `above`.
  const double x[4][5] = {
      {0.2, 1.0, 0.5, 4e-4, 0}, {0.3, 3.0, -0.5, 5e-4, 0}, {0.25, -2.0, 0, 5e-4, 0}, {0.05, 9.0, 0, 5e-4, 0}};
  frame.fields = {{"velocity", "m/s", 3, {}}, {"radius", "m", 1, {}}};
  for (std::int64_t k = 0; k < 4; ++k) {
    frame.id.push_back(k);
    frame.phase.push_back(0);
    frame.points.insert(frame.points.end(), {0.1, x[k][0], 0.0});
    frame.fields[0].values.insert(frame.fields[0].values.end(), {x[k][1], x[k][2], 0.0});
    frame.fields[1].values.push_back(x[k][3]);
  }
  const std::filesystem::path file = std::filesystem::path(::testing::TempDir()) / "barchan_flight.vtp";
  write_frame(file, frame, FrameFormat::vtp, true);
  const Scene scene = scene_with("side = \"left\"\nflux = 0.03\nabove = 0.1\nfile = \"" + file.string() + "\"");
  const Arrivals arrivals(scene, 0, 1e-3);
  int slow = 0, fast = 0;
  double mass = 0.0, time = 0.0;
  for (std::int64_t k = 0; k < 20000; ++k) {
    const auto g = arrivals(k);
    (g.height == 0.2 ? slow : fast) += 1;
    EXPECT_EQ(g.velocity[0], g.height == 0.2 ? 1.0 : 3.0);
    EXPECT_EQ(g.radius, g.height == 0.2 ? 4e-4 : 5e-4);
    mass += arrivals.mass_of(g.radius);
    time += g.wait;
  }
  EXPECT_NEAR(static_cast<double>(fast) / slow, 3.0, 0.15);
  EXPECT_NEAR(mass / time, 0.03, 6e-4);
  EXPECT_NEAR(arrivals.fastest(), std::hypot(3.0, 0.5), 1e-12);
  std::filesystem::remove(file);
  EXPECT_THROW(Arrivals(scene, 0, 1e-3), SceneError);
}

}  // namespace
}  // namespace grain_source
}  // namespace barchan
