// Beds that settled before the run: they stay where they are, and are the same on any number of threads.
#include <gtest/gtest.h>
#include <omp.h>

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>

#include "base/errors.hpp"
#include "output/compare.hpp"
#include "output/series.hpp"
#include "physics/small_scenes.hpp"
#include "simulation/grains_file.hpp"
#include "simulation/settle_room.hpp"
#include "unit/scene_texts.hpp"

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

/// What stands beside a bed and has no part in its settling.
const std::string beside = R"toml(
[phases.plate]
kind = "elastic"
density = 1000
young = 1e6
poisson = 0.3
[interactions.plate-plate]
radius = 1.6
[[fill]]
phase = "plate"
shape = { box = { min = [0.01, 0.02], max = [0.03, 0.026] } }
[[motion]]
phase = "plate"
box = { min = [0.01, 0.02], max = [0.014, 0.026] }
[[motion]]
phase = "plate"
box = { min = [0.026, 0.02], max = [0.03, 0.026] }
[[marker]]
name = "middle"
phase = "plate"
box = { min = [0.018, 0.02], max = [0.022, 0.026] }
[[force]]
name = "on_floor"
phase = "floor"
[[forcing]]
phase = "plate"
acceleration = [0, 1]
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

/// The farthest way of a grain of a phase from its begin (m) after a time.
double farthest_way(const Scene& scene, const std::vector<ParticleBlock>& blocks, double time, std::size_t phase = 0) {
  Simulation run(scene, make_plan(scene, blocks), blocks);
  while (run.time() < time) run.step(time - run.time());
  const PhaseParticles& p = run.phases()[phase];
  double farthest = 0.0;
  for (std::size_t i = 0; i < p.size(); ++i) {
    const auto from = blocks[phase].position[static_cast<std::size_t>(p.id()[i] - p.first_id())];
    double dx = p.column(Field::position, 0)[i] - from[0];
    dx -= scene.domain.size[0] * std::round(dx / scene.domain.size[0]);
    farthest = std::max(farthest, std::hypot(dx, p.column(Field::position, 1)[i] - from[1]));
  }
  return farthest;
}

TEST_P(SettledBed, StaysAtRest) {
  const Scene scene = parse_scene(*GetParam().text, "bed.toml", GetParam().overrides);
  const auto blocks = make_particles(scene);
  const std::size_t sand = 0;
  const double farthest = farthest_way(scene, blocks, 0.2);
  double area = 0.0;
  for (const double r : blocks[sand].radius) area += std::numbers::pi * r * r;
  EXPECT_LT(farthest, 1e-2 * 1e-3) << "in 0.2 s, of " << blocks[sand].position.size() << " grains";
  ::testing::Test::RecordProperty("farthest", std::to_string(farthest));
  // A layer as thick everywhere as asked: a packing of discs has 0.80 to 0.86 of the area; half a grain is missing on
  // top.
  const double room = GetParam().text == &flat ? 0.05 * 0.0075 : 0.12 * 0.0035;
  EXPECT_GT(area / room, 0.70);
  EXPECT_LT(area / room, 0.92);
}

/// A slope of 32 degrees, which friction alone holds: the contacts begin with the forces with which the bed came to
/// rest. Without them grains of the slope go until their contacts have slipped as far again.
TEST(SettledBed, OfASteepSlopeNeedsItsContacts) {
  const std::string dune =
      ", dune = { form = \"asymmetric\", slip-face-angle = 32, height = 0.016, length = 0.1, at = 0.06 } }";
  Scene scene = parse_scene(over_a_core, "slope.toml",
                            {"fill.0.shape={ bed = 0.002" + dune, "fill.1.shape={ bed = 0.006" + dune,
                             "phases.sand.friction=1.0", "phases.sand.rolling-friction=0.8"});
  auto blocks = make_particles(scene);
  EXPECT_GT(blocks[0].contacts.size(), blocks[0].position.size());
  EXPECT_LT(farthest_way(scene, blocks, 0.1), 1e-2 * 1e-3) << "of " << blocks[0].position.size() << " grains";
  blocks[0].contacts.clear();
  EXPECT_GT(farthest_way(scene, blocks, 0.1), 1e-2 * 1e-3);
}

/// A scene whose grains are those of a file.
Scene from_file(const std::filesystem::path& file, const std::vector<std::string>& more = {}) {
  std::vector<std::string> overrides{"fill.1={ phase = \"sand\", shape = { file = \"" + file.string() + "\" } }"};
  overrides.insert(overrides.end(), more.begin(), more.end());
  return parse_scene(flat, "bed.toml", overrides);
}

/// A frame of a settled bed as a run writes it, and what changes of it write.
class BedOfAFile : public ::testing::Test {
 protected:
  BedOfAFile() : made_(parse_scene(flat, "bed.toml", {"fill.1.shape={ bed = 0.003 }", "output.fields=[\"radius\"]"})) {
    blocks_ = make_particles(made_);
    const Simulation run(made_, make_plan(made_, blocks_), blocks_);
    frame_ = run.frame(0);
    add_contacts(frame_, blocks_[0].contacts, run.phases()[0].first_id());
    write(frame_);
  }
  ~BedOfAFile() override { std::filesystem::remove(file_); }
  void write(const Frame& frame) const { write_frame(file_, frame, FrameFormat::vtp, true); }
  static std::vector<double>& radius(Frame& frame) {
    const auto found = std::find_if(frame.fields.begin(), frame.fields.end(),
                                    [](const auto& field) { return field.name == "radius"; });
    return found->values;
  }
  /// Number in the frame of the n-th grain.
  static std::size_t grain(const Frame& frame, std::size_t n) {
    std::size_t i = 0;
    for (;; ++i)
      if (frame.phase_names[static_cast<std::size_t>(frame.phase[i])] == "sand" && n-- == 0) return i;
  }
  /// The scene is refused with these words, at a key of the fill.
  void refused(const std::string& words, const std::vector<std::string>& more = {}) const {
    try {
      make_particles(from_file(file_, more));
      ADD_FAILURE() << "taken: " << words;
    } catch (const SceneError& e) {
      EXPECT_NE(std::string(e.what()).find(words), std::string::npos) << e.what();
      EXPECT_NE(std::string(e.what()).find("fill.1"), std::string::npos) << e.what();
    }
  }

  const std::filesystem::path file_ =
      std::filesystem::temp_directory_path() / ("barchan_bed_" + std::to_string(getpid()) + ".vtp");
  Scene made_;
  std::vector<ParticleBlock> blocks_;
  Frame frame_;
};

TEST_F(BedOfAFile, IsThatOfTheFrame) {
  const auto read = make_particles(from_file(file_));
  ASSERT_EQ(read[0].position.size(), blocks_[0].position.size());
  for (std::size_t i = 0; i < blocks_[0].position.size(); ++i) {
    EXPECT_EQ(read[0].position[i], blocks_[0].position[i]);
    EXPECT_EQ(read[0].radius[i], blocks_[0].radius[i]);
  }
  const auto &contacts = read[0].contacts, &written = blocks_[0].contacts;
  ASSERT_EQ(contacts.size(), written.size());
  EXPECT_GT(contacts.size(), blocks_[0].position.size());
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    EXPECT_EQ(contacts[i].sphere, written[i].sphere);
    EXPECT_EQ(contacts[i].branch, written[i].branch);
    EXPECT_EQ(contacts[i].force, written[i].force);
    EXPECT_EQ(contacts[i].torque, written[i].torque);
  }
}

/// Contacts that begin with their forces have them after a step.
TEST_F(BedOfAFile, BeginsWithItsForces) {
  Simulation run(made_, make_plan(made_, blocks_), blocks_);
  run.step(1e-9);
  const auto& before = blocks_[0].contacts;
  const auto after = run.resting_contacts(0);
  double largest = 0.0, farthest = 0.0;
  std::size_t found = 0;
  for (const RestingContact& was : before)
    for (const RestingContact& is : after)
      if (is.sphere == was.sphere && norm(is.branch - was.branch) < 1e-6) {
        ++found;
        largest = std::max(largest, norm(was.force));
        farthest = std::max(farthest, norm(is.force - was.force));
      }
  EXPECT_EQ(found, before.size());
  EXPECT_GT(largest, 0.0);
  EXPECT_LT(farthest, 0.05 * largest);  // of one that slides, its limit is that of the step
}

TEST_F(BedOfAFile, IsRefusedWithContactsThatAreNotWhole) {
  Frame frame = frame_;
  frame.contacts.pop_back();
  write(frame);
  refused("has contacts that are not whole");
  frame = frame_;
  frame.contacts[2].values[4] = std::nan("");
  write(frame);
  refused("has contacts that are not whole");
  frame = frame_;
  frame.contacts[0].values.pop_back();
  write(frame);
  refused("has contacts that are not whole");
}

TEST_F(BedOfAFile, IsComparedWithItsContacts) {
  Frame frame = frame_;
  EXPECT_TRUE(compare(frame_, frame, 0.0).same);
  frame.contacts[2].values[4] *= 1.001;
  EXPECT_FALSE(compare(frame_, frame, 1e-9).same);
  frame.contacts.clear();
  EXPECT_FALSE(compare(frame_, frame, 1e-9).same);
}

/// The frame is one from the middle of a run, whose contacts remember their slip; those of the next run do not.
TEST_F(BedOfAFile, StaysAtRestInTheNextRun) {
  Simulation run(made_, make_plan(made_, blocks_), blocks_);
  while (run.time() < 0.02) run.step(0.02 - run.time());
  write(run.frame(1));
  const Scene as_it_is = from_file(file_), at_rest = from_file(file_, {"fill.1.packing=settled"});
  const auto taken = make_particles(as_it_is), rested = make_particles(at_rest);
  ASSERT_EQ(rested[0].position.size(), taken[0].position.size());
  EXPECT_LT(farthest_way(at_rest, rested, 0.2), 1e-2 * 1e-3) << "of " << rested[0].position.size() << " grains";
  // Without the slip that they remember a few grains roll.
  EXPECT_LT(farthest_way(as_it_is, taken, 0.2), 1e-3);
}

TEST_F(BedOfAFile, IsRefusedWhereTheSceneCannotHaveIt) {
  refused("the diameters of the phase", {"phases.sand.diameter={ mean = 1e-3, spread = 0.01 }"});
  refused("the diameters of the phase", {"phases.sand.diameter=1e-3"});
  refused("outside the domain", {"domain.size=[0.02, 0.03]", "domain.periodic=[]"});
  refused("shape.file: cannot read '", {"fill.1.shape={ file = \"nowhere.vtp\" }"});
  refused("the file says where the grains are", {"fill.1.packing=random"});
  refused("the file says where the grains are", {"fill.1.perturb=0.1"});
  refused("only spheres are read from a file", {"fill.1.phase=floor"});
  Frame frame = frame_;
  for (std::string& name : frame.phase_names)
    if (name == "sand") name = "grit";
  write(frame);
  refused("has no phase \"sand\"");
  try {
    parse_scene(
        "dimensions = 2\nspacing = 1e-3\n[domain]\nsize = [1, 1]\n[phases.sand]\nkind = \"grains\"\n"
        "density = 1\ndiameter = 0.1\n[[fill]]\nphase = \"sand\"\nshape = { file = \"bed.vtp\" }\n"
        "packing = \"random\"\n[time]\nend = 1\n",
        "bed.toml");
    ADD_FAILURE() << "taken with a packing";
  } catch (const SceneError& e) {
    EXPECT_NE(std::string(e.what()).find("bed.toml:12:11"), std::string::npos) << e.what();
  }
}

TEST_F(BedOfAFile, IsRefusedWithWrongFields) {
  Frame frame = frame_;
  std::erase_if(frame.fields, [](const FrameField& field) { return field.name == "radius"; });
  write(frame);
  refused("has no field radius");
  frame = frame_;
  radius(frame)[grain(frame, 3)] *= 2.0;
  write(frame);
  refused("the diameters of the phase");
  frame = frame_;
  frame.points[3 * grain(frame, 3) + 1] = std::nan("");
  write(frame);
  refused("at no finite place");
  frame = frame_;
  frame.points[3 * grain(frame, 3) + 2] = 1e-3;
  write(frame);
  refused("expected z = 0 in two dimensions");
}

TEST_F(BedOfAFile, IsRefusedWhereGrainsOverlap) {
  Frame frame = frame_;
  const std::size_t a = grain(frame, 3), b = grain(frame, 40);
  const double reach = radius(frame)[a] + radius(frame)[b];
  frame.points[3 * b] = frame.points[3 * a] + 0.69 * reach;
  frame.points[3 * b + 1] = frame.points[3 * a + 1];
  write(frame);
  refused("overlap by more than 30 %");
}

TEST_F(BedOfAFile, IsRefusedWhenDamaged) {
  const auto size = std::filesystem::file_size(file_);
  std::filesystem::resize_file(file_, size - size / 3);
  refused("shape.file: cannot read '");
}

TEST_F(BedOfAFile, IsAnotherSceneToACheckpointWhenItChanges) {
  const std::string identity = from_file(file_).identity;
  EXPECT_EQ(from_file(file_).identity, identity);
  Frame frame = frame_;
  frame.points[3 * grain(frame, 3)] += 1e-9;
  write(frame);
  EXPECT_NE(from_file(file_).identity, identity);
}

/// The whole scene without its wind: its bed settled with half of the friction, so that no contact slips when the run
/// begins without what contacts remember.
TEST(SettledBed, OfTheFlatBedStaysAtRestWithoutWind) {
  const Scene scene = read_scene(BARCHAN_SOURCE_DIR "/scenes/flat_bed.toml",
                                 {"fill.4.velocity=[0, 0]", "phases.lid.shear-stress=[0, 0]", "forcing=[]"});
  const auto blocks = make_particles(scene);
  const auto sand = static_cast<std::size_t>(
      std::find_if(scene.phases.begin(), scene.phases.end(), [](const Phase& p) { return p.name == "sand"; }) -
      scene.phases.begin());
  EXPECT_LT(farthest_way(scene, blocks, 0.005, sand), 1e-2 * 2.5e-4);
}

// Motions, markers, forces and what is measured belong to the run: the bed is the one that settles without them.
// The highest grain of each of ten columns of the domain (m).
std::vector<double> heights_of(const std::vector<ParticleBlock>& blocks, double width) {
  std::vector<double> highest(10, 0.0);
  for (const Vec3& x : blocks[0].position) {
    double& here = highest[std::min<std::size_t>(static_cast<std::size_t>(10.0 * x[0] / width), 9)];
    here = std::max(here, x[1]);
  }
  return highest;
}

TEST(SettledBed, OfAFormulaHasItsTwoDunes) {
  const std::string formula = "0.004 * (exp(-((x - 0.0125) / 0.004)^2) + exp(-((x - 0.0375) / 0.004)^2))";
  const Scene scene = parse_scene(
      testing::with(flat, "bed = 0.008", "bed = 0.008, dune = { form = \"formula\", formula = \"" + formula + "\" }"),
      "two.toml");
  const auto top = heights_of(make_particles(scene, nullptr), 0.05);
  for (const std::size_t crest : {2U, 7U}) EXPECT_NEAR(top[crest], 0.0115, 1e-3) << "column " << crest;
  for (const std::size_t plain : {0U, 4U, 5U, 9U}) EXPECT_NEAR(top[plain], 0.008, 1e-3) << "column " << plain;
}

TEST(SettledBed, TwoInOnePlaceAreRefusedBeforeTheySettle) {
  const std::string second = "\n[[fill]]\nphase = \"sand\"\npacking = \"settled\"\nshape = { ";
  const auto refusal = [&](const std::string& shape) -> std::string {
    try {
      refuse_beds_in_one_place(parse_scene(testing::with(flat, "\n[time]", second + shape + " }\n[time]"), "two.toml"));
    } catch (const SceneError& error) { return error.what(); }
    return "";
  };
  EXPECT_NE(refusal("bed = 0.01").find("its grains settle where those of fill.1 do, by 0.008 m"), std::string::npos)
      << refusal("bed = 0.01");
  EXPECT_NE(refusal("box = { min = [0.01, 0], max = [0.02, 0.02] }"), "");
  EXPECT_EQ(refusal("bed = 0.016, from = 0.008"), "") << "one over the other";
  EXPECT_EQ(refusal("box = { min = [0.01, 0.0081], max = [0.02, 0.02] }"), "");
}

TEST(SettledBed, BoxesSideBySideAreNotInOnePlace) {
  const std::string boxes =
      "shape = { box = { min = [0, 0], max = [0.025, 0.01] } }\npacking = \"settled\"\n[[fill]]\nphase = \"sand\"\n"
      "shape = { box = { min = [0.025, 0], max = [0.05, 0.01] } }\n";
  const Scene scene = parse_scene(testing::with(flat, "shape = { bed = 0.008 }\n", boxes), "boxes.toml");
  EXPECT_NO_THROW(refuse_beds_in_one_place(scene));
}

TEST(SettledBed, SettlesAloneWhateverStandsBesideIt) {
  const std::vector<std::string> shallow{"fill.1.shape={ bed = 0.003 }"};
  const auto alone = make_particles(parse_scene(flat, "bed.toml", shallow));
  const auto run = small::simulation(flat + beside, shallow);
  const auto blocks = make_particles(parse_scene(flat + beside, "bed.toml", shallow));
  ASSERT_EQ(alone[0].position.size(), blocks[0].position.size());
  for (std::size_t i = 0; i < alone[0].position.size(); ++i) EXPECT_EQ(alone[0].position[i], blocks[0].position[i]);
  for (int k = 0; k < 20; ++k) run->step(1.0);
  EXPECT_NO_THROW(run->check());
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
