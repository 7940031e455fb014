// Scenes made to break: each is stopped within 20 steps of the first particle that is wrong, with a message that names
// it, and leaves a series of good frames.
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "base/errors.hpp"
#include "checks/reader.hpp"
#include "output/series.hpp"
#include "stress/detector.hpp"
#include "stress/scenes.hpp"

namespace barchan {
namespace {

namespace fs = std::filesystem;
using namespace stress;

struct Case {
  const char* name;
  const std::string* scene;
  std::vector<std::string> overrides;
  std::vector<std::string> words;  // of the message
  long steps = 3000;               // after which it must have broken down
};
void PrintTo(const Case& c, std::ostream* out) { *out << c.name; }

/// Those that break on their way: exit status 3.
const std::vector<Case>& broken_on_the_way() {
  static const std::vector<Case> cases{
      {"FiveTimesTheStep", &vortices, {"time.step=0.008"}, {"phase \"fluid\"", "lower time.step"}},
      {"AccelerationBeyondSound",
       &vortices,
       {"forcing.0.acceleration=[100, 0]"},
       {"phase \"fluid\"", "is faster", "than sound (10 m/s)", "raise phases.fluid.sound-speed"}},
      {"TooFewNeighbours",
       &vortices,
       {"phases.fluid.scheme='plain'", "interactions.fluid-fluid=1.2", "phases.fluid.sound-speed=2.5"},
       {"phase \"fluid\"", ": density ", "out of bounds (0.7 to 1.3)", "the radius of interactions.fluid-fluid"}},
      {"CubicSplinePairing",
       &vortices,
       {"phases.fluid.scheme='plain'", "interactions.kernel='cubic-spline'", "interactions.fluid-fluid=3"},
       {"phase \"fluid\"", "stand in pairs", "wendland-c2"}},
      {"ForceSwitchedOn",
       &vortices,
       {"forcing.0.acceleration=['t > 0.05 ? 1e14 : 0', 0]"},
       {"particle ", "phase \"fluid\"", "is faster", "with an acceleration of 1e+14 m/s2"}},
      {"ForceNotFinite",
       &vortices,
       {"forcing.0.acceleration=['x <= 0 ? 1 : sqrt(0.05-t)', 0]"},
       {"particle 0 of phase \"fluid\"", "forcing.0.acceleration: the formula"}},
      {"AirAlmostAsFastAsItsSound",
       &two_fluids,
       {"fill.2.velocity=['15*sin(2*pi*x/0.3)', 0]", "phases.water.scheme='plain'", "phases.air.scheme='plain'"},
       {"phase \"air\"", "kg/m3 is out of bounds", "phases.air.sound-speed"}},
      {"GrainsWithLowContactSpeed",
       &over_a_floor,
       {"phases.sand.contact-speed=0.25", "fill.1.velocity=[0, -0.3]"},
       {"phase \"sand\"", "spacings in one step", "raise phases.sand.contact-speed (0.25 m/s)"}},
      {"PilePressedThroughItsFloor",
       &pile,
       {"phases.sand.contact-speed=0.1"},
       {"phase \"sand\"", "the wall \"floor\"", "raise phases.sand.contact-speed"}},
      {"NoWall",
       &over_a_floor,
       {"domain.gravity=[0, 9.81]", "fill.1.velocity=[0, 1]"},
       {"phase \"sand\"", "escaped through the upper side of y", "add a wall"}},
      {"StepTooLongForContacts",
       &over_a_floor,
       {"time.step=5e-5", "phases.sand.restitution=1"},
       {"escaped through the upper side of y at", "the computation gained that energy", "lower time.step"}},
      {"SoftBodiesInOnePlace",
       &single_particles,
       {},
       {"particle 0 of phase \"a\"", "in the same place", "1 of phase \"b\"", "raise phases.a.young"}},
      {"TornBody",
       &two_squares,
       {"fill.0.velocity=['8000*(x-0.01)', 0]"},
       {"phase \"a\"", "escaped through the lower side of x"}},
  };
  return cases;
}

/// Those that are wrong before the first step: exit status 2.
const std::vector<Case>& wrong_at_the_start() {
  static const std::vector<Case> cases{
      {"SoundBelowTheFlow",
       &vortices,
       {"phases.fluid.sound-speed=0.9"},
       {"phase \"fluid\"", "is faster", "sound (0.9"}},
      {"FastGrain",
       &over_a_floor,
       {"fill.1.velocity=[0, -300]"},
       {"particle 0 of phase \"sand\"", "300 m/s", "raise phases.sand.contact-speed"}},
      {"BodyFasterThanItsWaves", &single_particles, {"fill.0.velocity=[10, 0]"}, {"phase \"a\"", "compression waves"}},
      {"HugeForce",
       &vortices,
       {"forcing.0.acceleration=[1e12, 0]"},
       {"phase \"fluid\"", "with an acceleration of 1e+12 m/s2", "gains more than the signal speed, 10 m/s"}},
      {"CollapsedStep",
       &vortices,
       {"forcing.0.acceleration=[1e17, 0]"},
       {"phase \"fluid\"", "the time step collapsed", "[[forcing]]"}},
      {"PressureTooHigh", &vortices, {"fill.0.pressure=40"}, {"phase \"fluid\"", "density 1.4", "out of bounds"}},
  };
  return cases;
}

std::unique_ptr<Simulation> simulation(const Case& c) {
  const Scene scene = parse_scene(*c.scene, "scene.toml", c.overrides);
  const auto blocks = generate(scene);
  return std::make_unique<Simulation>(scene, make_plan(scene, blocks), blocks);
}

std::string missing(const std::string& message, const std::vector<std::string>& words) {
  for (const auto& w : words)
    if (message.find(w) == std::string::npos) return w;
  return "";
}

class Broken : public ::testing::TestWithParam<Case> {
 protected:
  void SetUp() override {
    char name[] = "/tmp/barchan_stress_XXXXXX";
    place_ = mkdtemp(name);
  }
  void TearDown() override {
    std::error_code ignored;
    fs::remove_all(place_, ignored);
  }

  int run(const Case& c) {
    std::ofstream(place_ / "scene.toml") << *c.scene;
    std::string command = "'" BARCHAN_PROGRAM "' run '" + (place_ / "scene.toml").string() +
                          "' --quiet --retreats 0 --out '" + out().string() + "' 2> '" + (place_ / "said").string() +
                          "'";
    for (const auto& o : c.overrides) {
      std::string text;  // for the shell: ' becomes '\''
      for (const char x : o) text += x == '\'' ? "'\\''" : std::string(1, x);
      command += " --set '" + text + "'";
    }
    const int status = std::system(command.c_str());
    std::ostringstream text;
    text << std::ifstream(place_ / "said").rdbuf();
    said_ = text.str();
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }
  fs::path out() const { return place_ / "out"; }

  fs::path place_;
  std::string said_;
};

class BrokenOnTheWay : public Broken {};

TEST_P(BrokenOnTheWay, IsStoppedWithinTwentySteps) {
  const Case& c = GetParam();
  const auto s = simulation(c);
  ASSERT_NO_THROW(s->check_start());
  const Detector detector(*s);
  ASSERT_EQ(detector.wrong(), "");
  long first = -1;
  std::string what;
  try {
    while (s->steps() < c.steps) {
      s->step(1e300);
      if (first < 0 && !(what = detector.wrong()).empty()) first = s->steps();
    }
    FAIL() << "nothing stopped it; first wrong at step " << first << ": " << what;
  } catch (const BreakdownError& e) {
    EXPECT_EQ(missing(e.what(), c.words), "") << e.what();
    if (first < 0) first = s->steps();  // noticed at once
    RecordProperty("steps_late", static_cast<int>(s->steps() - first));
    std::printf("first wrong particle in step %ld (%s), stopped in step %ld\n", first, what.c_str(), s->steps());
    EXPECT_LE(s->steps() - first, 20) << what << "; " << e.what();
    EXPECT_LT(s->good_step(), first) << "the good state is not from before it";
  }
}

TEST_P(BrokenOnTheWay, LeavesASeriesOfGoodFrames) {
  const Case& c = GetParam();
  ASSERT_EQ(run(c), 3) << said_;
  EXPECT_EQ(missing(said_, c.words), "") << said_;
  EXPECT_EQ(said_.find("0.000000"), std::string::npos) << said_;
  const auto entries = read_pvd(out() / "scene.pvd");
  ASSERT_FALSE(entries.empty());
  EXPECT_NE(said_.find("last good state: " + entries.back().file), std::string::npos) << said_;
  const Frame bad = read_frame(out() / "scene_bad.vtp");
  EXPECT_NE(said_.find("first bad state: scene_bad.vtp"), std::string::npos) << said_;
  for (const auto& e : entries) {
    const Frame frame = read_frame(out() / e.file);
    EXPECT_EQ(frame.time, e.time);
    EXPECT_LT(frame.time, bad.time);
    EXPECT_EQ(frame.size(), bad.size());
    for (const auto& field : frame.fields)
      EXPECT_TRUE(std::all_of(field.values.begin(), field.values.end(), [](double x) { return std::isfinite(x); }))
          << field.name << " of " << e.file;
  }
  std::ifstream history(out() / "history.csv");
  std::string line;
  while (std::getline(history, line)) EXPECT_EQ(line.find("nan"), std::string::npos) << line;
  const auto report = nlohmann::json::parse(std::ifstream(out() / "run.json"));
  EXPECT_EQ(report["end_reason"].get<std::string>().substr(0, 11), "breakdown: ");
}

const auto name_of = [](const auto& test) { return std::string(test.param.name); };
INSTANTIATE_TEST_SUITE_P(Scenes, BrokenOnTheWay, ::testing::ValuesIn(broken_on_the_way()), name_of);

class WrongAtTheStart : public Broken {};

TEST_P(WrongAtTheStart, IsAWrongSceneAndWritesNothing) {
  const Case& c = GetParam();
  const auto s = simulation(c);
  EXPECT_THROW(s->check_start(), SceneError);
  ASSERT_EQ(run(c), 2) << said_;
  EXPECT_EQ(missing(said_, c.words), "") << said_;
  EXPECT_NE(said_.find("the scene is wrong at its start"), std::string::npos) << said_;
  EXPECT_FALSE(fs::exists(out()));
}
INSTANTIATE_TEST_SUITE_P(Scenes, WrongAtTheStart, ::testing::ValuesIn(wrong_at_the_start()), name_of);

}  // namespace
}  // namespace barchan
