// Rigid bodies in parts: how they turn, the law of their contacts, their outlines against all edges in turn, their
// inertia.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "base/errors.hpp"
#include "laws/surface_contact.hpp"
#include "models/bodies/contact_surface.hpp"
#include "plan/plan.hpp"
#include "scene/generate.hpp"
#include "scene/outline.hpp"
#include "scene/reader.hpp"

namespace barchan {
namespace {

double energy(const RigidBody& b) {
  const Vec3 rate = own_angular_velocity(b);
  return 0.5 * dot(rate, b.now.spin);
}

RigidBody top(const Vec3& inertia, const Vec3& rate) {
  RigidBody b;
  b.dimensions = 3;
  b.inertia = inertia;
  b.now.spin = spin_of(b, rate);
  return b;
}

TEST(RigidTurning, AFreeTopKeepsEnergyAndAngularMomentum) {
  RigidBody b = top({1.0, 2.3, 3.1}, {0.01, 1.0, 0.01});
  const double start = energy(b);
  const Vec3 momentum = OwnAxes(b).to_space(b.now.spin);
  double worst = 0.0, drift = 0.0, least = 1.0;
  for (int k = 0; k < 6283; ++k) {  // 100 turns, a tenth of a radian a step
    turn_freely(b, 0.1);
    worst = std::max(worst, std::abs(energy(b) / start - 1.0));
    drift = std::max(drift, norm(OwnAxes(b).to_space(b.now.spin) - momentum) / norm(momentum));
    least = std::min(least, own_angular_velocity(b)[1]);
  }
  EXPECT_LT(worst, 1e-7);
  EXPECT_LT(drift, 1e-12);
  EXPECT_LT(least, -0.9) << "about its middle axis it turns over";
  for (int k = 0; k < 6283; ++k) turn_freely(b, -0.1);
  EXPECT_NEAR(own_angular_velocity(b)[1], 1.0, 1e-6) << "the splitting reverses";
}

/// The axis of a symmetric top goes round the angular momentum at the rate L/I_1 (Landau & Lifshitz, Mechanics, 33).
TEST(RigidTurning, TheAxisOfASymmetricTopGoesRound) {
  RigidBody b = top({2.0, 2.0, 1.0}, {0.3, 0.0, 1.0});
  const Vec3 momentum = OwnAxes(b).to_space(b.now.spin);
  const Vec3 axis = OwnAxes(b).to_space({0, 0, 1});
  const double period = 2.0 * std::acos(-1.0) / (norm(momentum) / 2.0);
  for (int k = 0; k < 400; ++k) turn_freely(b, period / 400);
  EXPECT_LT(norm(OwnAxes(b).to_space({0, 0, 1}) - axis), 1e-9);
  for (int k = 0; k < 200; ++k) turn_freely(b, period / 400);
  EXPECT_GT(norm(OwnAxes(b).to_space({0, 0, 1}) - axis), 0.1) << "half-way it points elsewhere";
}

TEST(RigidTurning, OneTurnAboutAnyAxisLeadsBack) {
  RigidBody b = top({1.0, 2.0, 3.0}, {});
  const Vec3 rate{0.3, -0.7, 0.2};
  for (int k = 0; k < 10; ++k) turn_by(b, rate, 0.2 * std::acos(-1.0) / norm(rate));
  EXPECT_NEAR(std::abs(b.now.turn[0]), 1.0, 1e-14);
  RigidBody flat;
  turn_by(flat, {0, 0, 2.0}, 0.25);
  EXPECT_EQ(flat.now.angle, 0.5);
  EXPECT_NEAR(OwnAxes(flat).to_space({1, 0, 0})[1], std::sin(0.5), 1e-15);
  EXPECT_NEAR(OwnAxes(flat).to_own(OwnAxes(flat).to_space({0.3, 0.4, 0}))[0], 0.3, 1e-15);
}

/// A mass that comes with speed 1 to a wall at x = 0, by leapfrog as the step has it.
double wall_restitution(double e, double stiffness, double mass, double step, double start) {
  const SurfaceContactLaw law{stiffness, e, 0.0};
  const double dt = step * std::sqrt(mass / stiffness);
  double v = -1.0, x = start * dt, a = 0.0;
  for (int k = 0; k < static_cast<int>(60 / step); ++k) {
    v += 0.5 * dt * a;
    x += dt * v;
    a = x < 0.0 ? law.push(-x, v, 1.0 / mass, dt) / mass : 0.0;
    v += 0.5 * dt * a;
  }
  return v;
}

TEST(SurfaceContact, KeepsTheWrittenShareOfTheSpeed) {
  double worst = 0.0, elastic = 0.0;
  for (const double start : {0.02, 0.3, 0.55, 0.91})
    for (const double stiffness : {1e2, 1e9})
      for (const double step : {0.1, 0.03}) {
        for (const double e : {0.05, 0.1, 0.3, 0.5, 0.7, 0.9, 0.97})
          worst = std::max(worst, std::abs(wall_restitution(e, stiffness, 3.0, step, start) - e));
        elastic = std::max(elastic, std::abs(wall_restitution(1.0, stiffness, 3.0, step, start) - 1.0));
      }
  EXPECT_LT(worst, 0.0025);
  EXPECT_LT(elastic, 1e-4);
}

TEST(SurfaceContact, NeverPullsAndSticksWithinCoulombsCone) {
  const SurfaceContactLaw law{1e6, 0.5, 0.3};
  for (const double speed : {-10.0, -1e-3, 0.0, 1e-3, 10.0}) EXPECT_GE(law.push(1e-5, speed, 1.0, 1e-4), 0.0);
  EXPECT_NEAR(law.grip(100.0, 5.0, 1.0, 1e-4) * 5.0, 30.0, 1e-12) << "sliding: mu F_n";
  EXPECT_LT(law.grip(100.0, 1e-6, 1.0, 1e-4) * 1e-6, 30.0) << "sticking: less";
  EXPECT_EQ(law.grip(100.0, 1.0, 0.0, 1e-4), 0.0) << "of two bodies that cannot move";
}

/// The naive twin: all edges in turn, and the number of times that a ray cuts them.
double naive_gap(const std::vector<Facet>& edges, const Vec3& x) {
  double least = 1e300;
  bool inside = false;
  for (const Facet& f : edges) {
    const Vec3 along = f[1] - f[0];
    const double s = std::clamp(dot(x - f[0], along) / dot(along, along), 0.0, 1.0);
    least = std::min(least, norm(x - f[0] - s * along));
    if ((f[0][1] > x[1]) != (f[1][1] > x[1]) &&
        x[0] < f[0][0] + (x[1] - f[0][1]) / (f[1][1] - f[0][1]) * (f[1][0] - f[0][0]))
      inside = !inside;
  }
  return inside ? -least : least;
}

TEST(ContactSurfaces, APolygonKnowsItsDistanceAndItsNormal) {
  // Not convex, given clockwise, with sharp and blunt corners.
  const PolygonShape star{{{0, 0}, {0.1, 1}, {0.5, 0.3}, {1, 1}, {0.95, 0}, {0.5, 0.1}}, {1.0, 0.0, {}}};
  const auto edges = facets_of(star);
  PolygonOutline outline(edges);
  outline.prepare(0.2, 0.01);
  EXPECT_EQ(outline.corners().size(), 6u);
  std::mt19937 random(7);
  std::uniform_real_distribution<double> anywhere(-0.5, 1.5);
  int near = 0, deep = 0, far = 0;
  for (int k = 0; k < 4000; ++k) {
    const Vec3 x{anywhere(random), anywhere(random), 0.0};
    const double truth = naive_gap(edges, x);
    const auto gap = outline.gap(x);
    if (!gap) {
      ++far;
      EXPECT_GT(truth, 0.2 - 1e-12);
      continue;
    }
    if (std::isinf(gap->distance)) {
      ++deep;
      EXPECT_LT(truth, -0.2);
      continue;
    }
    ++near;
    EXPECT_NEAR(gap->distance, truth, 1e-12);
    EXPECT_NEAR(norm(gap->normal), 1.0, 1e-12);
    const double further = naive_gap(edges, x + 1e-6 * gap->normal);
    EXPECT_NEAR(further - truth, 1e-6, 2e-8) << "the distance grows along the normal at " << x[0] << ", " << x[1];
  }
  EXPECT_GT(near, 500);
  EXPECT_GT(far, 500);
  EXPECT_GT(deep, 0);
}

TEST(ContactSurfaces, RoundOnesAndBoxesAreExact) {
  const ContactSurface ball = ContactSurface::round({1, 2, 3}, 0.5);
  EXPECT_NEAR(ball.gap({1, 2, 4})->distance, 0.5, 1e-15);
  EXPECT_NEAR(ball.gap({1.1, 2, 3})->distance, -0.4, 1e-15);
  const ContactSurface ring = ContactSurface::ring({0, 0, 0}, 1.0, 2.0);
  EXPECT_NEAR(ring.gap({0.9, 0, 0})->distance, 0.1, 1e-15);
  EXPECT_EQ(ring.gap({0.9, 0, 0})->normal[0], -1.0) << "its inner side looks at its centre";
  EXPECT_NEAR(ring.gap({1.2, 0, 0})->distance, -0.2, 1e-15);
  EXPECT_NEAR(ring.gap({0, 2.5, 0})->distance, 0.5, 1e-15);
  const ContactSurface box = ContactSurface::box({0, 0, 0}, {1, 2, 3});
  EXPECT_NEAR(box.gap({1.3, 2.4, 1})->distance, 0.5, 1e-15);
  EXPECT_NEAR(box.gap({0.5, 0.1, 1})->distance, -0.1, 1e-15);
  EXPECT_EQ(box.gap({0.5, 0.1, 1})->normal[1], -1.0);
  EXPECT_EQ(box.probes().size(), 8u);
}

const std::string scene_text = R"toml(
dimensions = 3
spacing = 0.1
[domain]
size = [3, 3, 3]
[phases.a]
kind = "rigid"
density = 1000
[interactions]
[[fill]]
phase = "a"
shape = { box = { min = [1, 1, 1], max = [2, 1.4, 1.2] } }
velocity = [1, 2, 3]
angular-velocity = [0.5, 0.6, 0.7]
[[fill]]
phase = "a"
shape = { sphere = { centre = [2.5, 2.5, 2.5], radius = 0.3 } }
[time]
end = 1
)toml";

TEST(RigidStart, MassInertiaAndMotionAreThoseOfTheParticles) {
  const Scene scene = parse_scene(scene_text, "s.toml");
  const Plan plan = make_plan(scene, generate(scene));
  ASSERT_EQ(plan.phases[0].rigid_bodies.size(), 2u) << "one a fill";
  const RigidBody& b = plan.phases[0].rigid_bodies[0];
  EXPECT_NEAR(b.mass, 1000 * 1.0 * 0.4 * 0.2, 1e-9);
  // n points of a spacing dx along a side: their mean square from the middle is (n^2 - 1) dx^2/12.
  const auto square = [](double n) { return (n * n - 1.0) * 0.01 / 12.0; };
  EXPECT_NEAR(b.inertia[0], b.mass * (square(4) + square(2)), 1e-9);
  EXPECT_NEAR(b.inertia[1], b.mass * (square(10) + square(2)), 1e-9);
  EXPECT_NEAR(b.inertia[2], b.mass * (square(10) + square(4)), 1e-9);
  EXPECT_NEAR(norm(b.now.velocity - Vec3{1, 2, 3}), 0.0, 1e-12);
  EXPECT_NEAR(norm(OwnAxes(b).to_space(own_angular_velocity(b)) - Vec3{0.5, 0.6, 0.7}), 0.0, 1e-12);
  EXPECT_NEAR(norm(b.now.place - Vec3{1.5, 1.2, 1.1}), 0.0, 1e-12);
}

void expect_body_refused(std::string text, const std::string& from, const std::string& to, const std::string& words) {
  const std::size_t at = text.find(from);
  ASSERT_NE(at, std::string::npos) << from;
  text.replace(at, from.size(), to);
  try {
    const Scene scene = parse_scene(text, "s.toml");
    make_plan(scene, generate(scene));
    ADD_FAILURE() << "not refused: " << to;
  } catch (const SceneError& e) { EXPECT_NE(std::string(e.what()).find(words), std::string::npos) << e.what(); }
}

TEST(RigidStart, RefusesWhatCannotBe) {
  const std::string first = "shape = { box = { min = [1, 1, 1], max = [2, 1.4, 1.2] } }";
  expect_body_refused(scene_text, first, "shape = { points = [[1, 1, 1], [1.1, 1, 1], [1.2, 1, 1]] }",
                      "stand in one line");
  expect_body_refused(scene_text, "angular-velocity = [0.5, 0.6, 0.7]", "angular-velocity = 1",
                      "an array of 3 numbers");
  expect_body_refused(scene_text, "[interactions]", "[interactions]\na-a = { radius = 2 }", "expected no such key");
  expect_body_refused(scene_text, "[time]", "[[motion]]\nphase = \"a\"\ntorque = [1, 0, 0]\n[time]",
                      "turn freely about");
  expect_body_refused(scene_text, "[time]",
                      "[[motion]]\nphase = \"a\"\nabout = [1, 1, 1]\nvelocity = [1, 0, 0]\n[time]",
                      "stays where it is");
  expect_body_refused(scene_text, "[time]",
                      "[[motion]]\nphase = \"a\"\nbox = { min = [0, 0, 0], max = [0.1, 0.1, 0.1] }\n[time]",
                      "no rigid body of phase \"a\"");
  expect_body_refused(scene_text, "[time]", "[[motion]]\nphase = \"a\"\n[[motion]]\nphase = \"a\"\n[time]",
                      "holds already");
  expect_body_refused(scene_text, first, first + "\npressure = 1", "only fluids");
  expect_body_refused(scene_text, "density = 1000", "density = 1000\nstiffness = 1e6", "nothing reads it");
  std::string boxes = scene_text;
  const std::string sphere = "shape = { sphere = { centre = [2.5, 2.5, 2.5], radius = 0.3 } }";
  boxes.replace(boxes.find(sphere), sphere.size(), "shape = { cube = { centre = [2.5, 2.5, 2.5], count = 4 } }");
  expect_body_refused(boxes, "[interactions]", "[interactions]\na-a = { restitution = 0.5 }", "along their edges");
  expect_body_refused(scene_text, "[interactions]\n",
                      "[interactions]\na-a = { restitution = 0.5 }\n[[fill]]\nphase = \"a\"\n"
                      "shape = { formula = \"0.2 - x\" }\n",
                      "this shape has none");
}

}  // namespace
}  // namespace barchan
