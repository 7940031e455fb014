// Two fluids that meet: momentum of layers that slide, the stress across their interface, its waves.
#include <gtest/gtest.h>

#include <cmath>
#include <sstream>
#include <string>

#include "physics/drive.hpp"
#include "physics/small_scenes.hpp"

namespace barchan {
namespace {

using testing::report;

std::string number(double x) {
  std::ostringstream text;
  text.precision(17);
  text << x;
  return text.str();
}

/// Two fluids a (below) and b (above), each half of a box one wide and one high.
struct Layers {
  double spacing = 0.05;
  std::string scheme = "consistent", periodic = "[\"x\"]", width = "1", gravity = "[0, 0]", more;
  double density_a = 1000, density_b = 1000;      // kg/m3
  double viscosity_a = 0.01, viscosity_b = 0.01;  // m2/s
  double sound = 15;                              // m/s
  std::string velocity_a = "[0, 0]", velocity_b = "[0, 0]", fill;

  std::string text() const {
    const auto fluid = [&](double density, double viscosity) {
      return "kind = \"fluid\"\nscheme = \"" + scheme + "\"\ndensity = " + number(density) +
             "\nviscosity = " + number(viscosity) + "\nsound-speed = " + number(sound) + "\n";
    };
    const auto layer = [&](const char* name, const char* from, const char* to, const std::string& velocity) {
      return std::string("[[fill]]\nphase = \"") + name + "\"\nshape = { box = { min = [0, " + from + "], max = [" +
             width + ", " + to + "] } }\nvelocity = " + velocity + "\n" + fill;
    };
    return "spacing = " + number(spacing) + "\n[domain]\nsize = [" + width + ", 1]\nperiodic = " + periodic +
           "\ngravity = " + gravity + "\n[phases.a]\n" + fluid(density_a, viscosity_a) + "[phases.b]\n" +
           fluid(density_b, viscosity_b) + more + layer("a", "0", "0.5", velocity_a) +
           layer("b", "0.5", "1", velocity_b) + "[time]\nend = 100\nlargest-speed = 1\n";
  }
};

double momentum(const Simulation& run) {
  double sum = 0.0;
  for (const PhaseParticles& p : run.phases())
    for (std::size_t k = 0; k < p.size(); ++k) sum += p.mass() * p.column(Field::velocity, 0)[k];
  return sum;
}

/// Momentum of a layer b that slides over a at 1 m/s, after this time, over that of the start.
double momentum_left(const char* scheme, double density, double viscosity, double until) {
  Layers layers;
  layers.periodic = "[\"x\", \"y\"]";
  layers.scheme = scheme;
  layers.viscosity_a = 0.1;
  layers.density_b = density;
  layers.viscosity_b = viscosity / density;
  layers.more = "[interactions]\na-a = 3\nb-b = 3\na-b = 3\n";
  layers.fill = "perturb = 0.1\n";
  layers.velocity_b = "[1, 0]";
  const auto run = small::simulation(layers.text());
  const double before = momentum(*run);
  while (run->time() < until) run->step(1.0);
  return momentum(*run) / before;
}

// What a pair gives, both of its particles get (plain scheme); what the corrected sums make besides is taken from all
// alike (KeptMomentum). A layer 830 times as light as the other made 15 % of its momentum in the first steps, 1e-4 m/s
// of the heavy one; in the plain scheme the mean of both pressures threw it out of the box.
TEST(TwoFluids, LayersThatSlideKeepTheirMomentum) {
  struct Case {
    double density, viscosity;
  };
  for (const char* scheme : {"consistent", "plain"})
    for (const Case& c : {Case{1000, 10}, {1000, 0.1}, {500, 0.1}, {100, 0.1}, {1.2, 0.1}}) {
      const double left = momentum_left(scheme, c.density, c.viscosity, 0.15);
      report("momentum over that of the start, less 1", std::abs(left - 1.0), 1e-5);
      EXPECT_NEAR(left, 1.0, 1e-5) << scheme << ", " << c.density << " kg/m3, " << c.viscosity << " Pa s";
    }
}

const std::string walls = R"([phases.floor]
kind = "wall"
[phases.lid]
kind = "wall"
velocity = [1, 0]
[interactions]
a-a = 2.6
b-b = 2.6
a-b = 2.6
a-floor = 2.6
b-lid = 2.6
a-lid = false
b-floor = false
[[fill]]
phase = "floor"
shape = { sides = ["bottom"] }
[[fill]]
phase = "lid"
shape = { sides = ["top"] }
)";

// Couette's flow of two layers: the stress is the same in both, the interface has the speed mu_b/(mu_a + mu_b). It is
// exact on rows, so that what starts as it stays as it is.
TEST(TwoFluids, ALidDragsTwoLayersWithOneStress) {
  for (const double ratio : {2.0, 10.0, 100.0}) {
    const double speed = 1.0 / (1.0 + ratio);
    Layers layers;
    layers.width = "0.4";
    layers.viscosity_a = 0.01 * ratio;
    layers.more = walls;
    layers.velocity_a = "[\"" + number(2.0 * speed) + "*y\", 0]";
    layers.velocity_b = "[\"" + number(speed) + "+(2*y-1)*" + number(1.0 - speed) + "\", 0]";
    const auto run = small::simulation(layers.text());
    while (run->time() < 0.3) run->step(1.0);
    double worst = 0.0;
    for (std::size_t phase : {0u, 1u}) {
      const PhaseParticles& p = run->phases()[phase];
      for (std::size_t k = 0; k < p.size(); ++k) {
        const double y = p.column(Field::position, 1)[k];
        const double exact = phase == 0 ? 2.0 * speed * y : speed + (2.0 * y - 1.0) * (1.0 - speed);
        worst = std::max(worst, std::abs(p.column(Field::velocity, 0)[k] - exact));
      }
    }
    report("largest error over the speed of the interface", worst / speed, 0.02);
    EXPECT_LE(worst, 0.02 * speed);
  }
}

}  // namespace
}  // namespace barchan
