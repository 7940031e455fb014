// Malformed scenes, each with its exact message: from the library, and from the program, which must leave nothing
// behind.
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "base/data_folder.hpp"
#include "base/errors.hpp"
#include "checks/reader.hpp"
#include "scene/keys.hpp"
#include "scene/nearest.hpp"
#include "start/generate.hpp"
#include "unit/scene_texts.hpp"

namespace barchan {
namespace {

using testing::dune_text;
using testing::square_text;
using testing::with;

struct Malformed {
  const char* name;
  std::string text;
  std::string message;  // FILE stands for the scene's file, FIELDS, KINDS and STATES for all their names
};
void PrintTo(const Malformed& scene, std::ostream* out) { *out << scene.name; }

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size())
    text.replace(at, from.size(), to);
  return text;
}

std::string message_of(const Malformed& scene, const std::string& file) {
  const std::string kinds = one_of(choices(*find_key("phases", "kind")));
  const std::string with_states = replaced(scene.message, "STATES", one_of(names_of_states()));
  return replaced(
      replaced(replaced(with_states, "FILE", file), "FIELDS", one_of(choices(*find_key("output", "fields")))), "KINDS",
      kinds);
}

/// The dune with one thing changed.
std::string dune(const std::string& from, const std::string& to) { return with(dune_text, from, to); }
/// The square with one thing changed.
std::string square(const std::string& from, const std::string& to) { return with(square_text, from, to); }

/// Two phases of one fluid with a border, with one thing changed.
std::string joined(const std::string& from, const std::string& to) {
  return with(R"toml(spacing = 0.1
[domain]
size = [1, 1]
periodic = ["x", "y"]
[phases.a]
kind = "fluid"
density = 1
viscosity = 0.1
sound-speed = 10
spacing = 0.05
[phases.b]
kind = "fluid"
density = 1
viscosity = 0.1
sound-speed = 10
[interactions]
a-a = 2.1
b-b = 2.1
a-b = { radius = 2.1, border = "x - 0.5" }
[[fill]]
phase = "a"
shape = { box = { min = [0, 0], max = [0.5, 1] } }
[[fill]]
phase = "b"
shape = "the-rest"
[time]
end = 0.01
)toml",
              from, to);
}

/// The square with a viscous fluid on a floor whose shear is measured, with one thing changed.
std::string shear(const std::string& from, const std::string& to) {
  const std::string floor =
      with(square_text, "density = 1\n", "density = 1\nviscosity = 1\n[phases.floor]\nkind = \"wall\"\n");
  return with(with(with(floor, "air-air = 3.0\n", "air-air = 3.0\nair-floor = 3.0\n"), "[time]",
                   "[[fill]]\nphase = \"floor\"\nshape = { sides = [\"bottom\"] }\n"
                   "[[wall-shear]]\nname = \"p\"\nphase = \"air\"\nwall = \"floor\"\n[time]"),
              from, to);
}

/// The square, periodic along x, with a floor that has more keys.
std::string wall(const std::string& keys) {
  return with(with(with(square_text, "size = [1, 1]", "size = [1, 1]\nperiodic = [\"x\"]"), "air-air = 3.0",
                   "air-air = 2.1\nair-wall = 2.1"),
              "[interactions]", "[phases.wall]\nkind = \"wall\"\n" + keys + "\n[interactions]") +
         "[[fill]]\nphase = \"wall\"\nshape = { sides = [\"bottom\"] }\n";
}

/// The square beside a gate that moves, with one thing changed.
std::string gate(const std::string& from, const std::string& to) {
  const std::string moved = R"toml(spacing = 0.1
[domain]
size = [1, 1]
[phases.air]
kind = "fluid"
density = 1
[phases.gate]
kind = "wall"
[interactions]
air-air = 2.6
air-gate = 2.6
[[fill]]
phase = "gate"
shape = { box = { min = [0, 0], max = [0.3, 1] } }
[[fill]]
phase = "air"
shape = { box = { min = [0.3, 0], max = [1, 1] } }
[[motion]]
phase = "gate"
velocity = [0.1, 0]
[time]
end = 1
)toml";
  return with(moved, from, to);
}

/// Grains that enter through a side, with one thing changed.
std::string influx(const std::string& from, const std::string& to) {
  const std::string blown = R"toml(spacing = 0.002
[domain]
size = [0.1, 0.1]
open = ["right"]
[phases.sand]
kind = "grains"
density = 1000
diameter = 0.002
[phases.floor]
kind = "wall"
[interactions]
sand-sand = { law = "linear" }
sand-floor = { law = "linear" }
[[fill]]
phase = "floor"
shape = { sides = ["bottom"] }
[[fill]]
phase = "sand"
shape = { points = [[0.05, 0.001]] }
[[influx]]
phase = "sand"
side = "left"
flux = 5
decay-height = 0.02
speed = 1
[time]
end = 0.02
largest-speed = 3
)toml";
  return with(blown, from, to);
}

/// The square over a fitted hill, with one thing changed.
std::string hill(const std::string& from, const std::string& to) {
  const std::string ground = with(with(square_text, "air-air = 3.0\n", "air-air = 3.0\nair-hill = 3.0\n"),
                                  "density = 1\n", "density = 1\n[phases.hill]\nkind = \"wall\"\n");
  const std::string bed = "[[fill]]\nphase = \"hill\"\nshape = { bed = 0.3 }\npacking = \"fitted\"\n[[fill]]";
  return with(with(with(ground, "[[fill]]", bed), "\"the-rest\"", "\"the-rest\"\npacking = \"fitted\""), from, to);
}

const std::vector<Malformed>& malformed_scenes() {
  static const std::vector<Malformed> scenes = {
#include "malformed_scenes.inc"
  };
  return scenes;
}

class MalformedScene : public ::testing::TestWithParam<Malformed> {};

TEST_P(MalformedScene, LibraryTellsExactlyWhatIsWrong) {
  ASSERT_EQ(GetParam().text.find("NOT FOUND"), std::string::npos) << GetParam().text;
  try {
    generate(parse_scene(GetParam().text, "s.toml"));
    ADD_FAILURE() << "accepted";
  } catch (const SceneError& error) { EXPECT_EQ(error.what(), message_of(GetParam(), "s.toml")); }
}

TEST_P(MalformedScene, ProgramSaysTheSameAndWritesNothing) {
  namespace fs = std::filesystem;
  if (!fs::exists(BARCHAN_PROGRAM)) GTEST_SKIP() << "no program at " BARCHAN_PROGRAM;
  const fs::path place = fs::path(::testing::TempDir()) / ("barchan_malformed_" + std::to_string(getpid()));
  fs::remove_all(place);
  fs::create_directories(place);
  const fs::path scene = place / "scene.toml", out = place / "out", errors = place / "stderr";
  std::ofstream(scene, std::ios::binary) << GetParam().text;
  const std::string command = "'" BARCHAN_PROGRAM "' run '" + scene.string() + "' --out '" + out.string() +
                              "' > /dev/null 2> '" + errors.string() + "'";
  const int status = std::system(command.c_str());
  std::ostringstream said;
  said << std::ifstream(errors).rdbuf();
  EXPECT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 2);
  EXPECT_FALSE(fs::exists(out));
  EXPECT_EQ(said.str(), "barchan: " + message_of(GetParam(), scene.string()) + "\n");
  fs::remove_all(place);
}

INSTANTIATE_TEST_SUITE_P(Scenes, MalformedScene, ::testing::ValuesIn(malformed_scenes()),
                         [](const auto& test) { return std::string(test.param.name); });

}  // namespace
}  // namespace barchan
