// Rigid bodies in parts: how they turn, the law of their contacts, their outlines against all edges in turn, their
// inertia.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "base/errors.hpp"
#include "checks/reader.hpp"
#include "laws/surface_contact.hpp"
#include "models/bodies/contact_surface.hpp"
#include "plan/plan.hpp"
#include "start/generate.hpp"
#include "start/outline.hpp"

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

TEST(RigidStart, MassInertiaAndMotionAreThoseOfTheShape) {
  const Scene scene = parse_scene(scene_text, "s.toml");
  const Plan plan = make_plan(scene, generate(scene));
  ASSERT_EQ(plan.phases[0].rigid_bodies.size(), 2u) << "one a fill";
  const RigidBody& b = plan.phases[0].rigid_bodies[0];
  EXPECT_NEAR(b.mass, 1000 * 1.0 * 0.4 * 0.2, 1e-9);
  EXPECT_NEAR(b.inertia[0], b.mass * (0.16 + 0.04) / 12.0, 1e-9);
  EXPECT_NEAR(b.inertia[1], b.mass * (1.0 + 0.04) / 12.0, 1e-9);
  EXPECT_NEAR(b.inertia[2], b.mass * (1.0 + 0.16) / 12.0, 1e-9);
  EXPECT_NEAR(norm(b.now.velocity - Vec3{1, 2, 3}), 0.0, 1e-12);
  EXPECT_NEAR(norm(OwnAxes(b).to_space(own_angular_velocity(b)) - Vec3{0.5, 0.6, 0.7}), 0.0, 1e-12);
  EXPECT_NEAR(norm(b.now.place - Vec3{1.5, 1.2, 1.1}), 0.0, 1e-12);
}

/// The last body of fills on a lattice of a spacing, with 1000 kg/m3, in a domain from 0 to 3 m.
RigidBody body_of(int dimensions, double spacing, const std::string& fill) {
  const bool solid = dimensions == 3;
  const Scene scene =
      parse_scene("dimensions = " + std::to_string(dimensions) + "\nspacing = " + std::to_string(spacing) +
                      "\n[domain]\nsize = [3, 3" + (solid ? ", 3" : "") +
                      "]\n[phases.a]\nkind = \"rigid\"\ndensity = "
                      "1000\n[interactions]\n" +
                      fill + "\n[time]\nend = 1\nlargest-speed = 1\n",
                  "s.toml");
  return make_plan(scene, generate(scene)).phases[0].rigid_bodies.back();
}

struct Moments {
  double mass, inertia;  // kg, kg m2: about z in 2D, the sum of the three in 3D
  Vec3 centre;
};

void expect_moments(int dimensions, const std::string& fill, const Moments& exact,
                    const std::vector<double>& spacings) {
  for (const double spacing : spacings) {
    const RigidBody b = body_of(dimensions, spacing, fill);
    const double inertia = dimensions == 2 ? b.inertia[2] : b.inertia[0] + b.inertia[1] + b.inertia[2];
    EXPECT_NEAR(b.mass / exact.mass, 1.0, 1e-3) << fill << " at " << spacing;
    EXPECT_NEAR(inertia / exact.inertia, 1.0, 1e-3) << fill << " at " << spacing;
    EXPECT_LT(norm(b.now.place - exact.centre), 1e-3) << fill << " at " << spacing;
  }
}

std::string shaped(const std::string& shape) { return "[[fill]]\nphase = \"a\"\nshape = { " + shape + " }\n"; }

constexpr double pi = 3.14159265358979323846;

/// Whatever the spacing of the particles: from one of them on.
TEST(RigidStart, ShapesInThePlaneHaveTheirMassAndInertia) {
  const std::vector<double> spacings{0.31, 0.2, 0.13, 0.1, 0.077, 0.05, 0.031, 0.025};
  const auto disc = [](double r) { return 1000 * pi * r * r; };
  expect_moments(2, shaped("box = { min = [1.1, 1], max = [1.9, 1.5] }"),
                 {400, 400 * (0.64 + 0.25) / 12.0, {1.5, 1.25, 0}}, spacings);
  expect_moments(2, shaped("disc = { centre = [1.5, 1.4], radius = 0.25 }"),
                 {disc(0.25), 0.5 * disc(0.25) * 0.0625, {1.5, 1.4, 0}}, spacings);
  const double ring = disc(0.6) - disc(0.3);
  expect_moments(2, shaped("ring = { centre = [1.5, 1.4], inner = 0.3, outer = 0.6 }"),
                 {ring, 0.5 * ring * (0.09 + 0.36), {1.5, 1.4, 0}}, {0.2, 0.13, 0.1, 0.077, 0.05, 0.031});
  // Two boxes of 0.8 by 0.4 and 0.4 by 0.4, an L; turned about nothing but its mass centre.
  const double lower = 320, upper = 160, about = lower + upper;
  const Vec3 centre{(lower * 1.4 + upper * 1.2) / about, (lower * 1.2 + upper * 1.6) / about, 0.0};
  const double low2 = std::pow(1.4 - centre[0], 2) + std::pow(1.2 - centre[1], 2),
               up2 = std::pow(1.2 - centre[0], 2) + std::pow(1.6 - centre[1], 2);
  const Moments ell{about, lower * ((0.64 + 0.16) / 12.0 + low2) + upper * ((0.16 + 0.16) / 12.0 + up2), centre};
  expect_moments(2, shaped("polygon = [[1, 1], [1.8, 1], [1.8, 1.4], [1.4, 1.4], [1.4, 1.8], [1, 1.8]]"), ell,
                 spacings);
  expect_moments(2, shaped("formula = \"x > 1 && x < 1.8 && y > 1 && y < 1.8 && (x < 1.4 || y < 1.4) ? 1 : 0\""), ell,
                 {0.31, 0.13, 0.05});
  const double ellipse = 1000 * pi * 0.5 * 0.3;
  expect_moments(2, shaped("formula = \"1 - ((x - 1.5)/0.5)^2 - ((y - 1.4)/0.3)^2\""),
                 {ellipse, 0.25 * ellipse * (0.25 + 0.09), {1.5, 1.4, 0}}, {0.2, 0.1, 0.031});
  const double gone = disc(0.3);
  expect_moments(2,
                 "[[fill]]\nphase = \"a\"\nshape = { disc = { centre = [1.5, 1.5], radius = 0.3 } }\n"
                 "[[fill]]\nphase = \"a\"\nleave-out = \"earlier-fills\"\nshape = { box = { min = [0.9, 0.9], max = "
                 "[2.1, 2.1] } }\n",
                 {1440 - gone, 1440 * 1.44 / 6.0 - 0.5 * gone * 0.09, {1.5, 1.5, 0}}, {0.1, 0.077, 0.05, 0.031});
}

TEST(RigidStart, ShapesInSpaceHaveTheirMassAndInertia) {
  const std::vector<double> spacings{0.31, 0.27, 0.21, 0.17, 0.13, 0.11, 0.1, 0.09};
  expect_moments(3, shaped("box = { min = [1, 1, 1], max = [1.8, 1.5, 1.4] }"),
                 {160, 160 * (0.64 + 0.25 + 0.16) / 6.0, {1.4, 1.25, 1.2}}, spacings);
  const double ball = 4000.0 / 3.0 * pi * 0.027;
  expect_moments(3, shaped("sphere = { centre = [1.5, 1.4, 1.3], radius = 0.3 }"),
                 {ball, 3 * 0.4 * ball * 0.09, {1.5, 1.4, 1.3}}, spacings);
  const double rod = 3000 * pi * 0.04;
  expect_moments(3, shaped("disc = { centre = [1.5, 1.4, 0], radius = 0.2 }"),
                 {rod, rod * (0.04 + 9.0 / 6.0), {1.5, 1.4, 1.5}}, spacings);
  const double tube = 3000 * pi * 0.27;
  expect_moments(3, shaped("ring = { centre = [1.5, 1.4, 0], inner = 0.3, outer = 0.6 }"),
                 {tube, tube * (0.45 + 9.0 / 6.0), {1.5, 1.4, 1.5}}, {0.2, 0.17, 0.13, 0.11});
  expect_moments(3, shaped("polygon = [[1, 1], [1.8, 1], [1.8, 1.5], [1, 1.5]]"),
                 {1200, 1200 * (0.64 + 0.25 + 9.0) / 6.0, {1.4, 1.25, 1.5}}, spacings);
  const double egg = 4000.0 / 3.0 * pi * 0.5 * 0.3 * 0.4;
  expect_moments(3, shaped("formula = \"1 - ((x - 1.5)/0.5)^2 - ((y - 1.4)/0.3)^2 - ((z - 1.3)/0.4)^2\""),
                 {egg, 0.4 * egg * (0.25 + 0.09 + 0.16), {1.5, 1.4, 1.3}}, {0.21, 0.13});
}

TEST(RigidStart, TakesTheMassTheCentreAndTheInertiaThatTheFillSays) {
  const std::string box = "[[fill]]\nphase = \"a\"\nshape = { box = { min = [1, 1], max = [1.8, 1.4] } }\n";
  const RigidBody heavy = body_of(2, 0.1, box + "mass = 5\n");
  EXPECT_EQ(heavy.mass, 5.0);
  EXPECT_NEAR(heavy.inertia[2], 5.0 * (0.64 + 0.16) / 12.0, 1e-12) << "in proportion";
  const RigidBody loaded =
      body_of(2, 0.1, box + "mass = 5\ninertia = 0.7\ncentre = [1.1, 1.1]\nangular-velocity = 2\nvelocity = [1, 0]\n");
  EXPECT_NEAR(loaded.inertia[2], 0.7, 1e-12);
  EXPECT_NEAR(norm(loaded.now.place - Vec3{1.1, 1.1, 0}), 0.0, 1e-12);
  EXPECT_NEAR(norm(loaded.now.velocity - Vec3{1, 0, 0}), 0.0, 1e-12) << "it turns about its centre of mass";
  EXPECT_NEAR(own_angular_velocity(loaded)[2], 2.0, 1e-12);
  const RigidBody turned = body_of(2, 0.1, box + "[[motion]]\nphase = \"a\"\nabout = [1, 1.2]\n");
  EXPECT_NEAR(turned.inertia[2], 320 * ((0.64 + 0.16) / 12.0 + 0.16), 1e-9) << "about the place";
  EXPECT_NEAR(kinetic_energy(loaded), 0.5 * 5.0 + 0.5 * 0.7 * 4.0, 1e-12);
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
  expect_body_refused(scene_text, first, first + "\ncentre = [1, 1, 1]", "expected inertia = ... next to it");
  expect_body_refused(scene_text, first, first + "\ninertia = [1, 1, 3]", "more than the other two together");
  expect_body_refused(scene_text, first, first + "\ninertia = [1, 0, 1]", "expected moments above 0");
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
