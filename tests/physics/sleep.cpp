// Grains that sleep: they cost nothing, wake when touched or pushed, and change nothing for those that are awake.
#include <gtest/gtest.h>
#include <omp.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "physics/small_scenes.hpp"

namespace barchan {
namespace {

/// A settled bed of 8 diameters, and a grain that falls on it from 0.17 m, in 0.186 s.
const std::string text = R"toml(
dimensions = 2
spacing = 1e-3
[domain]
size = [0.05, 0.2]
periodic = ["x"]
gravity = [0, -9.81]
[phases.sand]
kind = "grains"
density = 2650
diameter = { mean = 1e-3, spread = 0.2 }
friction = 0.5
rolling-friction = 0.2
stiffness = 1000
sleep = true
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
[[fill]]
phase = "sand"
shape = { points = [[0.025, 0.18]] }
[time]
end = 1
largest-speed = 2
)toml";
constexpr double before_impact = 0.18, after_impact = 0.2;  // s

class Sleep : public ::testing::Test {
 protected:
  static const std::vector<ParticleBlock>& blocks() {
    static const std::vector<ParticleBlock> made = make_particles(parse_scene(text, "sleep.toml"));
    return made;
  }
  struct Run {
    Scene scene;
    Simulation simulation;
    explicit Run(const std::vector<std::string>& overrides = {})
        : scene(parse_scene(text, "sleep.toml", overrides)), simulation(scene, make_plan(scene, blocks()), blocks()) {}
    void to(double time) {
      while (simulation.time() < time * (1.0 - 1e-12)) simulation.step(time - simulation.time());
    }
    const PhaseParticles& sand() const { return simulation.phases()[0]; }
    double of_history(const std::string& column) const {
      const auto names = simulation.history_columns();
      const auto found =
          std::find_if(names.begin(), names.end(), [&](const std::string& each) { return each.starts_with(column); });
      EXPECT_NE(found, names.end()) << column;
      return simulation.history_row()[static_cast<std::size_t>(found - names.begin())];
    }
    double asleep() const { return of_history("asleep"); }
    double pairs() const {
      double sum = 0.0;
      for (const PlanEntry& e : simulation.plan().entries) sum += static_cast<double>(simulation.pairs(e));
      return sum;
    }
    /// Place and velocity of the grain with the n-th id, 0 the first of the bed.
    std::array<double, 4> grain(std::size_t n) const {
      const PhaseParticles& p = sand();
      for (std::size_t i = 0; i < p.size(); ++i)
        if (static_cast<std::size_t>(p.id()[i] - p.first_id()) == n)
          return {p.column(Field::position, 0)[i], p.column(Field::position, 1)[i], p.column(Field::velocity, 0)[i],
                  p.column(Field::velocity, 1)[i]};
      return {};
    }
    /// The farthest way of a grain of the bed since the start, m.
    double farthest() const {
      double most = 0.0;
      for (std::size_t n = 0; n + 1 < sand().size(); ++n) {
        const auto g = grain(n);
        const Vec3& from = blocks()[0].position[n];
        double dx = g[0] - from[0];
        dx -= 0.05 * std::round(dx / 0.05);
        most = std::max(most, std::hypot(dx, g[1] - from[1]));
      }
      return most;
    }
  };
  static bool same_bits(const Run& a, const Run& b) {
    for (const Field f : {Field::position, Field::velocity, Field::angular_velocity})
      for (int c = 0; c < a.sand().components(f); ++c)
        if (std::memcmp(a.sand().column(f, c), b.sand().column(f, c), a.sand().size() * sizeof(double)) != 0)
          return false;
    return a.sand().id() == b.sand().id() && a.simulation.history_row() == b.simulation.history_row();
  }
};

TEST_F(Sleep, ABedFallsAsleepAndItsPairsCostNothing) {
  Run sleeps, wakes({"phases.sand.sleep=false"});
  sleeps.to(before_impact);
  wakes.to(before_impact);
  const double grains = static_cast<double>(sleeps.sand().size());
  EXPECT_GT(sleeps.asleep(), 0.9 * grains);
  EXPECT_LT(sleeps.asleep(), grains) << "a grain falls";
  EXPECT_LT(sleeps.pairs(), 0.2 * wakes.pairs());
  // What sleeps is still there: its contacts and what they store.
  EXPECT_NEAR(sleeps.of_history("contacts"), wakes.of_history("contacts"), 0.02 * grains);
  EXPECT_NEAR(sleeps.of_history("contacts_stored_energy [") / wakes.of_history("contacts_stored_energy ["), 1.0, 0.02);
  EXPECT_LT(sleeps.farthest(), 1e-2 * 1e-3);
}

TEST_F(Sleep, WhatIsAwakeGoesOnAsBeforeUntilItTouches) {
  Run sleeps, wakes({"phases.sand.sleep=false"});
  sleeps.to(before_impact);
  wakes.to(before_impact);
  const auto a = sleeps.grain(sleeps.sand().size() - 1), b = wakes.grain(wakes.sand().size() - 1);
  for (std::size_t c = 0; c < 4; ++c) EXPECT_NEAR(a[c], b[c], 1e-6 * std::abs(b[c]) + 1e-15);
  EXPECT_LT(a[1], 0.03) << "it has fallen";
}

TEST_F(Sleep, AnImpactWakesAndTheBedFallsAsleepAgain) {
  Run run;
  run.to(before_impact);
  const double before = run.asleep(), at_rest = run.farthest();
  double least = before;
  for (double t = before_impact; t < after_impact; t += 1e-4) {
    run.to(t);
    least = std::min(least, run.asleep());
  }
  EXPECT_LT(least, before - 5.0) << "grains under the impact wake";
  EXPECT_GT(run.farthest(), 0.05 * 1e-3);
  EXPECT_GT(run.farthest(), 10.0 * at_rest);
  run.to(0.6);
  EXPECT_GT(run.asleep(), 0.95 * static_cast<double>(run.sand().size()));
}

TEST_F(Sleep, APushWakesAll) {
  // A slope of 45 degrees from 0.15 s on.
  Run run({"forcing=[{ phase = \"sand\", acceleration = [\"t > 0.15 ? 9.81 : 0\", 0] }]"});
  run.to(0.149);
  EXPECT_GT(run.asleep(), 0.9 * static_cast<double>(run.sand().size()));
  run.to(0.155);
  EXPECT_EQ(run.asleep(), 0.0);
  run.to(0.2);
  EXPECT_GT(run.farthest(), 1e-3);
}

TEST_F(Sleep, HasTheSameBitsOnAnyNumberOfThreadsAndAfterARestart) {
  const int threads = omp_get_max_threads();
  omp_set_num_threads(1);
  Run one, loaded;
  one.to(before_impact);
  omp_set_num_threads(2);
  Run two;
  two.to(before_impact);
  ASSERT_TRUE(same_bits(one, two));
  ASSERT_GT(one.asleep(), 0.0);
  std::vector<std::vector<char>> saved;
  for (int k = 0; k < 400; ++k) {
    if (k % 40 == 0) {
      Archive a;
      one.simulation.archive(a);
      saved.push_back(a.bytes());
    }
    omp_set_num_threads(1);
    one.simulation.step(1e300);
    omp_set_num_threads(2);
    two.simulation.step(1e300);
    ASSERT_TRUE(same_bits(one, two)) << "step " << k;
  }
  EXPECT_GT(one.farthest(), 0.05 * 1e-3) << "the impact is among these steps";
  for (std::size_t s = 0; s < saved.size(); ++s) {
    Archive a(saved[s]);
    loaded.simulation.archive(a);
    a.finish();
    for (int k = static_cast<int>(s) * 40; k < 400; ++k) loaded.simulation.step(1e300);
    ASSERT_TRUE(same_bits(one, loaded)) << "saved after step " << s * 40;
  }
  omp_set_num_threads(threads);
}

}  // namespace
}  // namespace barchan
