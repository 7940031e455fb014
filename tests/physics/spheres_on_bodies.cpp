// Spheres on the outlines of rigid bodies: momentum of both, restitution, rolling, sliding, a plate that tilts, a belt.
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include "physics/drive.hpp"
#include "physics/small_scenes.hpp"

namespace barchan {
namespace {

using testing::report;
using testing::run_to;
using testing::value;

Vec3 vector(const PhaseParticles& p, Field field, std::size_t k) {
  Vec3 x{};
  for (int d = 0; d < p.components(field); ++d) x[static_cast<std::size_t>(d)] = p.column(field, d)[k];
  return x;
}

/// Of all spheres and of the body about the origin, with the spins; in space. In 2D by metre of depth.
struct Momenta {
  Vec3 linear{}, angular{};
  double speed = 0.0;  // mass times speed
};
Momenta momenta(const Simulation& run, const PhaseParticles& spheres, int dimensions) {
  Momenta sum;
  for (std::size_t k = 0; k < spheres.size(); ++k) {
    const double m = spheres.mass_of(k), r = spheres.has(Field::radius) ? spheres.column(Field::radius)[k] : 0.01;
    const Vec3 x = vector(spheres, Field::position, k), v = vector(spheres, Field::velocity, k);
    Vec3 w = vector(spheres, Field::angular_velocity, k);
    if (dimensions == 2) w = {0, 0, w[0]};
    sum.linear = sum.linear + m * v;
    sum.angular = sum.angular + m * cross(x, v) + 0.4 * m * r * r * w;
    sum.speed += m * norm(v);
  }
  const auto of_body = [&](const std::string& what) {
    Vec3 v{};
    for (std::size_t d = 0; d < static_cast<std::size_t>(dimensions); ++d)
      v[d] = value(run, "block" + what + "_" + "xyz"[d] + " ");
    return v;
  };
  const double mass = run.state().bodies.front().mass;  // of its shape
  const Vec3 x = of_body(""), v = of_body("_velocity");
  Vec3 own{0, 0, dimensions == 2 ? value(run, "block_angular_momentum ") : 0.0};
  if (dimensions == 3) own = of_body("_angular_momentum");
  sum.linear = sum.linear + mass * v;
  sum.angular = sum.angular + mass * cross(x, v) + own;
  sum.speed += mass * norm(v);
  return sum;
}

void expect_momenta(const std::string& text, int dimensions, int steps, const char* what) {
  const auto run = small::simulation(text);
  const PhaseParticles& spheres = run->phases()[0];
  const Momenta start = momenta(*run, spheres, dimensions);
  const Vec3 before{value(*run, "block_velocity_x"), value(*run, "block_velocity_y"), 0.0};
  double linear = 0.0, angular = 0.0, contacts = 0.0;
  for (int k = 0; k < steps; ++k) {
    run->step(1.0);
    const Momenta now = momenta(*run, spheres, dimensions);
    linear = std::max(linear, norm(now.linear - start.linear) / start.speed);
    angular = std::max(angular, norm(now.angular - start.angular) / (0.1 * start.speed));
    contacts = std::max(contacts, value(*run, "contacts"));
  }
  report(std::string("momentum over mass times speed, ") + what, linear, 1e-12);
  report(std::string("angular momentum over that and 0.1 m, ") + what, angular, 1e-10);
  EXPECT_LT(linear, 1e-12) << what;
  EXPECT_LT(angular, 1e-10) << what;
  EXPECT_GT(contacts, 3.0) << what;
  const Vec3 after{value(*run, "block_velocity_x"), value(*run, "block_velocity_y"), 0.0};
  EXPECT_GT(norm(after - before), 0.1) << "the spheres push it";
}

TEST(SpheresOnBodies, GiveThemWhatTheyLose) {
  expect_momenta(small::spheres_on_block, 2, 400, "2D");
  expect_momenta(small::spheres_on_block_3d, 3, 300, "3D");
}

/// A ball of the mean diameter 0.02 m on a plate, turned by an angle about the origin. `more`: keys of the ball.
std::string ball_on_plate(const std::string& plate, const std::string& ball, const std::string& more,
                          const std::string& motion, const std::string& gravity) {
  return "spacing = 0.01\n[domain]\norigin = [-0.6, -0.4]\nsize = [1.2, 0.8]\ngravity = " + gravity +
         "\n[phases.ball]\nkind = \"grains\"\ndensity = 2500\ndiameter = 0.02\n" + more +
         "[phases.plate]\nkind = \"rigid\"\ndensity = 1000\n[interactions]\nball-plate = { law = \"linear\" }\n" +
         "[[fill]]\nphase = \"plate\"\n" + plate + "[[fill]]\nphase = \"ball\"\n" + ball + motion +
         "[time]\nend = 3\nlargest-speed = 1\n";
}
const std::string plate = "shape = { box = { min = [-0.5, -0.02], max = [0.5, 0] } }\n",
                  clamped = "[[motion]]\nphase = \"plate\"\n";

std::string at(double x, double y) {
  return "shape = { points = [[" + std::to_string(x) + ", " + std::to_string(y) + "]] }\n";
}

/// The acceleration along a plate at rest, from 0.1 to 0.3 s, where gravity is turned by the angle (rad).
double acceleration(double angle, const std::string& more) {
  const auto run = small::simulation(ball_on_plate(
      plate, at(-0.4, 0.01), more, clamped,
      "[" + std::to_string(9.81 * std::sin(angle)) + ", " + std::to_string(-9.81 * std::cos(angle)) + "]"));
  run_to(*run, 0.1);
  const double before = run->phases()[0].column(Field::velocity, 0)[0];
  run_to(*run, 0.3);
  return (run->phases()[0].column(Field::velocity, 0)[0] - before) / 0.2;
}

TEST(SpheresOnBodies, ABallRollsAndSlides) {
  const double rolls = acceleration(0.3, "restitution = 0.3\nfriction = 0.3\n") / (5.0 / 7.0 * 9.81 * std::sin(0.3));
  const double slides =
      acceleration(1.0, "restitution = 0.3\nfriction = 0.3\n") / (9.81 * (std::sin(1.0) - 0.3 * std::cos(1.0)));
  report("acceleration of a ball that rolls over 5/7 g sin(a)", std::abs(rolls - 1.0), 0.005);
  report("of one that slips over g (sin(a) - mu cos(a))", std::abs(slides - 1.0), 0.005);
  EXPECT_NEAR(rolls, 1.0, 0.005);
  EXPECT_NEAR(slides, 1.0, 0.005);
}

/// The scene's slider cannot roll: it slides where tan(angle) passes its friction.
TEST(SpheresOnBodies, ABallOnATiltingPlateSlidesAtItsFriction) {
  const auto run = small::simulation(ball_on_plate(
      plate, at(0.0, 0.01), "restitution = 0.3\nfriction = 0.3\nrolling-friction = 1\n",
      "[[motion]]\nphase = \"plate\"\nabout = [0, 0]\nvelocity = [0, 0]\nangular-velocity = 0.2\n", "[0, -9.81]"));
  double slid = 0.0;
  while (run->time() < 2.0 && slid == 0.0) {
    run->step(1e-3);
    const PhaseParticles& ball = run->phases()[0];
    const double angle = value(*run, "plate_angle");
    const Vec3 x = vector(ball, Field::position, 0);
    const double along = std::cos(angle) * x[0] + std::sin(angle) * x[1];
    if (along < -1e-4) slid = std::tan(angle - 0.2 * std::cbrt(6e-4 / (9.81 * 0.2)));  // it fell from rest, a = g 0.2 t
  }
  report("tan(angle) at which it slides over the friction", std::abs(slid / 0.3 - 1.0), 0.05);
  EXPECT_NEAR(slid, 0.3, 0.05 * 0.3);
}

/// A ball meets a free disc of the mass of four such balls, head-on.
TEST(SpheresOnBodies, BouncesHaveTheRestitutionOfTheBall) {
  const auto run = small::simulation(ball_on_plate("shape = { disc = { centre = [0, 0], radius = 0.05 } }\n",
                                                   at(-0.08, 0.0) + "velocity = [1, 0]\n",
                                                   "restitution = 0.5\nfriction = 0.3\n", "", "[0, 0]"));
  run_to(*run, 0.1);
  const double parts = value(*run, "plate_velocity_x") - run->phases()[0].column(Field::velocity, 0)[0];
  report("restitution", std::abs(parts / 0.5 - 1.0), 0.01);
  EXPECT_NEAR(parts, 0.5, 0.005);
}

TEST(SpheresOnBodies, ABallTakesTheSpeedOfABelt) {
  const auto run =
      small::simulation(ball_on_plate(plate, at(0.3, 0.01), "restitution = 0.3\nfriction = 0.3\nrolling-friction = 1\n",
                                      "[[motion]]\nphase = \"plate\"\nvelocity = [-0.2, 0]\n", "[0, -9.81]"));
  run_to(*run, 0.3);
  const double speed = run->phases()[0].column(Field::velocity, 0)[0];
  report("speed over that of the plate", std::abs(speed / -0.2 - 1.0), 1e-3);
  EXPECT_NEAR(speed, -0.2, 2e-4);
}

}  // namespace
}  // namespace barchan
