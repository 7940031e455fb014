// Scenes of elastic bodies: what is refused by name.
#include <gtest/gtest.h>

#include "base/errors.hpp"
#include "checks/reader.hpp"
#include "plan/plan.hpp"
#include "simulation/simulation.hpp"
#include "start/generate.hpp"

namespace barchan {
namespace {

struct Parts {
  std::string a = "", pair = "a-b = { restitution = 0.5, friction = 0.25 }", more = "";
};

std::string text_of(const Parts& parts) {
  return "spacing = 0.1\n[domain]\nsize = [2, 1]\n[phases.a]\nkind = \"elastic\"\ndensity = 1000\nyoung = 1e6\n" +
         parts.a +
         "\n[phases.b]\nkind = \"elastic\"\ndensity = 1000\nyoung = 1e6\n[phases.sand]\nkind = \"grains\"\ndensity = "
         "10\n"
         "[interactions]\na-a = {}\nb-b = 2.1\nsand-sand = 1.1\n" +
         parts.pair +
         "\n[[fill]]\nphase = \"a\"\nshape = { cube = { centre = [0.5, 0.5], count = 4 } }\n"
         "[[fill]]\nphase = \"b\"\nshape = { cube = { centre = [1.3, 0.5], count = 4 } }\n"
         "[[fill]]\nphase = \"sand\"\nshape = { points = [[0.2, 0.1]] }\n" +
         parts.more + "\n[time]\nend = 1\n";
}
Scene scene_of(const Parts& parts) { return parse_scene(text_of(parts), "bodies.toml"); }

void expect_refused(const Parts& parts, const std::string& key, const std::string& words) {
  try {
    scene_of(parts);
    ADD_FAILURE() << "not refused: " << key;
  } catch (const SceneError& e) {
    const std::string what = e.what();
    EXPECT_NE(what.find(key), std::string::npos) << what;
    EXPECT_NE(what.find(words), std::string::npos) << what;
  }
}

TEST(SceneBodies, RefusesKeysThatNothingReads) {
  expect_refused({"artificial-viscosity = 1"}, "phases.a.artificial-viscosity", "\"updated-lagrangian\"");
  expect_refused({"artificial-viscosity-beta = 1"}, "phases.a.artificial-viscosity-beta", "\"updated-lagrangian\"");
  expect_refused({"energy = true"}, "phases.a.energy", "\"updated-lagrangian\"");
  for (const char* key :
       {"elasticity = \"neo-hookean\"", "hourglass = 0.1", "retardation = 1", "wave-correction = true"})
    expect_refused({"formulation = \"updated-lagrangian\"\n" + std::string(key)},
                   "phases.a." + std::string(key).substr(0, std::string(key).find(' ')), "\"total-lagrangian\"");
  expect_refused({"", "a-b = { radius = 1.1 }"}, "interactions.a-b.radius", "no such key");
  expect_refused({"", "a-b = { kernel = \"cubic-spline\" }"}, "interactions.a-b.kernel", "no such key");
  expect_refused({"", "a-b = { radius-in-metres = 0.1 }"}, "interactions.a-b.radius-in-metres", "no such key");
  expect_refused({"", "a-sand = { restitution = 0.5 }"}, "interactions.a-sand.restitution", "no such key");
  expect_refused({"", "a-b = { restitution = 0.01 }"}, "interactions.a-b.restitution", "0.05");
  expect_refused({"", "a-sand = { surfaces = true }"}, "interactions.a-sand.surfaces", "no such key");
}

TEST(SceneBodies, RefusesSetsThatAreNone) {
  expect_refused({"", "", "[[motion]]\nphase = \"c\"\n"}, "motion.0.phase", "there is no phase");
  expect_refused({"", "", "[[motion]]\nphase = \"sand\"\n"}, "motion.0.phase", "elastic");
  expect_refused({"", "", "[[marker]]\nname = \"a b\"\nphase = \"a\"\n"}, "marker.0.name", "letters");
  expect_refused({"", "", "[[marker]]\nname = \"e\"\nphase = \"a\"\n[[marker]]\nname = \"e\"\nphase = \"a\"\n"},
                 "marker.1.name", "twice");
  expect_refused({"", "", "[[marker]]\nname = \"e\"\nphase = \"a\"\nbox = { min = [1, 1], max = [0, 1] }\n"},
                 "marker.0.box", "min <= max");
}

/// What only the particles show.
void expect_refused_at_start(const std::string& text, const std::string& words) {
  const Scene s = parse_scene(text, "bodies.toml");
  const auto blocks = generate(s);
  try {
    const Plan plan = make_plan(s, blocks);
    const Simulation simulation(s, plan, blocks);
    ADD_FAILURE() << "not refused: " << words;
  } catch (const SceneError& e) { EXPECT_NE(std::string(e.what()).find(words), std::string::npos) << e.what(); }
}

TEST(SceneBodies, RefusesEmptySetsAndBodiesOfOneLayer) {
  expect_refused_at_start(
      text_of({"", "", "[[motion]]\nphase = \"a\"\nbox = { min = [1.8, 0.8], max = [1.9, 0.9] }\n"}),
      "no particle of phase \"a\" stands in the box");
  expect_refused_at_start(
      text_of({"", "", "[[motion]]\nphase = \"a\"\n[[motion]]\nphase = \"a\"\nvelocity = [1, 0]\n"}),
      "that motion.0 moves too");
  std::string turns = text_of({"", "", ""});
  const std::string updated = "formulation = \"updated-lagrangian\"";
  if (turns.find(updated) == std::string::npos)
    turns.replace(turns.find("kind = \"elastic\""), 16, "kind = \"elastic\"\n" + updated);
  turns.replace(turns.find("a-a = {}"), 8, "a-a = 2.1");
  const std::string still = "shape = { cube = { centre = [0.5, 0.5], count = 4 } }";
  turns.replace(turns.find(still), still.size(), still + "\nvelocity = [\"-10*(y - 0.5)\", \"10*(x - 0.5)\"]");
  expect_refused_at_start(turns, "an updated Lagrangian body cannot turn");
  std::string text = text_of({"", "", ""});
  const std::string cube = "shape = { cube = { centre = [0.5, 0.5], count = 4 } }";
  text.replace(text.find(cube), cube.size(), "shape = { points = [[0.5, 0.5], [0.6, 0.5], [0.7, 0.5]] }");
  expect_refused_at_start(text, "lie in one line or plane");
}

}  // namespace
}  // namespace barchan
