// Water that splashes out of a tank: what leaves is counted and gone, and no drop ends a run.
#include <omp.h>

#include <cmath>
#include <cstring>

#include "base/errors.hpp"
#include "physics/drive.hpp"

namespace barchan {
namespace {

using testing::Drive;
using testing::report;

/// The dam break of the scene in a tank that ends below the highest splash; the wall of fill 0 has no top.
std::vector<std::string> low_tank(const std::vector<std::string>& more = {}) {
  std::vector<std::string> all{"spacing=5.715e-3", "domain.size=[0.28575, 0.12573]", "time.end=1.0",
                               "fill.0.shape={ sides = [\"bottom\", \"left\", \"right\"], layers = 3 }",
                               "fill.1.shape={ box = { min = [0, 0], max = [0.05715, 0.1143] } }"};
  all.insert(all.end(), more.begin(), more.end());
  return all;
}

double left_mass(const Simulation& run) {
  double mass = 0.0;
  for (const Departed& one : run.state().departed) mass += one.mass;
  return mass;
}

PhaseParticles& water(Drive& drive) {
  for (std::size_t k = 0;; ++k)
    if (drive.plan().phases.at(k).flows()) return drive.phase(k);
}

TEST(OpenSides, WhatSplashesOutIsCountedAndGone) {
  Drive tank("verification/dam_break", low_tank());
  const PhaseParticles& p = water(tank);
  const double start = p.mass() * static_cast<double>(p.size());
  double fastest = 0.0;
  const std::size_t count = p.size();
  for (int k = 1; k <= 100; ++k) {
    tank.to(0.006 * k);
    for (std::size_t i = 0; i < p.size(); ++i)
      fastest = std::max(fastest, std::hypot(p.column(Field::velocity, 0)[i], p.column(Field::velocity, 1)[i]));
  }
  const double there = p.mass() * static_cast<double>(p.size()), gone = left_mass(tank.simulation());
  report("particles that left", static_cast<double>(count - p.size()), 1);
  report("mass there and gone over that of the start", (there + gone) / start - 1.0, 1e-12);
  EXPECT_LT(p.size(), count) << "nothing left: the test shows nothing";
  EXPECT_NEAR((there + gone) / start, 1.0, 1e-12);
  // In a closed tank the fastest drop has 2.5 m/s. Before the wall went on past its end it was 5.1 m/s here.
  report("fastest drop, m/s", fastest, 3.0);
  EXPECT_LT(fastest, 3.0);
  const auto warnings = tank.simulation().warnings().texts();
  EXPECT_TRUE(std::any_of(warnings.begin(), warnings.end(), [](const std::string& text) {
    return text.find("left through the open side (top)") != std::string::npos;
  }));
}

TEST(OpenSides, TheBooksStayClosedWhenFluidLeaves) {
  for (const char* seed : {"1", "2", "3"}) {  // no lattice: that of the scene is one start among many
    Drive tank("verification/dam_break", low_tank({"fill.1.perturb=0.01", std::string("fill.1.seed=") + seed}));
    double most = -1.0;
    for (int k = 1; k <= 40; ++k) {
      tank.to(0.01 * k);
      if (const auto growth = tank.simulation().budget().energy_growth(tank.simulation().state()))
        most = std::max(most, *growth);
    }
    ASSERT_GT(left_mass(tank.simulation()), 0.0);
    report("growth of energy, with what left", most, 0.02);
    EXPECT_LT(most, 0.02) << "seed " << seed;
  }
}

void expect_the_same(const PhaseParticles& a, const PhaseParticles& b) {
  ASSERT_EQ(a.id(), b.id());
  for (const Field f : {Field::position, Field::velocity, Field::density})
    for (int d = 0; d < a.components(f); ++d)
      ASSERT_EQ(std::memcmp(a.column(f, d), b.column(f, d), a.size() * sizeof(double)), 0) << info(f).name;
}

TEST(OpenSides, RestartsAndThreadsChangeNoBit) {
  const int threads = omp_get_max_threads();
  omp_set_num_threads(1);
  Drive one("verification/dam_break", low_tank());
  Archive before, between;
  one.to(0.2);
  one.simulation().archive(before);
  while (left_mass(one.simulation()) == 0.0) one.simulation().step(1.0);
  one.simulation().archive(between);
  for (int k = 0; k < 300; ++k) one.simulation().step(1.0);
  omp_set_num_threads(2);
  Drive two("verification/dam_break", low_tank());
  for (Archive* saved : {&between, &before}) {  // the second has more particles than there are then
    saved->load_again();
    two.simulation().archive(*saved);
    saved->finish();
    while (two.simulation().steps() < one.simulation().steps()) two.simulation().step(1.0);
    expect_the_same(water(one), water(two));
    EXPECT_EQ(left_mass(one.simulation()), left_mass(two.simulation()));
  }
  omp_set_num_threads(threads);
}

TEST(OpenSides, TheFrameOfTheLastGoodStateHasWhatWasThere) {
  Drive tank("verification/dam_break", low_tank());
  tank.to(0.2);
  while (left_mass(tank.simulation()) == 0.0) tank.simulation().step(1.0);
  const std::size_t now = tank.simulation().frame(0).size();
  const Frame good = tank.simulation().good_frame(1);
  EXPECT_GE(good.size(), now);
  EXPECT_LE(good.time, tank.simulation().time());
  EXPECT_EQ(tank.simulation().frame(2).size(), now);
}

TEST(OpenSides, AreWhatTheSceneSays) {
  // none open: the watch stops the run, as it does with a body
  Drive shut("verification/dam_break", low_tank({"domain.open=[\"none\"]"}));
  EXPECT_THROW(shut.to(0.5), BreakdownError);
  // opened by name: a column of history.csv
  Drive open("verification/dam_break", low_tank({"domain.open=[\"top\"]"}));
  open.to(0.3);
  const auto names = open.simulation().history_columns();
  const auto row = open.simulation().history_row();
  const auto found = std::find(names.begin(), names.end(), "water_left [kg/m]");
  ASSERT_NE(found, names.end());
  EXPECT_EQ(row[static_cast<std::size_t>(found - names.begin())], left_mass(open.simulation()));
  // the side itself: water runs out of an open right side
  Drive drain("verification/dam_break",
              low_tank({"domain.open=[\"right\"]", "fill.0.shape={ sides = [\"bottom\", \"left\"], layers = 3 }"}));
  drain.to(0.4);
  EXPECT_GT(left_mass(drain.simulation()), 0.5);
}

std::string refusal(const std::string& scene, const std::vector<std::string>& overrides) {
  try {
    Drive drive(scene, overrides);
  } catch (const SceneError& error) { return error.what(); }
  return "";
}

TEST(OpenSides, RefuseWhatCannotBeOpen) {
  EXPECT_NE(
      refusal("verification/dam_break", low_tank({"domain.open=[\"left\"]"})).find("the wall \"tank\" closes \"left\""),
      std::string::npos);
  EXPECT_NE(refusal("verification/dam_break", low_tank({"domain.open=[\"front\"]"})).find("needs three dimensions"),
            std::string::npos);
  EXPECT_NE(refusal("verification/poiseuille", {"domain.open=[\"left\"]"}).find("periodic axis x"), std::string::npos);
  EXPECT_NE(refusal("bouncing_block", {"domain.open=[\"top\"]"}).find("nothing leaves through it"), std::string::npos);
}

/// A post in the way: the thin layer that comes down on it slid through its corner, and the run ended.
TEST(OpenSides, WaterOnAPostStaysOutsideIt) {
  const std::string text = R"toml(
dimensions = 2
spacing = 0.0125
[domain]
size = [1.6, 0.9]
gravity = [0, -9.81]
[phases.water]
kind = "fluid"
density = 1000
viscosity = 1e-6
sound-speed = 44
artificial-viscosity = 0.02
scheme = "plain"
[phases.tank]
kind = "wall"
slip = "free-slip"
[interactions]
kernel = "wendland-c2"
water-water = 2.6
water-tank = 2.6
[[fill]]
phase = "tank"
shape = { sides = ["bottom", "left", "right"], layers = 3 }
[[fill]]
phase = "tank"
shape = { box = { min = [1.0, 0], max = [1.1, 0.4] } }
[[fill]]
phase = "water"
shape = { box = { min = [0, 0], max = [0.4, 0.5] } }
pressure = "hydrostatic"
[time]
end = 2
largest-speed = 4.4
)toml";
  const Scene scene = parse_scene(text, "post.toml", {});
  const auto blocks = generate(scene);
  Simulation tank(scene, make_plan(scene, blocks), blocks);
  const PhaseParticles& p = tank.phases()[0];
  std::size_t inside = 0, above = 0;
  while (tank.time() < 1.0) {
    ASSERT_NO_THROW(tank.step(1.0));
    if (tank.steps() % 100 != 0) continue;
    for (std::size_t k = 0; k < p.size(); ++k) {
      const double x = p.column(Field::position, 0)[k], y = p.column(Field::position, 1)[k];
      inside += x > 1.0 && x < 1.1 && y < 0.4 ? 1 : 0;
      above += x > 1.0 && x < 1.1 && y < 0.45 ? 1 : 0;
    }
  }
  EXPECT_EQ(inside, 0u);
  EXPECT_GT(above, 0u) << "no water came down on the post: the test shows nothing";
}

TEST(OpenSides, ADropThatNothingCanHaveMadeSoFastIsTold) {
  Drive tank("verification/still_tank");
  PhaseParticles& p = water(tank);
  const auto told = [&] {
    const auto warnings = tank.simulation().warnings().texts();
    return std::any_of(warnings.begin(), warnings.end(), [](const std::string& warning) {
      return warning.find("times what gravity, forcings, walls and the start can give") != std::string::npos;
    });
  };
  for (int k = 0; k < 20; ++k) tank.simulation().step(1.0);
  EXPECT_FALSE(told());
  const double fall = std::sqrt(2.0 * 9.81 * tank.scene().domain.size[1]);
  p.column(Field::velocity, 1)[p.size() - 1] = 3.5 * std::max(fall, tank.plan().largest_speed);
  for (int k = 0; k < 8; ++k) tank.simulation().step(1.0);
  EXPECT_TRUE(told());
}

}  // namespace
}  // namespace barchan
