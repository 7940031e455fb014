// Rigid bodies in fluids: momentum, energy, buoyancy, added mass, the torque of a turning cylinder.
#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <numbers>

#include "physics/drive.hpp"
#include "physics/small_scenes.hpp"

namespace barchan::of_rigid_in_fluid {
namespace {

using std::numbers::pi;
using testing::Drive;
using testing::mean_of;
using testing::report;
using testing::run_to;
using testing::value;

/// Momentum of all that moves, the bodies with the mass of their shapes; and mass times speed.
std::pair<Vec3, double> momentum(Simulation& run) {
  Vec3 sum{};
  double size = 0.0;
  for (int d = 0; d < run.phases().front().dimensions(); ++d)
    sum[static_cast<std::size_t>(d)] = value(run, std::string("momentum_") + "xyz"[d]);
  for (const PhaseParticles& p : run.phases())
    for (std::size_t k = 0; k < p.size(); ++k) {
      double square = 0.0;
      for (int d = 0; d < p.dimensions(); ++d)
        square += p.column(Field::velocity, d)[k] * p.column(Field::velocity, d)[k];
      size += p.mass() * std::sqrt(square);
    }
  return {sum, size};
}

double momentum_drift(const std::string& text, int steps) {
  const auto run = small::simulation(text);
  const Vec3 start = momentum(*run).first;
  double worst = 0.0;
  for (int k = 0; k < steps; ++k) {
    run->step(1.0);
    const auto [now, size] = momentum(*run);
    worst = std::max(worst, norm(now - start) / size);
  }
  return worst;
}

TEST(RigidInFluid, TakesWhatTheFluidLoses) {
  const double flat = momentum_drift(small::drowned, 200), solid = momentum_drift(small::drowned_ball, 50);
  report("momentum over mass times speed, 2D", flat, 1e-12);
  report("the same, 3D", solid, 1e-12);
  EXPECT_LT(flat, 1e-12);
  EXPECT_LT(solid, 1e-12);
  const auto run = small::simulation(small::drowned_ball);
  const double before = value(*run, "ball_velocity_x");
  for (int k = 0; k < 50; ++k) run->step(1.0);
  EXPECT_LT(value(*run, "ball_velocity_x"), 0.95 * before) << "the water holds it back";
  EXPECT_GT(value(*run, "ball_velocity_x"), 0.3 * before);
}

/// What is left of the energy over what became heat: kinetic energy, heat, what contacts took, and the work of what is
/// driven.
double energy_drift(const std::string& text, int steps, const std::vector<std::string>& moving,
                    const std::vector<std::string>& driven, const std::vector<std::string>& overrides = {}) {
  const auto run = small::simulation(text, overrides);
  const auto sum = [&](const std::vector<std::string>& names, const std::string& of) {
    double total = 0.0;
    for (const std::string& name : names) total += value(*run, name + of);
    return total;
  };
  const auto energy = [&] {
    const bool contacts = text.find("ball-block") != std::string::npos;
    return sum(moving, "_kinetic_energy") + value(*run, "water_internal_energy") + sum(driven, "_work") +
           (contacts ? value(*run, "ball_block_taken_energy") : 0.0);
  };
  const double start = energy(), heat = value(*run, "water_internal_energy");
  double worst = 0.0;
  for (int k = 0; k < steps; ++k) {
    run->step(1.0);
    worst = std::max(worst, std::abs(energy() - start));
  }
  return worst / std::abs(value(*run, "water_internal_energy") - heat);
}

/// The rest is of the second order in the step: 1/4 with half of it.
void expect_energy(const char* what, const std::string& text, int steps, const std::vector<std::string>& moving,
                   const std::vector<std::string>& driven, double safety = 1.0) {
  const auto drift = [&](int halvings) {
    return energy_drift(text, steps << halvings, moving, driven,
                        {"time.safety=" + std::to_string(safety / (1 << halvings))});
  };
  const double rest = drift(0), finer = drift(1);
  report(std::string("energy left over the heat, ") + what, rest, 5e-3);
  report("the same with half the step", finer, 1e-3);
  EXPECT_LT(rest, 5e-3) << what;
  EXPECT_LT(finer, 1e-3) << what;
  EXPECT_LT(finer, 0.4 * rest) << what;
}

TEST(RigidInFluid, WhatLeavesTheMotionIsHeat) {
  expect_energy("free bodies", small::drowned, 200, {"water", "ball", "block"}, {});
  const std::string motion = "\n[[motion]]\nphase = \"block\"\nabout = [0.9, 0.4]\nangular-velocity = \"20*t\"\n";
  expect_energy("one is driven and touches another", small::drowned + motion, 200, {"water", "ball"}, {"block"});
  // The ball starts at once in water at rest, as from a blow: with a safety of 1 0.006 to 0.009 are left of the first
  // steps, by where its rows lie. (0.003 where water stood inside of the ball, as it did before.)
  expect_energy("3D", small::drowned_ball, 100, {"water", "ball"}, {}, 0.5);
}

TEST(RigidInFluid, ATurningCylinderFeelsTheTorqueOfCouetteFlow) {
  Drive drive("verification/taylor_couette", {"spacing=0.0666666666666667"});
  const double exact = 4.0 * pi * 4.0 / 3.0;
  const double inner = std::abs(mean_of(drive.simulation(), "cylinder_torque", 0.9, 1.0) / -exact - 1.0);
  const double outer = std::abs(value(drive.simulation(), "shell_torque") / exact - 1.0);
  report("torque on the cylinder", inner, 0.02);
  report("torque on the shell", outer, 0.02);
  EXPECT_LT(inner, 0.02);
  EXPECT_LT(outer, 0.02);
}

constexpr double displaced = pi * 0.4 * 0.4;  // kg/m, of the liquid

TEST(RigidInFluid, AHeldBodyFeelsTheWeightOfWhatItDisplaces) {
  std::ifstream file(testing::scene_file("verification/sinking_disc"));
  const std::string text(std::istreambuf_iterator<char>(file), {});
  const auto run = small::simulation(text + "\n[[motion]]\nphase = \"disc\"\n");
  const double lift = mean_of(*run, "disc_force_y", 0.05, 0.4);
  const double error = std::abs(lift / displaced - 1.0);
  report("lift over the weight of the liquid displaced", error, 0.02);
  EXPECT_LT(error, 0.02);
  EXPECT_LT(std::abs(value(*run, "disc_torque")), 1e-3 * displaced * 0.4);
}

TEST(RigidInFluid, ABodyOfTheFluidsDensityStays) {
  Drive drive("verification/sinking_disc", {"phases.disc.density=1", "phases.water.viscosity=1e-3"});
  const double start = value(drive.simulation(), "disc_y");
  drive.to(0.4);
  const double way = std::abs(value(drive.simulation(), "disc_y") - start), falls = 0.5 * 0.4 * 0.4;
  report("way over that of a free fall", way / falls, 0.01);
  EXPECT_LT(way / falls, 0.01);
  EXPECT_GT(way, 0.0) << "it is not held";
}

TEST(RigidInFluid, AHeavyBodyStartsWithItsAddedMass) {
  Drive drive("verification/sinking_disc");
  const double start = value(drive.simulation(), "disc_y"), time = 0.4, added = (1.0 + 0.16) / (1.0 - 0.16);
  drive.to(time);
  const double found = 2.0 * (start - value(drive.simulation(), "disc_y")) / (time * time), exact = 1.0 / (2.0 + added);
  report("acceleration over that with the added mass", std::abs(found / exact - 1.0), 0.06);
  EXPECT_NEAR(found, exact, 0.06 * exact);
}

/// The body and the fluid turn as one: nothing rubs.
TEST(RigidInFluid, ABodyThatTurnsWithTheFluidFeelsNoTorque) {
  Drive drive("verification/taylor_couette",
              {"motion.1.angular-velocity=1", "fill.2.velocity=[\"-y\", \"x\"]", "spacing=0.1"});
  const double exact = 4.0 * pi * 4.0 / 3.0;
  const double torque = std::abs(mean_of(drive.simulation(), "cylinder_torque", 0.1, 0.3)) / exact;
  report("torque over that of a shell at rest", torque, 0.01);
  EXPECT_LT(torque, 0.01);
}

}  // namespace
}  // namespace barchan::of_rigid_in_fluid
