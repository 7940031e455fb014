// A run whose momentum or energy drifts says so: the budget of a closed scene, and none where the scene drives it.
#include "simulation/budget.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "checks/reader.hpp"
#include "simulation/simulation.hpp"
#include "unit/scene_texts.hpp"

namespace barchan {
namespace {

using testing::with;

/// Shear waves in a periodic square, u = sin(2 pi y), without gravity and walls: momentum and energy are promised.
const std::string wave = R"toml(spacing = 0.05
[domain]
size = [1, 1]
periodic = ["x", "y"]
[phases.water]
kind = "fluid"
density = 1000
sound-speed = 10
[interactions]
water-water = 2.1
[[fill]]
phase = "water"
shape = "the-rest"
velocity = ["sin(2*pi*y)", 0]
[time]
end = 1
)toml";

struct Case {
  explicit Case(const std::string& text)
      : scene(parse_scene(text, "wave.toml")),
        plan(make_plan(scene, generate(scene))),
        run(scene, plan, generate(scene)) {}
  Scene scene;
  Plan plan;
  Simulation run;
  std::vector<std::string> warnings() {
    Warnings list;
    run.budget().report(run.state(), list);
    return list.texts();
  }
  double* column(Field f, int component = 0) { return run.phases()[0].column(f, component); }
  std::size_t count() { return run.phases()[0].size(); }
};

bool one_tells(const std::vector<std::string>& texts, const std::string& words) {
  return texts.size() == 1 && texts[0].find(words) != std::string::npos;
}

TEST(Budget, IsSilentWhenNothingDrifts) {
  Case c(wave);
  for (int k = 0; k < 20; ++k) c.run.step(1.0);
  EXPECT_TRUE(c.warnings().empty()) << c.warnings().front();
  ASSERT_TRUE(c.run.budget().momentum_drift(c.run.state()));
  EXPECT_LT(*c.run.budget().momentum_drift(c.run.state()), 1e-6);
  ASSERT_TRUE(c.run.budget().energy_growth(c.run.state()));
  EXPECT_LT(*c.run.budget().energy_growth(c.run.state()), 1e-3);
}

TEST(Budget, TellsOfMomentumFromNowhere) {
  Case c(wave);
  const double added = 0.02 * std::sqrt(0.5);  // m/s: 2 % of the root of the mean square of the speed; the bound is 1 %
  for (std::size_t i = 0; i < c.count(); ++i) c.column(Field::velocity, 1)[i] += added;
  EXPECT_NEAR(*c.run.budget().momentum_drift(c.run.state()), 0.02, 1e-4);
  EXPECT_TRUE(one_tells(c.warnings(), "the momentum drifted by "));
}

TEST(Budget, TellsOfEnergyFromNowhere) {
  Case c(wave);
  for (std::size_t i = 0; i < c.count(); ++i) c.column(Field::velocity)[i] *= std::sqrt(1.1);  // 10 %; the bound is 5 %
  EXPECT_TRUE(one_tells(c.warnings(), "the energy of the motion"));
}

TEST(Budget, TellsWhatAFluidThatRestedGained) {
  Case c(with(wave, "velocity = [\"sin(2*pi*y)\", 0]\n", "velocity = [0, 0]\n"));
  for (std::size_t i = 0; i < c.count(); ++i) c.column(Field::velocity)[i] = i % 2 == 0 ? 0.5 : -0.5;  // of 1000 kg
  EXPECT_TRUE(one_tells(c.warnings(), "gained 125 J")) << c.warnings().front();
}

TEST(Budget, CountsWhatCompressionStores) {
  Case c(wave);
  // c^2 (rho/rho0 - 1)^2/2 = 100 * 1e-4/2 = 5e-3 J/kg, a fiftieth of the mean of u^2/2 = 0.25 J/kg.
  for (std::size_t i = 0; i < c.count(); ++i) c.column(Field::density)[i] = 1010.0;
  EXPECT_NEAR(*c.run.budget().energy_growth(c.run.state()), 0.02, 1e-3);
}

// A column of air gives and takes: nothing about a grain in it is promised.
TEST(Budget, PromisesNothingInAColumnOfAir) {
  const Scene scene = read_scene(BARCHAN_SOURCE_DIR "/scenes/verification/hop.toml");
  const auto blocks = generate(scene);
  Simulation run(scene, make_plan(scene, blocks), blocks);
  const auto sand = run.phases().size() - 1;
  PhaseParticles& grain = run.phases()[scene.phases[0].has_particles() ? 0 : sand];
  grain.column(Field::velocity, 0)[0] += 3.0;
  Warnings list;
  run.budget().report(run.state(), list);
  EXPECT_TRUE(list.texts().empty()) << list.texts().front();
}

TEST(Budget, PromisesNothingWhereTheSceneDrives) {
  Case forced(wave + "[[forcing]]\nphase = \"water\"\nacceleration = [1, 0]\n");
  EXPECT_FALSE(forced.run.budget().momentum_drift(forced.run.state()));
  EXPECT_FALSE(forced.run.budget().energy_growth(forced.run.state()));
  Case falling(with(wave, "periodic = [\"x\", \"y\"]", "periodic = [\"x\", \"y\"]\ngravity = [0, -1]"));
  EXPECT_TRUE(falling.run.budget().momentum_drift(falling.run.state())) << "along x it is kept";
  EXPECT_FALSE(falling.run.budget().energy_growth(falling.run.state())) << "it falls for ever";
}

}  // namespace
}  // namespace barchan
