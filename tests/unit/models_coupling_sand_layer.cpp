// The layers of wind between grains and the particles of the air, by hand: one grain over flat ground, with Stokes'
// drag.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "physics/drive.hpp"

namespace barchan::sand_layer_test {
namespace {

constexpr double diameter = 2.5e-4, solid = 2650.0, air_mass = 1.225, nu = 1.48e-5, g = 9.81;  // as the scene has them
constexpr double layer = 0.01;  // m, forty diameters: twelve layers along 0.12 m

/// scenes/wind_over_sand.toml with one grain at (x, y) m and air of 3 m/s everywhere, at its start.
struct OneGrain {
  testing::Drive drive;
  OneGrain(double x, double y, const std::string& wind = "3")
      : drive("wind_over_sand",
              {"fill.3={ phase = \"sand\", shape = { points = [[" + std::to_string(x) + ", " + std::to_string(y) +
                   "]] } }",
               "phases.sand.diameter={ mean = 2.5e-4, spread = 0 }", "interactions.air-sand.drag=stokes",
               "fill.4.velocity=[\"" + wind + "\", 0]", "time.end=1e-4"}) {}
  const PhaseParticles& sand() { return drive.phase(1); }
  double drag(int d) { return sand().column(Field::drag_acceleration, d)[0]; }
  const State& state() { return drive.simulation().state(); }
  double held() { return state().air[0].last; }  // s, for which a drag is kept
  /// Momentum that each layer gave to the grain in that time, N s/m by the length of the layer.
  std::vector<double> given() {
    std::vector<double> sums;
    for (const AirProfile& p : state().air) {
      double sum = 0.0;
      for (const double cell : p.given) sum += cell;
      sums.push_back(sum * layer);
    }
    return sums;
  }
};

/// Over 1.5 spacings a grain feels the particles of the air: for a constant wind the mean over the time T is
/// (1 - exp(-T/tau))/(T/tau) [u/tau + g] less gravity, tau = rho_s d^2/(18 rho nu). What it takes the air's particles
/// lose.
TEST(SandLayer, AGrainOverTheLayersFeelsTheParticlesOfTheAir) {
  OneGrain grain(0.052, 0.021);
  ASSERT_EQ(grain.sand().size(), 1u);
  ASSERT_EQ(grain.state().air.size(), 12u);
  const double tau = solid * diameter * diameter / (18.0 * air_mass * nu), x = grain.held() / tau;
  ASSERT_GT(x, 0.0);
  const double share = (1.0 - std::exp(-x)) / x;
  EXPECT_NEAR(grain.drag(0) / (share * 3.0 / tau), 1.0, 1e-6);
  EXPECT_NEAR(grain.drag(1), (1.0 - share) * g, 1e-6 * g);
  const PhaseParticles& air = grain.drive.phase(0);
  double lost[2] = {0.0, 0.0};
  for (int d = 0; d < 2; ++d)
    for (std::size_t k = 0; k < air.size(); ++k) lost[d] += air.mass_of(k) * air.column(Field::drag_acceleration, d)[k];
  const double mass = grain.sand().mass_of(0);
  EXPECT_NEAR(lost[0] / (-mass * grain.drag(0)), 1.0, 1e-10);
  EXPECT_NEAR(lost[1], -mass * grain.drag(1), 1e-10 * mass * grain.drag(0));
  for (const double momentum : grain.given()) EXPECT_EQ(momentum, 0.0) << "no layer gives it anything";
}

/// In the layers it takes the momentum of the two about it, by linear weights of their middles, across the periodic
/// side too: 1 and 0 in the middle of one, 3 to 1 at a quarter of the way.
TEST(SandLayer, AGrainInTheLayersTakesFromTheTwoAboutIt) {
  struct Case {
    double x;
    std::size_t left, right;
    double share;  // of the right one
  };
  for (const Case& c :
       {Case{0.025, 2, 3, 0.0}, Case{0.0275, 2, 3, 0.25}, Case{0.03, 2, 3, 0.5}, Case{0.001, 11, 0, 0.6}}) {
    OneGrain grain(c.x, 0.0035);
    const auto given = grain.given();
    ASSERT_EQ(given.size(), 12u);
    double sum = 0.0;
    for (std::size_t k = 0; k < given.size(); ++k) {
      sum += given[k];
      if (k == c.left || k == c.right) continue;
      EXPECT_EQ(given[k], 0.0) << "layer " << k << ", grain at " << c.x;
    }
    EXPECT_GT(grain.drag(0), 0.1) << "the wind pulls";
    EXPECT_NEAR(sum / (grain.sand().mass_of(0) * grain.drag(0) * grain.held()), 1.0, 1e-9) << "grain at " << c.x;
    EXPECT_NEAR(given[c.right] / sum, c.share, 0.02) << "grain at " << c.x;
  }
}

/// In a wind that changes along the ground a grain between two layers feels the mean of their winds.
TEST(SandLayer, AGrainBetweenTwoLayersFeelsTheWindOfBoth) {
  const std::string wind = "3*(1 + 0.8*cos(2*pi*x/0.12))";
  OneGrain left(0.025, 0.0035, wind), between(0.03, 0.0035, wind), right(0.035, 0.0035, wind);
  ASSERT_GT(left.drag(0), 1.5 * right.drag(0));
  EXPECT_NEAR(between.drag(0) / (0.5 * (left.drag(0) + right.drag(0))), 1.0, 0.05);
}

/// The wind on top of a layer is that over its middle: with a wind that is the same at x and at 0.12 m - x, layers that
/// mirror each other have the same.
TEST(SandLayer, LayersThatMirrorEachOtherHaveTheSameWindOnTop) {
  OneGrain grain(0.06, 0.0035, "3*(1 + 0.8*cos(2*pi*x/0.12))");
  const auto& air = grain.state().air;
  ASSERT_EQ(air.size(), 12u);
  EXPECT_GT(air[0].speed.back(), 2.0 * air[5].speed.back());
  for (std::size_t k = 0; k < 6; ++k)
    EXPECT_NEAR(air[k].speed.back() / air[11 - k].speed.back(), 1.0, 0.03) << "layer " << k;
}

/// Deeper than six diameters no wind comes; just above that a little of it does.
TEST(SandLayer, AGrainDeepInTheBedFeelsNothing) {
  OneGrain deep(0.05, 0.003 - 6.1 * diameter), shallow(0.05, 0.003 - 0.1 * diameter);
  EXPECT_EQ(deep.drag(0), 0.0);
  EXPECT_EQ(deep.drag(1), 0.0);
  EXPECT_GT(shallow.drag(0), 0.0);
}

/// What the particles of the air feel of the ground is the mean stress on top of the layers.
TEST(SandLayer, TellsOfTheStressOnTop) {
  OneGrain grain(0.05, 0.0035);
  double mean = 0.0;
  for (const AirProfile& p : grain.state().air) mean += p.stress.back() / 12.0;
  const auto columns = grain.drive.simulation().history_columns();
  const auto row = grain.drive.simulation().history_row();
  std::size_t at = 0;
  while (at < columns.size() && columns[at] != "air-sand_ground_stress [Pa]") ++at;
  ASSERT_LT(at, columns.size());
  EXPECT_NEAR(row[at] / mean, 1.0, 1e-12);
  EXPECT_GT(mean, 0.0);
}

}  // namespace
}  // namespace barchan::sand_layer_test
