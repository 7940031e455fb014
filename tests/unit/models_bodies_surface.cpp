// The surface of an elastic body, its normals when it is deformed, and the law of two surfaces.
#include <gtest/gtest.h>

#include <cmath>

#include "models/bodies/body_surface.hpp"

namespace barchan {
namespace {

constexpr double dx = 1e-3;

SmoothContactLaw law_of(double friction = 0.0) {
  return SmoothContactLaw::of(BodyContactLaw::of(dx, 1e3, 1e-3, 1.0, friction), 2);
}

/// A block of 12 x 8 particles at F X, periodic along x if asked.
struct Block {
  static constexpr std::size_t wide = 12, high = 8;
  std::vector<Vec3> places;
  Bounds bounds;
  PhaseParticles body{"body", 2, wide* high, 1.0, 0};
  RecordArray records{SurfaceRecord<2>::size};

  explicit Block(const std::array<double, 4>& f, bool periodic = false) {
    bounds.dimensions = 2;
    bounds.low = {0, -1, 0};
    bounds.high = {periodic ? wide * dx : 1.0, 1, 0};
    bounds.periodic[0] = periodic;
    body.add(Field::position);
    body.add(Field::velocity);
    for (std::size_t j = 0; j < high; ++j)
      for (std::size_t i = 0; i < wide; ++i) {
        const double x = (static_cast<double>(i) + 0.5) * dx, y = (static_cast<double>(j) + 0.5) * dx;
        const std::size_t k = places.size();
        places.push_back({x, y, 0});
        body.column(Field::position, 0)[k] = f[0] * x + f[1] * y;
        body.column(Field::position, 1)[k] = f[2] * x + f[3] * y;
      }
    body.keep_places();
    const BodySurface surface(places, bounds, dx, 1.6 * dx, law_of());
    records.resize(body.size(), 0);
    surface.pack(body, records);
    points = surface.size();
    alone = surface.alone();
  }
  Vec3 normal(std::size_t i, std::size_t j) const {
    const double* r = records[j * wide + i];
    return {r[SurfaceRecord<2>::normal], r[SurfaceRecord<2>::normal + 1], 0};
  }
  double share(std::size_t i, std::size_t j) const { return records[j * wide + i][SurfaceRecord<2>::share]; }
  std::size_t points = 0;
  std::int64_t alone = 0;
};

TEST(BodySurface, IsTheOutermostLayer) {
  const Block block({1, 0, 0, 1});
  EXPECT_EQ(block.points, 2 * (Block::wide + Block::high) - 4);
  EXPECT_EQ(block.alone, -1);
  EXPECT_EQ(block.share(5, 1), 0.0) << "the second layer is inside";
  EXPECT_NEAR(block.share(5, 0), 1.0, 0.01);
  EXPECT_NEAR(norm(block.normal(5, 0)), 1.0, 1e-12);
  EXPECT_LT(norm(block.normal(0, 0)), 0.2) << "an edge is not sure";
}

TEST(BodySurface, GoesRoundAPeriodicDomain) {
  const Block block({1, 0, 0, 1}, true);
  EXPECT_EQ(block.points, 2 * Block::wide);
  EXPECT_NEAR(norm(block.normal(0, 0) - Vec3{0, -1, 0}), 0.0, 1e-12);
}

// cof(F) N: in simple shear the bottom keeps its normal, and the sides turn.
TEST(BodySurface, NormalsFollowTheCofactor) {
  const double c = std::cos(0.4), s = std::sin(0.4);
  for (const auto& f : {std::array{1.0, 0.3, 0.0, 1.0}, std::array{c, -s, s, c}, std::array{1.2, 0.1, -0.2, 0.9}}) {
    const Block block(f);
    const Vec3 bottom{f[2], -f[0], 0}, left{-f[3], f[1], 0};  // cof(F) (0, -1) and cof(F) (-1, 0)
    EXPECT_NEAR(norm(block.normal(5, 0) - 1.0 / norm(bottom) * bottom), 0.0, 1e-10);
    EXPECT_NEAR(norm(block.normal(0, 4) - 1.0 / norm(left) * left), 0.0, 1e-10);
  }
}

TEST(BodySurface, FindsParticlesWithoutASurface) {
  Bounds bounds;
  bounds.dimensions = 2;
  bounds.low = {-1, -1, 0};
  bounds.high = {1, 1, 0};
  EXPECT_GE(BodySurface({{0, 0, 0}, {dx, 0, 0}, {2 * dx, 0, 0}}, bounds, dx, 1.6 * dx, law_of()).alone(), 0);
  EXPECT_EQ(BodySurface({{0, 0, 0}}, bounds, dx, 1.6 * dx, law_of()).alone(), 0);
}

using One = simd::Vec<double, 1>;
std::array<double, 2> force_of(std::array<double, 2> r, std::array<double, 2> v, std::array<double, 2> n_a,
                               std::array<double, 2> n_b, double friction = 0.0) {
  const SmoothContactLaw::Constants<One> constants(law_of(friction), 1e-6);
  const std::array<One, 2> rr{One(r[0]), One(r[1])}, vv{One(v[0]), One(v[1])}, na{One(n_a[0]), One(n_a[1])};
  const One nb[2] = {One(n_b[0]), One(n_b[1])};
  std::array<One, 2> f{One(0.0), One(0.0)};
  const One r2(r[0] * r[0] + r[1] * r[1]);
  if (friction > 0.0) SmoothContactLaw::add<true>(constants, rr, r2, vv, na, nb, One(0.9), f);
  else SmoothContactLaw::add<false>(constants, rr, r2, vv, na, nb, One(0.9), f);
  return {simd::sum(f[0]), simd::sum(f[1])};
}

TEST(SmoothContactLaw, ForcesAreEqualAndOppositeToTheLastBit) {
  const std::array<double, 2> r{3.1e-4, 8.3e-4}, v{0.2, -0.31}, n_a{0.11, -0.97}, n_b{-0.23, 0.9};
  for (const double friction : {0.0, 0.4}) {
    const auto one = force_of(r, v, n_a, n_b, friction);
    const auto other = force_of({-r[0], -r[1]}, {-v[0], -v[1]}, n_b, n_a, friction);
    EXPECT_GT(one[1], 0.0);
    EXPECT_EQ(one[0], -other[0]);
    EXPECT_EQ(one[1], -other[1]);
  }
}

TEST(SmoothContactLaw, DerivesFromItsEnergy) {
  const std::array<double, 2> n_a{0, -1}, n_b{0, 1};
  const auto law = law_of();
  const auto energy = [&](double x, double y) {
    const double o = std::max(dx - y, 0.0), deep = std::max(o - 0.35 * dx, 0.0);
    return 0.9 * law.weight(x * x) * (0.5 * 1e3 * o * o + 0.5 * 8e3 * deep * deep);
  };
  const double e = 1e-8;
  for (const auto& r : {std::array{4e-4, 9e-4}, std::array{-9e-4, 5e-4}, std::array{1.2e-3, 0.3e-3}}) {
    const auto f = force_of(r, {0, 0}, n_a, n_b);
    EXPECT_NEAR(f[0], -(energy(r[0] + e, r[1]) - energy(r[0] - e, r[1])) / (2 * e), 1e-6 * std::abs(f[1]));
    EXPECT_NEAR(f[1], -(energy(r[0], r[1] + e) - energy(r[0], r[1] - e)) / (2 * e), 1e-6 * std::abs(f[1]));
  }
}

TEST(SmoothContactLaw, SurfacesThatLookTheSameWayDoNotTouch) {
  EXPECT_EQ(force_of({0, 5e-4}, {0, 0}, {0.2, 1}, {0, 1})[1], 0.0);
  EXPECT_GT(force_of({0, 5e-4}, {0, 0}, {0.2, -1}, {0, 1})[1], 0.0);
}

TEST(SmoothContactLaw, WeightsSumToOne) {
  const auto law = law_of();
  for (const double aside : {0.0, 0.25, 0.5}) {
    double sum = 0.0;
    for (int k = -4; k <= 4; ++k) sum += law.weight(std::pow((k + aside) * dx, 2));
    EXPECT_NEAR(sum, 1.0, 0.0125);
  }
}

}  // namespace
}  // namespace barchan
