// Beds that settled before the run: they stay where they are, and are the same on any number of threads.
#include <gtest/gtest.h>
#include <omp.h>

#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <numbers>

#include "base/errors.hpp"
#include "output/series.hpp"
#include "physics/small_scenes.hpp"

namespace barchan {
namespace {

/// A bed of 8 diameters over a floor.
const std::string flat = R"toml(
dimensions = 2
spacing = 1e-3
[domain]
size = [0.05, 0.03]
periodic = ["x"]
gravity = [0, -9.81]
[phases.sand]
kind = "grains"
density = 2650
diameter = { mean = 1e-3, spread = 0.2 }
friction = 0.5
rolling-friction = 0.2
stiffness = 1000
[phases.floor]
kind = "wall"
[interactions]
sand-sand = { law = "linear" }
sand-floor = { law = "linear" }
[[fill]]
phase = "floor"
shape = { sides = ["bottom"], layers = 1 }
[[fill]]
phase = "sand"
shape = { bed = 0.008 }
packing = "settled"
[time]
end = 1
largest-speed = 0.5
)toml";

/// A layer of 4 diameters over a dune of fixed spheres, as high above it everywhere.
const std::string over_a_core = R"toml(
dimensions = 2
spacing = 1e-3
[domain]
size = [0.12, 0.03]
periodic = ["x"]
gravity = [0, -9.81]
[phases.sand]
kind = "grains"
density = 2650
diameter = { mean = 1e-3, spread = 0.2 }
friction = 0.8
rolling-friction = 0.5
stiffness = 1000
[phases.core]
kind = "wall"
diameter = 2e-3
[interactions]
sand-sand = { law = "linear" }
sand-core = { law = "linear" }
[[fill]]
phase = "core"
shape = { bed = 0.002, dune = { form = "cosine", height = 0.008, length = 0.08, at = 0.06 } }
packing = "staggered"
[[fill]]
phase = "sand"
shape = { bed = 0.006, dune = { form = "cosine", height = 0.008, length = 0.08, at = 0.06 } }
packing = "settled"
[time]
end = 1
largest-speed = 0.5
)toml";

struct Bed {
  const char* name;
  const std::string* text;
  std::vector<std::string> overrides;
};
std::ostream& operator<<(std::ostream& out, const Bed& bed) { return out << bed.name; }

class SettledBed : public ::testing::TestWithParam<Bed> {};
INSTANTIATE_TEST_SUITE_P(
    All, SettledBed,
    ::testing::Values(Bed{"Linear", &flat, {}},
                      Bed{"Hertz",
                          &flat,
                          {"interactions.sand-sand.law=hertz", "interactions.sand-floor.law=hertz",
                           "phases.sand={ kind = \"grains\", density = 2650, diameter = { mean = 1e-3, spread = 0.2 }, "
                           "friction = 0.5, rolling-friction = 0.2, young = 2e7, poisson = 0.3 }"}},
                      Bed{"OverACore", &over_a_core, {}}));

TEST_P(SettledBed, StaysAtRest) {
  const Scene scene = parse_scene(*GetParam().text, "bed.toml", GetParam().overrides);
  const auto blocks = make_particles(scene);
  const std::size_t sand = 0;
  Simulation run(scene, make_plan(scene, blocks), blocks);
  while (run.time() < 0.2) run.step(0.2 - run.time());
  const PhaseParticles& p = run.phases()[sand];
  double farthest = 0.0, area = 0.0;
  for (std::size_t i = 0; i < p.size(); ++i) {
    const auto from = blocks[sand].position[static_cast<std::size_t>(p.id()[i] - p.first_id())];
    double dx = p.column(Field::position, 0)[i] - from[0];
    dx -= scene.domain.size[0] * std::round(dx / scene.domain.size[0]);
    farthest = std::max(farthest, std::hypot(dx, p.column(Field::position, 1)[i] - from[1]));
    const double r = p.column(Field::radius)[i];
    area += std::numbers::pi * r * r;
  }
  EXPECT_LT(farthest, 1e-2 * 1e-3) << "in 0.2 s, of " << p.size() << " grains";
  ::testing::Test::RecordProperty("farthest", std::to_string(farthest));
  // A layer as thick everywhere as asked: a packing of discs has 0.80 to 0.86 of the area; half a grain is missing on
  // top.
  const double room = GetParam().text == &flat ? 0.05 * 0.0075 : 0.12 * 0.0035;
  EXPECT_GT(area / room, 0.70);
  EXPECT_LT(area / room, 0.92);
}

/// Writes the settled bed and gives a scene that reads it.
Scene from_file(const std::filesystem::path& file, const std::vector<std::string>& more = {}) {
  std::vector<std::string> overrides{"fill.1={ phase = \"sand\", shape = { file = \"" + file.string() + "\" } }"};
  overrides.insert(overrides.end(), more.begin(), more.end());
  return parse_scene(flat, "bed.toml", overrides);
}

TEST(BedOfAFile, IsThatOfTheFrame) {
  const Scene made = parse_scene(flat, "bed.toml", {"fill.1.shape={ bed = 0.003 }", "output.fields=[\"radius\"]"});
  const auto blocks = make_particles(made);
  const std::filesystem::path file =
      std::filesystem::temp_directory_path() / ("barchan_bed_" + std::to_string(getpid()) + ".vtp");
  write_frame(file, Simulation(made, make_plan(made, blocks), blocks).frame(0), FrameFormat::vtp, true);
  const auto read = make_particles(from_file(file));
  ASSERT_EQ(read[0].position.size(), blocks[0].position.size());
  for (std::size_t i = 0; i < blocks[0].position.size(); ++i) {
    EXPECT_EQ(read[0].position[i], blocks[0].position[i]);
    EXPECT_EQ(read[0].radius[i], blocks[0].radius[i]);
  }
  const std::string identity = from_file(file).identity;
  const auto refused = [&](const std::vector<std::string>& more, const std::string& word) {
    try {
      make_particles(from_file(file, more));
      ADD_FAILURE() << "taken: " << word;
    } catch (const SceneError& e) { EXPECT_NE(std::string(e.what()).find(word), std::string::npos) << e.what(); }
  };
  refused({"phases.sand.diameter={ mean = 1e-3, spread = 0.01 }"}, "the diameters of the phase");
  refused({"domain.size=[0.02, 0.03]", "domain.periodic=[]"}, "outside the domain");
  refused({"fill.1.shape={ file = \"nowhere.vtp\" }"}, "cannot be read");
  refused({"fill.1.packing=settled"}, "the file says where the grains are");
  refused({"fill.1.phase=floor"}, "only spheres are read from a file");
  Scene bare = made;
  bare.output.fields.clear();
  write_frame(file, Simulation(bare, make_plan(bare, blocks), blocks).frame(0), FrameFormat::vtp, true);
  refused({}, "no field radius");
  EXPECT_NE(from_file(file).identity, identity) << "another file is another scene to a checkpoint";
  std::filesystem::remove(file);
}

TEST(SettledBed, IsTheSameOnAnyNumberOfThreads) {
  const Scene scene = parse_scene(flat, "bed.toml", {"fill.1.shape={ bed = 0.003 }"});
  const int threads = omp_get_max_threads();
  omp_set_num_threads(1);
  const auto one = make_particles(scene);
  omp_set_num_threads(2);
  const auto three = make_particles(scene);
  omp_set_num_threads(threads);
  ASSERT_EQ(one[0].position.size(), three[0].position.size());
  for (std::size_t i = 0; i < one[0].position.size(); ++i) {
    EXPECT_EQ(one[0].position[i], three[0].position[i]);
    EXPECT_EQ(one[0].radius[i], three[0].radius[i]);
  }
}

}  // namespace
}  // namespace barchan
