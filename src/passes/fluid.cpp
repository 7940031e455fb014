#include "passes/fluid.hpp"

#include <algorithm>

#include "kernels/kernel.hpp"
#include "laws/consistent_fluid.hpp"
#include "laws/plain_fluid.hpp"
#include "passes/fluid_finish.hpp"

namespace barchan {

namespace {

template <int Dim, template <int> class Law>
BARCHAN_SIMD_INLINE typename Law<Dim>::template Own<Lanes> load_own(const double* record) {
  using R = MotionRecord<Dim>;
  typename Law<Dim>::template Own<Lanes> own;
  for (std::size_t d = 0; d < Dim; ++d) {
    own.x[d] = Lanes(record[R::position + d]);
    own.v[d] = Lanes(record[R::velocity + d]);
  }
  own.p = Lanes(record[R::pressure]);
  return own;
}

/// Adds one entry's row to `total`.
template <int Dim, template <int> class Law>
BARCHAN_SIMD_INLINE void add_row(PairList::Row row, const FluidNeighbour& e, const ReadyKernel& ready,
                                 const typename Law<Dim>::template Own<Lanes>& own, const Vec3& weight,
                                 typename Law<Dim>::template Sums<Lanes>& total) {
  using R = MotionRecord<Dim>;
  ready([&](const auto& kernel) __attribute__((always_inline)) {
    typename Law<Dim>::template Sums<Lanes> sums{};
    for_each_neighbour<R::size>(
        row, *e.records, [&](const Lanes* b) __attribute__((always_inline)) {
          std::array<Lanes, Dim> r;
          const Lanes r2 = separation<Dim>(own.x, b + R::position, r);
          Law<Dim>::add(own, r, r2, kernel.slope(r2), b + R::velocity, b[R::pressure], b[R::volume], sums);
        });
    total.take(sums, kernel.slope_factor(), e.viscosity, e.diffuse ? 1.0 : 0.0, weight);
  });
}

/// At most this many entries a phase.
constexpr std::size_t most_entries = 16;

std::vector<ReadyKernel>& ready_kernels(std::span<const FluidNeighbour> neighbours, int dimensions) {
  thread_local std::vector<ReadyKernel> kernels;
  kernels.reserve(most_entries);
  kernels.clear();
  for (const auto& e : neighbours) kernels.emplace_back(e.kernel, e.radius, dimensions);
  return kernels;
}

template <int Dim, template <int> class Law>
void rates(PhaseParticles& fluid, const RecordArray& own_records, std::span<const FluidNeighbour> neighbours,
           const FluidParameters& q) {
  using L = Law<Dim>;
  const Vec3 weight{q.reference_density * q.gravity[0], q.reference_density * q.gravity[1],
                    q.reference_density * q.gravity[2]};
  std::array<double*, Dim> a{}, du{};
  for (int d = 0; d < Dim; ++d) {
    a[static_cast<std::size_t>(d)] = fluid.column(Field::acceleration, d);
    if (fluid.has(Field::shift_velocity)) du[static_cast<std::size_t>(d)] = fluid.column(Field::shift_velocity, d);
  }
  double* rate = fluid.column(Field::density_rate);
  const double* rho = fluid.column(Field::density);
  const double mu = neighbours.empty() ? 0.0 : neighbours.front().viscosity;
  const auto& kernels = ready_kernels(neighbours, Dim);
  constexpr std::size_t moments = Dim * (Dim + 1) / 2;
  std::array<double*, moments> skew{};  // 2D: xx xy, and yy = -xx
  if constexpr (L::corrected)
    for (std::size_t c = 0; c < (Dim == 2 ? 2 : moments); ++c)
      skew[c] = fluid.column(Field::anisotropy, static_cast<int>(c));
  const auto n = static_cast<std::int64_t>(fluid.size());
#pragma omp parallel for schedule(dynamic, 256)
  for (std::int64_t i = 0; i < n; ++i) {
    const auto k = static_cast<std::size_t>(i);
    typename L::template Sums<Lanes> sums{};
    std::array<double, moments> anisotropy{};
    if constexpr (L::corrected) {
      if constexpr (Dim == 2) anisotropy = {skew[0][k], skew[1][k], -skew[0][k]};
      else
        for (std::size_t c = 0; c < moments; ++c) anisotropy[c] = skew[c][k];
    }
    auto own = load_own<Dim, Law>(own_records[k]);
    if constexpr (L::corrected)
      for (std::size_t d = 0; d < Dim; ++d)
        for (std::size_t e = 0; e <= d; ++e)
          own.anisotropy[moment_index(d, e)] = Lanes((d == e ? 1.0 : 2.0) * anisotropy[moment_index(d, e)]);
    for (std::size_t c = 0; c < neighbours.size(); ++c) {
      const auto& e = neighbours[c];
      const auto row = e.list->row(k);
      if (row.begin == row.end) continue;
      add_row<Dim, Law>(row, e, kernels[c], own, weight, sums);
    }
    const auto s = reduce<typename L::template Sums<double>>(sums);
    const auto r = finish<Dim>(s, mu, rho[k], q, anisotropy);
    if constexpr (L::corrected)
      for (std::size_t c = 0; c < (Dim == 2 ? 2 : moments); ++c) skew[c][k] = anisotropy[c];
    for (std::size_t d = 0; d < Dim; ++d) {
      a[d][k] = r.acceleration[d];
      if (du[d]) du[d][k] = r.shift[d];
    }
    rate[k] = r.density;
  }
}

template <int Dim>
void reaction(PhaseParticles& solid, const RecordArray& own_records, const FluidNeighbour& e, bool pores) {
  using R = MotionRecord<Dim>;
  using L = PlainFluid<Dim>;
  std::array<double*, Dim> a{};
  for (int d = 0; d < Dim; ++d) a[static_cast<std::size_t>(d)] = solid.column(Field::acceleration, d);
  const double inverse_mass = 1.0 / solid.mass();
  const ReadyKernel kernel(e.kernel, e.radius, Dim);
  const auto n = static_cast<std::int64_t>(solid.size());
#pragma omp parallel for schedule(dynamic, 256)
  for (std::int64_t i = 0; i < n; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const auto row = e.list->row(k);
    if (row.begin == row.end) continue;
    const double* record = own_records[k];
    typename L::template Sums<Lanes> sums{};
    add_row<Dim, PlainFluid>(row, e, kernel, load_own<Dim, PlainFluid>(record), {0, 0, 0}, sums);
    const auto s = reduce<typename L::template Sums<double>>(sums);
    const double closing = pores ? 2.0 * record[R::pressure] : 0.0;
    for (std::size_t d = 0; d < Dim; ++d)
      a[d][k] += record[R::volume] * inverse_mass * (2.0 * s.viscous[d] - s.pressure[d] + closing * s.concentration[d]);
  }
}

}  // namespace

void fluid_rates(PhaseParticles& fluid, const RecordArray& own, std::span<const FluidNeighbour> neighbours,
                 const FluidParameters& q, FluidScheme scheme) {
  const bool plain = scheme == FluidScheme::plain;
  if (fluid.dimensions() == 2)
    plain ? rates<2, PlainFluid>(fluid, own, neighbours, q) : rates<2, ConsistentFluid>(fluid, own, neighbours, q);
  else plain ? rates<3, PlainFluid>(fluid, own, neighbours, q) : rates<3, ConsistentFluid>(fluid, own, neighbours, q);
}

void fluid_reaction(PhaseParticles& solid, const RecordArray& own, const FluidNeighbour& fluid, bool pores) {
  if (solid.dimensions() == 2) reaction<2>(solid, own, fluid, pores);
  else reaction<3>(solid, own, fluid, pores);
}

}  // namespace barchan
