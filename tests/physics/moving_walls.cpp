// Walls that a [[motion]] carries, against exact values: a piston in a tube, a fluid that turns with its vessel, a belt
// and a drum with grains.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <stdexcept>

#include "physics/drive.hpp"
#include "physics/small_scenes.hpp"

namespace barchan {
namespace {

using testing::Drive;
using testing::report;
using testing::value;

const PhaseParticles& phase(const Simulation& run, const std::string& name) {
  for (const PhaseParticles& p : run.phases())
    if (p.name() == name) return p;
  throw std::runtime_error("no phase " + name);
}

// A particle on the diagonal of a corner lies as deep under the side as under the floor on which the gate stands:
// round-off chose, and the impulse on the gate changed by 6 % between spacings.
TEST(Gate, HasTheSameFacesLeftAndRightAtEverySpacing) {
  for (int rows = 20; rows < 40; ++rows) {
    const double spacing = 0.3 / rows;
    char size[40], place[80];
    std::snprintf(size, sizeof size, "spacing=%.17g", spacing);
    std::snprintf(place, sizeof place, "fill.1.shape.box.max=[%.17g, 0.45]", 0.6 + 4 * spacing);
    Drive drive("dam_gate", {size, place});
    const PhaseParticles& gate = phase(drive.simulation(), "gate");
    const double *x = gate.column(Field::position, 0), *y = gate.column(Field::position, 1),
                 *depth = gate.column(Field::wall_depth);
    const auto [left, right] = std::minmax_element(x, x + gate.size());
    const double middle = *left + *right;
    for (std::size_t k = 0; k < gate.size(); ++k) {
      std::size_t other = 0;
      const auto off = [&](std::size_t m) { return std::abs(x[k] + x[m] - middle) + std::abs(y[k] - y[m]); };
      for (std::size_t m = 1; m < gate.size(); ++m)
        if (off(m) < off(other)) other = m;
      EXPECT_NEAR(depth[k], depth[other], 1e-3 * spacing) << rows << " rows, at " << x[k] << ", " << y[k];
    }
  }
}

class Piston : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Schemes, Piston, ::testing::Values("consistent", "plain"),
                         [](const auto& scheme) { return std::string(scheme.param); });

// Behind the front the pressure is rho D U, D = U/2 + sqrt(c^2 + U^2/4), and the speed that of the piston.
TEST_P(Piston, MakesThePressureOfItsSpeed) {
  Drive drive("verification/piston", {std::string("phases.water.scheme=") + GetParam()});
  drive.to(0.08);
  const double u = 0.1, c = 10.0, front = 0.5 * u + std::sqrt(c * c + 0.25 * u * u), wanted = 1000.0 * front * u;
  const PhaseParticles& water = drive.phase(0);
  double pressure = 0.0, speed = 0.0, largest = 0.0, ahead = 0.0;
  int count = 0;
  for (std::size_t k = 0; k < water.size(); ++k) {
    const double x = water.column(Field::position, 0)[k], p = water.column(Field::pressure)[k];
    if (x > 0.05 + front * 0.08 + 0.2) ahead = std::max(ahead, std::abs(p));
    if (x > 0.65) continue;  // the front is at 0.854 m
    pressure += p;
    speed += water.column(Field::velocity, 0)[k];
    largest = std::max(largest, std::abs(p / wanted - 1.0));
    ++count;
  }
  report("mean pressure behind the front/exact, error", std::abs(pressure / count / wanted - 1.0), 0.01);
  EXPECT_NEAR(pressure / count, wanted, 0.01 * wanted);
  report("pressure of any particle behind the front/exact, error", largest, 0.05);
  EXPECT_LT(largest, 0.05);
  EXPECT_NEAR(speed / count, u, 0.01 * u);
  report("pressure ahead of the front/exact", ahead / wanted, 0.01);
  EXPECT_LT(ahead, 0.01 * wanted);
  report("force on the piston/exact, error",
         std::abs(value(drive.simulation(), "piston_force_x [") / (0.1 * wanted) + 1.0), 0.03);
  EXPECT_NEAR(value(drive.simulation(), "piston_force_x ["), -0.1 * wanted, 0.003 * wanted);
  EXPECT_NEAR(value(drive.simulation(), "motion_0_x [m]"), 0.025 + 0.1 * 0.08, 1e-12);
  const PhaseParticles& piston = phase(drive.simulation(), "piston");
  for (std::size_t k = 0; k < piston.size(); ++k) EXPECT_EQ(piston.column(Field::velocity, 0)[k], u);
}

/// Water in a vessel that speeds up along x: at rest in the vessel, p = -rho a (x - x_m).
const std::string vessel = R"toml(
spacing = 0.025
[domain]
size = [2, 0.5]
periodic = ["y"]
[phases.water]
kind = "fluid"
density = 1000
viscosity = 0.02
sound-speed = 20
[phases.vessel]
kind = "wall"
[interactions]
kernel = "wendland-c2"
water-water = 2.6
water-vessel = 2.6
[[fill]]
phase = "vessel"
shape = { box = { min = [0, 0], max = [0.125, 0.5] } }
[[fill]]
phase = "vessel"
shape = { box = { min = [0.625, 0], max = [0.75, 0.5] } }
[[fill]]
phase = "water"
shape = { box = { min = [0.125, 0], max = [0.625, 0.5] } }
pressure = "-1000*0.5*(x - 0.375)"
velocity = [0, 0]
[[motion]]
phase = "vessel"
velocity = ["0.5*t", 0]
[time]
end = 1
largest-speed = 1
)toml";

class Vessel : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Schemes, Vessel, ::testing::Values("consistent", "plain"),
                         [](const auto& scheme) { return std::string(scheme.param); });

// Without the wall's acceleration in its pressure (Adami et al. 2012) the water would sink into the wall.
TEST_P(Vessel, WaterRestsInAVesselThatSpeedsUp) {
  const auto run = small::simulation(vessel, {std::string("phases.water.scheme=") + GetParam()});
  while (run->time() < 0.4 * (1.0 - 1e-12)) run->step(0.4 - run->time());
  const PhaseParticles& water = run->phases()[0];
  double fastest = 0.0, error = 0.0;
  for (std::size_t k = 0; k < water.size(); ++k) {
    const double x = water.column(Field::position, 0)[k] - 0.25 * 0.4 * 0.4;
    fastest = std::max(fastest, std::abs(water.column(Field::velocity, 0)[k] - 0.5 * 0.4));
    error = std::max(error, std::abs(water.column(Field::pressure)[k] + 500.0 * (x - 0.375)));
  }
  report("speed of the water in the vessel/that of the vessel", fastest / 0.2, 0.01);
  EXPECT_LT(fastest, 0.002);
  report("pressure, error/(rho a L/2)", error / 125.0, 0.05);
  EXPECT_LT(error, 0.05 * 125.0);
}

/// A viscous fluid in a drum: it turns as a whole with its vessel.
const std::string whirl = R"toml(
spacing = 0.05
[domain]
size = [3, 3]
[phases.oil]
kind = "fluid"
density = 1000
viscosity = 0.1
sound-speed = 20
[phases.drum]
kind = "wall"
[interactions]
kernel = "wendland-c2"
oil-oil = 2.6
oil-drum = 2.6
[[fill]]
phase = "drum"
shape = { ring = { centre = [1.5, 1.5], inner = 1, outer = 1.25 } }
[[fill]]
phase = "oil"
shape = { formula = "1 - (x - 1.5)^2 - (y - 1.5)^2" }
leave-out = "earlier-fills"
velocity = ["-(y - 1.5)", "x - 1.5"]
pressure = "500*((x - 1.5)^2 + (y - 1.5)^2)"
[[motion]]
phase = "drum"
about = [1.5, 1.5]
angular-velocity = 1
[time]
end = 2
largest-speed = 1
)toml";

TEST(Drum, TurnsOilAsAWhole) {
  const auto run = small::simulation(whirl);
  while (run->time() < 1.0 - 1e-12) run->step(1.0 - run->time());
  const PhaseParticles& oil = run->phases()[0];
  double worst = 0.0;
  for (std::size_t k = 0; k < oil.size(); ++k) {
    const double x = oil.column(Field::position, 0)[k] - 1.5, y = oil.column(Field::position, 1)[k] - 1.5;
    worst = std::max(worst, std::hypot(oil.column(Field::velocity, 0)[k] + y, oil.column(Field::velocity, 1)[k] - x));
  }
  report("velocity in a vessel that turns/that of the vessel, error", worst, 0.02);
  EXPECT_LT(worst, 0.02);
  EXPECT_NEAR(value(*run, "motion_0_angle [rad]"), 1.0, 1e-12);
}

// A gate that is pulled out of the water takes no jet along: nothing drives the water upwards but the pressure beside
// it.
TEST(Gate, IsLetGo) {
  Drive drive("dam_gate");
  drive.to(0.08);
  const PhaseParticles& water = drive.phase(0);
  double up = 0.0, front = 0.0;
  for (std::size_t k = 0; k < water.size(); ++k) {
    up = std::max(up, water.column(Field::velocity, 1)[k]);
    front = std::max(front, water.column(Field::position, 0)[k]);
  }
  report("speed upwards of water under a gate that rises at 4.5 m/s, m/s", up, 1.0);
  EXPECT_LT(up, 1.0);
  EXPECT_GT(front, 0.65) << "the water runs out under the gate";
}

// Round-off decided which of two faces the particle in the lower edge of the gate lies behind: at a half of all
// spacings the water under it was released at once, and the force fell to a half before the gate had risen by a
// spacing.
TEST(Gate, HoldsTheWaterWhateverItsSpacing) {
  double least = 1e300, most = 0.0;
  for (const char* spacing : {"spacing=0.015", "spacing=0.0125", "spacing=0.0115384615384615"}) {
    Drive drive("dam_gate", {spacing, "fill.1.shape.box.max=[0.69, 0.45]"});
    drive.to(0.012);
    const double impulse = value(drive.simulation(), "gate_impulse_x [");
    least = std::min(least, impulse);
    most = std::max(most, impulse);
  }
  report("impulse on a gate at three spacings, largest/least - 1", most / least - 1.0, 0.05);
  EXPECT_LT(most / least, 1.05);
  EXPECT_NEAR(least / (0.5 * 9810 * 0.3 * 0.3 * 0.012), 1.0, 0.05) << "it still carries the weight of the water";
}

/// A belt along a periodic axis, with one grain on it.
const std::string belt = R"toml(
spacing = 1e-3
[domain]
size = [0.02, 0.02]
periodic = ["x"]
gravity = [0, -9.81]
[phases.sand]
kind = "grains"
density = 2650
diameter = 1e-3
friction = 0.5
stiffness = 500
restitution = 0.5
[phases.belt]
kind = "wall"
[interactions]
sand-sand = { law = "linear" }
sand-belt = { law = "linear" }
[[fill]]
phase = "belt"
shape = { box = { min = [0, 0], max = [0.02, 0.001] } }
[[fill]]
phase = "sand"
shape = { points = [[0.00501, 0.0015]] }
[[motion]]
phase = "belt"
velocity = ["0.1*min(1, t/0.1)", 0]
[time]
end = 1
largest-speed = 0.2
)toml";

TEST(Belt, CarriesAGrainRoundThePeriodicDomain) {
  const auto run = small::simulation(belt);
  while (run->time() < 0.6 - 1e-12) run->step(0.6 - run->time());
  const PhaseParticles& sand = run->phases()[0];
  // A sphere that rolls without slip on a surface that speeds up has 2/7 of its speed: m a = F, (2/5) m r^2 w' = F r.
  report("speed of a grain on a belt/two sevenths of the belt's, error",
         std::abs(sand.column(Field::velocity, 0)[0] / (0.2 / 7.0) - 1.0), 1e-3);
  EXPECT_NEAR(sand.column(Field::velocity, 0)[0], 0.2 / 7.0, 1e-5);
  EXPECT_NEAR(sand.column(Field::velocity, 1)[0], 0.0, 1e-4);
  EXPECT_GT(sand.column(Field::position, 1)[0], 0.001) << "it lies on the belt";
}

TEST(Drum, CarriesGrainsRoundAndLosesNone) {
  const auto run =
      small::simulation(small::drum + "[[force]]\nname = \"drum\"\nphase = \"drum\"\nabout = [0.01, 0.01]\n",
                        {"phases.sand.sleep=false", "motion.0.velocity=[0, 0]", "motion.0.angular-velocity=10"});
  const PhaseParticles& sand = run->phases()[0];
  const auto centre = [&] {
    double x = 0.0;
    for (std::size_t k = 0; k < sand.size(); ++k) x += (sand.column(Field::position, 0)[k] - 0.01);
    return x / static_cast<double>(sand.size());
  };
  double highest = -1.0;
  while (run->time() < 0.5 - 1e-12) {
    run->step(0.5 - run->time());
    for (std::size_t k = 0; k < sand.size(); ++k) {
      ASSERT_LT(std::hypot(sand.column(Field::position, 0)[k] - 0.01, sand.column(Field::position, 1)[k] - 0.01),
                0.0085)
          << "a grain left the drum";
      highest = std::max(highest, sand.column(Field::position, 1)[k]);
    }
  }
  // It turns counterclockwise: the bed leans towards +x.
  report("mean place of the grains along x, diameters", centre() / 1e-3, 1.0);
  EXPECT_GT(centre(), 1e-3);
  EXPECT_LT(value(*run, "drum_torque_z ["), 0.0) << "the grains brake the drum";
}

/// A grain that sleeps on a plate wakes when the plate tilts, and slides off.
TEST(Plate, WakesTheGrainsThatSleepOnIt) {
  const std::string text = [] {
    std::string s = belt;
    s.replace(s.find("restitution"), 0, "sleep = true\n");
    return s;
  }();
  const auto run = small::simulation(text, {"motion.0.velocity=[\"t < 0.3 ? 0 : 0.1*min(1, (t - 0.3)/0.1)\", 0]"});
  bool slept = false;
  while (run->time() < 0.6 - 1e-12) {
    run->step(0.6 - run->time());
    slept = slept || (run->time() < 0.3 && value(*run, "asleep") == 1.0);
  }
  EXPECT_TRUE(slept) << "the test is meant to see it asleep";
  EXPECT_NEAR(run->phases()[0].column(Field::velocity, 0)[0], 0.2 / 7.0, 1e-5) << "it rolls";
}

}  // namespace
}  // namespace barchan
