// Bodies on walls that are boxes or polygons: contacts know their outlines, not the lattice of their particles.
#include <gtest/gtest.h>

#include <cmath>
#include <sstream>

#include "checks/reader.hpp"
#include "physics/drive.hpp"
#include "start/generate.hpp"

namespace barchan {
namespace {

struct Body {
  Vec3 place{}, velocity{};
};

/// Mean place and velocity of the first phase.
Body mean_of(Simulation& run, int dimensions) {
  const PhaseParticles& p = run.phases()[0];
  Body mean;
  for (int d = 0; d < dimensions; ++d)
    for (std::size_t k = 0; k < p.size(); ++k) {
      mean.place[static_cast<std::size_t>(d)] += p.column(Field::position, d)[k] / static_cast<double>(p.size());
      mean.velocity[static_cast<std::size_t>(d)] += p.column(Field::velocity, d)[k] / static_cast<double>(p.size());
    }
  return mean;
}

std::unique_ptr<Simulation> begin_run(const std::string& text, Scene& scene) {
  scene = parse_scene(text, "walls.toml");
  const auto blocks = generate(scene);
  return std::make_unique<Simulation>(scene, make_plan(scene, blocks), blocks);
}

/// A disc of radius 20 mm that meets a plate at 2.1 m/s along the plate's normal, without friction and weight.
std::string disc_on(const std::string& plate, double x, double y, double u, double v) {
  std::ostringstream text;
  text.precision(17);
  text << R"(spacing = 0.002
[domain]
size = [0.2, 0.12]
[phases.disc]
kind = "elastic"
formulation = "total-lagrangian"
density = 1000
young = 1e6
poisson = 0.3
[phases.plate]
kind = "wall"
[interactions]
disc-disc = { radius = 1.6, kernel = "wendland-c2" }
disc-plate = { restitution = 1 }
[[fill]]
phase = "plate"
shape = )"
       << plate << "\n[[fill]]\nphase = \"disc\"\npacking = \"relaxed\"\nshape = { disc = { centre = [" << x << ", "
       << y << "], radius = 0.02 } }\nvelocity = [" << u << ", " << v << "]\n[time]\nend = 0.02\nlargest-speed = 3\n";
  return text.str();
}

/// The share of the impact speed that goes along the wall after the rebound; -1: it did not rebound.
double sideways(const std::string& text, const Vec3& normal) {
  Scene scene;
  const auto run = begin_run(text, scene);
  const double before = norm(mean_of(*run, 2).velocity);
  while (run->time() < 0.02) run->step(1.0);
  const Vec3 after = mean_of(*run, 2).velocity;
  const double out = dot(after, normal);
  if (!(out > 0.3 * before)) return -1.0;
  return norm(after - out * normal) / before;
}

TEST(SmoothWalls, DiscLeavesAPlateAsItCame) {
  for (const double x : {0.1, 0.1003, 0.1005, 0.1008, 0.105}) {
    const double share =
        sideways(disc_on("{ box = { min = [0, 0], max = [0.2, 0.01] } }", x, 0.0315, 0.0, -2.1), {0, 1, 0});
    EXPECT_GE(share, 0.0) << x;
    EXPECT_LE(share, 0.01) << "box, at " << x;
  }
}

TEST(SmoothWalls, DiscLeavesASlopeThatTheLatticeCutsAsItCame) {
  const double angle = 0.37;
  const Vec3 normal{-std::sin(angle), std::cos(angle), 0};
  std::ostringstream wedge;
  wedge.precision(17);
  wedge << "{ polygon = [[0.01, 0.01], [0.19, 0.01], [0.19, " << 0.01 + 0.18 * std::tan(angle) << "]] }";
  for (const double along : {0.1, 0.1006, 0.1011}) {
    const Vec3 foot{along, 0.01 + (along - 0.01) * std::tan(angle), 0}, at = foot + 0.022 * normal;
    const double share = sideways(disc_on(wedge.str(), at[0], at[1], -2.1 * normal[0], -2.1 * normal[1]), normal);
    EXPECT_GE(share, 0.0) << along;
    EXPECT_LE(share, 0.01) << "slope, at " << along;
  }
}

// A block that slides with friction 0.3 comes to rest after v^2/(2 mu g); on a box as on a side.
TEST(SmoothWalls, BlockSlidesToRestWhereCoulombSays) {
  for (const char* floor : {"{ box = { min = [-0.02, 0], max = [0.6, 0.02] } }", "{ sides = [\"bottom\"] }"}) {
    const bool box = std::string(floor).find("box") != std::string::npos;
    const double bottom = box ? 0.02 : 0.0;
    std::ostringstream text;
    text << R"(spacing = 0.01
[domain]
origin = [-0.02, 0]
size = [0.62, 0.2]
gravity = [0, -9.81]
[phases.block]
kind = "elastic"
formulation = "total-lagrangian"
density = 1000
young = 1e6
poisson = 0.3
[phases.floor]
kind = "wall"
[interactions]
block-block = { radius = 1.6, kernel = "wendland-c2" }
block-floor = { restitution = 0.5, friction = 0.3 }
[[fill]]
phase = "floor"
shape = )"
         << floor << "\n[[fill]]\nphase = \"block\"\nshape = { box = { min = [0.05, " << bottom << "], max = [0.15, "
         << bottom + 0.05 << "] } }\nvelocity = [1, 0]\n[time]\nend = 0.6\nlargest-speed = 2\n";
    Scene scene;
    const auto run = begin_run(text.str(), scene);
    const double from = mean_of(*run, 2).place[0];
    while (run->time() < 0.6) run->step(1.0);
    const Body end = mean_of(*run, 2);
    const double way = 1.0 / (2.0 * 0.3 * 9.81);
    testing::report(std::string("way over v^2/(2 mu g), ") + (box ? "box" : "side"), (end.place[0] - from) / way, 1.0);
    EXPECT_NEAR((end.place[0] - from) / way, 1.0, 0.01) << floor;
    EXPECT_NEAR(end.velocity[0], 0.0, 0.01) << floor;
  }
}

}  // namespace
}  // namespace barchan
