// Contacts of rigid bodies by their outlines against a naive twin: all pairs of discs and all of their images, the law
// of laws/surface_contact.hpp at the one place where two discs touch.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "checks/reader.hpp"
#include "laws/surface_contact.hpp"
#include "models/bodies/rigid_contact.hpp"
#include "plan/plan.hpp"
#include "simulation/simulation.hpp"
#include "start/generate.hpp"
#include "unit/particle_sets.hpp"

namespace barchan::rigid_contact_test {
namespace {

constexpr double radius = 0.2, restitution_of_discs = 0.6, friction_of_discs = 0.3;  // m

std::string text_of_number(double x) {
  char text[32];
  std::snprintf(text, sizeof text, "%.9g", x);
  return text;
}

/// Rigid bodies in a box of 2 m: what a scene adds to it.
std::string bodies_in_a_box(const std::string& more, const std::string& interactions, const std::string& fills) {
  return "spacing = 0.04\n[domain]\nsize = [2, 2]\n" + more +
         "[phases.a]\nkind = \"rigid\"\ndensity = 1000\nlargest-overlap = 0.2\n[interactions]\n" + interactions +
         fills + "[time]\nend = 1\nlargest-speed = 3\n";
}

struct ContactRun {
  Scene scene;
  std::unique_ptr<Simulation> simulation;
  explicit ContactRun(const std::string& text) : scene(parse_scene(text, "contact.toml")) {
    const auto blocks = generate(scene);
    simulation = std::make_unique<Simulation>(scene, make_plan(scene, blocks), blocks);
  }
  double history(const std::string& column) const {
    const auto names = simulation->history_columns();
    for (std::size_t k = 0; k < names.size(); ++k)
      if (names[k].starts_with(column)) return simulation->history_row()[k];
    ADD_FAILURE() << "no column " << column;
    return 0.0;
  }
};

struct Load {
  Vec3 force{};         // N
  double torque = 0.0;  // N m, about the body's place
};

/// Velocity and rate as the contacts saw them: the kick that ended the step is taken back.
struct Motion {
  Vec3 velocity{};
  double rate = 0.0;
  Motion(const RigidBody& b, double dt)
      : velocity(b.now.velocity - 0.5 * dt / b.mass * b.now.force),
        rate(own_angular_velocity(b)[2] - 0.5 * dt * b.now.torque[2] / b.inertia[2]) {}
};

Vec3 across(const Vec3& x) { return {-x[1], x[0], 0.0}; }  // z x r
double moment(const Vec3& arm, const Vec3& force) { return arm[0] * force[1] - arm[1] * force[0]; }

/// The naive twin. `deepest` (m): the deepest overlap; `beyond`: counts the contacts of bodies that stand farther from
/// each other than half a period.
std::vector<Load> naive(const ContactRun& run, double period, double& deepest, std::size_t& beyond) {
  const auto& bodies = run.simulation->state().bodies;
  const double dt = run.simulation->state().dt;
  const SurfaceContactLaw law{contact_stiffness(run.scene, run.simulation->plan(), 0), restitution_of_discs,
                              friction_of_discs};
  std::vector<Load> loads(bodies.size());
  deepest = 0.0;
  for (std::size_t i = 0; i < bodies.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      for (int image = -3; image <= 3; ++image) {
        if (period == 0.0 && image != 0) continue;
        const RigidBody &a = bodies[i], &b = bodies[j];
        const Vec3 r = a.now.place - b.now.place + Vec3{image * period, 0.0, 0.0};
        const double overlap = 2.0 * radius - norm(r);
        if (overlap <= 0.0) continue;
        deepest = std::max(deepest, overlap);
        beyond += image != 0;
        const Vec3 n = 1.0 / norm(r) * r, arm_a = -(radius - 0.5 * overlap) * n, arm_b = r + arm_a;
        const Motion of_a(a, dt), of_b(b, dt);
        const Vec3 v = of_a.velocity + of_a.rate * across(arm_a) - of_b.velocity - of_b.rate * across(arm_b);
        const auto inverse = [&](const Vec3& d) {
          return 1.0 / a.mass + 1.0 / b.mass + std::pow(moment(arm_a, d), 2) / a.inertia[2] +
                 std::pow(moment(arm_b, d), 2) / b.inertia[2];
        };
        const double speed = dot(v, n), push = law.push(overlap, speed, inverse(n), dt);
        const Vec3 along = v - speed * n;
        const double sliding = norm(along);
        const Vec3 force =
            push * n - (sliding > 0.0 ? law.grip(push, sliding, inverse(1.0 / sliding * along), dt) : 0.0) * along;
        loads[i].force = loads[i].force + force;
        loads[j].force = loads[j].force - force;
        loads[i].torque += moment(arm_a, force);
        loads[j].torque -= moment(arm_b, force);
      }
  return loads;
}

/// Discs on a lattice, perturbed or not, that run into each other; all of their contacts in many steps.
void compare_discs(bool periodic, double perturb, Vec3 drift) {
  sets::Uniform random(41);
  std::string fills;
  const double first = periodic ? 0.25 : 0.3, apart = periodic ? 0.5 : 0.45;  // m; across the side as far as elsewhere
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 3; ++j) {
      const double x = first + apart * i + perturb * random(-1, 1), y = 0.4 + 0.45 * j + perturb * random(-1, 1);
      const double outwards = !periodic ? 0.0 : i == 0 ? -3.0 : i == 3 ? 3.0 : 0.0;  // m/s: towards the side
      fills += "[[fill]]\nphase = \"a\"\nshape = { disc = { centre = [" + text_of_number(x) + ", " + text_of_number(y) +
               "], radius = 0.2 } }\nvelocity = [" + text_of_number(random(-1, 1) + drift[0] + outwards) + ", " +
               text_of_number(random(-1, 1) + drift[1]) + "]\nangular-velocity = " + text_of_number(random(-3, 3)) +
               "\n";
    }
  ContactRun run(
      bodies_in_a_box(periodic ? "periodic = [\"x\"]\n" : "", "a-a = { restitution = 0.6, friction = 0.3 }\n", fills));
  std::size_t touching = 0, turned = 0, beyond = 0;
  for (int step = 0; step < (periodic ? 1200 : 400); ++step) {
    run.simulation->step(1.0);
    double deepest = 0.0;
    const auto loads = naive(run, periodic ? 2.0 : 0.0, deepest, beyond);
    const auto& bodies = run.simulation->state().bodies;
    double scale = 1e-300;
    for (const Load& load : loads) scale = std::max(scale, norm(load.force));
    for (std::size_t k = 0; k < bodies.size(); ++k) {
      ASSERT_LT(norm(bodies[k].now.touch_force - loads[k].force), 1e-9 * scale) << "step " << step << ", body " << k;
      ASSERT_NEAR(bodies[k].now.touch_torque[2], loads[k].torque, 1e-9 * scale * radius) << "step " << step;
      touching += norm(loads[k].force) > 0.0;
      turned += std::abs(loads[k].torque) > 1e-3 * scale * radius;
    }
    ASSERT_NEAR(run.history("a_a_overlap"), deepest, 1e-12 + 1e-9 * deepest);
  }
  EXPECT_GT(touching, 200u);
  EXPECT_GT(turned, 100u) << "friction turns them";
  if (periodic) { EXPECT_GT(beyond, 50u) << "contacts across the side"; }
}

TEST(RigidContact, DiscsPushAsTheNaiveTwinSays) { compare_discs(false, 0.0, {0.0, 0.0, 0.0}); }
TEST(RigidContact, PerturbedDiscsPushAsTheNaiveTwinSays) { compare_discs(false, 0.02, {0.0, 0.0, 0.0}); }
TEST(RigidContact, DiscsPushAcrossAPeriodicSide) { compare_discs(true, 0.02, {20.0, 0.0, 0.0}); }

/// A block that comes straight down touches the floor with two corners, half its width left and right of its middle:
/// 1/m_n = 1/m + (w/2)^2/I of each.
TEST(RigidContact, ABlockTouchesTheFloorWithTwoCorners) {
  ContactRun run(
      bodies_in_a_box("", "a-floor = { restitution = 0.5 }\n[phases.floor]\nkind = \"wall\"\n",
                      "[[fill]]\nphase = \"a\"\nshape = { box = { min = [0.8, 0.01], max = [1.2, 0.21] } }\n"
                      "velocity = [0, -1]\n[[fill]]\nphase = \"floor\"\nshape = { sides = [\"bottom\"] }\n"));
  std::size_t touching = 0;
  double mass = 0.0;
  for (int step = 0; step < 400 && run.history("a_velocity_y") < 0.49; ++step) {
    run.simulation->step(1.0);
    const RigidBody& block = run.simulation->state().bodies[0];
    mass = block.mass;
    // As deep as its place has come down since the gap of 0.01 m was gone.
    const double overlap = block.first_place[1] - 0.01 - block.now.place[1], dt = run.simulation->state().dt;
    const SurfaceContactLaw law{contact_stiffness(run.scene, run.simulation->plan(), 0), 0.5, 0.0};
    const double speed = Motion(block, dt).velocity[1];
    const double force =
        overlap > 0.0 ? 2.0 * law.push(overlap, speed, 1.0 / mass + 0.2 * 0.2 / block.inertia[2], dt) : 0.0;
    ASSERT_NEAR(block.now.touch_force[1], force, 1e-8 * (1.0 + force)) << "step " << step;
    ASSERT_NEAR(block.now.touch_torque[2], 0.0, 1e-9 * (1.0 + force));
    ASSERT_EQ(block.now.touch_force[0], 0.0);
    touching += force > 0.0;
  }
  EXPECT_GT(touching, 5u);
  EXPECT_NEAR(run.history("a_velocity_y"), 0.5, 0.01) << "the written share of its speed";
  // What the contact took is what the motion lost: 1/2 m (1 - e^2).
  EXPECT_NEAR(run.history("a_floor_taken_energy") / (0.5 * mass), 1.0 - std::pow(run.history("a_velocity_y"), 2), 1e-4);
}

/// A square of 0.2 m over the floor of a tank, with its bottom at a height (m); `water`: entries with one, or none.
ContactRun over_a_floor(double height, const std::string& water) {
  return ContactRun(bodies_in_a_box(
      "gravity = [0, -1]\n[phases.water]\nkind = \"fluid\"\ndensity = 1\nviscosity = 1\n",
      "water-water = {}\na-floor = { restitution = 0.5 }\n" + water + "[phases.floor]\nkind = \"wall\"\n",
      "[[fill]]\nphase = \"a\"\nshape = { box = { min = [0.8, " + text_of_number(height) + "], max = [1, " +
          text_of_number(height + 0.2) +
          "] } }\n[[fill]]\nphase = \"floor\"\nshape = { sides = [\"bottom\"] }\n[[fill]]\n"
          "phase = \"water\"\nshape = { box = { min = [1.6, 1.6], max = [1.8, 1.8] } }\n"));
}

/// m, of the square's bottom where the floor first pushes.
double height_of_the_first_push(ContactRun run) {
  for (int step = 0; step < 20000; ++step) {
    const double height = run.simulation->state().bodies[0].now.place[1] - 0.1;
    run.simulation->step(1.0);
    if (run.simulation->state().bodies[0].now.touch_force[1] > 0.0) return height;
  }
  return -1.0;
}

/// Where a fluid is between, a contact begins a spacing of it before the outlines meet, or as far as they have been
/// apart. A fluid that only one of both feels is not between.
TEST(RigidContact, BeginsASpacingOfTheFluidBefore) {
  const std::string both = "water-a = {}\nwater-floor = {}\n";
  EXPECT_NEAR(height_of_the_first_push(over_a_floor(0.12, both)), 0.04, 1e-3);
  EXPECT_NEAR(height_of_the_first_push(over_a_floor(0.02, both)), 0.02, 1e-3) << "no push before it fell";
  EXPECT_NEAR(height_of_the_first_push(over_a_floor(0.12, "water-a = {}\n")), 0.0, 1e-3);
}

/// Without a key the water's contact is softer: it stops the fastest body of the scene within half a spacing, not
/// within a fiftieth.
TEST(RigidContact, IsSofterInAFluidWhereTheSceneSaysNothing) {
  const auto step_of = [](const std::string& water, const std::string& key) {
    std::string text =
        bodies_in_a_box("[phases.water]\nkind = \"fluid\"\ndensity = 1\nviscosity = 1\n",
                        "water-water = {}\na-a = { restitution = 0.5 }\n" + water,
                        "[[fill]]\nphase = \"a\"\nshape = { disc = { centre = [0.5, 0.5], radius = 0.2 } }\n"
                        "[[fill]]\nphase = \"water\"\nshape = { box = { min = [1.6, 1.6], max = [1.8, 1.8] } }\n");
    text.replace(text.find("largest-overlap = 0.2\n"), 22, key);
    const ContactRun run(text);
    for (const auto& l : run.simulation->plan().limits)
      if (l.name == "contact a-a") return l.value;
    return 0.0;
  };
  const double dry = step_of("", "");
  EXPECT_GT(dry, 0.0);
  EXPECT_NEAR(step_of("water-a = {}\n", "") / dry, 25.0, 1e-9);
  EXPECT_EQ(step_of("water-a = {}\n", "largest-overlap = 0.02\n"), dry) << "what the scene says";
}

/// The step of a contact: 0.1 sqrt(m/K) of the two lightest, with `safety`; a push on a disc goes through its centre.
TEST(RigidContact, LimitsTheStepByTheLightest) {
  ContactRun run(
      bodies_in_a_box("", "a-a = { restitution = 0.5 }\n",
                      "[[fill]]\nphase = \"a\"\nshape = { disc = { centre = [0.5, 0.5], radius = 0.2 } }\n"
                      "[[fill]]\nphase = \"a\"\nshape = { disc = { centre = [1.5, 0.5], radius = 0.1 } }\n"));
  const Plan& plan = run.simulation->plan();
  const double mass = run.simulation->state().bodies[1].mass, stiffness = contact_stiffness(run.scene, plan, 0);
  EXPECT_NEAR(mass / (1000.0 * std::acos(-1.0) * 0.1 * 0.1), 1.0, 0.1) << "of its particles";
  double limit = 0.0;
  for (const auto& l : plan.limits)
    if (l.name == "contact a-a") limit = l.value;
  EXPECT_NEAR(limit / (run.scene.time.safety * 0.1 * std::sqrt(0.5 * mass / stiffness)), 1.0, 1e-6);
}

/// Two that reach over half of a periodic domain together could touch on both sides.
TEST(RigidContact, RefusesBodiesTooWideForAPeriodicDomain) {
  // Two squares of `side` m: each reaches 0.71 of it from its middle.
  const auto make = [](double side) {
    const auto square = [&](double from) {
      const std::string low = text_of_number(from), high = text_of_number(from + side);
      return "[[fill]]\nphase = \"a\"\nshape = { box = { min = [" + low + ", " + low + "], max = [" + high + ", " +
             high + "] } }\n";
    };
    ContactRun(bodies_in_a_box("periodic = [\"x\"]\n", "a-a = { restitution = 0.5 }\n", square(0.1) + square(1.05)));
  };
  EXPECT_NO_THROW(make(0.6));
  try {
    make(0.8);
    ADD_FAILURE() << "accepted: together they reach 1.13 m, half of the domain is 1 m";
  } catch (const std::exception& error) {
    EXPECT_NE(std::string(error.what()).find("together wider than the periodic domain"), std::string::npos)
        << error.what();
  }
}

}  // namespace
}  // namespace barchan::rigid_contact_test
