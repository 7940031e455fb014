// The fluid continued into solids against a naive twin of the formulas in src/models/walls/walls.hpp, and what these
// formulas promise: a linear velocity continues exactly, a column at rest gives the wall its pressure.
#include "models/walls/walls.hpp"

#include <gtest/gtest.h>

#include "unit/naive_fluid.hpp"

namespace barchan {
namespace {

using namespace sets;

constexpr double wall_rounding = 1e-12;

/// A solid below, a fluid above and a second fluid among it, with random fields. Some of the solid knows its depth.
Cast solid_under_fluids(int dimensions, Uniform& random) {
  const Bounds b = dimensions == 2 ? box(2, {8, 6, 0}, {true, false, false}) : box(3, {5, 5, 6}, {true, false, true});
  Bounds below = b;
  below.low[1] = -5.0;
  below.high[1] = 0.0;
  std::vector<Vec3> one, other;
  for (const Vec3& x : lattice(b, 1.0, 0.2, random)) (random(0, 1) < 0.7 ? one : other).push_back(x);
  std::vector<PhaseParticles> p;
  const std::vector<Field> fluid{Field::velocity, Field::density, Field::pressure};
  p.push_back(phase(dimensions, lattice(below, 1.0, 0.1, random), 1.0,
                    {Field::velocity, Field::wall_normal, Field::wall_depth}));
  p.push_back(phase(dimensions, one, 1.2, fluid, 1000));
  p.push_back(phase(dimensions, other, 900.0, fluid, 2000));
  for (auto& q : p) randomise(q, Field::velocity, -2, 2, random);
  for (std::size_t k : {1u, 2u}) {
    randomise(p[k], Field::density, 0.9 * p[k].mass(), 1.1 * p[k].mass(), random);
    randomise(p[k], Field::pressure, -3, 9, random);
  }
  for (std::size_t k = 0; k < p[0].size(); ++k) {
    p[0].column(Field::wall_normal, 1)[k] = 1.0;
    p[0].column(Field::wall_depth)[k] = k % 4 == 0 ? 0.0 : -position(p[0], k)[1];
  }
  return Cast(b, std::move(p), {{0, 1, 3.0}, {0, 2, 2.2}});
}

/// A solid and how the fluids slip along it.
struct Solid {
  int dimensions;
  Slip slip;
  PhaseKind kind;
  bool drag = false;  // grains: a form drag acts, so that those alone in the fluid let it pass
  std::string name() const {
    return std::string(kind == PhaseKind::wall      ? "Wall"
                       : kind == PhaseKind::elastic ? "Elastic"
                                                    : "Grains") +
           std::to_string(dimensions) + "D" + (slip == Slip::no_slip ? "NoSlip" : "FreeSlip") + (drag ? "Drag" : "");
  }
};
void PrintTo(const Solid& solid, std::ostream* out) { *out << solid.name(); }

std::vector<Solid> every_solid() {
  std::vector<Solid> solids;
  for (const int dimensions : {2, 3})
    for (const Slip slip : {Slip::no_slip, Slip::free_slip})
      for (const PhaseKind kind : {PhaseKind::wall, PhaseKind::elastic, PhaseKind::grains})
        solids.push_back({dimensions, slip, kind});
  for (const int dimensions : {2, 3}) solids.push_back({dimensions, Slip::no_slip, PhaseKind::grains, true});
  return solids;
}

class Extension : public ::testing::TestWithParam<Solid> {};
INSTANTIATE_TEST_SUITE_P(Walls, Extension, ::testing::ValuesIn(every_solid()),
                         [](const auto& solid) { return solid.param.name(); });

TEST_P(Extension, EqualsTheNaiveSums) {
  const auto [dimensions, slip, kind, drag] = GetParam();
  const bool accelerates = kind == PhaseKind::elastic;  // the blows of grains are no motion of a boundary
  Uniform random(31);
  Cast cast = solid_under_fluids(dimensions, random);
  auto& wall = cast.phases[0];
  if (kind != PhaseKind::wall) {
    wall.add(Field::acceleration);
    randomise(wall, Field::acceleration, -3, 3, random);
  }
  const Vec3 gravity{0.5, -9.81, dimensions == 3 ? 1.5 : 0.0};
  const std::vector<double> rest{1.2, 900.0};
  // sum V W about a lone grain: of both fluids together what the upper layers of this solid have, so that some of its
  // particles count as alone, some as part of a bed, some as between.
  const std::array<double, 2> about{drag ? 0.15 : 0.0, drag ? 0.05 : 0.0};
  std::array<std::vector<double>, 3> velocity;
  std::vector<double> pressure;
  int alone = 0, linear = 0, passing = 0, between = 0, bedded = 0;
  for (std::size_t k = 0; k < wall.size(); ++k) {
    const Vec3 v_w = vector(wall, Field::velocity, k), n = vector(wall, Field::wall_normal, k);
    const double phi_w = wall.column(Field::wall_depth)[k];
    const Vec3 pull = gravity - (accelerates ? vector(wall, Field::acceleration, k) : Vec3{});
    double sum = 0.0, sum_p = 0.0, sum_phi2 = 0.0;
    Vec3 sum_v{}, sloped{};
    for (std::size_t b : {1u, 2u})
      for_all_pairs(cast.bounds, wall, k, cast.phases[b], false, cast.directions[b - 1].radius,
                    [&, dimensions = dimensions](std::size_t j, const Vec3& r, const std::array<int, 3>&) {
                      const PhaseParticles& fluid = cast.phases[b];
                      const KernelKind kernel = b == 1 ? KernelKind::wendland_c2 : KernelKind::cubic_spline;
                      const double w = naive::volume(fluid, j) *
                                       naive::weight(kernel, cast.directions[b - 1].radius, dimensions, norm(r));
                      const Vec3 v_a = vector(fluid, Field::velocity, j);
                      const double phi_a = -dot(n, r) - phi_w;
                      sum += w;
                      sum_p += w * (fluid.column(Field::pressure)[j] + rest[b - 1] * dot(pull, r));
                      sum_phi2 += w * phi_a * phi_a;
                      sum_v = sum_v + w * v_a;
                      sloped = sloped + w * phi_a * (v_a - v_w);
                    });
    Vec3 v = v_w;
    if (sum > 0.0) {
      const Vec3 mean = 1.0 / sum * sum_v;
      // 0 up to 0.65 of the fluid about a lone grain, 1 from 0.9 on
      const double rise = drag ? std::clamp((sum / (about[0] + about[1]) - 0.65) / 0.25, 0.0, 1.0) : 0.0;
      const double open = 3 * rise * rise - 2 * rise * rise * rise;
      ++(open == 0.0 ? bedded : open == 1.0 ? passing : between);
      const Vec3 stuck = kind == PhaseKind::grains ? v_w + open * (mean - v_w)
                         : phi_w > 0.0             ? v_w - phi_w / sum_phi2 * sloped
                                                   : 2.0 * v_w - mean;
      v = slip == Slip::no_slip ? stuck : mean + dot(stuck - mean, n) * n;
      linear += phi_w > 0.0;
    } else {
      ++alone;
    }
    for (std::size_t d = 0; d < 3; ++d) velocity[d].push_back(v[d]);
    pressure.push_back(sum > 0.0 ? sum_p / sum : 0.0);
  }
  EXPECT_GT(alone, 0) << "the lowest layers see no fluid";
  EXPECT_GT(linear, 0);
  if (drag) {
    EXPECT_GT(passing, 0);
    EXPECT_GT(between, 0);
    EXPECT_GT(bedded, 0);
  }
  const std::vector<ExtensionSource> fluids{
      {&cast.list(0), &cast.motion[1], KernelKind::wendland_c2, 3.0, rest[0], about[0]},
      {&cast.list(1), &cast.motion[2], KernelKind::cubic_spline, 2.2, rest[1], about[1]}};
  extend_into_solid(wall, cast.motion[0], fluids, gravity, ExtensionRule{slip, accelerates, kind == PhaseKind::grains});
  const auto n = static_cast<std::size_t>(dimensions);
  std::vector<double> got(wall.size());
  for (std::size_t d = 0; d <= n; ++d) {  // the velocity's components, then the pressure
    for (std::size_t k = 0; k < wall.size(); ++k) got[k] = cast.motion[0][k][n + d];
    EXPECT_LT(difference(got.data(), d < n ? velocity[d] : pressure), wall_rounding)
        << (d < n ? "velocity" : "pressure");
  }
}

/// Fluid over a flat wall at y = 0, a velocity and a pressure that depend on y; the wall's extended records.
class Flat {
 public:
  template <class Velocity, class Pressure>
  Flat(const Vec3& v_wall, const Vec3& gravity, Slip slip, Velocity&& v_of, Pressure&& p_of)
      : cast_(make(v_wall, v_of, p_of)) {
    const std::vector<ExtensionSource> fluid{{&cast_.list(0), &cast_.motion[1], KernelKind::wendland_c2, 3.0, 1.2}};
    extend_into_solid(cast_.phases[0], cast_.motion[0], fluid, gravity, ExtensionRule{slip});
  }
  template <class F>
  void each(F&& f) const {  // f(x, velocity, pressure) of wall particles near the fluid
    for (std::size_t k = 0; k < cast_.phases[0].size(); ++k) {
      const Vec3 x = position(cast_.phases[0], k);
      const double* r = cast_.motion[0][k];
      if (x[1] > -2.2) f(x, Vec3{r[2], r[3], 0}, r[4]);
    }
  }

 private:
  template <class Velocity, class Pressure>
  static Cast make(const Vec3& v_wall, Velocity&& v_of, Pressure&& p_of) {
    Uniform random(32);
    const Bounds b = box(2, {10, 8, 0}, {true, false, false});
    Bounds below = b;
    below.low[1] = -3.0;
    below.high[1] = 0.0;
    std::vector<PhaseParticles> p;
    p.push_back(
        phase(2, lattice(below, 1.0, 0.0, random), 1.0, {Field::velocity, Field::wall_normal, Field::wall_depth}));
    p.push_back(phase(2, lattice(b, 1.0, 0.25, random), 1.2, {Field::velocity, Field::density, Field::pressure}, 1000));
    for (std::size_t k = 0; k < p[0].size(); ++k) {
      p[0].column(Field::wall_normal, 1)[k] = 1.0;
      p[0].column(Field::wall_depth)[k] = -position(p[0], k)[1];
      for (int d = 0; d < 2; ++d) p[0].column(Field::velocity, d)[k] = v_wall[static_cast<std::size_t>(d)];
    }
    for (std::size_t k = 0; k < p[1].size(); ++k) {
      const Vec3 x = position(p[1], k), v = v_of(x);
      p[1].column(Field::density)[k] = 1.2;
      p[1].column(Field::pressure)[k] = p_of(x);
      for (int d = 0; d < 2; ++d) p[1].column(Field::velocity, d)[k] = v[static_cast<std::size_t>(d)];
    }
    return Cast(b, std::move(p), {{0, 1, 3.0}});
  }
  Cast cast_;
};

double without_pressure(const Vec3&) { return 0.0; }

TEST(FlatWall, ALinearVelocityContinuesExactly) {
  const Vec3 v_wall{0.7, 0, 0};
  const Flat flat(
      v_wall, {}, Slip::no_slip,
      [](const Vec3& x) {
        return Vec3{0.7 + 3.0 * x[1], -0.5 * x[1], 0};
      },
      without_pressure);
  flat.each([](const Vec3& x, const Vec3& v, double) {
    EXPECT_NEAR(v[0], 0.7 + 3.0 * x[1], 1e-12);
    EXPECT_NEAR(v[1], -0.5 * x[1], 1e-12);
  });
}

TEST(FlatWall, FreeSlipKeepsTheTangentialAndReflectsTheNormal) {
  const Flat flat(
      {5.0, 0, 0}, {}, Slip::free_slip,
      [](const Vec3& x) {
        return Vec3{1.5, 2.0 * x[1], 0};
      },
      without_pressure);
  flat.each([](const Vec3& x, const Vec3& v, double) {
    EXPECT_NEAR(v[0], 1.5, 1e-12) << "whatever the wall does along itself";
    EXPECT_NEAR(v[1], 2.0 * x[1], 1e-12);
  });
}

// A particle that has come between two of the wall's, or stands on the surface, is met by a velocity against its own.
// With the sign of its depth it was met by twice its own: it felt the wall flee, and went through rigid bodies and
// paddles.
TEST(FlatWall, WhatComesInIsMetByAVelocityAgainstItsOwn) {
  for (const double y : {0.05, 0.0, -0.1, -0.3}) {
    std::vector<PhaseParticles> p;
    const std::vector<Vec3> wall{{-0.5, -0.5, 0}, {0.5, -0.5, 0}, {-0.5, -1.5, 0}, {0.5, -1.5, 0}};
    p.push_back(phase(2, wall, 1.0, {Field::velocity, Field::wall_normal, Field::wall_depth}));
    p.push_back(phase(2, {{0, y, 0}}, 1.2, {Field::velocity, Field::density, Field::pressure}, 1000));
    for (std::size_t k = 0; k < p[0].size(); ++k) {
      p[0].column(Field::wall_normal, 1)[k] = 1.0;
      p[0].column(Field::wall_depth)[k] = -position(p[0], k)[1];
    }
    p[1].column(Field::velocity, 1)[0] = -1.0;
    p[1].column(Field::density)[0] = 1.2;
    Cast cast(box(2, {10, 8, 0}, {false, false, false}), std::move(p), {{0, 1, 3.0}});
    const std::vector<ExtensionSource> fluid{{&cast.list(0), &cast.motion[1], KernelKind::wendland_c2, 3.0, 1.2}};
    ExtensionRule rule{Slip::no_slip};
    rule.least_phi = 0.25;
    extend_into_solid(cast.phases[0], cast.motion[0], fluid, Vec3{}, rule);
    for (std::size_t k = 0; k < cast.phases[0].size(); ++k)
      EXPECT_NEAR(cast.motion[0][k][3], -position(cast.phases[0], k)[1] * std::abs(y) / std::max(y * y, 0.25 * 0.25),
                  1e-12)
          << y;
  }
}

TEST(FlatWall, ARestingColumnGivesTheWallItsPressure) {
  const Vec3 gravity{0, -9.81, 0};
  const auto weight = [](const Vec3& x) { return 20.0 - 1.2 * 9.81 * x[1]; };
  const Flat flat(
      {}, gravity, Slip::no_slip, [](const Vec3&) { return Vec3{}; }, weight);
  flat.each([&](const Vec3& x, const Vec3& v, double p) {
    EXPECT_NEAR(p, weight(x), 1e-11);
    EXPECT_EQ(v[0], 0.0);
  });
}

/// Velocity that the air (2, 1 m/s) sees in grains (-1 m/s) on a lattice of the air: one alone in its site, and one in
/// the top row of a bed four rows deep. `drag`: whether a form drag acts.
std::array<Vec3, 2> seen_in_grains(bool drag) {
  Uniform random(33);
  const Bounds b = box(2, {14, 14, 0}, {true, false, false});
  std::vector<Vec3> air, grains{{6.5, 9.5, 0}, {6.5, 3.5, 0}};
  for (const Vec3& x : lattice(b, 1.0, 0.0, random)) {
    if (x[1] > 4.0 && norm(x - grains[0]) > 0.5) air.push_back(x);
    if (x[1] < 4.0 && norm(x - grains[1]) > 0.5) grains.push_back(x);
  }
  std::vector<PhaseParticles> p;
  p.push_back(phase(2, grains, 1.0, {Field::velocity}));
  p.push_back(phase(2, air, 1.2, {Field::velocity, Field::density, Field::pressure}, 1000));
  std::fill_n(p[0].column(Field::velocity), grains.size(), -1.0);
  std::fill_n(p[1].column(Field::velocity), air.size(), 2.0);
  std::fill_n(p[1].column(Field::velocity, 1), air.size(), 1.0);
  std::fill_n(p[1].column(Field::density), air.size(), 1.2);
  Cast cast(b, std::move(p), {{0, 1, 2.5}});
  double about = 0.0;  // the lattice without its middle
  for (int i = -2; i <= 2; ++i)
    for (int j = -2; j <= 2; ++j)
      if (i != 0 || j != 0) about += naive::weight(KernelKind::wendland_c2, 2.5, 2, std::hypot(i, j));
  const std::vector<ExtensionSource> fluid{
      {&cast.list(0), &cast.motion[1], KernelKind::wendland_c2, 2.5, 1.2, drag ? about : 0.0}};
  extend_into_solid(cast.phases[0], cast.motion[0], fluid, Vec3{}, ExtensionRule{Slip::no_slip, false, true});
  std::array<Vec3, 2> seen{};
  for (std::size_t k = 0; k < cast.phases[0].size(); ++k)
    if (const auto id = cast.phases[0].id()[k]; id < 2)
      seen[static_cast<std::size_t>(id)] = {cast.motion[0][k][2], cast.motion[0][k][3], 0};
  return seen;
}

TEST(GrainsWithDrag, AloneLetTheFluidPassInABedDoNot) {
  const auto seen = seen_in_grains(true);
  EXPECT_NEAR(seen[0][0], 2.0, 1e-12);
  EXPECT_NEAR(seen[0][1], 1.0, 1e-12);
  EXPECT_EQ(seen[1], (Vec3{-1, 0, 0}));
}

TEST(GrainsWithoutDrag, AreAlwaysWalls) {
  for (const Vec3& v : seen_in_grains(false)) EXPECT_EQ(v, (Vec3{-1, 0, 0}));
}

}  // namespace
}  // namespace barchan
