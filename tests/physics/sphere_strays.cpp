// A few fast grains over a bed: each is searched anew alone, and no contact is missed.
#include <gtest/gtest.h>
#include <omp.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>

#include "physics/small_scenes.hpp"
#include "state/archive.hpp"

namespace barchan::of_sphere_strays {
namespace {

/// A settled bed of 4 diameters under 18 grains that come down on it at 6 to 14 m/s, one by one.
const std::string text = R"toml(
dimensions = 2
spacing = 1e-3
[domain]
size = [0.12, 0.2]
periodic = ["x"]
gravity = [0, -9.81]
[phases.sand]
kind = "grains"
density = 2650
diameter = { mean = 1e-3, spread = 0.2 }
friction = 0.5
rolling-friction = 0.2
stiffness = 2e4
[phases.floor]
kind = "wall"
[interactions]
sand-sand = { law = "linear" }
sand-floor = { law = "linear" }
[[fill]]
phase = "floor"
shape = { sides = ["bottom", "top"], layers = 1 }
[[fill]]
phase = "sand"
shape = { bed = 0.004 }
packing = "settled"
[[fill]]
phase = "sand"
shape = { points = [[0.01, 0.02], [0.03, 0.025], [0.06, 0.03], [0.08, 0.035], [0.1, 0.04], [0.02, 0.06], [0.05, 0.065],
  [0.07, 0.07], [0.09, 0.075], [0.11, 0.08], [0.012, 0.1], [0.032, 0.11], [0.062, 0.12], [0.082, 0.13], [0.102, 0.14],
  [0.022, 0.15], [0.052, 0.16], [0.072, 0.17]] }
velocity = ["10 + 20*x", -6]
[time]
end = 1
largest-speed = 14
)toml";

using Overrides = std::vector<std::string>;
class SphereStrays : public ::testing::TestWithParam<Overrides> {
 protected:
  struct Run {
    Scene scene;
    Simulation simulation;
    explicit Run(const Overrides& overrides)
        : scene(parse_scene(text, "strays.toml", overrides)),
          simulation(scene, make_plan(scene, blocks(scene)), blocks(scene)) {}
    static const std::vector<ParticleBlock>& blocks(const Scene& scene) {
      static std::map<std::string, std::vector<ParticleBlock>> made;
      auto& blocks = made[scene.identity];
      if (blocks.empty()) blocks = make_particles(scene);
      return blocks;
    }
    void steps(int count) {
      for (int k = 0; k < count; ++k) simulation.step(1.0);
    }
    double of_history(const std::string& column) const {
      const auto names = simulation.history_columns();
      const auto found = std::find(names.begin(), names.end(), column);
      return simulation.history_row()[static_cast<std::size_t>(found - names.begin())];
    }
    /// Pairs of grains that overlap, and grains that overlap the floor or the lid: every pair is asked.
    int overlaps() const {
      const PhaseParticles& p = simulation.phases()[0];
      const double *x = p.column(Field::position, 0), *y = p.column(Field::position, 1), *r = p.column(Field::radius);
      int n = 0;
      for (std::size_t a = 0; a < p.size(); ++a) {
        n += (y[a] < r[a]) + (0.2 - y[a] < r[a]);
        for (std::size_t b = 0; b < a; ++b) {
          double dx = x[a] - x[b];
          dx -= 0.12 * std::round(dx / 0.12);
          n += std::hypot(dx, y[a] - y[b]) < r[a] + r[b];
        }
      }
      return n;
    }
  };
  static bool same(const Run& a, const Run& b) {
    const PhaseParticles &p = a.simulation.phases()[0], &q = b.simulation.phases()[0];
    for (const Field f : {Field::position, Field::velocity, Field::angular_velocity})
      for (int c = 0; c < p.components(f); ++c)
        if (std::memcmp(p.column(f, c), q.column(f, c), p.size() * sizeof(double)) != 0) return false;
    return p.id() == q.id() && a.simulation.history_row() == b.simulation.history_row();
  }
};
INSTANTIATE_TEST_SUITE_P(Awake, SphereStrays, ::testing::Values(Overrides{}));
INSTANTIATE_TEST_SUITE_P(SomeAsleep, SphereStrays, ::testing::Values(Overrides{"phases.sand.sleep=true"}));

// So many are strays that all are searched anew.
INSTANTIATE_TEST_SUITE_P(AllMove, SphereStrays,
                         ::testing::Values(Overrides{"fill.1.velocity=[\"3*sin(500*y)\", \"2 + 2*sin(700*x)\"]"}));

TEST_P(SphereStrays, NoContactIsMissed) {
  Run run(GetParam());
  int most = 0;
  for (int k = 0; k < 150; ++k) {
    run.steps(5);
    // Contacts have a force up to a step before they overlap: there may be more of them than overlaps, never fewer.
    const int overlaps = run.overlaps();
    ASSERT_GE(run.of_history("contacts"), overlaps) << "after " << 5 * (k + 1) << " steps";
    most = std::max(most, overlaps);
  }
  EXPECT_GT(most, 100) << "the bed touches";
  EXPECT_GT(run.of_history("sand_largest_speed [m/s]"), 5.0) << "grains still fly";
}

TEST_P(SphereStrays, ThreadsAndARestartChangeNoBit) {
  const int before = omp_get_max_threads();
  omp_set_num_threads(1);
  Run one(GetParam()), goes_on(GetParam());
  one.steps(150);
  Archive saved;
  one.simulation.archive(saved);
  one.steps(150);
  omp_set_num_threads(2);
  Run two(GetParam());
  two.steps(300);
  EXPECT_TRUE(same(one, two)) << "two threads";
  Archive loaded(saved.bytes());
  goes_on.simulation.archive(loaded);
  goes_on.steps(150);
  EXPECT_TRUE(same(one, goes_on)) << "restarted";
  omp_set_num_threads(before);
}

TEST_F(SphereStrays, AFewFastGrainsDoNotSearchTheBedAnew) {
  Run run({});
  run.steps(100);
  const long searches = run.simulation.searches();
  run.steps(300);
  // Eight steps of the contacts in each, in which a grain of 12 m/s goes 0.4 diameters.
  EXPECT_LT(run.simulation.searches() - searches, 60);
  EXPECT_GT(run.of_history("sand_largest_speed [m/s]"), 5.0);
}

}  // namespace
}  // namespace barchan::of_sphere_strays
