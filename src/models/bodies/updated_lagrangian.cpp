#include "models/bodies/updated_lagrangian.hpp"

#include <algorithm>
#include <array>

#include "engine/fours.hpp"
#include "engine/shares.hpp"
#include "kernels/kernel.hpp"
#include "laws/elastic.hpp"

namespace barchan::BARCHAN_TARGET {

namespace {

/// The field's order: xx yy zz xy yz xz.
constexpr std::size_t column_of[3][3] = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}};

template <int Dim>
void pack(const PhaseParticles& body, RecordArray& records) {
  using R = StressRecord<Dim>;
  const double mass = body.mass();
  const double *rho = body.column(Field::density), *p = body.column(Field::pressure);
  std::array<const double*, Dim> x{}, v{};
  std::array<const double*, 6> stress{};
  for (std::size_t d = 0; d < Dim; ++d) {
    x[d] = body.column(Field::position, static_cast<int>(d));
    v[d] = body.column(Field::velocity, static_cast<int>(d));
  }
  for (std::size_t d = 0; d < Dim; ++d)
    for (std::size_t e = 0; e <= d; ++e)
      stress[column_of[d][e]] = body.column(Field::stress, static_cast<int>(column_of[d][e]));
  const std::size_t n = body.size();
  const auto fours = static_cast<std::int64_t>((n + 3) / 4);
#pragma omp parallel for schedule(static)
  for (std::int64_t q = 0; q < fours; ++q) {
    const std::size_t k = 4 * static_cast<std::size_t>(q), count = std::min(n - k, std::size_t{4});
    std::array<Four, R::volume + 1> values;
    for (std::size_t d = 0; d < Dim; ++d) {
      values[R::position + d] = load_four(x[d], k, count);
      values[R::velocity + d] = load_four(v[d], k, count);
    }
    const Four density = load_four(rho, k, count), pressure = load_four(p, k, count);
    const Four inverse = Four(1.0) / (density * density);
    for (std::size_t d = 0; d < Dim; ++d)
      for (std::size_t e = 0; e <= d; ++e) {
        const Four s = load_four(stress[column_of[d][e]], k, count);
        values[static_cast<std::size_t>(R::stress) + stress_index<Dim>(d, e)] = (d == e ? s - pressure : s) * inverse;
      }
    values[R::volume] = Four(mass) / density;
    if (count == 4) {
      store_records(values, records[k], R::size);
    } else {
      for (std::size_t lane = 0; lane < count; ++lane)
        for (std::size_t f = 0; f < values.size(); ++f) records[k + lane][f] = values[f][static_cast<int>(lane)];
    }
  }
}

/// A symmetric stress of four particles: the components that the dimensions have, and zz in two (plane strain).
template <int Dim>
struct Stress {
  std::array<std::array<Four, Dim>, Dim> in;
  Four zz;  // two dimensions only
};
template <int Dim>
using Gradient = std::array<std::array<Four, Dim>, Dim>;  // row: component of v

/// 2 G dev(D) + s.W^T + W.s at stress s.
template <int Dim>
BARCHAN_SIMD_INLINE Stress<Dim> stress_rate(const Stress<Dim>& s, const Gradient<Dim>& l, Four shear_modulus) {
  Stress<Dim> rate;
  Four third(0.0);
  for (std::size_t d = 0; d < Dim; ++d) third += l[d][d];
  third *= Four(2.0 / 3.0) * shear_modulus;
  const auto spin = [&](std::size_t d, std::size_t e) { return Four(0.5) * (l[d][e] - l[e][d]); };
  for (std::size_t d = 0; d < Dim; ++d)
    for (std::size_t e = 0; e <= d; ++e) {
      Four sum = shear_modulus * (l[d][e] + l[e][d]);
      if (d == e) sum -= third;
      for (std::size_t f = 0; f < Dim; ++f) {
        if (f != e) sum = simd::fma(s.in[d][f], spin(e, f), sum);
        if (f != d) sum = simd::fma(spin(d, f), s.in[f][e], sum);
      }
      rate.in[d][e] = rate.in[e][d] = sum;
    }
  rate.zz = -third;
  return rate;
}

template <int Dim>
BARCHAN_SIMD_INLINE Stress<Dim> advance(const Stress<Dim>& s, Four time, const Stress<Dim>& rate) {
  Stress<Dim> r;
  for (std::size_t d = 0; d < Dim; ++d)
    for (std::size_t e = 0; e < Dim; ++e) r.in[d][e] = simd::fma(time, rate.in[d][e], s.in[d][e]);
  r.zz = simd::fma(time, rate.zz, s.zz);
  return r;
}

std::vector<ReadyKernel>& ready_kernels(std::span<const ElasticNeighbour> neighbours, int dimensions) {
  thread_local std::vector<ReadyKernel> kernels;
  kernels.reserve(16);
  kernels.clear();
  for (const auto& e : neighbours) kernels.emplace_back(e.kernel, e.radius, dimensions);
  return kernels;
}

template <int Dim>
void strain(PhaseParticles& body, const RecordArray& own_records, std::span<const ElasticNeighbour> neighbours,
            const ElasticParameters& q, double dt) {
  using R = StressRecord<Dim>;
  using Law = ElasticStrain<Dim>;
  double *rho = body.column(Field::density), *p = body.column(Field::pressure);
  std::array<double*, 6> stress{};
  for (int c = 0; c < 6; ++c) stress[static_cast<std::size_t>(c)] = body.column(Field::stress, c);
  const auto& kernels = ready_kernels(neighbours, Dim);
  const Four time(dt), half(0.5 * dt), shear(q.shear_modulus), stiffness(q.bulk_modulus / q.reference_density);
  const std::size_t n = body.size();
  const auto fours = static_cast<std::int64_t>((n + 3) / 4);
  Shares shares(fours, 64);
#pragma omp parallel
  for (const std::int64_t block : shares) {
    const std::size_t first = 4 * static_cast<std::size_t>(block), count = std::min<std::size_t>(4, n - first);
    std::array<typename Law::template Sums<Lanes>, 4> sums;
    for (std::size_t lane = 0; lane < 4; ++lane) {
      const std::size_t k = std::min(first + lane, n - 1);
      const double* record = own_records[k];
      std::array<Lanes, Dim> x, v;
      for (std::size_t d = 0; d < Dim; ++d) {
        x[d] = Lanes(record[R::position + d]);
        v[d] = Lanes(record[R::velocity + d]);
      }
      typename Law::template Sums<Lanes> s{};
      for (std::size_t c = 0; c < neighbours.size(); ++c) {
        const auto& e = neighbours[c];
        const auto row = e.row(k);
        const Lanes mass(e.mass);
        kernels[c]([&](const auto& kernel) __attribute__((always_inline)) {
          for_each_neighbour<R::size>(
              row, *e.records, [&](const Lanes* b) __attribute__((always_inline)) {
                std::array<Lanes, Dim> r;
                const Lanes r2 = separation<Dim>(x, b + R::position, r);
                Law::add(v, mass, r, kernel.gradient(r2), b + R::velocity, b[R::volume], s);
              });
        });
      }
      sums[lane] = s;
    }
    const auto s = reduce<typename Law::template Sums<Four>, double>(sums);
    Gradient<Dim> l;
    Stress<Dim> old;
    for (std::size_t d = 0; d < Dim; ++d)
      for (std::size_t e = 0; e < Dim; ++e) {
        l[d][e] = -s.gradient[d * Dim + e];
        old.in[d][e] = load_four(stress[column_of[d][e]], first, count);
      }
    old.zz = load_four(stress[2], first, count);
    const Stress<Dim> mid = advance(old, half, stress_rate<Dim>(old, l, shear));
    const Stress<Dim> next = advance(old, time, stress_rate<Dim>(mid, l, shear));
    for (std::size_t d = 0; d < Dim; ++d)
      for (std::size_t e = 0; e <= d; ++e) store_four(next.in[d][e], stress[column_of[d][e]], first, count);
    if (Dim == 2) store_four(next.zz, stress[2], first, count);
    Four density = load_four(rho, first, count);
    density = simd::fma(time, s.density, density);
    store_four(density, rho, first, count);
    store_four(stiffness * (density - Four(q.reference_density)), p, first, count);
  }
}

/// Adds f^4 (R_a + R_b) to the stress of a vector of neighbours, which begin at `entry` of a row; weight: W(r)/W(dx).
template <std::size_t N>
BARCHAN_SIMD_INLINE void pull_apart(const std::array<Lanes, N>& own, const RecordArray& records,
                                    const std::uint32_t* entry, Lanes weight, Lanes* stress) {
  constexpr int size = ArtificialStressRecord::size;
  Lanes other[size];
  simd::load_transposed<size>(records.data(), size / PairList::stride, entry, other);
  const Lanes near = nearness(weight);
  for (std::size_t c = 0; c < N; ++c) stress[c] = simd::fma(near, own[c] + other[c], stress[c]);
}

/// Viscosity over the smoothing length and its square (laws/elastic.hpp).
struct Viscosity {
  double alpha, beta;  // -alpha c/rho, beta/rho
};

/// What the pairs of particle k add up to: acceleration, and its power with WithPower.
template <int Dim, bool Viscous, bool WithPower, bool Pulled>
BARCHAN_SIMD_INLINE std::array<Lanes, Dim + (WithPower ? 1 : 0)> forces_on(
    std::size_t k, const RecordArray& own_records, std::span<const ElasticNeighbour> neighbours,
    const std::vector<ReadyKernel>& kernels, const Viscosity& viscosity,
    [[maybe_unused]] const RecordArray* artificial) {
  using R = StressRecord<Dim>;
  using Law = ElasticForce<Dim>;
  const double* record = own_records[k];
  typename Law::template Own<Lanes> own;
  std::array<Lanes, Dim> sum;
  Lanes power(0.0);
  for (std::size_t d = 0; d < Dim; ++d) {
    own.x[d] = Lanes(record[R::position + d]);
    own.v[d] = Lanes(record[R::velocity + d]);
    sum[d] = Lanes(0.0);
  }
  [[maybe_unused]] std::array<Lanes, Law::stresses> pull;
  for (std::size_t c = 0; c < Law::stresses; ++c) {
    own.s[c] = Lanes(record[R::stress + c]);
    if constexpr (Pulled) pull[c] = Lanes((*artificial)[k][c]);
  }
  for (std::size_t c = 0; c < neighbours.size(); ++c) {
    const auto& e = neighbours[c];
    const auto row = e.row(k);
    const double h = 0.5 * e.radius;
    own.mass_b = Lanes(e.mass);
    own.alpha = Lanes(viscosity.alpha * h);
    own.beta = Lanes(viscosity.beta * h * h);
    own.soft = Lanes(0.01 * h * h);
    [[maybe_unused]] const Lanes inverse_weight(e.inverse_weight);
    [[maybe_unused]] const std::uint32_t* entry = row.begin;
    kernels[c]([&](const auto& kernel) __attribute__((always_inline)) {
      for_each_neighbour<R::size>(
          row, *e.records, [&](Lanes * b) __attribute__((always_inline)) {
            std::array<Lanes, Dim> r;
            const Lanes r2 = separation<Dim>(own.x, b + R::position, r);
            Lanes factor;
            if constexpr (Pulled) {
              Lanes weight;
              kernel.value_and_gradient(r2, weight, factor);
              pull_apart(pull, *e.artificial, entry, weight * inverse_weight, b + R::stress);
              entry += Lanes::width;
            } else {
              factor = kernel.gradient(r2);
            }
            Law::template add<Viscous, WithPower>(own, r, r2, factor, b + R::velocity, b + R::stress, b[R::volume], sum,
                                                  power);
          });
    });
  }
  std::array<Lanes, Dim + (WithPower ? 1 : 0)> all;
  for (std::size_t d = 0; d < Dim; ++d) all[d] = sum[d];
  if constexpr (WithPower) all[Dim] = power;
  return all;
}

template <int Dim, bool Viscous, bool WithPower, bool Pulled>
void forces(PhaseParticles& body, const RecordArray& own_records, std::span<const ElasticNeighbour> neighbours,
            const ElasticParameters& q, const RecordArray* artificial) {
  constexpr std::size_t sums_of = Dim + (WithPower ? 1 : 0);
  const Viscosity viscosity{-q.alpha * q.sound_speed / q.reference_density, q.beta / q.reference_density};
  std::array<double*, Dim> a{};
  for (int d = 0; d < Dim; ++d) a[static_cast<std::size_t>(d)] = body.column(Field::acceleration, d);
  double* rate = WithPower ? body.column(Field::energy_rate) : nullptr;
  const auto& kernels = ready_kernels(neighbours, Dim);
  const std::size_t n = body.size();
  const auto fours = static_cast<std::int64_t>((n + 3) / 4);
  Shares shares(fours, 64);
#pragma omp parallel
  for (const std::int64_t block : shares) {
    const std::size_t first = 4 * static_cast<std::size_t>(block), count = std::min<std::size_t>(4, n - first);
    std::array<std::array<Lanes, sums_of>, 4> sums;
    for (std::size_t lane = 0; lane < 4; ++lane)
      sums[lane] = forces_on<Dim, Viscous, WithPower, Pulled>(std::min(first + lane, n - 1), own_records, neighbours,
                                                              kernels, viscosity, artificial);
    const auto s = reduce<std::array<Four, sums_of>, double>(sums);
    for (std::size_t d = 0; d < Dim; ++d) store_four(s[d] + Four(q.gravity[d]), a[d], first, count);
    if constexpr (WithPower) store_four(Four(-0.5) * s[Dim], rate, first, count);
  }
}

}  // namespace

void pack_stress(const PhaseParticles& body, RecordArray& records) {
  body.dimensions() == 2 ? pack<2>(body, records) : pack<3>(body, records);
}

void elastic_strain(PhaseParticles& body, const RecordArray& own, std::span<const ElasticNeighbour> neighbours,
                    const ElasticParameters& q, double dt) {
  body.dimensions() == 2 ? strain<2>(body, own, neighbours, q, dt) : strain<3>(body, own, neighbours, q, dt);
}

void elastic_forces(PhaseParticles& body, const RecordArray& own, std::span<const ElasticNeighbour> neighbours,
                    const ElasticParameters& q, const RecordArray* artificial) {
  const bool viscous = q.alpha != 0.0 || q.beta != 0.0;
  const auto run = [&]<bool Viscous, bool WithPower, bool Pulled>() {
    body.dimensions() == 2 ? forces<2, Viscous, WithPower, Pulled>(body, own, neighbours, q, artificial)
                           : forces<3, Viscous, WithPower, Pulled>(body, own, neighbours, q, artificial);
  };
  const auto with_power = [&]<bool Viscous, bool WithPower>() {
    artificial ? run.template operator()<Viscous, WithPower, true>()
               : run.template operator()<Viscous, WithPower, false>();
  };
  if (body.has(Field::energy_rate))
    viscous ? with_power.template operator()<true, true>() : with_power.template operator()<false, true>();
  else viscous ? with_power.template operator()<true, false>() : with_power.template operator()<false, false>();
}

}  // namespace barchan::BARCHAN_TARGET
