// Grains that enter through a side and leave through others: what is booked is what is there; threads and restarts
// change no bit.
#include <gtest/gtest.h>
#include <omp.h>

#include <cmath>
#include <cstring>

#include "physics/small_scenes.hpp"

namespace barchan {
namespace {

std::string blown(const std::string& influx, const std::string& open = "[\"left\", \"right\", \"top\"]",
                  const std::string& gravity = "[0, -9.81]") {
  return R"toml(
dimensions = 2
spacing = 1e-3
[domain]
size = [0.1, 0.05]
gravity = )toml" +
         gravity + "\nopen = " + open + R"toml(
[phases.sand]
kind = "grains"
density = 2650
diameter = { mean = 1e-3, spread = 0.2 }
friction = 0.5
[phases.floor]
kind = "wall"
diameter = 1e-3
[interactions]
sand-sand = { law = "linear" }
sand-floor = { law = "linear" }
[[fill]]
phase = "floor"
shape = { box = { min = [0, 0], max = [0.1, 1e-3] } }
[[fill]]
phase = "sand"
shape = { box = { min = [0.03, 1e-3], max = [0.07, 3e-3] } }
[[influx]]
phase = "sand"
side = "left"
)toml" + influx +
         R"toml(
[time]
end = 1
largest-speed = 3
)toml";
}
const std::string storm =
    "flux = 2\nabove = 2e-3\ndecay-height = 0.01\nspeed = 1.5\nspeed-spread = 0.3\nangle = -10\nangle-spread = 10";

struct Blown {
  explicit Blown(const std::string& text) : scene(parse_scene(text, "test.toml")), blocks(make_particles(scene)) {
    simulation = std::make_unique<Simulation>(scene, make_plan(scene, blocks), blocks);
  }
  void step(int count) {
    for (int k = 0; k < count; ++k) simulation->step(1e300);
  }
  void run(double until) {
    while (simulation->time() < until) simulation->step(until - simulation->time());
  }
  double column(const std::string& name) const {
    const HistoryRow row = simulation->history();
    for (std::size_t k = 0; k < row.names.size(); ++k)
      if (row.names[k].starts_with(name)) return row.values[k];
    ADD_FAILURE() << "no column " << name;
    return 0.0;
  }
  const PhaseParticles& sand() const { return simulation->phases()[0]; }
  double mass() const {
    double sum = 0.0;
    for (std::size_t k = 0; k < sand().size(); ++k) sum += sand().mass_of(k);
    return sum;
  }
  Scene scene;
  std::vector<ParticleBlock> blocks;
  std::unique_ptr<Simulation> simulation;
};

TEST(GrainSources, MassThatIsThereIsWhatCameLessWhatLeft) {
  Blown run(blown(storm));
  const double start = run.mass();
  run.run(0.2);
  double out = 0.0, number = 0.0;
  for (const char* side : {"left", "right", "top"}) {
    out += run.column(std::string("sand_") + side + "_out [kg/m]");
    number += run.column(std::string("sand_") + side + "_out_number");
  }
  const double in = run.column("sand_left_in [kg/m]");
  EXPECT_NEAR(run.mass(), start + in - out, 1e-12 * start);
  EXPECT_NEAR(in, 2.0 * 0.2, 0.1);  // about 290 grains by chance, a sixteenth of them
  EXPECT_GT(number, 50.0);
  EXPECT_NEAR(run.column("sand_left [kg/m]"), out, 1e-12 * start);
  EXPECT_EQ(static_cast<double>(run.blocks[0].position.size()) + run.column("sand_left_in_number") - number,
            static_cast<double>(run.sand().size()));
}

/// Without gravity and collisions what enters goes straight through: as much momentum and energy leaves, and the
/// speeds are those of what entered.
TEST(GrainSources, WhatFliesThroughLeavesAsItCame) {
  Blown run(blown("flux = 0.05\nabove = 0.02\ndecay-height = 0.005\nspeed = 1.5\nspeed-spread = 0.3", "[\"right\"]",
                  "[0, 0]"));
  while (run.column("sand_right_out_number") < 30.0) run.step(200);
  const double mean_in = run.column("sand_left_in_momentum_x") / run.column("sand_left_in [kg/m]");
  const double mean_out = run.column("sand_right_out_momentum_x") / run.column("sand_right_out [kg/m]");
  EXPECT_NEAR(mean_in, 1.5, 0.2);
  EXPECT_NEAR(mean_out, mean_in, 0.1);
  EXPECT_NEAR(run.column("sand_right_out_momentum_y"), 0.0, 1e-15);
}

/// One that is due in the middle of a step is on its way already: no grain enters in steps.
TEST(GrainSources, AGrainIsWhereItIsDue) {
  Blown run(blown("flux = 5\nabove = 0.02\ndecay-height = 0.005\nspeed = 1.5", "[\"right\"]", "[0, 0]"));
  run.step(500);
  int between = 0;
  for (std::size_t k = 0; k < run.sand().size(); ++k) {
    const double x = run.sand().column(Field::position, 0)[k], steps = x / (1.5 * run.simulation->time() / 500.0);
    if (run.sand().column(Field::velocity, 0)[k] > 0.0 && std::abs(steps - std::round(steps)) > 0.05) ++between;
  }
  EXPECT_GT(between, 10);
}

/// An empty box of walls into which grains are poured.
std::string poured(int dimensions, const std::string& more) {
  const bool flat = dimensions == 2;
  return "dimensions = " + std::to_string(dimensions) + R"toml(
spacing = 2e-3
[domain]
size = )toml" +
         (flat ? "[0.06, 0.08]" : "[0.03, 0.06, 0.03]") + "\ngravity = " + (flat ? "[0, -9.81]" : "[0, -9.81, 0]") +
         R"toml(
[phases.sand]
kind = "grains"
material = "quartz-sand"
diameter = { mean = 2e-3, log-normal = 0.2 }
[phases.floor]
kind = "wall"
[interactions]
sand-sand = { law = "linear" }
sand-floor = { law = "linear" }
[[fill]]
phase = "floor"
shape = { sides = ["bottom", "left", "right")toml" +
         (flat ? "" : ", \"front\", \"back\"") + R"toml(] }
[[influx]]
phase = "sand"
box = )toml" +
         (flat ? "{ min = [0.02, 0.05], max = [0.04, 0.07] }"
               : "{ min = [0.01, 0.04, 0.01], max = [0.02, 0.055, 0.02] }") +
         "\n" + more + R"toml(
[time]
end = 1
largest-speed = 2
)toml";
}

TEST(GrainSources, PourFromAnEmptyStartWithinTheirTimes) {
  for (const int dimensions : {2, 3}) {
    const double flux = dimensions == 2 ? 4.0 : 0.008;  // kg/m/s; kg/s
    Blown run(poured(dimensions, "flux = " + std::to_string(flux) + "\nstart = 0.02\nuntil = 0.22"));
    EXPECT_EQ(run.sand().size(), 0u);
    run.run(0.015);
    EXPECT_EQ(run.sand().size(), 0u) << "before it starts";
    run.run(0.24);
    const double mass = run.mass();
    run.run(0.4);
    EXPECT_NEAR(run.mass(), mass, 1e-12 * mass) << "after it ended";
    EXPECT_NEAR(mass, 0.2 * flux, 0.25 * 0.2 * flux) << dimensions;
    EXPECT_GT(run.sand().size(), 40u * (dimensions == 2 ? 2u : 1u));
    EXPECT_NEAR(run.column("sand_poured_in"), mass, 1e-12 * mass);
    for (std::size_t k = 0; k < run.sand().size(); ++k) {
      EXPECT_GT(run.sand().column(Field::position, 1)[k], 0.0);
      EXPECT_LT(run.sand().column(Field::position, 1)[k], 0.05) << "it fell";
    }
    EXPECT_LT(run.column("contacts_deepest"), 0.1);
  }
}

/// Grains that reach over the side of a period along y take room in a box on its other end.
TEST(GrainSources, PourAcrossAPeriodWithoutOverlap) {
  std::string row;
  for (int k = 0; k < 18; ++k) row += (k > 0 ? ", [" : "[") + std::to_string(0.004 + 0.003 * k) + ", 0.0798]";
  std::string text = poured(2, "flux = 30");
  const auto replace = [&text](const std::string& from, const std::string& to) {
    ASSERT_NE(text.find(from), std::string::npos) << from;
    text.replace(text.find(from), from.size(), to);
  };
  replace("gravity = [0, -9.81]", "periodic = [\"y\"]");
  replace("sides = [\"bottom\", \"left\", \"right\"]", "sides = [\"left\", \"right\"]");
  replace("{ min = [0.02, 0.05], max = [0.04, 0.07] }", "{ min = [0.0, 0.0], max = [0.06, 0.004] }");
  replace("[[influx]]", "[[fill]]\nphase = \"sand\"\nshape = { points = [" + row + "] }\n[[influx]]");
  Blown run(text);
  run.run(0.05);
  EXPECT_GT(run.sand().size(), 25u);
  EXPECT_EQ(run.column("contacts_deepest"), 0.0) << "none begins in another, at rest";
}

TEST(GrainSources, PourNoMoreThanTheBoxLetsFall) {
  Blown run(poured(2, "flux = 60\nvelocity = [0, -0.2]"));
  run.run(0.12);
  EXPECT_LT(run.mass(), 0.5 * 60.0 * 0.12);
  EXPECT_LT(run.column("contacts_deepest"), 0.1) << "none begins in another";
  bool said = false;
  for (const std::string& warning : run.simulation->warnings().texts())
    said = said || warning.find("into the box of influx.0") != std::string::npos;
  EXPECT_TRUE(said);
}

TEST(GrainSources, NoneEntersWhereOthersAre) {
  // The bed reaches the side and over all heights at which grains enter.
  std::string text = blown("flux = 5\nabove = 1e-3\ndecay-height = 2e-4\nspeed = 1", "[\"right\"]", "[0, 0]");
  text.replace(text.find("min = [0.03, 1e-3]"), 18, "min = [0, 1e-3]");
  text.replace(text.find("max = [0.07, 3e-3]"), 18, "max = [0.07, 8e-3]");
  Blown blocked(text);
  const double start = blocked.mass();
  blocked.run(0.04);
  EXPECT_LT(blocked.mass() - start, 0.3 * 5.0 * 0.04);
  bool said = false;
  for (const std::string& warning : blocked.simulation->warnings().texts())
    said = said || warning.find("found no room to enter") != std::string::npos;
  EXPECT_TRUE(said);
}

void expect_same_bits(const Blown& a, const Blown& b) {
  ASSERT_EQ(a.sand().id(), b.sand().id());
  for (const Field field : {Field::position, Field::velocity, Field::radius})
    for (int c = 0; c < a.sand().components(field); ++c)
      EXPECT_EQ(std::memcmp(a.sand().column(field, c), b.sand().column(field, c), a.sand().size() * sizeof(double)), 0);
  EXPECT_EQ(a.simulation->history_row(), b.simulation->history_row());
}

TEST(GrainSources, HaveTheSameBitsOnTwoThreadsAndFromACheckpoint) {
  const int threads = omp_get_max_threads();
  omp_set_num_threads(1);
  Blown straight(blown(storm));
  straight.step(4500);
  Archive saved;
  straight.simulation->archive(saved);
  straight.step(4500);
  EXPECT_GT(straight.column("sand_right_out_number"), 0.0);
  omp_set_num_threads(2);
  Blown two(blown(storm));
  two.step(9000);
  expect_same_bits(straight, two);
  Blown again(blown(storm));
  Archive loaded(saved.bytes());
  again.simulation->archive(loaded);
  again.step(4500);
  expect_same_bits(straight, again);
  omp_set_num_threads(threads);
}

}  // namespace
}  // namespace barchan
