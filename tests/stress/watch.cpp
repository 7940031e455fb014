// What the watch lets through, what it does not, and what it leaves behind when it is silent.
#include <gtest/gtest.h>
#include <omp.h>

#include <algorithm>
#include <cmath>

#include "base/errors.hpp"
#include "checks/reader.hpp"
#include "models/step_limits.hpp"
#include "simulation/simulation.hpp"
#include "stress/scenes.hpp"

namespace barchan {
namespace {

using namespace stress;

std::unique_ptr<Simulation> simulation(const std::string& text, const std::vector<std::string>& overrides = {}) {
  const Scene scene = parse_scene(text, "scene.toml", overrides);
  const auto blocks = generate(scene);
  return std::make_unique<Simulation>(scene, make_plan(scene, blocks), blocks);
}

std::string message_of(Simulation& s, long steps) {
  try {
    for (long k = 0; k < steps; ++k) s.step(1e300);
    s.check();
  } catch (const BreakdownError& e) { return e.what(); }
  return "";
}

/// An elastic square that falls on a floor, with the sections in either order.
std::string dropped(bool body_first) {
  const std::string body = R"toml([phases.body]
kind = "elastic"
formulation = "updated-lagrangian"
density = 1000
young = 1e6
poisson = 0.3
artificial-viscosity = 0.5
)toml",
                    floor = "[phases.floor]\nkind = \"wall\"\n";
  std::string text = R"toml(spacing = 0.001
[domain]
size = [0.03, 0.03]
gravity = [0, -9.81]
)toml";
  text += body_first ? body : floor;
  text += body_first ? floor : body;
  return text + R"toml([interactions]
body-body = 2.4
body-floor = 1.1
[[fill]]
phase = "floor"
shape = { sides = ["bottom"], layers = 1 }
[[fill]]
phase = "body"
shape = { box = { min = [0.010, 0.002], max = [0.020, 0.008] } }
velocity = [0, -1]
[time]
end = 1
)toml";
}

TEST(Wall, HoldsAnElasticBodyWhateverTheOrderOfTheSections) {
  double heights[2];
  for (const bool body_first : {true, false}) {
    const auto s = simulation(dropped(body_first));
    ASSERT_EQ(message_of(*s, 1000), "");
    const auto& p = s->phases()[body_first ? 0 : 1];
    const double *y = p.column(Field::position, 1), *v = p.column(Field::velocity, 1);
    double mean = 0;
    for (std::size_t k = 0; k < p.size(); ++k) mean += v[k] / static_cast<double>(p.size());
    EXPECT_GT(mean, 0.3) << "it came back";
    EXPECT_GT(*std::min_element(y, y + p.size()), 0.0);
    heights[body_first ? 0 : 1] = *std::min_element(y, y + p.size());
  }
  EXPECT_EQ(heights[0], heights[1]);
}

/// A column whose own weight compresses it by 15 %, and a wave of 20 %: within the bound of 30 %.
TEST(Watch, LetsCompressionThrough) {
  const auto column = simulation(
      two_fluids, {"phases.water.sound-speed=2.6", "phases.air.sound-speed=20", "fill.1.velocity=[0, 0]",
                   "fill.2.velocity=[0, 0]", "fill.1.pressure='hydrostatic'", "fill.2.pressure='hydrostatic'",
                   "phases.water.scheme='consistent'", "phases.air.scheme='consistent'"});
  ASSERT_NO_THROW(column->check_start());
  EXPECT_EQ(message_of(*column, 300), "");
  const auto wave = simulation(vortices, {"fill.0.velocity=[0, 0]", "fill.0.pressure='x < 0.5 ? 20 : 0'"});
  ASSERT_NO_THROW(wave->check_start());
  EXPECT_EQ(message_of(*wave, 200), "");
  EXPECT_EQ(wave->warnings().texts().size(), 1u);  // but it is worth a word
}

/// Six times faster at once: no particle is faster than sound, but nothing in the scene can have done it.
TEST(Watch, SeesEnergyThatNoLawExplains) {
  const auto s = simulation(vortices);
  ASSERT_EQ(message_of(*s, 20), "");
  for (int d = 0; d < 2; ++d) {
    double* v = s->phases()[0].column(Field::velocity, d);
    for (std::size_t k = 0; k < s->phases()[0].size(); ++k) v[k] *= 6.0;
  }
  const std::string message = message_of(*s, 0);
  EXPECT_NE(message.find("kinetic energy of all particles"), std::string::npos) << message;
  EXPECT_NE(message.find("particle "), std::string::npos) << message;
}

/// The same particle, place and step for any number of threads.
TEST(Watch, NamesTheSameParticleWithAnyNumberOfThreads) {
  const int before = omp_get_max_threads();
  std::string messages[3];
  for (int threads = 1; threads <= 3; ++threads) {
    omp_set_num_threads(threads);
    messages[threads - 1] = message_of(*simulation(vortices, {"forcing.0.acceleration=[100, 0]"}), 200);
  }
  omp_set_num_threads(before);
  EXPECT_NE(messages[0], "");
  EXPECT_EQ(messages[0], messages[1]);
  EXPECT_EQ(messages[0], messages[2]);
}

/// The state kept is that of its step, and looking at it changes nothing.
TEST(Watch, KeepsAGoodStateApart) {
  const auto s = simulation(vortices);
  s->check_start();
  EXPECT_EQ(s->good_step(), 0);
  for (int k = 0; k < 10; ++k) s->step(1e300);
  s->check();
  const Frame then = s->frame(3);
  for (int k = 0; k < 30; ++k) s->step(1e300);
  const Frame before = s->frame(4), good = s->good_frame(3), after = s->frame(4);
  EXPECT_EQ(s->good_step(), 10);
  EXPECT_EQ(good.time, then.time);
  EXPECT_EQ(good.step, then.step);
  EXPECT_EQ(good.id, then.id);
  EXPECT_EQ(good.points, then.points);
  EXPECT_NE(good.points, before.points);
  EXPECT_EQ(before.points, after.points);
  EXPECT_EQ(before.id, after.id);
  for (std::size_t f = 0; f < good.fields.size(); ++f) EXPECT_EQ(good.fields[f].values, then.fields[f].values);
}

/// The force of the first moment limits the first step.
TEST(FirstStep, ObeysTheForceLimit) {
  const double force = 1e5;
  const auto s = simulation(
      vortices, {"phases.fluid.sound-speed=60", "forcing.0.acceleration=[" + std::to_string(force) + ", 0]"});
  ASSERT_NO_THROW(s->check_start());
  s->step(1e300);
  const double limit = StepConstants::force * std::sqrt(s->plan().phases[0].smoothing_length / force);
  ASSERT_LT(limit, s->plan().step()) << "the test needs a force that rules";
  EXPECT_EQ(s->ruling_limit(), "force");
  EXPECT_NEAR(s->last_step(), limit, 0.02 * limit);
}

/// A density error above 5 % is said at the end, with particle, place and time; a quiet run says nothing.
TEST(Warnings, TellOfTheLargestDensityError) {
  const auto quiet = simulation(vortices);
  ASSERT_EQ(message_of(*quiet, 100), "");
  EXPECT_TRUE(quiet->warnings().texts().empty());

  const auto off = simulation(vortices, {"interactions.fluid-fluid=1.5", "phases.fluid.enclosed=false"});
  const auto& p = off->phases()[0];
  double largest = 0.0;
  for (int k = 0; k < 300; ++k) {
    ASSERT_EQ(message_of(*off, 1), "");
    const double* rho = p.column(Field::density);
    for (std::size_t i = 0; i < p.size(); ++i) largest = std::max(largest, std::abs(rho[i] - 1.0));
  }
  const auto warnings = off->warnings().texts();
  ASSERT_EQ(warnings.size(), 1u);
  ASSERT_GT(largest, 0.05);
  EXPECT_NE(warnings[0].find("the density of \"fluid\" was off by "), std::string::npos) << warnings[0];
  EXPECT_NEAR(std::stod(warnings[0].substr(warnings[0].find("off by ") + 7)), 100 * largest, 2.0) << warnings[0];
  for (const char* part : {"particle ", " m, t = ", "step ", "raise phases.fluid.sound-speed"})
    EXPECT_NE(warnings[0].find(part), std::string::npos) << part << " in: " << warnings[0];
}

/// The state after 300 steps, `aside` or not looked at after each 7th, 14th, ...: as if a clock had asked for
/// checkpoints.
std::vector<char> state_after_looks(bool aside) {
  const auto s = simulation(vortices, {"forcing.0.acceleration=[\"0.3*sin(2*pi*x)\", 0]"});
  for (int k = 1; k <= 300; ++k) {
    s->step(1e300);
    if (aside && k % 7 == 0) s->check_aside();
  }
  Archive state;
  s->archive(state);
  return state.bytes();
}

TEST(Watch, LeavesNoTraceAtMomentsThatAClockChose) { EXPECT_EQ(state_after_looks(true), state_after_looks(false)); }

}  // namespace
}  // namespace barchan
