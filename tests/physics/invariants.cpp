// What the forces conserve on random patches, to round-off: momentum of a fluid of two phases at a density ratio of
// 2000, of elastic bodies and of grains; angular momentum where the law is central; the energy of a fluid; the power of
// elastic forces against the work of stress; and action and reaction between a fluid and grains.
#include <gtest/gtest.h>

#include "models/bodies/updated_lagrangian.hpp"
#include "models/fluid/energy.hpp"
#include "models/fluid/fluid_rates.hpp"
#include "models/pair_forces.hpp"
#include "unit/naive_fluid.hpp"

namespace barchan {
namespace {

using namespace sets;

/// Sums over phases of m q, and of |m q|, by component.
struct Balance {
  Vec3 sum{}, size{};
  void add(const Vec3& x) {
    for (std::size_t d = 0; d < 3; ++d) {
      sum[d] += x[d];
      size[d] += std::abs(x[d]);
    }
  }
  void expect_zero(int components, double tolerance) const {
    for (std::size_t d = 0; d < static_cast<std::size_t>(components); ++d) {
      EXPECT_GT(size[d], 0.0);
      EXPECT_NEAR(sum[d] / size[d], 0.0, tolerance) << "component " << d;
    }
  }
};

void add_forces(Balance& balance, const PhaseParticles& p) {
  for (std::size_t k = 0; k < p.size(); ++k) balance.add(p.mass() * vector(p, Field::acceleration, k));
}

Vec3 cross(const Vec3& a, const Vec3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

/// Torques about the origin: (z), or (x, y, z) in three dimensions.
void add_torques(Balance& balance, const PhaseParticles& p) {
  for (std::size_t k = 0; k < p.size(); ++k) {
    const Vec3 t = p.mass() * cross(position(p, k), vector(p, Field::acceleration, k));
    balance.add(p.dimensions() == 2 ? Vec3{t[2], 0, 0} : t);
  }
}

Bounds patch(int dimensions, bool periodic) {
  return dimensions == 2 ? box(2, {12, 10, 0}, {periodic, periodic, false})
                         : box(3, {7, 6, 6}, {periodic, periodic, periodic});
}

/// Two phases mixed at random on a perturbed lattice, the second `ratio` times as dense.
Cast mixture(int dimensions, bool periodic, double ratio, const std::vector<Field>& fields,
             const std::vector<Direction>& directions) {
  Uniform random(41);
  const Bounds b = patch(dimensions, periodic);
  std::vector<Vec3> one, other;
  for (const Vec3& x : lattice(b, 1.0, 0.3, random)) (random(0, 1) < 0.5 ? one : other).push_back(x);
  std::vector<PhaseParticles> p;
  p.push_back(phase(dimensions, one, 1.0, fields));
  p.push_back(phase(dimensions, other, ratio, fields, 10000));
  for (auto& q : p)
    for (const Field f : fields)
      if (f == Field::density) randomise(q, f, 0.9 * q.mass(), 1.1 * q.mass(), random);
      else randomise(q, f, -2.0, 5.0, random);
  return Cast(b, std::move(p), directions);
}

const std::vector<Field> fluid_fields{Field::velocity, Field::density, Field::pressure, Field::acceleration,
                                      Field::density_rate};
const std::vector<Direction> all_directions{{0, 0, 3.0}, {0, 1, 2.0}, {1, 0, 2.0}, {1, 1, 2.4}};

FluidParameters parameters() {
  FluidParameters q{};
  q.reference_density = 1.0;
  q.sound_speed = 10.0;
  q.diffusivity = 0.3;
  return q;
}

class Invariants : public ::testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Dimensions, Invariants, ::testing::Values(2, 3));

/// age: s, of the velocities when the forces act.
void rate_mixture(Cast& cast, double mu, double age = 0.0) {
  for (std::size_t a = 0; a < 2; ++a) {
    const std::size_t b = 1 - a;
    const double own_radius = cast.directions[a == 0 ? 0 : 3].radius;
    const std::vector<FluidNeighbour> n{
        {&cast.list(a == 0 ? 0 : 3), &cast.motion[a], KernelKind::wendland_c2, own_radius, 2.0 * mu, true},
        {&cast.list(a == 0 ? 1 : 2), &cast.motion[b], KernelKind::cubic_spline, 2.0, mu, false}};
    fluid_rates(cast.phases[a], cast.motion[a], n, parameters(), FluidScheme::plain);
    if (cast.phases[a].has(Field::energy_rate))
      fluid_energy(cast.phases[a], cast.motion[a], n, std::span<const SolidNeighbour>{}, age);
  }
}

TEST_P(Invariants, PlainFluidsOfRatio2000KeepTheirMomentum) {
  for (const double mu : {0.0, 3.0}) {
    Cast cast = mixture(GetParam(), true, 2000.0, fluid_fields, all_directions);
    rate_mixture(cast, mu);
    Balance momentum;
    for (const auto& p : cast.phases) add_forces(momentum, p);
    momentum.expect_zero(GetParam(), 1e-12);
  }
}

// What pressure and friction take from the motion, the internal energy gains.
TEST_P(Invariants, PlainFluidsKeepTheirEnergy) {
  for (const double mu : {0.0, 3.0}) {
    auto fields = fluid_fields;
    fields.push_back(Field::energy_rate);
    Cast cast = mixture(GetParam(), true, 2000.0, fields, all_directions);
    const double age = mu > 0.0 ? 1e-4 : 0.0;
    rate_mixture(cast, mu, age);
    Balance energy;
    for (const auto& p : cast.phases)
      for (std::size_t k = 0; k < p.size(); ++k) {
        const Vec3 gain = vector(p, Field::acceleration, k);
        energy.add({p.mass() * dot(vector(p, Field::velocity, k) + age * gain, gain), 0, 0});
        energy.add({p.mass() * p.column(Field::energy_rate)[k], 0, 0});
      }
    energy.expect_zero(1, 1e-12);
  }
}

// Pressure acts along the line of centres; the viscosity of Morris et al. 1997 does not.
TEST_P(Invariants, PressureKeepsTheAngularMomentumOfAPatch) {
  Cast cast = mixture(GetParam(), false, 2000.0, fluid_fields, all_directions);
  rate_mixture(cast, 0.0);
  Balance angular;
  for (const auto& p : cast.phases) add_torques(angular, p);
  angular.expect_zero(GetParam() == 2 ? 1 : 3, 1e-12);
}

const std::vector<Field> elastic_fields{Field::velocity, Field::density, Field::pressure, Field::stress,
                                        Field::acceleration};

/// Elastic phases with packed stress.
struct Bodies {
  Cast cast;
  std::vector<RecordArray> stress;
  ElasticParameters q{.reference_density = 1.0,
                      .shear_modulus = 0.5,
                      .bulk_modulus = 1.0,
                      .alpha = 0.0,
                      .beta = 0.0,
                      .sound_speed = 2.0,
                      .gravity = {}};
  Bodies(int dimensions, bool periodic, double ratio, bool pressure_only,
         const std::vector<Field>& fields = elastic_fields)
      : cast(mixture(dimensions, periodic, ratio, fields, all_directions)) {
    for (auto& p : cast.phases) {
      if (pressure_only)
        for (int c = 0; c < 6; ++c) std::fill_n(p.column(Field::stress, c), p.size(), 0.0);
      stress.emplace_back(dimensions == 2 ? StressRecord<2>::size : StressRecord<3>::size);
    }
    pack();
  }
  void pack() {
    for (std::size_t k = 0; k < 2; ++k) {
      stress[k].resize(cast.phases[k].size(), cast.neighbours.grid(k).images());
      pack_stress(cast.phases[k], stress[k]);
      stress[k].fill_images(cast.neighbours.grid(k), cast.bounds.dimensions);
    }
  }
  std::vector<ElasticNeighbour> neighbours(std::size_t a) const {
    const std::size_t b = 1 - a;
    const double own_radius = cast.directions[a == 0 ? 0 : 3].radius;
    return {{&cast.list(a == 0 ? 0 : 3), &stress[a], KernelKind::wendland_c2, own_radius, cast.phases[a].mass()},
            {&cast.list(a == 0 ? 1 : 2), &stress[b], KernelKind::cubic_spline, 2.0, cast.phases[b].mass()}};
  }
  void force() {
    for (std::size_t a = 0; a < 2; ++a) elastic_forces(cast.phases[a], stress[a], neighbours(a), q);
  }
};

TEST_P(Invariants, ElasticBodiesKeepTheirMomentum) {
  for (const double alpha : {0.0, 1.5}) {
    Bodies bodies(GetParam(), true, 30.0, false);
    bodies.q.alpha = alpha;
    bodies.q.beta = 0.5 * alpha;
    bodies.force();
    Balance momentum;
    for (const auto& p : bodies.cast.phases) add_forces(momentum, p);
    momentum.expect_zero(GetParam(), 1e-12);
  }
}

// Pressure and Monaghan's viscosity are central. Shear stress is not: uncorrected, it turns a patch.
TEST_P(Invariants, PressureAndViscosityOfBodiesKeepTheirAngularMomentum) {
  Bodies bodies(GetParam(), false, 30.0, true);
  bodies.q.alpha = 1.5;
  bodies.q.beta = 0.5;
  bodies.force();
  Balance angular;
  for (const auto& p : bodies.cast.phases) add_torques(angular, p);
  angular.expect_zero(GetParam() == 2 ? 1 : 3, 1e-12);
}

// What stress and viscosity take from the motion, the internal energy gains (eq. 13).
TEST_P(Invariants, ElasticBodiesKeepTheirEnergy) {
  auto fields = elastic_fields;
  fields.push_back(Field::energy_rate);
  for (const double alpha : {0.0, 1.5}) {
    Bodies bodies(GetParam(), true, 7.0, false, fields);
    bodies.q.alpha = alpha;
    bodies.force();
    Balance energy;
    for (const auto& p : bodies.cast.phases)
      for (std::size_t k = 0; k < p.size(); ++k) {
        energy.add({p.mass() * dot(vector(p, Field::velocity, k), vector(p, Field::acceleration, k)), 0, 0});
        energy.add({p.mass() * p.column(Field::energy_rate)[k], 0, 0});
      }
    energy.expect_zero(1, 1e-12);
  }
}

// sum m v.a = -sum V sigma : grad v: what the forces do to the motion, the strain pass finds as work of the stress.
// Masses and densities are 1. From zero stress and with 2 G = 1, a very short strain pass leaves dt dev(D); the density
// it changes by -dt tr(D), whatever the length.
TEST_P(Invariants, ElasticPowerIsTheWorkOfStress) {
  Bodies bodies(GetParam(), true, 1.0, false);
  for (auto& p : bodies.cast.phases) std::fill_n(p.column(Field::density), p.size(), 1.0);
  bodies.pack();
  bodies.force();
  constexpr int places[3][3] = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}};
  double power = 0.0, work = 0.0, size = 0.0;
  for (std::size_t a = 0; a < 2; ++a) {
    auto& p = bodies.cast.phases[a];
    const PhaseParticles before = p;
    for (int c = 0; c < 6; ++c) std::fill_n(p.column(Field::stress, c), p.size(), 0.0);
    constexpr double dt = 1e-9;
    elastic_strain(p, bodies.stress[a], bodies.neighbours(a), bodies.q, dt);
    const PhaseParticles strained = p;
    std::fill_n(p.column(Field::density), p.size(), 1.0);
    elastic_strain(p, bodies.stress[a], bodies.neighbours(a), bodies.q, 1.0);
    for (std::size_t k = 0; k < p.size(); ++k) {
      const double of_force = dot(vector(p, Field::velocity, k), vector(p, Field::acceleration, k));
      power += of_force;
      size += std::abs(of_force);
      const double trace = 1.0 - p.column(Field::density)[k];
      for (std::size_t d = 0; d < static_cast<std::size_t>(GetParam()); ++d)
        for (std::size_t e = 0; e < static_cast<std::size_t>(GetParam()); ++e) {
          const double rate = strained.column(Field::stress, places[d][e])[k] / dt + (d == e ? trace / 3.0 : 0.0);
          work += rate *
                  (before.column(Field::stress, places[d][e])[k] - (d == e ? before.column(Field::pressure)[k] : 0.0));
        }
    }
  }
  EXPECT_GT(std::abs(power), 1e-3 * size) << "the patch does something";
  EXPECT_NEAR((power + work) / size, 0.0, 1e-8);  // dt times the spin
}

TEST_P(Invariants, GrainsKeepMomentumAndAngularMomentum) {
  for (const bool periodic : {true, false}) {
    Cast cast = mixture(GetParam(), periodic, 5.0, {Field::velocity, Field::acceleration},
                        {{0, 0, 1.3}, {0, 1, 1.1}, {1, 0, 1.1}, {1, 1, 1.3}});
    for (auto& p : cast.phases)
      for (int d = 0; d < GetParam(); ++d) std::fill_n(p.column(Field::acceleration, d), p.size(), 0.0);
    for (std::size_t q = 0; q < 4; ++q) {
      const auto& [a, b, radius] = cast.directions[q];
      const auto law = with_kernel<double>(KernelKind::cubic_spline, radius, GetParam(), [](const auto& kernel) {
        return KernelContacts{{}, {40.0, 0.9, kernel.value(1.0), 1.0 / std::abs(kernel.derivative(1.0))}};
      });
      pair_forces(cast.phases[a], cast.motion[a],
                  PairEntry<KernelContacts>{&cast.list(q), &cast.motion[b], KernelKind::cubic_spline, radius, law});
    }
    Balance momentum, angular;
    for (const auto& p : cast.phases) {
      add_forces(momentum, p);
      if (!periodic) add_torques(angular, p);
    }
    momentum.expect_zero(GetParam(), 1e-12);
    if (!periodic) angular.expect_zero(GetParam() == 2 ? 1 : 3, 1e-12);
  }
}

// What grains add to the fluid's acceleration, the fluid does to the grains: the pores are left open here.
TEST_P(Invariants, FluidAndGrainsActAndReact) {
  Cast cast = mixture(GetParam(), true, 2000.0, fluid_fields, all_directions);
  auto &fluid = cast.phases[0], &grains = cast.phases[1];
  const FluidNeighbour own{&cast.list(0), &cast.motion[0], KernelKind::wendland_c2, 3.0, 2.0, true};
  const FluidNeighbour solid{&cast.list(1), &cast.motion[1], KernelKind::wendland_c2, 2.0, 1.5, true};
  const FluidNeighbour back{&cast.list(2), &cast.motion[0], KernelKind::wendland_c2, 2.0, 1.5, false};
  Balance both;
  fluid_rates(fluid, cast.motion[0], std::vector{own, solid}, parameters(), FluidScheme::plain);
  add_forces(both, fluid);  // the fluid's own entry adds up to nothing
  for (int d = 0; d < GetParam(); ++d) std::fill_n(grains.column(Field::acceleration, d), grains.size(), 0.0);
  fluid_reaction(grains, cast.motion[1], back, false);
  Balance on_grains;
  add_forces(on_grains, grains);
  add_forces(both, grains);
  both.expect_zero(GetParam(), 1e-12);
  EXPECT_GT(std::abs(on_grains.sum[0]), 1e-6 * on_grains.size[0]) << "the grains do feel the fluid";
}

}  // namespace
}  // namespace barchan
