// The flux of grains and the pull of a wind in history.csv, of a constructed state; what warns of too much of either.
#include "models/grains/grain_flux.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "checks/reader.hpp"
#include "plan/plan.hpp"
#include "simulation/simulation.hpp"
#include "unit/scene_texts.hpp"

namespace barchan {
namespace {

using testing::with;

/// Two grains of 0.25 mm over 0.01 m of ground, in a column of wind.
const std::string two_grains = R"toml(spacing = 2.5e-4
[domain]
size = [0.01, 0.02]
periodic = ["x"]
gravity = [0, -9.81]
[phases.air]
kind = "column"
density = 1.2
viscosity = 1.5e-5
friction-velocity = 0.5
[phases.sand]
kind = "grains"
density = 2650
diameter = { mean = 2.5e-4, spread = 0 }
restitution = 0.7
stiffness = 150
[phases.floor]
kind = "wall"
[interactions]
air-sand = { drag = "duran" }
sand-sand = { law = "linear" }
sand-floor = { law = "linear" }
[[fill]]
phase = "floor"
shape = { sides = ["bottom"] }
[[fill]]
phase = "sand"
shape = { points = [[0.002, 0.005], [0.006, 0.005]] }
velocity = ["x < 0.004 ? 1 : 3", 0]
[time]
end = 1e-3
largest-speed = 10
)toml";

std::unique_ptr<Simulation> run_of(const std::string& text) {
  const Scene scene = parse_scene(text, "grains.toml");
  return std::make_unique<Simulation>(scene, make_plan(scene, generate(scene)), generate(scene));
}

std::vector<double> flux_columns(const Simulation& run, const std::string& name) {
  const auto names = run.history_columns();
  const auto row = run.history_row();
  std::vector<double> found;
  for (std::size_t k = 0; k < names.size(); ++k)
    if (names[k] == name) found.push_back(row[k]);
  return found;
}

bool any_with(const std::vector<std::string>& texts, const std::string& words) {
  return std::any_of(texts.begin(), texts.end(), [&](const auto& t) { return t.find(words) != std::string::npos; });
}

// A grain of the slab, one diameter thick, by metre of width: rho pi/6 d^2.
TEST(GrainFlux, IsMassTimesSpeedOverTheLength) {
  const auto run = run_of(two_grains);
  const double by_metre = 2650.0 * std::numbers::pi / 6.0 * 2.5e-4 * 2.5e-4;
  ASSERT_EQ(flux_columns(*run, "sand_flux [kg/m/s]").size(), 1U);
  EXPECT_NEAR(flux_columns(*run, "sand_flux [kg/m/s]")[0], by_metre * (1.0 + 3.0) / 0.01, 1e-12);
  EXPECT_NEAR(flux_columns(*run, "air_pull [Pa]").at(0), 1.2 * 0.25, 1e-15);
  EXPECT_NEAR(flux_columns(*run, "air_equivalent_friction_velocity [m/s]").at(0), 0.5, 1e-15);
}

TEST(GrainFlux, StandsOnceBesideASaltationLayerOfItsName) {
  const auto run = run_of(two_grains + "[[saltation]]\nname = \"sand\"\nphase = \"sand\"\n");
  EXPECT_EQ(flux_columns(*run, "sand_flux [kg/m/s]").size(), 1U);
}

TEST(GrainFlux, IsNotThereWithoutADrive) {
  const auto run = run_of(with(two_grains, "friction-velocity = 0.5", "speed = 5\nheld = true"));
  EXPECT_TRUE(flux_columns(*run, "sand_flux [kg/m/s]").empty());
  EXPECT_TRUE(flux_columns(*run, "air_pull [Pa]").empty());
}

// The line gives 36.9 g/m/s at 0.5 m/s; the two grains carry 34.7 g/m/s, faster ones 217 g/m/s.
TEST(GrainFlux, TellsOfAFluxFarAboveTheMeasuredOne) {
  EXPECT_NEAR(creyssels_flux(0.5), 0.0369, 1e-4);
  EXPECT_EQ(creyssels_flux(0.1), 0.0);
  for (const bool fast : {false, true}) {
    const auto run = run_of(fast ? with(two_grains, "? 1 : 3", "? 12 : 13") : two_grains);
    while (run->time() < 1e-3 * (1 - 1e-9)) run->step(1e-3 - run->time());
    EXPECT_EQ(any_with(run->warnings().texts(), "Creyssels"), fast);
  }
}

TEST(GrainFlux, AColumnBeyondTheMeasuredWindsIsWarnedOf) {
  const auto warnings = [](const std::string& text) {
    const Scene scene = parse_scene(text, "grains.toml");
    return make_plan(scene, generate(scene)).warnings;
  };
  EXPECT_FALSE(any_with(warnings(two_grains), "1.5 times too large"));
  EXPECT_FALSE(any_with(run_of(two_grains)->warnings().texts(), "1.5 times too large"));
  EXPECT_TRUE(any_with(run_of(with(two_grains, "= 0.5", "= 0.85"))->warnings().texts(), "1.5 times too large"));
  EXPECT_TRUE(any_with(warnings(with(two_grains, "= 0.5", "= 0.85")), "1.5 times too large"));
  EXPECT_TRUE(any_with(warnings(with(two_grains, "= 0.5", "= \"0.5 + 500*t\"")), "1.5 times too large"));
}

TEST(WindowMean, IsThatOfWholeWindows) {
  WindowMean mean;
  mean.add(1.0, 0.5, 0.5, 2.0);
  mean.add(1.0, 1.0, 0.5, -1.0);  // alternates
  EXPECT_DOUBLE_EQ(mean.recent(1.0), 0.5);
  mean.add(1.0, 1.25, 0.25, 7.0);
  EXPECT_DOUBLE_EQ(mean.sum / mean.time, 7.0);
  EXPECT_DOUBLE_EQ(mean.recent(1.0), 0.5) << "the new window has had less than half";
  mean.add(1.0, 1.75, 0.5, 1.0);
  EXPECT_DOUBLE_EQ(mean.recent(1.0), 3.0);
}

}  // namespace
}  // namespace barchan
