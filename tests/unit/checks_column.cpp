// What a column of air refuses, by name.
#include <gtest/gtest.h>

#include "base/errors.hpp"
#include "checks/reader.hpp"

namespace barchan {
namespace {

const std::string good = R"toml(
spacing = 1e-3
[domain]
size = [0.1, 0.05]
periodic = ["x"]
gravity = [0, -9.81]
[phases.air]
kind = "column"
density = 1.2
viscosity = 1.5e-5
friction-velocity = 0.4
[phases.sand]
kind = "grains"
density = 2650
[phases.floor]
kind = "wall"
density = 2650
[phases.water]
kind = "fluid"
density = 100
sound-speed = 10
[interactions]
air-sand = {}
sand-floor = 1.1
water-water = 2.1
[[fill]]
phase = "sand"
shape = { box = { min = [0, 0.01], max = [0.1, 0.02] } }
[[fill]]
phase = "floor"
shape = { sides = ["bottom"] }
[[fill]]
phase = "water"
shape = { box = { min = [0, 0.03], max = [0.1, 0.04] } }
[time]
end = 1
)toml";

std::string with(const std::string& old, const std::string& now) {
  std::string text = good;
  const std::size_t at = text.find(old);
  EXPECT_NE(at, std::string::npos) << old;
  return text.replace(at, old.size(), now);
}

/// The message, "" when it is read.
std::string refusal(const std::string& text) {
  try {
    parse_scene(text, "FILE", {});
  } catch (const SceneError& e) { return e.what(); }
  return "";
}

void expect_column_refused(const std::string& text, const std::string& key, const std::string& words) {
  const std::string message = refusal(text);
  EXPECT_NE(message.find(": " + key + ": "), std::string::npos) << message;
  EXPECT_NE(message.find(words), std::string::npos) << message;
  EXPECT_EQ(message.find('\n'), std::string::npos) << "one mistake, one line: " << message;
}

TEST(SceneColumn, IsRead) {
  EXPECT_EQ(refusal(good), "");
  EXPECT_EQ(refusal(with("periodic = [\"x\"]", "periodic = [\"x\"]\norigin = [0, -1]")).find("air"), std::string::npos);
  const Scene scene = parse_scene(good, "FILE", {});
  EXPECT_EQ(scene.interactions[0].drag_law, DragLaw::duran) << "the default";
  EXPECT_EQ(parse_scene(with("air-sand = {}", "air-sand = { drag = \"cheng\" }"), "FILE", {}).interactions[0].drag_law,
            DragLaw::cheng);
}

TEST(SceneColumn, RefusesWhatCannotWork) {
  expect_column_refused(with("[0, -9.81]", "[1, -9.81]"), "domain.gravity", "along -y");
  expect_column_refused(with("periodic = [\"x\"]\n", ""), "phases.air.held", "expected domain.periodic = [\"x\"]");
  expect_column_refused(with("viscosity = 1.5e-5\n", ""), "phases.air.viscosity", "expected a number > 0");
  expect_column_refused(with("air-sand = {}", "air-sand = 2.1"), "interactions.air-sand", "no radius");
  expect_column_refused(with("air-sand = {}", "air-sand = { radius = 2.1 }"), "interactions.air-sand.radius",
                        "no kernel");
  expect_column_refused(with("air-sand = {}", "air-sand = { kernel = \"wendland-c2\" }"),
                        "interactions.air-sand.kernel", "no kernel");
  expect_column_refused(with("air-sand = {}", "air-sand = { drag = 0.4 }"), "interactions.air-sand.drag",
                        "the name of a law");
  expect_column_refused(with("air-sand = {}", "air-sand = {}\nair-floor = {}"), "interactions.air-floor",
                        "grains only");
  expect_column_refused(with("air-sand = {}", "air-sand = {}\nair-water = {}"), "interactions.air-water",
                        "grains only");
  expect_column_refused(with("air-sand = {}", "air-sand = {}\nair-air = {}"), "interactions.air-air", "grains only");
  expect_column_refused(with("air-sand = {}", "air-sand = {}\nwater-sand = {}"), "interactions.air-sand", "already");
  expect_column_refused(with("air-sand = {}\n", ""), "phases.air", "nothing interacts with this air");
  expect_column_refused(with("phase = \"water\"", "phase = \"air\"") +
                            "[[fill]]\nphase = \"water\"\nshape = { points = [[0.05, 0.045]] }\n",
                        "fill.2.phase", "no particles");
  expect_column_refused(with("sand-floor = 1.1", "sand-floor = { radius = 1.1, drag = \"duran\" }"),
                        "interactions.sand-floor.drag", "has a drag");
}

TEST(SceneColumn, RefusesKeysThatNothingReads) {
  const std::string wind = "friction-velocity = 0.4\n";
  expect_column_refused(with(wind, "speed = 1\nlog-profile = { friction-velocity = 1, roughness = 1e-5 }\n"),
                        "phases.air.log-profile", "a second wind");
  expect_column_refused(with(wind, "held = true\n"), "phases.air.held", "no wind to hold");
  expect_column_refused(with(wind, "held = true\nspeed = 1\nfriction-velocity = 0.4\n"), "phases.air.friction-velocity",
                        "needs none");
  expect_column_refused(with(wind, "held = true\nspeed = 1\nmixing-length = \"none\"\n"), "phases.air.mixing-length",
                        "needs none");
  expect_column_refused(with(wind, "held = true\nspeed = 1\nheight = 0.1\n"), "phases.air.height", "needs none");
  expect_column_refused(with(wind, "held = true\nspeed = 1\nresolution = 1e-4\n"), "phases.air.resolution", "no cells");
  expect_column_refused(with(wind, wind + "sound-speed = 10\n"), "phases.air.sound-speed",
                        "not a key of a phase of kind column");
  expect_column_refused(with(wind, wind + "spacing = 1e-3\n"), "phases.air.spacing",
                        "not a key of a phase of kind column");
}

TEST(SceneColumn, LawsOfDragByNameNeedIt) {
  std::string text = with("air-sand = {}", "water-sand = { drag = \"duran\" }");
  text.erase(text.find("[phases.air]"), text.find("[phases.sand]") - text.find("[phases.air]"));
  const std::string message = refusal(text);
  for (const char* words : {"phases.sand.diameter: a law of drag by name needs spheres",
                            "interactions.water-sand.drag: a law of drag by name needs a turbulent wind",
                            "interactions.water-sand.drag: a law of drag by name needs ground under the wind"})
    EXPECT_NE(message.find(words), std::string::npos) << message;
}

}  // namespace
}  // namespace barchan
