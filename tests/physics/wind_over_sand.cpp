// Wind over grains finer than the air's particles (scenes/wind_over_sand.toml): what the layers near the ground leave
// of the logarithmic profile in the first hundredth of a second, before many grains fly.
#include <omp.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <numbers>
#include <string>
#include <vector>

#include "base/errors.hpp"
#include "models/column/air_column.hpp"
#include "physics/drive.hpp"

namespace barchan {
namespace {

using testing::Drive;
using testing::report;

TEST(WindOverSand, KeepsTheLogarithmicProfile) {
  Drive drive("wind_over_sand", {"time.end=0.01"});
  drive.to(0.01);
  constexpr double friction_velocity = 0.4, roughness = 8.3e-6, bed = 0.003;  // as the scene has them
  const auto& air = drive.phase(0);
  double worst = 0;
  for (std::size_t k = 0; k < air.size(); ++k) {
    const double height = air.column(Field::position, 1)[k] - bed;
    if (height < 4e-3) continue;  // above the second row
    const double wind = friction_velocity / 0.4 * std::log(height / roughness);
    worst = std::max(worst, std::abs(air.column(Field::velocity, 0)[k] / wind - 1));
  }
  report("largest error of the wind over 4 mm", worst, 0.02);
  EXPECT_LE(worst, 0.02);
  const auto columns = drive.simulation().history_columns();
  const auto row = drive.simulation().history_row();
  const auto at = std::find(columns.begin(), columns.end(), "air-sand_ground_stress [Pa]") - columns.begin();
  ASSERT_LT(static_cast<std::size_t>(at), row.size());
  const double share = row[static_cast<std::size_t>(at)] / (1.225 * friction_velocity * friction_velocity);
  report("stress on the ground over rho u*^2", share, 2.0);
  EXPECT_GE(share, 0.9);
  EXPECT_LE(share, 2.0);
}

/// Warnings of the bed in an open wind: grains at rest but those before the outflow, and what enters.
std::vector<std::string> warnings_of_an_open_wind(const std::string& roughness, const std::string& speed) {
  const std::string wind = "log-profile = { friction-velocity = 0.4, roughness = " + roughness + " }";
  Drive drive("wind_over_sand",
              {"domain.periodic=[]", "domain.open=[\"right\"]", "forcing=[]", "phases.lid.shear-stress=[0, 0]",
               "inflow=[{ phase = \"air\", side = \"left\", velocity = { " + wind + " } }]",
               "outflow=[{ phase = \"air\", side = \"right\" }]", "fill.4.velocity={ " + wind + " }",
               "fill.3.velocity=[\"x < 0.09 ? 0 : " + speed + "\", 0]", "time.end=2e-4"});
  drive.to(2e-4);
  return drive.simulation().warnings().texts();
}

TEST(WindOverSand, AnOpenWindIsWarnedOfWhereItIsNotTheStatedOne) {
  const auto any = [](const std::vector<std::string>& texts, const std::string& words) {
    return std::any_of(texts.begin(), texts.end(), [&](const auto& t) { return t.find(words) != std::string::npos; });
  };
  const auto calm = warnings_of_an_open_wind("8.3e-6", "0");
  EXPECT_FALSE(any(calm, "the ground took")) << calm.front();
  EXPECT_FALSE(any(calm, "still grows at the outflow"));
  EXPECT_TRUE(any(warnings_of_an_open_wind("8.3e-6", "0.1"), "still grows at the outflow"));
  // The same u* over a ground that is said to be much smoother: the speeds are those of a larger u*.
  EXPECT_TRUE(any(warnings_of_an_open_wind("8.3e-9", "0"), "the ground took"));
}

/// Without grains in flight nothing but the bed takes the wind's momentum: that of a smooth sheet would be less.
TEST(WindOverSand, AHeavyBedIsAsRoughAsItsGrains) {
  Drive drive("wind_over_sand", {"phases.sand.density=2.65e6", "time.end=0.004"});
  drive.to(0.004);
  const auto columns = drive.simulation().history_columns();
  const auto row = drive.simulation().history_row();
  const auto at = std::find(columns.begin(), columns.end(), "air-sand_ground_stress [Pa]") - columns.begin();
  const double share = row[static_cast<std::size_t>(at)] / (1.225 * 0.4 * 0.4);
  report("stress on the ground over rho u*^2", share, 1.2);
  EXPECT_NEAR(share, 1.05, 0.15);
}

/// The air keeps the drag of one exchange: that of a second phase of grains would take its place.
TEST(WindOverSand, OneAirHasOnePhaseOfGrains) {
  std::string told;
  try {
    const std::string grit =
        "phases.grit={ kind = \"grains\", density = 2650, diameter = 5e-4, stiffness = 200, restitution = 0.7 }";
    Drive drive("wind_over_sand", {grit, "interactions.air-grit={ drag = \"duran\" }"});
  } catch (const SceneError& error) { told = error.what(); }
  EXPECT_NE(told.find("one phase of grains in its air"), std::string::npos) << told;
}

/// A grain that is twice as heavy as the air feels half of gravity besides its drag.
TEST(WindOverSand, BuoyancyTakesTheWeightOfTheAir) {
  Drive drive("wind_over_sand", {"fill.3={ phase = \"sand\", shape = { points = [[0.05, 0.02]] } }",
                                 "phases.sand.diameter={ mean = 2.5e-4, spread = 0 }", "phases.sand.density=2.45",
                                 "interactions.air-sand.buoyancy=true", "time.end=1e-5"});
  drive.simulation().step(1e-5);
  const PhaseParticles& sand = drive.phase(1);
  const double weight = sand.column(Field::acceleration, 1)[0] - sand.column(Field::drag_acceleration, 1)[0];
  EXPECT_NEAR(weight, -0.5 * 9.81, 1e-9);
}

/// Of one grain on flat ground, at rest: the share of the drag that Anderson & Hallet's difference of winds gives.
TEST(WindOverSand, LiftIsAShareOfTheDrag) {
  const std::string grain = "fill.3={ phase = \"sand\", shape = { points = [[0.05, 0.0032]] } }";
  Drive drive("wind_over_sand", {grain, "phases.sand.diameter={ mean = 2.5e-4, spread = 0 }",
                                 "interactions.air-sand.lift=0.85", "time.end=1e-4"});
  drive.simulation().step(1e-4);
  const PhaseParticles& sand = drive.phase(1);
  ASSERT_EQ(sand.size(), 1u);
  // Half way between two layers; its radius on both sides of it.
  const double radius = 1.25e-4, height = sand.column(Field::position, 1)[0] - 0.003;
  double shear = 0, wind = 0;
  for (const std::size_t k : {4, 5}) {
    AirProfile profile = drive.simulation().state().air.at(k);
    AirColumn column({1.225, 1.48e-5, MixingLength::duran, Slip::no_slip}, profile);
    column.integrate_speed();
    shear += column.mean_speed(height, height + radius) - column.mean_speed(height - radius, height);
    wind += column.mean_speed(height - radius, height + radius);
  }
  const double share = 0.85 * shear / wind;
  const double lift = sand.column(Field::drag_acceleration, 1)[0], drag = sand.column(Field::drag_acceleration, 0)[0];
  EXPECT_GT(drag, 1.0);
  report("lift over drag, over its formula", lift / drag / share, 1.02);
  EXPECT_NEAR(lift / drag / share, 1.0, 0.02);
}

/// Grains of a cloud in the layers and over them, with gusts and lift.
std::vector<std::string> cloud_with(const std::string& key) {
  std::string points;
  for (int k = 0; k < 60; ++k)
    points += (k ? ", [" : "[") + std::to_string(0.001 + 0.002 * k) + ", " + std::to_string(0.0034 + 1e-4 * k) + "]";
  const std::string cloud = "fill.3={ phase = \"sand\", shape = { points = [" + points + "] } }";
  return {cloud, "interactions.air-sand.lift=0.85", "interactions.air-sand.gusts=0.38", "time.end=2e-3", key};
}

double momentum_by_drag(const PhaseParticles& p, int d) {
  double sum = 0;
  for (std::size_t k = 0; k < p.size(); ++k) sum += p.mass_of(k) * p.column(Field::drag_acceleration, d)[k];
  return sum;
}

/// What the layers and the particles of the air lose less what grains in the layers and over them get, along x and y;
/// and what the grains get along x.
std::array<double, 3> unbalanced(Drive& drive) {
  const State& state = drive.simulation().state();
  double layers = 0;
  for (const AirProfile& p : state.air)
    for (const double given : p.given)
      layers += given / state.air[0].last * 0.12 / static_cast<double>(state.air.size());
  const PhaseParticles &air = drive.phase(0), &sand = drive.phase(1);
  const double x = momentum_by_drag(sand, 0), y = momentum_by_drag(sand, 1);
  EXPECT_GT(std::abs(momentum_by_drag(air, 0)), 1e-3 * std::abs(x));  // some are over the layers, and gusts
  EXPECT_GT(std::abs(y), 1e-3 * std::abs(x));
  return {layers - x - momentum_by_drag(air, 0), y + momentum_by_drag(air, 1), x};
}

void expect_exact_exchange(Drive& drive) {
  const auto [along, up, all] = unbalanced(drive);
  EXPECT_NEAR(along / all, 0.0, 1e-10);
  EXPECT_NEAR(up / all, 0.0, 1e-10);
}

TEST(WindOverSand, GustsAndLiftKeepTheMomentum) {
  for (const char* more :
       {"phases.sand.sleep=false", "interactions.air-sand.magnus=true", "phases.air.turbulence=k-omega"}) {
    Drive drive("wind_over_sand", cloud_with(more));
    for (int step = 0; step < 20; ++step) drive.simulation().step(1.0);
    expect_exact_exchange(drive);
  }
}

/// The same in three dimensions: a cloud that also moves along z, about both sides of the period.
void expect_exact_exchange_in_3d(const std::string& turbulence) {
  std::string points;
  for (int k = 0; k < 60; ++k)
    points += (k ? ", [" : "[") + std::to_string(0.001 + 0.0006 * k) + ", " + std::to_string(0.0034 + 1e-4 * k) + ", " +
              std::to_string(0.0165 * k - 0.01 * std::floor(1.65 * k)) + "]";
  Drive drive(
      "wind_over_sand",
      {"dimensions=3", "domain.size=[0.04, 0.033, 0.01]", "domain.periodic=[\"x\", \"z\"]",
       "domain.gravity=[0, -9.81, 0]", "phases.lid.shear-stress=[0.196, 0, 0]", "profile=[]",
       "fill.3={ phase = \"sand\", shape = { points = [" + points + "] }, velocity = [0.2, 0, \"0.5*cos(900*z)\"] }",
       "interactions.air-sand.lift=0.85", "interactions.air-sand.gusts=0.38", "interactions.air-sand.magnus=true",
       "time.end=2e-3", "phases.air.turbulence=" + turbulence});
  for (int step = 0; step < 20; ++step) drive.simulation().step(1.0);
  const State& state = drive.simulation().state();
  EXPECT_EQ(state.air.size(), 4u) << "of 10 mm along x, as wide as the domain";
  double layers = 0;
  for (const AirProfile& p : state.air)
    for (const double given : p.given)
      layers += given / state.air[0].last * 0.04 * 0.01 / static_cast<double>(state.air.size());
  const PhaseParticles &air = drive.phase(0), &sand = drive.phase(1);
  const double all = momentum_by_drag(sand, 0);
  EXPECT_GT(std::abs(momentum_by_drag(air, 0)), 1e-3 * std::abs(all));
  EXPECT_GT(std::abs(momentum_by_drag(sand, 2)), 1e-3 * std::abs(all));
  EXPECT_NEAR((layers - all - momentum_by_drag(air, 0)) / all, 0.0, 1e-10);
  for (const int d : {1, 2}) EXPECT_NEAR((momentum_by_drag(sand, d) + momentum_by_drag(air, d)) / all, 0.0, 1e-10) << d;
}

TEST(WindOverSand, InThreeDimensionsItKeepsTheMomentum) {
  for (const char* turbulence : {"mixing-length", "k-omega"}) expect_exact_exchange_in_3d(turbulence);
}

TEST(WindOverSand, InThreeDimensionsTheGroundIsTheSameAlongZ) {
  const std::string ground =
      R"(fill.0={ phase = "ground", packing = "fitted", shape = { bed = 0.003, dune = { form = "formula",)";
  for (const bool waves : {false, true}) {
    std::string told;
    try {
      Drive drive("wind_over_sand",
                  {"dimensions=3", "domain.size=[0.04, 0.033, 0.01]", "domain.periodic=[\"x\", \"z\"]",
                   "domain.gravity=[0, -9.81, 0]", "phases.lid.shear-stress=[0.196, 0, 0]", "profile=[]",
                   ground + " formula = \"0.0003*sin(2*pi*" + (waves ? "z/0.01" : "x/0.04") + ")\" } } }",
                   "fill.3={ phase = \"sand\", shape = { points = [[0.01, 0.006, 0.005]] } }"});
    } catch (const SceneError& error) { told = error.what(); }
    EXPECT_EQ(told.find("expected a flat bed, or one that is the same along z") != std::string::npos, waves) << told;
  }
}

/// Mean k (m2/s2) of the air from 12 to 16 mm over the bottom after 2 ms of k-omega, beside grains that go with the
/// wind.
double energy_beside(const std::string& points) {
  const std::string air_fill =
      "fill.3={ phase = \"air\", shape = \"the-rest\", packing = \"fitted\", velocity = { log-profile = { "
      "friction-velocity = 0.4, roughness = 8.3e-6 } } }";
  const std::string sand_fill =
      "fill.4={ phase = \"sand\", shape = { points = [" + points + "] }, velocity = [\"log((y - 0.003)/8.3e-6)\", 0] }";
  Drive drive("wind_over_sand",
              {"phases.air.turbulence=k-omega", "interactions.air-sand.drag=stokes", "phases.sand.sleep=false",
               "phases.sand.diameter={ mean = 2.5e-4, spread = 0 }", "time.end=2e-3", air_fill, sand_fill});
  drive.to(2e-3);
  const PhaseParticles& air = drive.phase(0);
  double sum = 0.0, count = 0.0;
  for (std::size_t k = 0; k < air.size(); ++k)
    if (const double y = air.column(Field::position, 1)[k]; y > 0.012 && y < 0.016) {
      sum += air.column(Field::turbulent_kinetic_energy)[k];
      ++count;
    }
  return sum / count;
}

/// Grains that go with the wind give it no momentum, but take of its k as exp(-2 s t), s their Stokes rate times their
/// mass over that of the air. The shear makes some of it again (0.06 in this time).
TEST(WindOverSand, GrainsInTheAirTakeOfItsTurbulence) {
  std::string points;
  for (int row = 0; row < 10; ++row)
    for (int k = 0; k < 24; ++k)
      points += (points.empty() ? "[" : ", [") + std::to_string(0.12 * (k + 0.5) / 24) + ", " +
                std::to_string(0.009 + 0.001 * (row + 0.5)) + "]";
  const double mass = 2650.0 * std::numbers::pi / 6.0 * 2.5e-4 * 2.5e-4,
               each = 18.0 * 1.225 * 1.48e-5 / (2650.0 * 6.25e-8), rate = 240.0 * mass * each / (1.225 * 0.12 * 0.010);
  const double lost = -std::log(energy_beside(points) / energy_beside("[0.06, 0.03]"));
  report("exponent of the loss over 2 s t", lost / (2.0 * rate * 2e-3), 0.98);
  EXPECT_NEAR(lost / (2.0 * rate * 2e-3), 0.94, 0.04);
}

/// Grains rest at the start and keep the drag of the first exchange for 16 (the first one is balanced to a hundredth,
/// with and without sleep): nothing is lost meanwhile, and after it all feel the wind again.
TEST(WindOverSand, ADragThatIsKeptKeepsTheMomentum) {
  Drive drive("wind_over_sand", cloud_with("phases.sand.sleep=true"));
  const PhaseParticles& sand = drive.phase(1);
  const auto drag_of_lowest = [&sand] {
    std::size_t lowest = 0;
    for (std::size_t k = 0; k < sand.size(); ++k)
      if (sand.id()[k] < sand.id()[lowest]) lowest = k;
    return sand.column(Field::drag_acceleration, 0)[lowest];
  };
  drive.simulation().step(1.0);
  const auto first = unbalanced(drive);
  const double kept = drag_of_lowest();
  for (int step = 1; step < 40; ++step) {
    drive.simulation().step(1.0);
    const auto now = unbalanced(drive);
    EXPECT_EQ(drag_of_lowest(), kept) << step;
    for (std::size_t d = 0; d < 2; ++d) EXPECT_NEAR((now[d] - first[d]) / now[2], 0.0, 1e-10) << step;
  }
  for (int step = 40; step < 80; ++step) drive.simulation().step(1.0);
  EXPECT_NE(drag_of_lowest(), kept);
  expect_exact_exchange(drive);
}

TEST(WindOverSand, AKeptDragHasTheSameBitsOnTwoThreadsAndFromACheckpoint) {
  const auto same = [](Drive& a, Drive& b) {
    for (const std::size_t phase : {std::size_t{0}, std::size_t{1}})
      for (const Field field : {Field::position, Field::velocity, Field::drag_acceleration})
        for (int d = 0; d < 2; ++d)
          if (std::memcmp(a.phase(phase).column(field, d), b.phase(phase).column(field, d),
                          a.phase(phase).size() * sizeof(double)) != 0)
            return false;
    return true;
  };
  const int threads = omp_get_max_threads();
  omp_set_num_threads(1);
  Drive one("wind_over_sand", cloud_with("phases.sand.sleep=true"));
  Drive again("wind_over_sand", cloud_with("phases.sand.sleep=true"));
  for (int step = 0; step < 5; ++step) one.simulation().step(1.0);
  Archive saved;
  one.simulation().archive(saved);
  for (int step = 0; step < 40; ++step) one.simulation().step(1.0);
  Archive loaded(saved.bytes());
  again.simulation().archive(loaded);
  for (int step = 0; step < 40; ++step) again.simulation().step(1.0);
  EXPECT_TRUE(same(one, again)) << "from a checkpoint";
  omp_set_num_threads(2);
  Drive two("wind_over_sand", cloud_with("phases.sand.sleep=true"));
  for (int step = 0; step < 45; ++step) two.simulation().step(1.0);
  EXPECT_TRUE(same(one, two)) << "on two threads";
  omp_set_num_threads(threads);
}

}  // namespace
}  // namespace barchan
