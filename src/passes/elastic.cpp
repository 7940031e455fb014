#include "passes/elastic.hpp"

#include "kernels/kernel.hpp"
#include "laws/elastic.hpp"

namespace barchan {

namespace {

using Tensor = std::array<std::array<double, 3>, 3>;

/// The field's order: xx yy zz xy yz xz.
constexpr std::size_t column_of[3][3] = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}};

template <int Dim>
void pack(const PhaseParticles& body, RecordArray& records) {
  using R = StressRecord<Dim>;
  const double mass = body.mass();
  const double *rho = body.column(Field::density), *p = body.column(Field::pressure);
  const auto n = static_cast<std::int64_t>(body.size());
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < n; ++i) {
    const auto k = static_cast<std::size_t>(i);
    double* r = records[k];
    for (int d = 0; d < Dim; ++d) {
      r[R::position + d] = body.column(Field::position, d)[k];
      r[R::velocity + d] = body.column(Field::velocity, d)[k];
    }
    const double inverse = 1.0 / (rho[k] * rho[k]);
    for (std::size_t d = 0; d < Dim; ++d)
      for (std::size_t e = 0; e <= d; ++e) {
        const double s = body.column(Field::stress, static_cast<int>(column_of[d][e]))[k] - (d == e ? p[k] : 0.0);
        r[static_cast<std::size_t>(R::stress) + stress_index<Dim>(d, e)] = s * inverse;
      }
    r[R::volume] = mass / rho[k];
  }
}

/// 2 G dev(D) + s.W^T + W.s at stress s, with L the velocity gradient (row: component of v).
Tensor stress_rate(const Tensor& s, const Tensor& l, double shear_modulus) {
  Tensor rate{}, spin{}, strain{};
  for (std::size_t d = 0; d < 3; ++d)
    for (std::size_t e = 0; e < 3; ++e) {
      strain[d][e] = 0.5 * (l[d][e] + l[e][d]);
      spin[d][e] = 0.5 * (l[d][e] - l[e][d]);
    }
  const double third = (strain[0][0] + strain[1][1] + strain[2][2]) / 3.0;
  for (std::size_t d = 0; d < 3; ++d)
    for (std::size_t e = 0; e < 3; ++e) {
      rate[d][e] = 2.0 * shear_modulus * (strain[d][e] - (d == e ? third : 0.0));
      for (std::size_t f = 0; f < 3; ++f) rate[d][e] += s[d][f] * spin[e][f] + spin[d][f] * s[f][e];
    }
  return rate;
}

template <int Dim>
void strain(PhaseParticles& body, const RecordArray& own_records, std::span<const ElasticNeighbour> neighbours,
            const ElasticParameters& q, double dt) {
  using R = StressRecord<Dim>;
  using Law = ElasticStrain<Dim>;
  double *rho = body.column(Field::density), *p = body.column(Field::pressure);
  double* energy = body.has(Field::energy) ? body.column(Field::energy) : nullptr;
  std::array<double*, 6> stress{};
  for (int c = 0; c < 6; ++c) stress[static_cast<std::size_t>(c)] = body.column(Field::stress, c);
  const auto n = static_cast<std::int64_t>(body.size());
#pragma omp parallel for schedule(dynamic, 256)
  for (std::int64_t i = 0; i < n; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const double* record = own_records[k];
    std::array<Lanes, Dim> x, v;
    for (std::size_t d = 0; d < Dim; ++d) {
      x[d] = Lanes(record[R::position + d]);
      v[d] = Lanes(record[R::velocity + d]);
    }
    typename Law::template Sums<Lanes> s{};
    for (const auto& e : neighbours) {
      const auto row = e.list->row(k);
      if (row.begin == row.end) continue;
      const Lanes mass(e.mass);
      with_kernel<double>(e.kernel, e.radius, Dim, [&](const auto& kernel) {
        for_each_neighbour<R::size>(
            row, *e.records, [&](const Lanes* b) __attribute__((always_inline)) {
              std::array<Lanes, Dim> r;
              const Lanes r2 = separation<Dim>(x, b + R::position, r);
              Law::add(v, mass, r, kernel.gradient(r2), b + R::velocity, b[R::volume], s);
            });
      });
    }
    Tensor l{}, old{}, mid{};
    for (std::size_t d = 0; d < Dim; ++d)
      for (std::size_t e = 0; e < Dim; ++e) l[d][e] = -simd::sum(s.gradient[d * Dim + e]);
    for (std::size_t d = 0; d < 3; ++d)
      for (std::size_t e = 0; e < 3; ++e) old[d][e] = stress[column_of[d][e]][k];
    const Tensor first = stress_rate(old, l, q.shear_modulus);
    for (std::size_t d = 0; d < 3; ++d)
      for (std::size_t e = 0; e < 3; ++e) mid[d][e] = old[d][e] + 0.5 * dt * first[d][e];
    const Tensor rate = stress_rate(mid, l, q.shear_modulus);
    for (std::size_t d = 0; d < 3; ++d)
      for (std::size_t e = 0; e <= d; ++e) stress[column_of[d][e]][k] = old[d][e] + dt * rate[d][e];
    if (energy) {  // de/dt = s:L/rho, eq. (13b) with the whole stress; the power at the middle of the step
      double power = -p[k] * (l[0][0] + l[1][1] + l[2][2]);
      for (std::size_t d = 0; d < 3; ++d)
        for (std::size_t e = 0; e < 3; ++e) power += mid[d][e] * l[d][e];
      energy[k] += dt * power / rho[k];
    }
    rho[k] += dt * simd::sum(s.density);
    p[k] = q.bulk_modulus / q.reference_density * (rho[k] - q.reference_density);
  }
}

template <int Dim, bool Viscous>
void forces(PhaseParticles& body, const RecordArray& own_records, std::span<const ElasticNeighbour> neighbours,
            const ElasticParameters& q) {
  using R = StressRecord<Dim>;
  using Law = ElasticForce<Dim>;
  std::array<double*, Dim> a{};
  for (int d = 0; d < Dim; ++d) a[static_cast<std::size_t>(d)] = body.column(Field::acceleration, d);
  const auto n = static_cast<std::int64_t>(body.size());
#pragma omp parallel for schedule(dynamic, 256)
  for (std::int64_t i = 0; i < n; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const double* record = own_records[k];
    typename Law::template Own<Lanes> own;
    std::array<Lanes, Dim> sum;
    for (std::size_t d = 0; d < Dim; ++d) {
      own.x[d] = Lanes(record[R::position + d]);
      own.v[d] = Lanes(record[R::velocity + d]);
      sum[d] = Lanes(0.0);
    }
    for (std::size_t c = 0; c < Law::stresses; ++c) own.s[c] = Lanes(record[R::stress + c]);
    for (const auto& e : neighbours) {
      const auto row = e.list->row(k);
      if (row.begin == row.end) continue;
      const double h = 0.5 * e.radius;
      own.mass_b = Lanes(e.mass);
      own.alpha = Lanes(-q.alpha * q.sound_speed * h / q.reference_density);
      own.beta = Lanes(q.beta * h * h / q.reference_density);
      own.soft = Lanes(0.01 * h * h);
      with_kernel<double>(e.kernel, e.radius, Dim, [&](const auto& kernel) {
        for_each_neighbour<R::size>(
            row, *e.records, [&](const Lanes* b) __attribute__((always_inline)) {
              std::array<Lanes, Dim> r;
              const Lanes r2 = separation<Dim>(own.x, b + R::position, r);
              Law::template add<Viscous>(own, r, r2, kernel.gradient(r2), b + R::velocity, b + R::stress, b[R::volume],
                                         sum);
            });
      });
    }
    for (std::size_t d = 0; d < Dim; ++d) a[d][k] = simd::sum(sum[d]) + q.gravity[d];
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
                    const ElasticParameters& q) {
  const bool viscous = q.alpha != 0.0 || q.beta != 0.0;
  if (body.dimensions() == 2)
    viscous ? forces<2, true>(body, own, neighbours, q) : forces<2, false>(body, own, neighbours, q);
  else viscous ? forces<3, true>(body, own, neighbours, q) : forces<3, false>(body, own, neighbours, q);
}

}  // namespace barchan
