#include "passes/fluid.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "kernels/kernel.hpp"
#include "laws/consistent_fluid.hpp"
#include "laws/joined_fluids.hpp"
#include "laws/plain_fluid.hpp"
#include "passes/fluid_finish.hpp"
#include "passes/fours.hpp"

namespace barchan {

namespace {

template <int Dim, template <int> class Law, class T>
BARCHAN_SIMD_INLINE typename Law<Dim>::template Own<LanesOf<T>> load_own(const T* record) {
  using R = MotionRecord<Dim>;
  typename Law<Dim>::template Own<LanesOf<T>> own;
  for (std::size_t d = 0; d < Dim; ++d) {
    own.x[d] = LanesOf<T>(record[R::position + d]);
    own.v[d] = LanesOf<T>(record[R::velocity + d]);
  }
  own.p = LanesOf<T>(record[R::pressure]);
  return own;
}

template <class T>
const T* records_of(const FluidNeighbour& e) {
  if constexpr (std::is_same_v<T, double>) return e.records->data();
  else return e.compact->data();
}

/// The raw sums of one entry's row: without the kernel's constant factor.
template <int Dim, template <int> class Law, class T>
BARCHAN_SIMD_INLINE void sum_row(PairList::Row row, const FluidNeighbour& e, const ReadyKernelOf<T>& ready,
                                 const typename Law<Dim>::template Own<LanesOf<T>>& own, LanesOf<T> unit,
                                 typename Law<Dim>::template Sums<LanesOf<T>>& out) {
  using R = MotionRecord<Dim>;
  ready([&](const auto& kernel) __attribute__((always_inline)) {
    typename Law<Dim>::template Sums<LanesOf<T>> sums{};
    for_each_staged<R::size>(
        row, records_of<T>(e),
        [&](const LanesOf<T>* b, LanesOf<T>* stage) __attribute__((always_inline)) {
          std::array<LanesOf<T>, Dim> r;
          const LanesOf<T> r2 = separation<Dim, T>(own.x, b + R::position, unit, r);
          for (std::size_t d = 0; d < Dim; ++d) {
            stage[d] = r[d];
            stage[Dim + d] = b[R::velocity + d];
          }
          stage[2 * Dim] = b[R::pressure];
          stage[2 * Dim + 1] = b[R::volume];
          stage[2 * Dim + 2] = kernel.slope(r2);
          if constexpr (Law<Dim>::needs_distance) stage[2 * Dim + 3] = r2;
        },
        [&](const LanesOf<T>* stage) __attribute__((always_inline)) {
          std::array<LanesOf<T>, Dim> r;
          for (std::size_t d = 0; d < Dim; ++d) r[d] = stage[d];
          Law<Dim>::add(own, r, stage[2 * Dim + 3], stage[2 * Dim + 2], stage + Dim, stage[2 * Dim], stage[2 * Dim + 1],
                        sums);
        });
    out = sums;
  });
}

/// At most this many entries a phase.
constexpr std::size_t most_entries = 16;

template <class T>
std::vector<ReadyKernelOf<T>>& ready_kernels(std::span<const FluidNeighbour> neighbours, int dimensions) {
  thread_local std::vector<ReadyKernelOf<T>> kernels;
  kernels.reserve(most_entries);
  kernels.clear();
  for (const auto& e : neighbours) kernels.emplace_back(e.kernel, e.radius, dimensions);
  return kernels;
}

/// The first particle of pairs across an interface; rho: its density, so that it carries its own weight exactly.
template <int Dim, class T>
BARCHAN_SIMD_INLINE typename JoinedFluids<Dim>::template Own<LanesOf<T>> joined_own(
    const typename ConsistentFluid<Dim>::template Own<LanesOf<T>>& own, const FluidNeighbour& e,
    const FluidParameters& q, double rho) {
  using V = LanesOf<T>;
  typename JoinedFluids<Dim>::template Own<V> joined{own, {}, {}, {}};
  for (std::size_t d = 0; d < Dim; ++d) joined.weight[d] = simd::broadcast<V>(rho * q.gravity[d]);
  joined.ratio = simd::broadcast<V>(e.joined / q.reference_density);
  joined.share = simd::broadcast<V>(2.0 * q.reference_density / (q.reference_density + e.joined));
  return joined;
}

template <int Dim, template <int> class Law, class T, bool Joined = false>
void rates(PhaseParticles& fluid, const T* own_records, double length_unit, std::span<const FluidNeighbour> neighbours,
           const FluidParameters& q) {
  using L = Law<Dim>;
  using V = LanesOf<T>;
  constexpr auto record_size = static_cast<std::size_t>(MotionRecord<Dim>::size);
  const V unit = simd::broadcast<V>(length_unit);
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
  const auto& kernels = ready_kernels<T>(neighbours, Dim);
  constexpr std::size_t moments = Dim * (Dim + 1) / 2, kept = Dim == 2 ? 2 : moments;
  std::array<double*, moments> skew{};  // 2D: xx xy, and yy = -xx
  if constexpr (L::corrected)
    for (std::size_t c = 0; c < kept; ++c) skew[c] = fluid.column(Field::anisotropy, static_cast<int>(c));
  const double* pressure = fluid.column(Field::pressure);
  const SurfaceColumns<Dim> surface(fluid);
  const std::size_t n = fluid.size();
  const auto fours = static_cast<std::int64_t>((n + 3) / 4);
#pragma omp parallel for schedule(dynamic, 64)
  for (std::int64_t block = 0; block < fours; ++block) {
    const std::size_t first = 4 * static_cast<std::size_t>(block), count = std::min<std::size_t>(4, n - first);
    typename L::template Sums<Four> s{};
    for (std::size_t c = 0; c < neighbours.size(); ++c) {
      const auto& e = neighbours[c];
      std::array<typename L::template Sums<V>, 4> sums;
      bool any = false;
      for (std::size_t lane = 0; lane < 4; ++lane) {
        const std::size_t k = std::min(first + lane, n - 1);  // the last one again, and again dropped
        const auto row = e.list->row(k);
        any = any || row.begin != row.end;
        auto own = load_own<Dim, Law>(own_records + k * record_size);
        if constexpr (L::corrected) {
          for (std::size_t m = 0; m < kept; ++m) own.anisotropy[m] = simd::broadcast<V>(skew[m][k]);
          if constexpr (Dim == 2) own.anisotropy[2] = -own.anisotropy[0];
          for (std::size_t d = 0; d < Dim; ++d)
            for (std::size_t m = 0; m < d; ++m) own.anisotropy[moment_index(d, m)] *= simd::broadcast<V>(2.0);
        }
        if constexpr (Joined) {
          if (e.joined > 0) {
            const auto across = joined_own<Dim, T>(own, e, q, rho[k]);
            sum_row<Dim, JoinedFluids, T>(row, e, kernels[c], across, unit, sums[lane]);
            continue;
          }
        }
        sum_row<Dim, Law, T>(row, e, kernels[c], own, unit, sums[lane]);
      }
      if (any) {
        auto raw = reduce<typename L::template Sums<Four>, T>(sums);
        if constexpr (Joined)
          if (e.joined > 0)
            for (std::size_t d = 0; d < Dim; ++d) {  // the Laplacian's own factor is this phase's viscosity
              raw.viscous[d] *= Four(mu > 0 ? e.viscosity / mu : 0.0);
              raw.weighted[d] *= Four(mu > 0 ? e.viscosity / mu : 0.0);
            }
        s.take(raw, kernels[c].slope_factor(), e.viscosity, e.diffuse ? 1.0 : 0.0, weight);
      }
    }
    std::array<Four, moments> anisotropy;
    if constexpr (L::corrected) {
      for (std::size_t c = 0; c < kept; ++c) anisotropy[c] = load_four(skew[c], first, count);
      if constexpr (Dim == 2) anisotropy[2] = -anisotropy[0];
    }
    Place<Dim, Four> place{load_four(pressure, first, count), {}, {}};
    for (std::size_t d = 0; d < Dim; ++d)
      place.normal[d] = surface.wholeness ? load_four(surface.normal[d], first, count) : Four(0.0);
    const auto r = finish<Dim, Four>(s, mu, load_four(rho, first, count), q, anisotropy, place);
    if (surface.wholeness) {
      store_four(place.wholeness, surface.wholeness, first, count);
      for (std::size_t d = 0; d < Dim; ++d) store_four(s.concentration[d], surface.normal[d], first, count);
    }
    if constexpr (L::corrected)
      for (std::size_t c = 0; c < kept; ++c) store_four(anisotropy[c], skew[c], first, count);
    for (std::size_t d = 0; d < Dim; ++d) {
      store_four(r.acceleration[d], a[d], first, count);
      if (du[d]) store_four(r.shift[d], du[d], first, count);
    }
    store_four(r.density, rate, first, count);
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
    typename L::template Sums<Lanes> raw, s{};
    sum_row<Dim, PlainFluid, double>(row, e, kernel, load_own<Dim, PlainFluid>(record), Lanes(1.0), raw);
    s.take(raw, kernel.slope_factor(), e.viscosity, 0.0, {0, 0, 0});
    const Lanes closing(pores ? 2.0 * record[R::pressure] : 0.0);
    for (std::size_t d = 0; d < Dim; ++d)
      a[d][k] += record[R::volume] * inverse_mass *
                 simd::sum(Lanes(2.0) * s.viscous[d] - s.pressure[d] + closing * s.concentration[d]);
  }
}

template <class T>
void dispatch(PhaseParticles& fluid, const T* own, double unit, std::span<const FluidNeighbour> neighbours,
              const FluidParameters& q, FluidScheme scheme) {
  const bool plain = scheme == FluidScheme::plain, flat = fluid.dimensions() == 2;
  const bool joined = std::any_of(neighbours.begin(), neighbours.end(), [](const auto& e) { return e.joined > 0; });
  if (joined && flat) rates<2, ConsistentFluid, T, true>(fluid, own, unit, neighbours, q);
  else if (joined) rates<3, ConsistentFluid, T, true>(fluid, own, unit, neighbours, q);
  else if (flat && plain && fluid.has(Field::wholeness)) rates<2, PlainSurface>(fluid, own, unit, neighbours, q);
  else if (flat && plain) rates<2, PlainFluid>(fluid, own, unit, neighbours, q);
  else if (flat) rates<2, ConsistentFluid>(fluid, own, unit, neighbours, q);
  else if (plain && fluid.has(Field::wholeness)) rates<3, PlainSurface>(fluid, own, unit, neighbours, q);
  else if (plain) rates<3, PlainFluid>(fluid, own, unit, neighbours, q);
  else rates<3, ConsistentFluid>(fluid, own, unit, neighbours, q);
}

}  // namespace

void fluid_rates(PhaseParticles& fluid, const RecordArray& own, std::span<const FluidNeighbour> neighbours,
                 const FluidParameters& q, FluidScheme scheme) {
  dispatch(fluid, own.data(), 1.0, neighbours, q, scheme);
}

void fluid_rates(PhaseParticles& fluid, const CompactRecords& own, std::span<const FluidNeighbour> neighbours,
                 const FluidParameters& q, FluidScheme scheme) {
  dispatch(fluid, own.data(), own.unit(), neighbours, q, scheme);
}

void fluid_reaction(PhaseParticles& solid, const RecordArray& own, const FluidNeighbour& fluid, bool pores) {
  if (solid.dimensions() == 2) reaction<2>(solid, own, fluid, pores);
  else reaction<3>(solid, own, fluid, pores);
}

}  // namespace barchan
