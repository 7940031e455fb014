// Curved walls: what holds a fluid above them, normals of walls that nobody described, the pressure that turns a flow.
#include <gtest/gtest.h>

#include <cmath>

#include "models/fluid/ground_distance.hpp"
#include "models/fluid/relief.hpp"
#include "models/walls/wall_normals.hpp"
#include "models/walls/walls.hpp"
#include "unit/particle_sets.hpp"

namespace barchan {
namespace {

using namespace sets;

TEST(Relief, HoldsAboveASlopeAndLeavesTheRest) {
  for (const int dimensions : {2, 3}) {
    const Bounds b = box(dimensions, {4, 4, 4}, {true, false, true});
    // a plane that rises by 1/2 along x (and 1/4 along z), up to the seam
    const std::array<int, 2> counts{8, dimensions == 3 ? 8 : 0};
    std::vector<double> heights;
    for (int k = 0; k <= counts[1]; ++k)
      for (int i = 0; i <= 8; ++i) heights.push_back(0.25 * i + 0.125 * k);
    const Relief ground(b, counts, heights);
    EXPECT_NEAR(ground.at(1.1, 0)[0], 0.55, 1e-14);
    EXPECT_NEAR(ground.at(5.1, 4.0)[0], 0.55, 1e-14) << "periodic";
    const double z = dimensions == 3 ? 1.6 : 0.0, h = 0.5 + 0.25 * z;
    auto p = phase(dimensions, {{1, h - 0.1, z}, {1, h + 0.5, z}}, 1.0, {Field::velocity});
    for (std::size_t k : {0u, 1u}) {
      p.column(Field::velocity, 0)[k] = 2.0;
      p.column(Field::velocity, 1)[k] = -1.0;
    }
    hold_above(p, ground, 0.02);
    const Vec3 normal = [&] {
      const Vec3 n{-0.5, 1.0, dimensions == 3 ? -0.25 : 0.0};
      return (1.0 / norm(n)) * n;
    }();
    const Vec3 x = position(p, 0), v = vector(p, Field::velocity, 0);
    EXPECT_NEAR(dot(normal, x - Vec3{1, h, z}), 0.02, 1e-12);
    EXPECT_NEAR(dot(normal, v), 0.0, 1e-12);
    EXPECT_NEAR(norm(v - Vec3{2, -1, 0}), std::abs(dot(normal, {2, -1, 0})), 1e-12) << "along the ground it goes on";
    EXPECT_EQ(position(p, 1)[1], h + 0.5);
    EXPECT_EQ(vector(p, Field::velocity, 1)[1], -1.0);
  }
}

TEST(WallNormals, PointOutOfADiscAcrossTheSeam) {
  const Bounds b = box(2, {40, 40, 0}, {true, false, false});
  Uniform random(5);
  std::vector<Vec3> places;
  for (Vec3 x : lattice(b, 1.0, 0.0, random)) {
    if (norm(x - Vec3{20, 20, 0}) >= 10.0) continue;
    x[0] = std::fmod(x[0] + 20.0, 40.0);  // the disc stands on the seam
    places.push_back(x);
  }
  auto wall = phase(2, places, 1.0, {Field::wall_normal, Field::wall_depth});
  wall.column(Field::wall_depth)[0] = 1.0;  // known: left alone
  const WallPart parts[] = {{&wall, 1.0}};
  find_wall_normals(wall, parts, b, 1.0);
  EXPECT_EQ(norm(vector(wall, Field::wall_normal, 0)), 0.0);
  for (std::size_t k = 1; k < places.size(); ++k) {
    Vec3 out = position(wall, k) - Vec3{0, 20, 0};
    out[0] -= 40.0 * std::round(out[0] / 40.0);
    const Vec3 n = vector(wall, Field::wall_normal, k);
    if (norm(out) < 5.5) {
      EXPECT_EQ(norm(n), 0.0) << "the same all round";
    } else if (norm(out) > 7.5) {
      EXPECT_NEAR(norm(n), 1.0, 1e-12);
      EXPECT_GT(dot(n, out) / norm(out), 0.97) << "stairs and all";
    }
  }
}

/// A post on a floor: the floor's particles count by their volume, whatever their spacing.
TEST(WallNormals, CountNeighboursByTheirVolume) {
  const Bounds b = box(2, {40, 40, 0}, {false, false, false});
  const auto filled = [](double low_x, double high_x, double low_y, double high_y, double dx) {
    std::vector<Vec3> places;
    for (double x = low_x + 0.5 * dx; x < high_x; x += dx)
      for (double y = low_y + 0.5 * dx; y < high_y; y += dx) places.push_back({x, y, 0});
    return places;
  };
  const auto post = filled(16, 20, 16, 40, 1.0);
  const auto on_floor = [&](double dx, double volume) {
    auto wall = phase(2, post, 1.0, {Field::wall_normal, Field::wall_depth});
    const auto floor = phase(2, filled(0, 40, 12, 16, dx), dx * dx, {Field::wall_normal, Field::wall_depth});
    const WallPart parts[] = {{&wall, 1.0}, {&floor, volume}};
    find_wall_normals(wall, parts, b, 1.0);
    std::size_t k = 0;
    while (norm(position(wall, k) - Vec3{19.5, 17.5, 0}) > 1e-9) ++k;
    const Vec3 n = vector(wall, Field::wall_normal, k);
    return std::atan2(n[1], n[0]);
  };
  const double same = on_floor(1.0, 1.0);
  EXPECT_NEAR(on_floor(0.5, 0.25), same, 0.02);
  EXPECT_GT(on_floor(0.5, 1.0), same + 0.2) << "by their number the floor would push the normal up";
}

/// Two rows of a wall round a disc that touches no side; the second says nothing that the first does not.
TEST(GroundDistance, IsThatToTheSurfaceOfAFittedWall) {
  const Bounds b = box(2, {60, 60, 0}, {true, false, false});
  std::vector<Vec3> rows;
  for (const double r : {19.5, 18.5})
    for (int k = 0; k < 125; ++k)
      rows.push_back({30 + r * std::cos(k * 0.05026548), 30 + r * std::sin(k * 0.05026548), 0});
  auto wall = phase(2, rows, 1.0, {Field::wall_normal, Field::wall_depth});
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const Vec3 out = rows[k] - Vec3{30, 30, 0};
    wall.column(Field::wall_depth)[k] = 20.0 - norm(out);
    for (int d = 0; d < 2; ++d) wall.column(Field::wall_normal, d)[k] = out[static_cast<std::size_t>(d)] / norm(out);
  }
  GroundDistance ground(b, Sides{}, 1.0, true);
  const GroundDistance::Ground phases[] = {{&wall, 1.0}};
  ground.refresh(phases);
  Uniform random(7);
  for (const Vec3& x : scattered(b, 3000, random)) {
    const double r = norm(x - Vec3{30, 30, 0});
    if (r < 20.05 || r > 29) continue;  // the seam is nearer to some place beyond
    EXPECT_NEAR(ground.distance(x), r - 20.0, 0.02 + 0.01 * (r - 20.0));
  }
}

/// Air that circles round a disc, u = 1/r, p = -u^2/2: the wall continues the pressure beyond the surface.
TEST(CurvedWall, ContinuesThePressureThatTurnsTheFlow) {
  const Bounds b = box(2, {60, 60, 0}, {false, false, false}, {-30, -30, 0});
  Uniform random(6);
  const double radius = 20.0;
  std::vector<Vec3> solid, air;
  for (const Vec3& x : lattice(b, 1.0, 0.0, random)) (norm(x) < radius ? solid : air).push_back(x);
  const auto speed = [&](double r) { return radius / r; };
  double errors[2] = {0.0, 0.0};
  for (const bool bent : {false, true}) {
    std::vector<PhaseParticles> p;
    p.push_back(phase(2, solid, 1.0, {Field::velocity, Field::wall_normal, Field::wall_depth}));
    p.push_back(phase(2, air, 1.2, {Field::velocity, Field::density, Field::pressure}, 10000));
    SurfaceBend bend;
    for (std::size_t k = 0; k < solid.size(); ++k) {
      const double r = norm(solid[k]);
      p[0].column(Field::wall_depth)[k] = radius - r;
      for (int d = 0; d < 2; ++d) p[0].column(Field::wall_normal, d)[k] = solid[k][static_cast<std::size_t>(d)] / r;
      // of y = sqrt(R^2 - x^2): y''/sqrt(1 + y'^2) = -1/(R cos^2), cos that of the slope
      const double cosine = std::abs(solid[k][1]) / r;
      bend.values.push_back(-1.0 / (radius * std::max(cosine * cosine, 1e-6)));
    }
    for (std::size_t k = 0; k < air.size(); ++k) {
      const double r = norm(air[k]);
      p[1].column(Field::density)[k] = 1.2;
      p[1].column(Field::pressure)[k] = -0.6 * speed(r) * speed(r);
      p[1].column(Field::velocity, 0)[k] = speed(r) * air[k][1] / r;
      p[1].column(Field::velocity, 1)[k] = -speed(r) * air[k][0] / r;
    }
    Cast cast(b, std::move(p), {{0, 1, 3.0}});
    const std::vector<ExtensionSource> fluid{{&cast.list(0), &cast.motion[1], KernelKind::wendland_c2, 3.0, 1.2}};
    extend_into_solid(cast.phases[0], cast.motion[0], fluid, Vec3{}, ExtensionRule{Slip::free_slip},
                      bent ? bend : SurfaceBend{});
    for (std::size_t k = 0; k < solid.size(); ++k) {
      const Vec3 x = position(cast.phases[0], k);
      const double r = norm(x);
      if (r < radius - 1.5 || std::abs(x[1]) < 0.5 * r) continue;
      errors[bent] = std::max(errors[bent], std::abs(cast.motion[0][k][4] + 0.6 * speed(r) * speed(r)));
    }
  }
  EXPECT_GT(errors[0], 0.10) << "the mean of the fluid's";
  EXPECT_LT(errors[1], 0.035) << "of a dynamic pressure of 0.6";
}

}  // namespace
}  // namespace barchan
