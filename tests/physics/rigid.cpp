// Rigid bodies: the free top, the pendulum, what rolls, what collides, what turns about a place.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/errors.hpp"
#include "physics/drive.hpp"

namespace barchan {
namespace {

using std::numbers::pi;
using testing::Drive;
using testing::report;

/// A scene from its text, in progress.
class RunContext {
 public:
  explicit RunContext(const std::string& text) : scene_(parse_scene(text, "rigid.toml")) {
    const auto blocks = generate(scene_);
    simulation_ = std::make_unique<Simulation>(scene_, make_plan(scene_, blocks), blocks);
  }
  void to(double time) {
    while (simulation_->time() < time * (1.0 - 1e-12)) simulation_->step(time - simulation_->time());
  }
  double operator[](const std::string& column) const { return value(*simulation_, column); }
  Simulation& simulation() { return *simulation_; }

  static double value(const Simulation& s, const std::string& column) {
    const auto columns = s.history_columns();
    const auto found =
        std::find_if(columns.begin(), columns.end(), [&](const std::string& name) { return name.starts_with(column); });
    if (found == columns.end()) throw std::logic_error("no column " + column);
    return s.history_row()[static_cast<std::size_t>(found - columns.begin())];
  }

 private:
  Scene scene_;
  std::unique_ptr<Simulation> simulation_;
};

double column(Drive& drive, const std::string& name) { return RunContext::value(drive.simulation(), name); }

TEST(RigidBodies, AFreeTopKeepsEnergyAndAngularMomentumFor100Turns) {
  Drive drive("verification/free_top");
  const auto momentum = [&] {
    return Vec3{column(drive, "top_angular_momentum_x"), column(drive, "top_angular_momentum_y"),
                column(drive, "top_angular_momentum_z")};
  };
  const double energy = column(drive, "top_kinetic_energy");
  const Vec3 start = momentum();
  double worst = 0.0, drift = 0.0, least = 1e300;
  for (int k = 1; k <= 100; ++k) {
    drive.to(0.6283 * k);
    worst = std::max(worst, std::abs(column(drive, "top_kinetic_energy") / energy - 1.0));
    drift = std::max(drift, norm(momentum() - start) / norm(start));
    least = std::min(least, column(drive, "top_angular_velocity_y"));
  }
  report("energy of the particles", worst, 1e-6);
  report("angular momentum", drift, 1e-6);
  EXPECT_LT(worst, 1e-6);
  EXPECT_LT(drift, 1e-6);
  EXPECT_GT(worst, 0.0) << "it moves";
}

TEST(RigidBodies, ABarThatSwingsHasThePeriodOfThePhysicalPendulum) {
  Drive drive("verification/compound_pendulum");
  const double length = 0.5, height = 0.02;
  const double exact = 4.0 * std::sqrt((length * length / 3.0 + height * height / 12.0) / (9.81 * 0.5 * length)) *
                       std::comp_ellint_1(std::sin(pi / 4.0));
  std::vector<double> crossings;  // of the lowest place, swinging to either side
  double before = column(drive, "bar_angle") + pi / 2.0, at = 0.0;
  while (crossings.size() < 5) {
    drive.simulation().step(1e300);
    const double now = column(drive, "bar_angle") + pi / 2.0, time = drive.simulation().time();
    if (before * now < 0.0) crossings.push_back(at + (time - at) * before / (before - now));
    before = now;
    at = time;
  }
  const double period = crossings[4] - crossings[2], error = std::abs(period / exact - 1.0);
  report("period over the elliptic integral's", error, 1e-3);
  EXPECT_LT(error, 1e-3);
  EXPECT_NEAR(crossings[2] - crossings[0], period, 1e-5 * period) << "the next swing takes as long";
}

TEST(RigidBodies, ABarHasItsPeriodAtAnySpacing) {
  for (const char* spacing : {"spacing=0.013", "spacing=0.016", "spacing=0.0199"}) {
    Drive drive("verification/compound_pendulum", {spacing, "time.end=0.4"});
    drive.to(0.3);
    const double angle = column(drive, "bar_angle");
    const double drop = -0.25 * std::sin(angle), moment = 0.25 / 3.0 + 0.0004 / 12.0;
    EXPECT_NEAR(std::pow(column(drive, "bar_angular_velocity"), 2), 2.0 * 9.81 * drop / moment, 1e-3 * 40.0) << spacing;
  }
}

/// Its rows of particles have 1.03 of the mass of the shape, and their mean stands beside its centre.
TEST(RigidBodies, AForcingAcceleratesTheMassOfTheShape) {
  RunContext context(
      "spacing = 0.016\n[domain]\nsize = [2, 1]\n[phases.a]\nkind = \"rigid\"\ndensity = "
      "1000\n[interactions]\n[[fill]]\n"
      "phase = \"a\"\nshape = { polygon = [[0.103, 0.2], [0.221, 0.2], [0.103, 0.33]] }\n[[forcing]]\nphase = \"a\"\n"
      "acceleration = [3, 1]\n[time]\nend = 1\nlargest-speed = 3\n");
  const double mass = 0.5 * 0.118 * 0.13 * 1000;
  context.to(0.1);
  EXPECT_NEAR(context["a_velocity_x"], 0.3, 1e-12);
  EXPECT_NEAR(context["a_velocity_y"], 0.1, 1e-12);
  EXPECT_NEAR(context["a_angular_velocity"], 0.0, 1e-10);
  EXPECT_NEAR(context["momentum_x"], 0.3 * mass, 1e-9 * mass);
  EXPECT_NEAR(context["a_kinetic_energy"], 0.5 * mass * 0.1, 1e-9 * mass);
  EXPECT_NEAR(context["a_work"], 0.5 * mass * 0.1, 1e-9 * mass);
}

/// Of the way from the start to a time.
double acceleration(const std::string& scene, double end) {
  Drive drive(scene);
  const double start = column(drive, "ball_x [m]");
  drive.to(end);
  return 2.0 * (column(drive, "ball_x [m]") - start) / (end * end);
}

TEST(RigidBodies, WhatRollsHasTheAnalyticAcceleration) {
  const double pull = 9.81 * std::sin(pi / 12.0);
  const double disc = std::abs(acceleration("verification/rolling_disc", 0.3) / (pull * 2.0 / 3.0) - 1.0);
  const double sphere = std::abs(acceleration("verification/rolling_sphere", 0.3) / (pull * 5.0 / 7.0) - 1.0);
  report("disc", disc, 5e-3);
  report("sphere", sphere, 5e-3);
  EXPECT_LT(disc, 5e-3);
  EXPECT_LT(sphere, 5e-3);
}

std::string number(double x) {
  char text[32];
  std::snprintf(text, sizeof text, "%.9g", x);
  return text;
}

/// Two bodies in the plane; the first comes with 1 m/s along x.
std::string meeting(const std::string& first, const std::string& second, double e, const std::string& more = "") {
  return "spacing = 0.02\n[domain]\nsize = [4, 2]\n[phases.a]\nkind = \"rigid\"\ndensity = 1000\nlargest-overlap = "
         "0.2\n[phases.b]\nkind = "
         "\"rigid\"\ndensity = 300\n[interactions]\na-b = { restitution = " +
         number(e) + more + " }\n[[fill]]\nphase = \"a\"\nshape = { " + first +
         " }\nvelocity = [1, 0]\n[[fill]]\nphase = \"b\"\nshape = { " + second + " }\n[time]\nend = 1\n";
}

const std::string disc = "disc = { centre = [1, 1], radius = 0.3 }";
const std::string block = "box = { min = [1.35, 0.7], max = [1.75, 1.3] }";

TEST(RigidBodies, KeepTheWrittenShareOfTheirSpeedWhateverTheirMasses) {
  double worst = 0.0;
  for (const double e : {0.05, 0.3, 0.6, 0.9, 1.0})
    for (const std::string& second : {block, std::string("disc = { centre = [1.65, 1], radius = 0.3 }")})
      for (const std::string& first : {disc, std::string("box = { min = [0.7, 0.8], max = [1.3, 1.2] }")}) {
        RunContext context(meeting(first, second, e));
        const double momentum = context["momentum_x"];
        context.to(0.2);
        const double parting = context["b_velocity_x"] - context["a_velocity_x"];
        worst = std::max(worst, std::abs(parting - e));
        EXPECT_NEAR(context["momentum_x"], momentum, 1e-12 * momentum);
        EXPECT_EQ(context["a_b_overlap"], 0.0) << "they have parted";
        EXPECT_NEAR(context["a_angular_velocity"], 0.0, 1e-6);
      }
  report("restitution of bodies", worst, 0.01);
  EXPECT_LT(worst, 0.01);
}

/// Off the centre the bodies turn; momentum, angular momentum and, with e = 1, energy are kept.
TEST(RigidBodies, AnObliqueCollisionKeepsMomentumAngularMomentumAndEnergy) {
  for (const std::string friction : {"", ", friction = 0.4"}) {
    RunContext context(meeting(disc, "polygon = [[1.35, 0.9], [1.8, 1.1], [1.5, 1.6]]", 1.0, friction));
    const auto turning = [&] {
      double total = 0.0;
      for (const std::string b : {"a", "b"})
        total +=
            context[b + "_angular_momentum"] +
            (context[b + "_x [m]"] * context[b + "_velocity_y"] - context[b + "_y [m]"] * context[b + "_velocity_x"]) *
                context.simulation().plan().phases[b == "a" ? 0 : 1].rigid_bodies[0].mass;
      return total;
    };
    const double momentum = context["momentum_x"], angular = turning(),
                 energy = context["a_kinetic_energy"] + context["b_kinetic_energy"];
    context.to(0.3);
    EXPECT_GT(std::abs(context["b_angular_velocity"]), 0.1) << "it was hit off its centre";
    EXPECT_NEAR(context["momentum_x"], momentum, 1e-12 * momentum);
    EXPECT_NEAR(context["momentum_y"], 0.0, 1e-12 * momentum);
    EXPECT_NEAR(turning(), angular, 1e-9 * momentum);
    const double left = (context["a_kinetic_energy"] + context["b_kinetic_energy"]) / energy;
    if (friction.empty()) EXPECT_NEAR(left, 1.0, 1e-3);
    else EXPECT_LT(left, 1.0 - 1e-4) << "friction takes energy";
  }
}

TEST(RigidBodies, FeelNothingAcrossAGap) {
  RunContext context(meeting(disc, "box = { min = [1.302, 0.7], max = [1.7, 1.3] }", 0.5));  // a tenth of a spacing
  context.to(0.0015);
  EXPECT_EQ(context["b_force_x"], 0.0);
  EXPECT_EQ(context["b_velocity_x"], 0.0);
  context.to(0.004);
  EXPECT_GT(context["b_velocity_x"], 0.0) << "then they touch";
}

TEST(RigidBodies, StrikeElasticOnesWithTheSameMomentum) {
  RunContext context(
      "spacing = 0.02\nprecision = \"double\"\n[domain]\nsize = [2, 1]\n[phases.a]\nkind = \"rigid\"\ndensity = "
      "2000\n[phases.b]\nkind = "
      "\"elastic\"\ndensity = 1000\nyoung = 1e7\npoisson = 0.3\n[interactions]\nb-b = {}\na-b = { restitution = 1 }\n"
      "[[fill]]\nphase = \"a\"\nshape = { box = { min = [0.4, 0.4], max = [0.6, 0.6] } }\nvelocity = [2, 0]\n"
      "[[fill]]\nphase = \"b\"\nshape = { box = { min = [0.6, 0.4], max = [0.8, 0.6] } }\n[time]\nend = 1\n");
  const double momentum = context["momentum_x"];
  context.to(0.02);
  EXPECT_NEAR(context["momentum_x"], momentum, 1e-12 * momentum);
  EXPECT_GT(context["b_mean_vx"], 2.0) << "the heavy one drives the light one off";
  EXPECT_LT(context["a_velocity_x"], 1.2);
  EXPECT_GT(context["a_velocity_x"], 0.5);
}

std::string wheel(const std::string& motion) {
  return "spacing = 0.02\n[domain]\nsize = [2, 2]\n[phases.a]\nkind = \"rigid\"\ndensity = 1000\n[interactions]\n"
         "[[fill]]\nphase = \"a\"\nshape = { disc = { centre = [1, 1], radius = 0.5 } }\nangular-velocity = 2\n"
         "[[motion]]\nphase = \"a\"\n" +
         motion + "\n[time]\nend = 4\nstep = 1e-3\nlargest-speed = 5\n";
}

TEST(RigidBodies, AWheelFollowsItsTorqueItsFrictionAndItsDrive) {
  const RunContext at_start(wheel("about = [1, 1]"));
  const double inertia = at_start["a_angular_momentum"] / at_start["a_angular_velocity"];
  RunContext driven(wheel("about = [1, 1]\ntorque = " + number(0.5 * inertia)));
  driven.to(2.0);
  EXPECT_NEAR(driven["a_angular_velocity"], 3.0, 1e-9);
  EXPECT_NEAR(driven["a_angle"], 2.0 * 2.0 + 0.25 * 4.0, 1e-9);
  RunContext slowed(wheel("about = [1, 1]\nfriction = " + number(inertia)));  // it stops at 2 s
  slowed.to(1.0);
  EXPECT_NEAR(slowed["a_angular_velocity"], 1.0, 1e-9);
  slowed.to(3.0);
  EXPECT_NEAR(slowed["a_angular_velocity"], 0.0, 1e-12);
  RunContext held(wheel("about = [1, 1]\nfriction = " + number(inertia) + "\ntorque = " + number(0.5 * inertia)));
  held.to(4.0);
  held.to(4.0 + 0.5);
  EXPECT_NEAR(held["a_angular_velocity"], 0.0, 1e-9) << "friction holds half of what it can";
  RunContext turned(wheel("about = [1, 1.25]\nangular-velocity = \"2*t\"\nvelocity = [0.1, 0]"));
  turned.to(1.0);
  EXPECT_NEAR(turned["a_angle"], 1.0, 1e-6);
  EXPECT_NEAR(turned["a_x [m]"], 1.1 + 0.25 * std::sin(1.0), 1e-6);
  EXPECT_NEAR(turned["a_y [m]"], 1.25 - 0.25 * std::cos(1.0), 1e-6);
}

/// Bodies of one phase, a fill each, touch by the entry of the phase with itself.
TEST(RigidBodies, OfOnePhaseHandOnTheirMomentum) {
  std::string text =
      "spacing = 0.02\n[domain]\nsize = [4, 1]\n[phases.a]\nkind = \"rigid\"\ndensity = 1000\nlargest-overlap = 0.1\n"
      "[interactions]\na-a = { restitution = 1 }\n";
  for (const char* x : {"0.5", "1.0", "1.5"})
    text += "[[fill]]\nphase = \"a\"\nshape = { disc = { centre = [" + std::string(x) + ", 0.5], radius = 0.2 } }\n" +
            (std::string(x) == "0.5" ? "velocity = [1, 0]\n" : "");
  RunContext context(text + "[time]\nend = 1\n");
  context.to(0.4);
  EXPECT_NEAR(context["a_1_velocity_x"], 0.0, 1e-3);
  EXPECT_NEAR(context["a_2_velocity_x"], 0.0, 1e-3);
  EXPECT_NEAR(context["a_3_velocity_x"], 1.0, 1e-3);
}

/// A body on a periodic axis comes out on the other side and strikes what stands there.
TEST(RigidBodies, GoRoundAPeriodicDomain) {
  std::string text = meeting(disc, "disc = { centre = [0.5, 1], radius = 0.15 }", 1.0);
  text.replace(text.find("size = [4, 2]"), 13, "size = [4, 2]\nperiodic = [\"x\"]");
  RunContext context(text);
  context.to(2.9);  // from 1 m to 3.9 m: they touch when it stands at 4.05 m
  EXPECT_EQ(context["b_velocity_x"], 0.0);
  EXPECT_NEAR(context["a_x [m]"], 3.9, 1e-9);
  context.to(3.2);
  EXPECT_GT(context["b_velocity_x"], 1.0);
}

}  // namespace
}  // namespace barchan
