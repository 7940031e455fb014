// The kick-drift-kick step: exact in free fall, of second order for grains in contact and for a vibrating elastic bar,
// and reversible where the forces are conservative.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "physics/small_scenes.hpp"

namespace barchan::of_integrator {
namespace {

std::string fixed(double step) {
  char text[40];
  std::snprintf(text, sizeof text, "time.step=%.17g", step);
  return text;
}

/// Position and velocity of the particle with this id.
struct Particle {
  Vec3 x{}, v{};
};
std::vector<Particle> by_id(const Simulation& run, std::size_t phase) {
  const PhaseParticles& p = run.phases()[phase];
  std::vector<Particle> all(p.size());
  const std::int64_t first = *std::min_element(p.id().begin(), p.id().end());
  for (std::size_t k = 0; k < p.size(); ++k)
    for (int d = 0; d < p.dimensions(); ++d) {
      auto& particle = all[static_cast<std::size_t>(p.id()[k] - first)];
      particle.x[static_cast<std::size_t>(d)] = p.column(Field::position, d)[k];
      particle.v[static_cast<std::size_t>(d)] = p.column(Field::velocity, d)[k];
    }
  return all;
}

void advance(Simulation& run, int steps) {
  for (int k = 0; k < steps; ++k) run.step(1e9);
}

void turn_back(Simulation& run) {
  for (auto& p : run.phases())
    for (int d = 0; d < p.dimensions(); ++d)
      for (std::size_t k = 0; k < p.size(); ++k) p.column(Field::velocity, d)[k] *= -1.0;
}

/// Largest distance between two sets of particles.
double distance(const std::vector<Particle>& a, const std::vector<Particle>& b) {
  double worst = 0.0;
  for (std::size_t k = 0; k < a.size(); ++k) worst = std::max(worst, norm(a[k].x - b[k].x));
  return worst;
}

const std::string two_grains = R"toml(
spacing = 0.1
[domain]
size = [4, 4]
gravity = [1, -10]
[phases.sand]
kind = "grains"
density = 1000
restitution = 1.0
contact-speed = 2.0
[interactions]
sand-sand = 1.1
[[fill]]
phase = "sand"
shape = { points = [[2.0, 2.0], [2.06, 2.06]] }
velocity = [0.5, 0.25]
[time]
end = 1
)toml";

TEST(Integrator, FreeFallIsExact) {
  const auto run = small::simulation(two_grains, {"fill.0.shape={ points = [[2.0, 3.0], [3.0, 3.0]] }", fixed(0.004)});
  const auto start = by_id(*run, 0);
  advance(*run, 150);
  const double t = run->time();
  EXPECT_NEAR(t, 0.6, 1e-12);
  for (std::size_t k = 0; k < 2; ++k) {
    const Particle p = by_id(*run, 0)[k];
    EXPECT_NEAR(p.x[0], start[k].x[0] + 0.5 * t + 0.5 * t * t, 1e-13);
    EXPECT_NEAR(p.x[1], start[k].x[1] + 0.25 * t - 5.0 * t * t, 1e-13);
    EXPECT_NEAR(p.v[1], 0.25 - 10.0 * t, 1e-13);
  }
}

// Two grains pressed together by a seventh of their size fly apart; the error is taken while they still touch.
TEST(Integrator, IsOfSecondOrderForTwoGrains) {
  const auto state = [](int steps) {
    const double end = 0.008;  // s; the contact has a time scale of d/c = 0.05 s
    const auto run = small::simulation(two_grains, {fixed(end / steps)});
    advance(*run, steps);
    return by_id(*run, 0);
  };
  const auto truth = state(640);
  EXPECT_LT(norm(truth[0].x - truth[1].x), 0.1) << "still in contact";
  const double coarse = distance(state(10), truth), middle = distance(state(20), truth),
               fine = distance(state(40), truth);
  EXPECT_NEAR(std::log2(coarse / middle), 2.0, 0.1);
  EXPECT_NEAR(std::log2(middle / fine), 2.0, 0.1);
}

TEST(Integrator, GoesBackTheWayItCame) {
  const auto run =
      small::simulation(small::grains, {"phases.sand.restitution=1.0", "time.step=2e-5", "domain.gravity=[0, 0]"});
  const auto start = by_id(*run, 0);
  advance(*run, 300);
  EXPECT_GT(distance(by_id(*run, 0), start), 1e-4) << "grains moved, and met";
  turn_back(*run);
  advance(*run, 300);
  EXPECT_LT(distance(by_id(*run, 0), start), 1e-12);
}

/// A free bar of 12 x 4 particles, stretched and squeezed along itself.
const std::string bar = R"toml(
spacing = 0.1
[domain]
size = [3, 2]
[phases.rod]
kind = "elastic"
formulation = "updated-lagrangian"
density = 1000
young = 1e6
poisson = 0.3
[interactions]
rod-rod = 2.4
[[fill]]
phase = "rod"
shape = { box = { min = [0.9, 0.8], max = [2.1, 1.2] } }
velocity = ["0.01*sin(pi*(x-1.5)/1.2)", "0.003*sin(pi*(x-1.5)/1.2)"]
[time]
end = 1
largest-speed = 0.01
)toml";

// Bodies drift in two halves; none of it shows in a fall without strain.
TEST(Integrator, ABodyFallsLikeAParticle) {
  const auto run = small::simulation(bar, {"fill.0.velocity=[0.5, 0.25]", "domain.gravity=[1, -10]", "time.step=1e-4"});
  const auto start = by_id(*run, 0);
  advance(*run, 300);
  const double t = run->time();
  const auto end = by_id(*run, 0);
  for (std::size_t k = 0; k < end.size(); ++k) {
    EXPECT_NEAR(end[k].x[0], start[k].x[0] + 0.5 * t + 0.5 * t * t, 1e-11);  // rounding, made stress by a stiff body
    EXPECT_NEAR(end[k].x[1], start[k].x[1] + 0.25 * t - 5.0 * t * t, 1e-11);
  }
}

TEST(Integrator, IsOfSecondOrderForAnElasticBar) {
  const auto state = [](int steps) {
    const double end = 0.024;  // s; a period of the bar is 2 L/c = 0.07 s, the largest stable step about 1e-3 s
    const auto run = small::simulation(bar, {fixed(end / steps)});
    advance(*run, steps);
    return by_id(*run, 0);
  };
  const auto truth = state(960);
  const double coarse = distance(state(60), truth), middle = distance(state(120), truth),
               fine = distance(state(240), truth);
  EXPECT_GT(coarse, 1e-10) << "there is an error to converge";
  EXPECT_GT(std::log2(coarse / middle), 1.8);
  EXPECT_GT(std::log2(middle / fine), 1.8);
}

}  // namespace
}  // namespace barchan::of_integrator
