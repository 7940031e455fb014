// [[forcing]] hold = "stress" and "pressure-gradient": the force on the ground is rho u*^2, history.csv says so, the
// air gains what is pulled less what the ground takes, and a held speed that pulls too hard is told of.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "physics/drive.hpp"
#include "physics/small_scenes.hpp"

namespace barchan {
namespace {

using testing::report;
using testing::value;

bool has_column(const Simulation& run, const std::string& name) {
  const auto names = run.history_columns();
  return std::find(names.begin(), names.end(), name) != names.end();
}

bool warns(const Simulation& run, const std::string& of) {
  const auto texts = run.warnings().texts();
  return std::any_of(texts.begin(), texts.end(),
                     [&](const std::string& text) { return text.find(of) != std::string::npos; });
}

/// Air of 1 m on a floor, 0.8 m of the periodic axis; rho u*^2 = 2 * 0.25 = 0.5 Pa.
const std::string air = R"toml(
spacing = 0.1
[domain]
size = [0.8, 1]
periodic = ["x"]
[phases.air]
kind = "fluid"
density = 2
viscosity = 0.1
sound-speed = 20
[phases.floor]
kind = "wall"
slip = "free-slip"
[phases.lid]
kind = "wall"
SLIDES
[interactions]
air-air = 2.1
air-floor = 2.1
air-lid = 2.1
[[fill]]
phase = "floor"
shape = { sides = ["bottom"] }
[[fill]]
phase = "lid"
shape = { sides = ["top"] }
[[fill]]
phase = "air"
shape = "the-rest"
velocity = [1, 0]
[[forcing]]
phase = "air"
HOLDS
[time]
end = 1
)toml";

std::unique_ptr<Simulation> wind(const std::string& lid, const std::string& hold,
                                 const std::vector<std::string>& sets = {}) {
  std::string text = air;
  text.replace(text.find("SLIDES"), 6, lid);
  text.replace(text.find("HOLDS"), 5, hold);
  return small::simulation(text, sets);
}

const std::string in_bulk = "hold = \"pressure-gradient\"\nfriction-velocity = 0.5",
                  by_lid = "hold = \"stress\"\nfriction-velocity = 0.5", slips = "slip = \"free-slip\"",
                  pulls = "shear-stress = [0.2, 0]";

// Without friction the momentum of 0.8 m of air grows by 0.5 Pa * 0.8 m a second.
TEST(HeldStress, GivesTheAirWhatItSays) {
  for (const bool lid : {false, true}) {
    const auto run = wind(lid ? pulls : slips, lid ? by_lid : in_bulk);
    const double before = value(*run, "momentum_x ["), start = run->time();
    while (run->time() < 0.2) run->step(1.0);
    const double gained = value(*run, "momentum_x [") - before;
    const double error = gained / (0.5 * 0.8 * (run->time() - start)) - 1.0;
    report(lid ? "momentum gained over rho u*^2 A t less 1, lid" : "the same, in the bulk", error, lid ? 0.01 : 1e-3);
    EXPECT_NEAR(error, 0.0, lid ? 0.01 : 1e-3);
    EXPECT_NEAR(value(*run, "air_pull [Pa]"), 0.5, 1e-12);
    EXPECT_NEAR(value(*run, "air_equivalent_friction_velocity [m/s]"), 0.5, 1e-12);
    EXPECT_NEAR(value(*run, "air_held_acceleration_x [m/s2]"), (lid ? 0.3 : 0.5) / 2.0, 1e-12);
  }
}

// A floor that rubs takes its share: dP/dt = pull less the force on the floor.
TEST(HeldStress, SlowsAsTheGroundTakesMore) {
  const auto run = wind(slips, in_bulk + "\n[[force]]\nname = \"f\"\nphase = \"floor\"", {"phases.floor.slip=no-slip"});
  while (run->time() < 0.05) run->step(1.0);
  const double before = value(*run, "momentum_x ["), start = run->time();
  const double taken = value(*run, "f_impulse_x [");
  while (run->time() < 0.25) run->step(1.0);
  const double time = run->time() - start, gained = value(*run, "momentum_x [") - before;
  const double floor = value(*run, "f_impulse_x [") - taken;
  const double expected = 0.5 * 0.8 * time - floor, error = (gained - expected) / (0.5 * 0.8 * time);
  report("momentum gained less (pull - floor), over the pull", error, 0.02);
  EXPECT_LT(gained, 0.0) << "the floor takes more than is given";
  EXPECT_NEAR(error, 0.0, 0.02);
}

// A formula in t; a scene that nothing drives has no such columns.
TEST(HeldStress, FollowsAFormula) {
  const auto run = wind(slips, "hold = \"pressure-gradient\"\nfriction-velocity = \"1 - 2*t\"");
  while (run->time() < 0.75) run->step(0.75 - run->time());
  EXPECT_NEAR(value(*run, "air_held_acceleration_x [m/s2]"), -0.25, 1e-9) << "rho u*|u*|/(rho 1 m)";
  EXPECT_FALSE(has_column(*wind(slips, in_bulk, {"forcing=[]"}), "air_pull [Pa]"));
}

// Rows may come after any number of steps: each has the mean of the hold over all of them.
TEST(HeldStress, ARowHasAllStepsSinceTheRowBefore) {
  const auto run = wind(pulls, "hold = \"bulk-speed\"", {"phases.floor.slip=no-slip"});
  const double mass = 2.0;  // kg/m2 of ground
  for (const int steps : {7, 1, 4, 12}) {
    double impulse = 0.0, time = 0.0;
    for (int k = 0; k < steps; ++k) {
      run->step(1.0);
      impulse += run->last_step() * value(*run, "air_held_acceleration_x [m/s2]");
      time += run->last_step();
    }
    const double expected = 0.2 + mass * impulse / time;
    EXPECT_NEAR(value(*run, "air_pull [Pa]"), expected, 1e-12 * std::abs(expected)) << steps;
    run->begin_row();
    EXPECT_NEAR(value(*run, "air_pull [Pa]"), expected, 1e-12 * std::abs(expected)) << "no step since";
  }
}

// What holds the speed alternates from step to step: the column is its mean since the last row, and goes on with the
// same bits after a restart.
TEST(HeldStress, MeansGoOnAfterARestart) {
  const auto make = [] { return wind(pulls, "hold = \"bulk-speed\"", {"phases.floor.slip=no-slip"}); };
  const auto run = make();
  for (int k = 0; k < 25; ++k) run->step(1.0);
  Archive saved;
  run->archive(saved);
  const auto again = make();
  Archive loads(saved.bytes());
  again->archive(loads);
  EXPECT_EQ(again->history_row(), run->history_row());
  for (int k = 0; k < 25; ++k) {
    run->step(1.0);
    again->step(1.0);
  }
  EXPECT_EQ(again->history_row(), run->history_row());
}

// The lid says 0.02 Pa, and the no-slip floor under air of 1 m/s takes more.
TEST(HeldStress, AHeldSpeedThatPullsTooHardIsToldOf) {
  const std::string speed = "hold = \"bulk-speed\"", weak = "shear-stress = [0.02, 0]";
  const std::vector<std::string> short_run{"phases.floor.slip=no-slip", "time.end=0.1"};
  const auto hard = wind(weak, speed, short_run), soft = wind("shear-stress = [2, 0]", speed, short_run);
  const auto held = wind(pulls, by_lid, short_run);
  for (const auto& run : {hard.get(), soft.get(), held.get()})
    while (run->time() < 0.1 * (1 - 1e-9)) run->step(0.1 - run->time());
  EXPECT_TRUE(warns(*hard, "\"air\" was pulled with"));
  EXPECT_FALSE(warns(*soft, "was pulled with"));
  EXPECT_FALSE(warns(*held, "was pulled with"));
}

}  // namespace
}  // namespace barchan
