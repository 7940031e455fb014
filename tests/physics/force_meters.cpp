// [[force]]: force and torque on walls and bodies against exact values.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "base/errors.hpp"
#include "physics/drive.hpp"
#include "physics/small_scenes.hpp"

namespace barchan {
namespace {

using testing::report;
using testing::value;

std::string meter(const std::string& name, const std::string& phase, const std::string& more = "") {
  return "\n[[force]]\nname = \"" + name + "\"\nphase = \"" + phase + "\"\n" + more;
}

// Pairs of the plain scheme are antisymmetric: what the fluid gains beyond its weight is what the wall does to it.
TEST(ForceMeters, ForceOnAWallIsWhatTheFluidLoses) {
  const auto run = small::simulation("precision = \"double\"\n" + small::channel + meter("floor", "floor"));
  double worst = 0.0;
  std::array<double, 2> before{};  // a row has the mean of the force at the beginning and at the end of its only step
  for (int step = 0; step < 50; ++step) {
    run->begin_row();
    run->step(1.0);
    const PhaseParticles& water = run->phases()[0];
    for (int d = 0; d < 2; ++d) {
      const double weight = d == 0 ? 0.1 : -9.81;
      double gain = 0.0, size = 0.0;
      for (std::size_t k = 0; k < water.size(); ++k) {
        const double push = water.mass() * (water.column(Field::acceleration, d)[k] - weight);
        gain += push;
        size += std::abs(push);
      }
      const double force = value(*run, d == 0 ? "floor_force_x [" : "floor_force_y [");
      if (step > 10) { EXPECT_GT(std::abs(force), 1e-6 * size) << "there is a force"; }
      double& old = before[static_cast<std::size_t>(d)];
      if (step > 0) worst = std::max(worst, std::abs(0.5 * (gain + old) + force) / size);
      old = gain;
    }
  }
  report("force on the wall and on the fluid, sum/size", worst, 1e-10);
  EXPECT_LE(worst, 1e-10);
}

/// Water at rest in an open tank, 1 m wide and 0.8 m deep.
const std::string tank = R"toml(
spacing = 0.0125
[domain]
size = [1, 1.2]
gravity = [0, -10]
[phases.water]
kind = "fluid"
density = 1000
viscosity = 1e-3
sound-speed = 60
[phases.floor]
kind = "wall"
[phases.left]
kind = "wall"
[phases.right]
kind = "wall"
[interactions]
water-water = {}
water-floor = {}
water-left = {}
water-right = {}
[[fill]]
phase = "floor"
shape = { sides = ["bottom"] }
[[fill]]
phase = "left"
shape = { sides = ["left"] }
[[fill]]
phase = "right"
shape = { sides = ["right"] }
[[fill]]
phase = "water"
shape = { box = { min = [0, 0], max = [1, 0.8] } }
pressure = "hydrostatic"
[time]
end = 10
largest-speed = 4
)toml";

TEST(ForceMeters, HydrostaticForceAndMoment) {
  const auto run = small::simulation(tank + meter("floor", "floor") + meter("left", "left") +
                                     meter("right", "right", "about = [1, 0]\n"));
  double floor = 0.0, left = 0.0, right = 0.0, moment = 0.0;
  constexpr int rest = 50, mean = 50;  // the particles of a corner belong to the floor: half a row of the sides
  for (int step = 0; step < rest + mean; ++step) {
    run->begin_row();
    run->step(1.0);
    if (step < rest) continue;
    floor += value(*run, "floor_force_y [") / mean;
    left += value(*run, "left_force_x [") / mean;
    right += value(*run, "right_force_x [") / mean;
    moment += value(*run, "right_torque_z [") / mean;
  }
  const double weight = 1000.0 * 10.0 * 0.8, side = 0.5 * weight * 0.8;
  report("force on the floor/weight - 1", floor / -weight - 1.0, 0.005);
  report("force on the left wall/(rho g H2/2) - 1", left / -side - 1.0, 0.005);
  report("force on the right wall/(rho g H2/2) - 1", right / side - 1.0, 0.005);
  report("its moment about the corner/(rho g H3/6) - 1", moment / (-side * 0.8 / 3.0) - 1.0, 0.005);
  EXPECT_NEAR(floor / -weight, 1.0, 0.005);
  EXPECT_NEAR(left / -side, 1.0, 0.005);
  EXPECT_NEAR(right / side, 1.0, 0.005);
  EXPECT_NEAR(moment / (-side * 0.8 / 3.0), 1.0, 0.005) << "it turns the wall outwards";
}

/// Plane Poiseuille flow at its end, 20 spacings across, disturbed.
std::string channel(const std::string& walls, const std::string& entries, const std::string& fills) {
  return R"toml(
spacing = 0.05
[domain]
size = [1, 1]
periodic = ["x"]
[phases.water]
kind = "fluid"
density = 2
viscosity = 0.1
sound-speed = 15
)toml" + walls +
         "[interactions]\nwater-water = {}\n" + entries + fills + R"toml(
[[fill]]
phase = "water"
shape = "the-rest"
perturb = 0.1
velocity = ["4*y*(1 - y)", 0]
[[forcing]]
phase = "water"
acceleration = [0.8, 0]
[time]
end = 10
largest-speed = 1
)toml";
}

/// Mean force along x over the second half of three seconds.
double mean_drag(Simulation& run, const std::string& column) {
  double sum = 0.0;
  int count = 0;
  while (run.time() < 3.0) {
    run.begin_row();
    run.step(1.0);
    if (run.time() < 1.5) continue;
    sum += value(run, column);
    ++count;
  }
  return sum / count;
}

TEST(ForceMeters, ShearOnTheWallsOfAChannel) {
  const std::string fill = "[[fill]]\nphase = \"wall\"\nshape = { sides = [\"bottom\", \"top\"] }\n";
  const auto run =
      small::simulation(channel("[phases.wall]\nkind = \"wall\"\n", "water-wall = {}\n", fill) + meter("wall", "wall"));
  const double exact = 2.0 * 0.8, found = mean_drag(*run, "wall_force_x [");  // rho F L a metre
  report("shear on both walls/(rho F L) - 1", found / exact - 1.0, 0.005);
  EXPECT_NEAR(found / exact, 1.0, 0.005);
}

// One of two walls: by pairs, whose sum takes the shear of the fluid next to the wall for that at the wall.
TEST(ForceMeters, ShearOnOneWallOfAChannel) {
  const std::string fills =
      "[[fill]]\nphase = \"floor\"\nshape = { sides = [\"bottom\"] }\n[[fill]]\nphase = \"lid\"\nshape = { sides = "
      "[\"top\"] }\n";
  const auto run = small::simulation(channel("[phases.floor]\nkind = \"wall\"\n[phases.lid]\nkind = \"wall\"\n",
                                             "water-floor = {}\nwater-lid = {}\n", fills) +
                                     meter("floor", "floor"));
  const double exact = 0.8, found = mean_drag(*run, "floor_force_x [");
  report("shear on the floor/(rho F L/2) - 1", found / exact - 1.0, 0.012);
  EXPECT_NEAR(found / exact, 1.0, 0.012);
}

// What grains get beside their weight, walls of spheres and sides of the domain lose, in every step of the contacts.
TEST(ForceMeters, WallsGetTheMomentumThatGrainsLose) {
  std::string text = small::spheres;
  const auto forcing = text.find("[[forcing]]");
  text.erase(forcing, text.find("[time]") - forcing);
  const auto run = small::simulation(text);
  const auto momentum = [&](int d) { return value(*run, d == 0 ? "momentum_x [" : "momentum_y ["); };
  double mass = 0.0, worst = 0.0, scale = 0.0, on_base = 0.0, by_stones = 0.0;
  for (const PhaseParticles& p : run->phases())
    for (std::size_t k = 0; p.has(Field::contact_acceleration) && k < p.size(); ++k) mass += p.mass_of(k);
  const double begun[] = {momentum(0), momentum(1)};
  for (int step = 0; step < 400; ++step) {
    run->step(1.0);
    for (int d = 0; d < 2; ++d) {
      const std::string axis = d == 0 ? "x [" : "y [";
      const double base = value(*run, "base_impulse_" + axis), floor = value(*run, "floor_impulse_" + axis);
      const double weight = mass * (d == 0 ? 0.5 : -9.81) * run->time();
      scale = std::max(scale, std::abs(momentum(d) - begun[d]));
      worst = std::max(worst, std::abs(momentum(d) - begun[d] - weight + base + floor));
      on_base = std::max(on_base, std::abs(base));
    }
    by_stones = value(*run, "stones_on_floor_impulse_y [");
  }
  report("momentum of grains and walls, change", worst / scale, 1e-11);
  EXPECT_LT(worst / scale, 1e-11);
  EXPECT_GT(on_base / scale, 0.05) << "grains fall on the base";
  EXPECT_LE(std::abs(by_stones), std::abs(value(*run, "floor_impulse_y [")));
}

// A grain at rest: its weight, at the place where it touches.
TEST(ForceMeters, AGrainAtRestWeighs) {
  const auto run = small::simulation(R"toml(
spacing = 1e-3
[domain]
size = [0.04, 0.02]
gravity = [0, -9.81]
[phases.sand]
kind = "grains"
density = 2650
diameter = 1e-3
restitution = 0.3
[phases.floor]
kind = "wall"
[interactions]
sand-sand = { law = "linear" }
sand-floor = { law = "linear" }
[[fill]]
phase = "floor"
shape = { sides = ["bottom"] }
[[fill]]
phase = "sand"
shape = { points = [[0.03, 0.00055]] }
[time]
end = 0.1
largest-speed = 0.1
)toml" + meter("floor", "floor", "about = [0.01, 0.3]\n") +
                                     meter("by_sand", "floor", "by = \"sand\"\n"));
  while (run->time() < 0.1) {
    run->begin_row();
    run->step(0.1 - run->time());
  }
  const double weight = run->phases()[0].mass_of(0) * 9.81;
  const double force = value(*run, "floor_force_y ["), torque = value(*run, "floor_torque_z [");
  report("force on the floor over the weight - 1", force / -weight - 1.0, 1e-3);
  report("its torque over 2 cm times the weight - 1", torque / (-0.02 * weight) - 1.0, 1e-3);
  EXPECT_NEAR(force / -weight, 1.0, 1e-3);
  EXPECT_NEAR(torque / (-0.02 * weight), 1.0, 1e-3);
  EXPECT_EQ(force, value(*run, "by_sand_force_y ["));
}

// A body that falls freely feels nothing; one that is pushed feels its push, about any point.
TEST(ForceMeters, BodyThatIsPushed) {
  const std::string body = R"toml(
spacing = 0.1
[domain]
size = [10, 10]
gravity = [0, -10]
[phases.block]
kind = "elastic"
density = 1000
young = 1e6
[interactions]
block-block = 1.6
[[fill]]
phase = "block"
shape = { box = { min = [4, 4], max = [5, 6] } }
[[forcing]]
phase = "block"
acceleration = [3, 0]
[time]
end = 1
)toml" + meter("block", "block", "about = [4.5, 3]\n") +
                           meter("half", "block", "box = { min = [4, 4], max = [5, 5] }\n");
  const auto run = small::simulation(body);
  for (int step = 0; step < 5; ++step) {
    run->begin_row();
    run->step(1.0);
  }
  const double mass = 2000.0;
  EXPECT_NEAR(value(*run, "block_force_x ["), 3.0 * mass, 1e-6 * mass);
  EXPECT_NEAR(value(*run, "block_force_y ["), 0.0, 1e-6 * mass);
  const PhaseParticles& block = run->phases()[0];
  double lever = -3.0;
  for (std::size_t k = 0; k < block.size(); ++k)
    lever += block.column(Field::position, 1)[k] / static_cast<double>(block.size());
  EXPECT_NEAR(value(*run, "block_torque_z ["), -lever * 3.0 * mass, 1e-3 * mass);
  EXPECT_NEAR(value(*run, "half_force_x ["), 1.5 * mass, 0.01 * mass) << "the whole moves as one";
}

TEST(ForceMeters, WhatIsNotMeasuredIsRefused) {
  const auto refusal = [](const std::string& text) {
    try {
      parse_scene(text, "s.toml");
    } catch (const SceneError& error) { return std::string(error.what()); }
    return std::string();
  };
  EXPECT_NE(refusal(tank + meter("a", "water")).find("force.0.phase: \"water\" is neither wall nor body"),
            std::string::npos);
  EXPECT_NE(refusal(tank + meter("a", "flor")).find("there is no phase \"flor\""), std::string::npos);
  EXPECT_NE(refusal(tank + meter("a", "floor") + meter("a", "left")).find("force.1.name: \"a\" is given twice"),
            std::string::npos);
  EXPECT_NE(refusal(tank + meter("a b", "floor")).find("expected letters, digits and underscores"), std::string::npos);
  EXPECT_NE(refusal(small::dune + meter("a", "floor")).find("on a wall is not measured"), std::string::npos);
  EXPECT_NE(refusal(small::spheres + meter("a", "floor", "box = { min = [0, 0], max = [1, 1] }\n"))
                .find("force.3.phase: the force of \"stones\" on a part of a wall is not measured"),
            std::string::npos);
  EXPECT_NE(refusal(small::spheres + meter("a", "base", "by = \"floor\"\n"))
                .find("force.3.by: \"floor\" and \"base\" have no entry in [interactions]"),
            std::string::npos);
  std::string sleepy = small::spheres;
  sleepy.insert(sleepy.find("density = 2650"), "sleep = true\n");
  EXPECT_NE(refusal(sleepy).find("the force of \"sand\" on a wall is not measured where grains sleep"),
            std::string::npos);
  EXPECT_EQ(refusal(tank + meter("a", "floor")), "");
}

// A zone brings a stream to its velocity as its rate says.
TEST(Zones, BringAFluidToAVelocity) {
  const std::string stream = R"toml(
spacing = 0.1
[domain]
size = [1, 1]
periodic = ["x", "y"]
[phases.water]
kind = "fluid"
density = 1
sound-speed = 20
[interactions]
water-water = {}
[[fill]]
phase = "water"
shape = "the-rest"
velocity = [1, 0]
[[forcing]]
phase = "water"
velocity = [0, "0.5"]
rate = 2
[time]
end = 1
largest-speed = 1
)toml";
  const auto run = small::simulation(stream);
  while (run->time() < 0.5 * (1 - 1e-12)) run->step(0.5 - run->time());
  const PhaseParticles& water = run->phases()[0];
  for (std::size_t k = 0; k < water.size(); ++k) {
    EXPECT_NEAR(water.column(Field::velocity, 0)[k], std::exp(-1.0), 0.01);
    EXPECT_NEAR(water.column(Field::velocity, 1)[k], 0.5 * (1.0 - std::exp(-1.0)), 0.01);
  }
  // Where its box ends, so does the zone: a fluid that moves across it is reached in part.
  std::string boxed = stream;
  boxed.replace(boxed.find("rate = 2"), 8, "rate = 2\nbox = { min = [0, 0], max = [1, 0.5] }");
  const auto part = small::simulation(boxed);
  for (int step = 0; step < 5; ++step) part->step(1.0);
  double below = 0.0, above = 0.0;
  for (std::size_t k = 0; k < 100; ++k) {
    const PhaseParticles& p = part->phases()[0];
    const double y = p.column(Field::position, 1)[k], lost = 1.0 - p.column(Field::velocity, 0)[k];
    if (y < 0.3) below += lost;
    if (y > 0.7) above += lost;
  }
  EXPECT_GT(below, 0.5);
  EXPECT_LT(std::abs(above), 0.02 * below);
}

}  // namespace
}  // namespace barchan
