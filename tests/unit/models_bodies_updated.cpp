// The passes of solids against naive twins written from the formulas in their headers: strain and force of elastic
// bodies, contacts, the fluid continued into walls, the fluid's reaction; and that a linear velocity continues exactly.
#include <gtest/gtest.h>

#include "kernels/kernel.hpp"
#include "laws/elastic.hpp"
#include "models/bodies/artificial_stress.hpp"
#include "models/bodies/updated_lagrangian.hpp"
#include "models/pair_forces.hpp"
#include "models/walls/walls.hpp"
#include "unit/naive_fluid.hpp"

namespace barchan {
namespace {

using namespace sets;
using naive::gradient_factor;
using naive::Matrix;
using naive::volume;

constexpr double rounding = 1e-12;
constexpr int places[3][3] = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}};  // of a stress in the field: xx yy zz xy yz xz

/// Two touching phases on a perturbed periodic lattice, all fields random.
Cast two_phases(int dimensions, const std::vector<Field>& fields, std::vector<Direction> directions,
                std::uint64_t seed) {
  Uniform random(seed);
  const Bounds b = dimensions == 2 ? box(2, {9, 7, 0}, {true, true, false}) : box(3, {5, 6, 5}, {true, false, true});
  std::vector<Vec3> left, right;
  for (const Vec3& x : lattice(b, 1.0, 0.2, random)) (x[1] < 3.5 ? left : right).push_back(x);
  std::vector<PhaseParticles> two;
  two.push_back(phase(dimensions, left, 1.3, fields));
  two.push_back(phase(dimensions, right, 0.6, fields, 1000));
  for (auto& p : two)
    for (const Field f : fields) {
      const bool density = f == Field::density, depth = f == Field::wall_depth;
      randomise(p, f, density ? 0.9 : depth ? -1.0 : -2.0, density ? 1.2 : 1.5, random);
    }
  return Cast(b, std::move(two), std::move(directions));
}

Matrix stress_of(const PhaseParticles& p, std::size_t k) {
  Matrix s{};
  for (std::size_t d = 0; d < 3; ++d)
    for (std::size_t e = 0; e < 3; ++e) s[d][e] = p.column(Field::stress, places[d][e])[k];
  return s;
}

/// 2 G dev(D) + s W^T + W s.
Matrix stress_rate(const Matrix& s, const Matrix& l, double shear) {
  Matrix rate{};
  const double third = (l[0][0] + l[1][1] + l[2][2]) / 3.0;
  for (std::size_t d = 0; d < 3; ++d)
    for (std::size_t e = 0; e < 3; ++e) {
      rate[d][e] = shear * (l[d][e] + l[e][d]) - (d == e ? 2.0 * shear * third : 0.0);
      for (std::size_t f = 0; f < 3; ++f) {
        const double spin_df = 0.5 * (l[d][f] - l[f][d]), spin_ef = 0.5 * (l[e][f] - l[f][e]);
        rate[d][e] += s[d][f] * spin_ef + spin_df * s[f][e];
      }
    }
  return rate;
}

struct ElasticStage {
  Cast cast;
  std::vector<RecordArray> stress, artificial;
  std::vector<ElasticNeighbour> neighbours;
  ElasticParameters q{.reference_density = 1.05,
                      .shear_modulus = 7.0,
                      .bulk_modulus = 11.0,
                      .alpha = 0.9,
                      .beta = 0.4,
                      .sound_speed = 3.0,
                      .gravity = {0.2, -9.81, 0}};
  static constexpr double own_radius = 2.4, other_radius = 1.6;

  explicit ElasticStage(int dimensions)
      : cast(two_phases(
            dimensions,
            {Field::velocity, Field::density, Field::pressure, Field::stress, Field::acceleration, Field::energy_rate},
            {{0, 0, own_radius}, {0, 1, other_radius}}, 21)) {
    for (std::size_t k = 0; k < 2; ++k) {
      // Plane strain: no shear out of the plane.
      for (int c = 4; dimensions == 2 && c < 6; ++c)
        std::fill_n(cast.phases[k].column(Field::stress, c), cast.phases[k].size(), 0.0);
      stress.emplace_back(dimensions == 2 ? StressRecord<2>::size : StressRecord<3>::size);
      stress[k].resize(cast.phases[k].size(), cast.neighbours.grid(k).images());
      pack_stress(cast.phases[k], stress[k]);
      stress[k].fill_images(cast.neighbours.grid(k), dimensions);
    }
    neighbours = {{&cast.list(0), &stress[0], KernelKind::wendland_c2, own_radius, cast.phases[0].mass()},
                  {&cast.list(1), &stress[1], KernelKind::cubic_spline, other_radius, cast.phases[1].mass()}};
  }
  /// Gives both phases artificial stress; the second none of its own.
  void pull() {
    const int dimensions = cast.bounds.dimensions;
    for (std::size_t k = 0; k < 2; ++k) {
      artificial.emplace_back(ArtificialStressRecord::size);
      artificial[k].resize(cast.phases[k].size(), cast.neighbours.grid(k).images());
      pack_artificial_stress(cast.phases[k], k == 0 ? 0.3 : 0.0, artificial[k]);
      artificial[k].fill_images(cast.neighbours.grid(k), 0);
    }
    for (std::size_t b = 0; b < 2; ++b) {
      neighbours[b].artificial = &artificial[b];
      neighbours[b].inverse_weight = 1.0 / naive::weight(neighbours[b].kernel, neighbours[b].radius, dimensions, 1.0);
    }
  }
  /// Calls f(b, j, r, F, h) for every neighbour of particle k of phase 0.
  template <class F>
  void for_neighbours(std::size_t k, F&& f) const {
    for (std::size_t b = 0; b < 2; ++b) {
      const auto& e = neighbours[b];
      for_all_pairs(cast.bounds, cast.phases[0], k, cast.phases[b], b == 0, e.radius,
                    [&](std::size_t j, const Vec3& r, const std::array<int, 3>&) {
                      f(cast.phases[b], j, r, gradient_factor(e.kernel, e.radius, cast.bounds.dimensions, norm(r)),
                        0.5 * e.radius);
                    });
    }
  }
};

class ElasticPasses : public ::testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Dimensions, ElasticPasses, ::testing::Values(2, 3));

TEST_P(ElasticPasses, StrainEqualsTheNaiveSums) {
  const int dimensions = GetParam();
  ElasticStage stage(dimensions);
  const double dt = 0.01;
  auto& body = stage.cast.phases[0];
  std::vector<double> rho, pressure;
  std::array<std::vector<double>, 6> stress;
  for (std::size_t k = 0; k < body.size(); ++k) {
    const Vec3 v_a = vector(body, Field::velocity, k);
    Matrix l{}, mid{};
    double drho = 0.0;
    stage.for_neighbours(k, [&](const PhaseParticles& b, std::size_t j, const Vec3& r, double f, double) {
      const Vec3 v_ab = v_a - vector(b, Field::velocity, j);
      for (std::size_t d = 0; d < 3; ++d) l[d] = l[d] - volume(b, j) * v_ab[d] * f * r;
      drho += b.mass() * f * dot(v_ab, r);
    });
    const Matrix old = stress_of(body, k), first = stress_rate(old, l, stage.q.shear_modulus);
    for (std::size_t d = 0; d < 3; ++d) mid[d] = old[d] + 0.5 * dt * first[d];
    const Matrix rate = stress_rate(mid, l, stage.q.shear_modulus);
    for (std::size_t d = 0; d < 3; ++d)
      for (std::size_t e = 0; e <= d; ++e)
        stress[static_cast<std::size_t>(places[d][e])].push_back(old[d][e] + dt * rate[d][e]);
    rho.push_back(body.column(Field::density)[k] + dt * drho);
    pressure.push_back(stage.q.bulk_modulus / stage.q.reference_density * (rho.back() - stage.q.reference_density));
  }
  elastic_strain(body, stage.stress[0], stage.neighbours, stage.q, dt);
  EXPECT_LT(difference(body.column(Field::density), rho), rounding);
  EXPECT_LT(difference(body.column(Field::pressure), pressure), rounding);
  for (int c = 4; dimensions == 2 && c < 6; ++c)
    for (std::size_t k = 0; k < body.size(); ++k) EXPECT_EQ(body.column(Field::stress, c)[k], 0.0);
  for (int c = 0; c < (dimensions == 2 ? 4 : 6); ++c)
    EXPECT_LT(difference(body.column(Field::stress, c), stress[static_cast<std::size_t>(c)]), rounding)
        << "component " << c;
}

TEST_P(ElasticPasses, ForcesEqualTheNaiveSums) {
  const int dimensions = GetParam();
  for (const int which : {0, 1, 2, 3}) {
    const bool viscous = which % 2 == 1, pulled = which / 2 == 1;
    ElasticStage stage(dimensions);
    auto& q = stage.q;
    if (!viscous) q.alpha = q.beta = 0.0;
    if (pulled) stage.pull();
    // R of particle k of a phase, and f^4.
    const auto artificial = [&](const PhaseParticles& p, std::size_t k) {
      Matrix s{};
      for (std::size_t d = 0; pulled && d < static_cast<std::size_t>(dimensions); ++d)
        for (std::size_t e = 0; e < static_cast<std::size_t>(dimensions); ++e)
          s[d][e] = stage.artificial[&p == &stage.cast.phases[0] ? 0 : 1][k]
                                    [dimensions == 2 ? stress_index<2>(d, e) : stress_index<3>(d, e)];
      return s;
    };
    const auto nearness = [&](const PhaseParticles& p, const Vec3& r) {
      const ElasticNeighbour& e = stage.neighbours[&p == &stage.cast.phases[0] ? 0 : 1];
      return std::pow(
          naive::weight(e.kernel, e.radius, dimensions, norm(r)) / naive::weight(e.kernel, e.radius, dimensions, 1.0),
          4);
    };
    auto& body = stage.cast.phases[0];
    std::array<std::vector<double>, 3> expected;
    std::vector<double> heating;  // eq. (13), half of what each pair takes from the motion
    const auto sigma = [](const PhaseParticles& p, std::size_t k) {  // (s - p I)/rho^2
      Matrix s = stress_of(p, k);
      const double rho = p.column(Field::density)[k];
      for (std::size_t d = 0; d < 3; ++d) {
        s[d][d] -= p.column(Field::pressure)[k];
        s[d] = 1.0 / (rho * rho) * s[d];
      }
      return s;
    };
    for (std::size_t k = 0; k < body.size(); ++k) {
      const Matrix s_a = sigma(body, k), r_a = artificial(body, k);
      const Vec3 v_a = vector(body, Field::velocity, k);
      Vec3 dv = q.gravity;
      double power = 0.0;
      stage.for_neighbours(k, [&](const PhaseParticles& b, std::size_t j, const Vec3& r, double f, double h) {
        const Matrix s_b = sigma(b, j), r_b = artificial(b, j);
        const double near = pulled ? nearness(b, r) : 0.0;
        const Vec3 v_ab = v_a - vector(b, Field::velocity, j);
        const double vr = dot(v_ab, r), mu = vr < 0 ? h * vr / (dot(r, r) + 0.01 * h * h) : 0.0;
        const double resistance = (-q.alpha * q.sound_speed * mu + q.beta * mu * mu) / q.reference_density;
        for (std::size_t d = 0; d < 3; ++d) {
          const double pair = b.mass() * f * (dot(s_a[d] + s_b[d] + near * (r_a[d] + r_b[d]), r) - resistance * r[d]);
          dv[d] += pair;
          power += pair * v_ab[d];
        }
      });
      for (std::size_t d = 0; d < 3; ++d) expected[d].push_back(dv[d]);
      heating.push_back(-0.5 * power);
    }
    elastic_forces(body, stage.stress[0], stage.neighbours, q, pulled ? &stage.artificial[0] : nullptr);
    EXPECT_LT(difference(body.column(Field::energy_rate), heating), rounding);
    for (int d = 0; d < dimensions; ++d)
      EXPECT_LT(difference(body.column(Field::acceleration, d), expected[static_cast<std::size_t>(d)]), rounding);
  }
}

// Stresses with known principal values, of any sign and some of them equal, in random axes.
TEST_P(ElasticPasses, ArtificialStressIsOfWhatPulls) {
  const int dimensions = GetParam();
  const auto size = static_cast<std::size_t>(dimensions);
  Uniform random(5);
  PhaseParticles body =
      phase(dimensions, std::vector<Vec3>(200), 1.0, {Field::density, Field::pressure, Field::stress});
  std::vector<Matrix> expected;
  for (std::size_t k = 0; k < body.size(); ++k) {
    Vec3 principal{random(-2, 2), random(-2, 2), random(-2, 2)};
    if (k % 4 == 0) principal[1] = principal[0];
    if (k % 10 == 0) principal[2] = 0.0;
    const double t = random(0, 7), u = dimensions == 3 ? random(0, 7) : 0.0;
    const Matrix axes{Vec3{std::cos(t) * std::cos(u), std::sin(t) * std::cos(u), std::sin(u)},
                      Vec3{-std::sin(t), std::cos(t), 0.0},
                      Vec3{-std::cos(t) * std::sin(u), -std::sin(t) * std::sin(u), std::cos(u)}};
    Matrix s{}, pulls{};
    for (std::size_t q = 0; q < size; ++q)
      for (std::size_t d = 0; d < 3; ++d) {
        s[d] = s[d] + principal[q] * axes[q][d] * axes[q];
        pulls[d] = pulls[d] + std::max(principal[q], 0.0) * axes[q][d] * axes[q];
      }
    const double rho = random(0.5, 2.0), p = random(-1, 1);
    body.column(Field::density)[k] = rho;
    body.column(Field::pressure)[k] = p;
    for (std::size_t d = 0; d < 3; ++d) {
      for (std::size_t e = 0; e <= d; ++e) body.column(Field::stress, places[d][e])[k] = s[d][e] + (d == e ? p : 0.0);
      pulls[d] = -0.3 / (rho * rho) * pulls[d];
    }
    expected.push_back(pulls);
  }
  RecordArray records(ArtificialStressRecord::size);
  records.resize(body.size(), 0);
  pack_artificial_stress(body, 0.3, records);
  for (std::size_t k = 0; k < body.size(); ++k)
    for (std::size_t d = 0; d < size; ++d)
      for (std::size_t e = 0; e <= d; ++e)
        EXPECT_NEAR(records[k][dimensions == 2 ? stress_index<2>(d, e) : stress_index<3>(d, e)], expected[k][d][e],
                    1e-13)
            << k;
}

class SolidPasses : public ::testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Dimensions, SolidPasses, ::testing::Values(2, 3));

TEST_P(SolidPasses, ContactsEqualTheNaiveSums) {
  const int dimensions = GetParam();
  Cast cast = two_phases(dimensions, {Field::velocity, Field::acceleration}, {{0, 0, 1.1}, {0, 1, 1.3}}, 22);
  auto& grains = cast.phases[0];
  std::array<std::vector<double>, 3> expected;
  for (std::size_t k = 0; k < grains.size(); ++k)
    for (std::size_t d = 0; d < 3; ++d)
      expected[d].push_back(d < static_cast<std::size_t>(dimensions) ? vector(grains, Field::acceleration, k)[d] : 0.0);
  for (std::size_t b = 0; b < 2; ++b) {
    const double radius = cast.directions[b].radius, damping = b == 0 ? 0.7 : 0.0, stiffness = 30.0;
    const auto w = [&](double r) { return naive::weight(KernelKind::cubic_spline, radius, dimensions, r); };
    const auto slope = [&](double r) { return r * gradient_factor(KernelKind::cubic_spline, radius, dimensions, r); };
    const KernelContacts law{{}, {stiffness, damping, w(1.0), 1.0 / std::abs(slope(1.0))}};
    for (std::size_t k = 0; k < grains.size(); ++k)
      for_all_pairs(
          cast.bounds, grains, k, cast.phases[b], b == 0, radius,
          [&](std::size_t j, const Vec3& r, const std::array<int, 3>&) {
            const double distance = norm(r);
            if (distance >= 1.0) return;  // the rest distance
            const double g = (w(distance) - w(1.0)) / std::abs(slope(1.0)), ratio = slope(distance) / slope(1.0);
            const double v_n =
                dot(vector(grains, Field::velocity, k) - vector(cast.phases[b], Field::velocity, j), r) / distance;
            const double force = stiffness * g * ratio - damping * ratio * v_n;
            for (std::size_t d = 0; d < 3; ++d) expected[d][k] += force * r[d] / distance / grains.mass();
          });
    pair_forces(grains, cast.motion[0],
                PairEntry<KernelContacts>{&cast.list(b), &cast.motion[b], KernelKind::cubic_spline, radius, law});
  }
  for (int d = 0; d < dimensions; ++d)
    EXPECT_LT(difference(grains.column(Field::acceleration, d), expected[static_cast<std::size_t>(d)]), rounding);
}

// Two grains and a particle of the wall in one place: no direction, no force, whatever their velocities.
TEST_P(SolidPasses, CoincidentGrainsFeelNothing) {
  const int dimensions = GetParam();
  for (const KernelKind kernel : {KernelKind::cubic_spline, KernelKind::wendland_c2}) {
    const Bounds b = box(dimensions, {9, 8, 7}, {true, false, false});
    const Vec3 place{4.3, 3.7, dimensions == 3 ? 2.9 : 0.0};
    std::vector<PhaseParticles> two;
    two.push_back(phase(dimensions, {place, place}, 1.0, {Field::velocity, Field::acceleration}));
    two.push_back(phase(dimensions, {place}, 1.0, {Field::velocity}, 10));
    two[0].column(Field::velocity, 0)[0] = 3.0;
    Cast cast(b, std::move(two), {{0, 0, 1.1}, {0, 1, 1.1}});
    const auto law = with_kernel<double>(kernel, 1.1, dimensions, [](const auto& w) {
      return KernelContacts{{}, {40.0, 0.9, w.value(1.0), 1.0 / std::abs(w.derivative(1.0))}};
    });
    for (std::size_t q = 0; q < 2; ++q) {
      ASSERT_EQ(cast.list(q).entries(), 2u);
      pair_forces(cast.phases[0], cast.motion[0],
                  PairEntry<KernelContacts>{&cast.list(q), &cast.motion[q], kernel, 1.1, law});
      for (int d = 0; d < dimensions; ++d)
        for (std::size_t k = 0; k < 2; ++k) EXPECT_EQ(cast.phases[0].column(Field::acceleration, d)[k], 0.0);
    }
  }
}

TEST_P(SolidPasses, ReactionEqualsTheNaiveSums) {
  const int dimensions = GetParam();
  for (const bool pores : {false, true}) {
    Cast cast = two_phases(dimensions, {Field::velocity, Field::density, Field::pressure, Field::acceleration},
                           {{0, 1, 2.5}}, 23);
    auto& grains = cast.phases[0];
    const PhaseParticles& fluid = cast.phases[1];
    std::array<std::vector<double>, 3> expected;
    for (std::size_t k = 0; k < grains.size(); ++k) {
      Vec3 force{};
      const double p_w = grains.column(Field::pressure)[k];
      for_all_pairs(cast.bounds, grains, k, fluid, false, 2.5,
                    [&](std::size_t j, const Vec3& r, const std::array<int, 3>&) {
                      const double vvf = volume(grains, k) * volume(fluid, j) *
                                         gradient_factor(KernelKind::wendland_c2, 2.5, dimensions, norm(r));
                      const Vec3 v = vector(grains, Field::velocity, k) - vector(fluid, Field::velocity, j);
                      const double p = p_w + fluid.column(Field::pressure)[j] - (pores ? 2.0 * p_w : 0.0);
                      force = force - vvf * p * r + 2.0 * 0.8 * vvf * v;
                    });
      const Vec3 a = vector(grains, Field::acceleration, k) + 1.0 / grains.mass() * force;
      for (std::size_t d = 0; d < 3; ++d) expected[d].push_back(a[d]);
    }
    fluid_reaction(grains, cast.motion[0],
                   FluidNeighbour{&cast.list(0), &cast.motion[1], KernelKind::wendland_c2, 2.5, 0.8, false}, pores);
    for (int d = 0; d < dimensions; ++d)
      EXPECT_LT(difference(grains.column(Field::acceleration, d), expected[static_cast<std::size_t>(d)]), rounding);
  }
}

}  // namespace
}  // namespace barchan
