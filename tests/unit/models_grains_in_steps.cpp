// Spheres of unequal sizes in whole steps: what friction and rolling resistance give to one sphere of a pair the other
// gets too, at its own lever, and the books of history.csv hold it.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "physics/small_scenes.hpp"

namespace barchan {
namespace {

double value(const Simulation& run, const std::string& column) {
  const auto names = run.history_columns();
  const auto at =
      std::find_if(names.begin(), names.end(), [&](const std::string& each) { return each.starts_with(column); });
  return at == names.end() ? NAN : run.history_row()[static_cast<std::size_t>(at - names.begin())];
}

/// Spheres that fly towards the middle of a domain without sides and turn about it; radius of the cloud in m, speed at
/// its edge in m/s.
std::string cloud(int dimensions, const std::string& law, double radius, double speed, double friction) {
  const bool solid = dimensions == 3;
  const std::string rate = std::to_string(speed / radius);
  return "dimensions = " + std::to_string(dimensions) +
         "\nspacing = 1e-3\n[domain]\nsize = " + (solid ? "[0.1, 0.1, 0.1]" : "[0.1, 0.1]") + R"toml(
[phases.sand]
kind = "grains"
density = 2650
diameter = { mean = 1e-3, spread = 0.4 }
restitution = 0.6
friction = )toml" +
         std::to_string(friction) + "\nrolling-friction = " + std::to_string(0.2 * friction) + "\n" +
         (law == "hertz" ? "young = 1e7" : "stiffness = " + std::to_string(200.0 * speed * speed)) +
         R"toml(
[interactions]
sand-sand = { law = ")toml" +
         law + "\" }\n[[fill]]\nphase = \"sand\"\nshape = { " +
         (solid ? "sphere = { centre = [0.05, 0.05, 0.05], radius = " : "disc = { centre = [0.05, 0.05], radius = ") +
         std::to_string(radius) + " } }\nvelocity = [\"" + rate + "*(y - x)\", \"" + rate + "*(0.05 - y" +
         (solid ? " + 0.05 - z)\", \"" + rate + "*(0.05 - z)\"]" : ")\"]") +
         "\n[time]\nend = 1\nlargest-speed = " + std::to_string(2.0 * speed) + "\n";
}

/// Momenta and energies from the particles' own columns, those of turning with 2/5 m r^2.
struct Books {
  std::array<double, 3> momentum{}, angular{};
  double moving = 0.0, turning = 0.0;
  explicit Books(const Simulation& run) {
    const PhaseParticles& p = run.state().phases[0];
    const int dimensions = p.dimensions();
    for (std::size_t k = 0; k < p.size(); ++k) {
      const double m = p.mass_of(k), r = p.column(Field::radius)[k];
      Vec3 x{}, v{}, w{};
      for (int d = 0; d < dimensions; ++d) {
        x[static_cast<std::size_t>(d)] = p.column(Field::position, d)[k] - 0.05;
        v[static_cast<std::size_t>(d)] = p.column(Field::velocity, d)[k];
      }
      const int spins = p.has(Field::angular_velocity) ? p.components(Field::angular_velocity) : 0;
      for (int d = 0; d < spins; ++d)
        w[static_cast<std::size_t>(spins == 1 ? 2 : d)] = p.column(Field::angular_velocity, d)[k];
      const Vec3 l = m * cross(x, v) + 0.4 * m * r * r * w;
      for (std::size_t d = 0; d < 3; ++d) {
        momentum[d] += m * v[d];
        angular[d] += l[d];
      }
      moving += 0.5 * m * dot(v, v);
      turning += 0.2 * m * r * r * dot(w, w);
    }
  }
};

void expect_closed_books(int dimensions, const std::string& law, double radius, double speed, double time,
                         double friction) {
  const auto run = small::simulation(cloud(dimensions, law, radius, speed, friction));
  const Books start(*run);
  while (run->time() < time) run->step(time - run->time());
  const Books end(*run);
  const std::string where = std::to_string(dimensions) + "D, " + law;
  if (friction > 0.0) { EXPECT_GT(end.turning, 1e-3 * start.moving) << where << ": they turn"; }
  EXPECT_LT(end.moving, 0.9 * start.moving) << where << ": they have met";
  const double mass = 2.0 * start.moving, scale = std::sqrt(mass * 2650.0 * 1e-6);
  for (std::size_t d = 0; d < 3; ++d) {
    EXPECT_NEAR(end.momentum[d], start.momentum[d], 1e-9 * scale) << where;
    EXPECT_NEAR(end.angular[d], start.angular[d], 1e-9 * scale * radius) << where;
  }
  EXPECT_NEAR(value(*run, "rotation_energy ["), end.turning, 1e-9 * end.turning) << where;
  const double told =
      end.moving + end.turning + value(*run, "contacts_lost_energy [") + value(*run, "contacts_stored_energy [");
  EXPECT_NEAR(told, start.moving, 0.03 * start.moving) << where << ": soft contacts in twelve steps, 0.018 at most";
}

TEST(SpheresInSteps, KeepMomentaAndTheBooks) {
  for (const std::string law : {"linear", "hertz"}) {
    expect_closed_books(2, law, 0.004, 1.0, 0.003, 0.5);
    expect_closed_books(3, law, 0.0025, 1.0, 0.002, 0.5);
  }
}

// So many that chunks of 512 share pairs. Without friction: where many layers collapse at once, what friction takes is
// booked with the velocities that the contact itself leaves, and the books of these steps gape by a tenth.
TEST(SpheresInSteps, CountTheLossOfSharedPairsOnce) { expect_closed_books(2, "linear", 0.02, 5.0, 0.002, 0.0); }

}  // namespace
}  // namespace barchan
