// The rows of a fluid's entries and the columns of its rates, shared by the passes over laminar and turbulent fluids.
#pragma once

#include <functional>
#include <vector>

#include "engine/fours.hpp"
#include "kernels/kernel.hpp"
#include "models/fluid/fluid_finish.hpp"

namespace barchan {

/// A law whose neighbours bring the square root of their viscosity.
template <class Law>
concept NeedsRoot = requires {
  Law::needs_root;
};

/// The square roots of the neighbours' viscosities: of each its own (2D: in its record), or of all the same.
struct Roots {
  const double* each = nullptr;  // null: all the same
  double all = 0.0;
};

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

/// The roots of neighbours whose record is b and whose entries in the list begin at `at`.
template <int Dim, class T>
BARCHAN_SIMD_INLINE LanesOf<T> roots_of(const Roots& roots, [[maybe_unused]] const LanesOf<T>* b,
                                        [[maybe_unused]] const std::uint32_t* at) {
  if (!roots.each) return simd::broadcast<LanesOf<T>>(roots.all);
  if constexpr (Dim == 2) return b[MotionRecord<2>::root];
  else return simd::convert<T>(gather_of<LanesOf<T>::width>(roots.each, at));
}

/// The raw sums of one entry's row: without the kernel's constant factor.
template <int Dim, template <int> class Law, class T>
BARCHAN_SIMD_INLINE void sum_row(PairList::Row row, const FluidNeighbour& e, const ReadyKernelOf<T>& ready,
                                 const typename Law<Dim>::template Own<LanesOf<T>>& own, LanesOf<T> unit,
                                 typename Law<Dim>::template Sums<LanesOf<T>>& out,
                                 [[maybe_unused]] const Roots& roots = {}) {
  using R = MotionRecord<Dim>;
  using V = LanesOf<T>;
  ready([&](const auto& kernel) __attribute__((always_inline)) {
    typename Law<Dim>::template Sums<V> sums{};
    for_each_staged<R::size>(
        row, records_of<T>(e),
        [&](const V* b, [[maybe_unused]] const std::uint32_t* at, V* stage) __attribute__((always_inline)) {
          std::array<V, Dim> r;
          const V r2 = separation<Dim, T>(own.x, b + R::position, unit, r);
          for (std::size_t d = 0; d < Dim; ++d) {
            stage[d] = r[d];
            stage[Dim + d] = b[R::velocity + d];
          }
          stage[2 * Dim] = b[R::pressure];
          stage[2 * Dim + 1] = b[R::volume];
          stage[2 * Dim + 2] = kernel.slope(r2);
          if constexpr (Law<Dim>::needs_distance) stage[2 * Dim + 3] = r2;
          if constexpr (NeedsRoot<Law<Dim>>) stage[2 * Dim + 4] = roots_of<Dim, T>(roots, b, at);
        },
        [&](const V* stage) __attribute__((always_inline)) {
          std::array<V, Dim> r;
          for (std::size_t d = 0; d < Dim; ++d) r[d] = stage[d];
          const V *v = stage + Dim, *rest = stage + 2 * Dim;  // p, V, F, r2, root
          if constexpr (NeedsRoot<Law<Dim>>)
            Law<Dim>::add(own, r, rest[3], rest[2], v, rest[0], rest[1], rest[4], sums);
          else Law<Dim>::add(own, r, rest[3], rest[2], v, rest[0], rest[1], sums);
        });
    out = sums;
  });
}

/// Four particles side by side, of which `count` exist; the last one of all again in place of those that do not.
struct FourOf {
  std::size_t first, count, last;
  FourOf(std::int64_t block, std::size_t particles)
      : first(4 * static_cast<std::size_t>(block)),
        count(std::min<std::size_t>(4, particles - first)),
        last(particles - 1) {}
  static std::int64_t blocks(std::size_t particles) { return static_cast<std::int64_t>((particles + 3) / 4); }
};

/// sum_row for four particles. `own_of(k)`: particle k. False if they have no neighbour in this entry; `raw` is then
/// not written.
template <int Dim, template <int> class Law, class T, class OwnOf>
BARCHAN_SIMD_INLINE bool sum_rows(const FourOf& at, const FluidNeighbour& e, const ReadyKernelOf<T>& ready,
                                  LanesOf<T> unit, OwnOf&& own_of, typename Law<Dim>::template Sums<Four>& raw,
                                  const Roots& roots = {}) {
  const auto row_of = [&](std::size_t lane) __attribute__((always_inline)) {
    return e.list->row(std::min(at.first + lane, at.last));
  };
  bool any = false;
  for (std::size_t lane = 0; lane < 4 && !any; ++lane) any = row_of(lane).begin != row_of(lane).end;
  if (!any) return false;
  std::array<typename Law<Dim>::template Sums<LanesOf<T>>, 4> sums;
  for (std::size_t lane = 0; lane < 4; ++lane)
    sum_row<Dim, Law, T>(row_of(lane), e, ready, own_of(std::min(at.first + lane, at.last)), unit, sums[lane], roots);
  raw = reduce<typename Law<Dim>::template Sums<Four>, T>(sums);
  return true;
}

template <class T, class Range, class PairOf = std::identity>
std::vector<ReadyKernelOf<T>>& ready_kernels(const Range& neighbours, int dimensions, PairOf pair_of = {}) {
  thread_local std::vector<ReadyKernelOf<T>> kernels;
  kernels.reserve(most_entries);
  kernels.clear();
  for (const auto& e : neighbours) {
    const FluidNeighbour& pair = std::invoke(pair_of, e);
    kernels.emplace_back(pair.kernel, pair.radius, dimensions);
  }
  return kernels;
}

/// The columns that a fluid's rates come from and go to. Corrected: of the consistent scheme.
template <int Dim, bool Corrected>
struct RateColumns {
  static constexpr std::size_t moments = Dim * (Dim + 1) / 2, kept = Dim == 2 ? 2 : moments;
  std::array<double*, Dim> acceleration{}, shift{};
  std::array<double*, moments> skew{};  // 2D: xx xy, and yy = -xx
  double* rate;
  const double *rho, *pressure;
  std::array<const double*, Dim> velocity{};
  SurfaceColumns<Dim> surface;
  const double* near_void = nullptr;  // null: its fluid may end beside every particle

  explicit RateColumns(PhaseParticles& fluid)
      : rate(fluid.column(Field::density_rate)),
        rho(fluid.column(Field::density)),
        pressure(fluid.column(Field::pressure)),
        surface(fluid) {
    for (std::size_t d = 0; d < Dim; ++d) {
      acceleration[d] = fluid.column(Field::acceleration, static_cast<int>(d));
      velocity[d] = fluid.column(Field::velocity, static_cast<int>(d));
      if (fluid.has(Field::shift_velocity)) shift[d] = fluid.column(Field::shift_velocity, static_cast<int>(d));
    }
    if constexpr (Corrected)
      for (std::size_t c = 0; c < kept; ++c) skew[c] = fluid.column(Field::anisotropy, static_cast<int>(c));
    if (fluid.has(Field::near_void)) near_void = fluid.column(Field::near_void);
  }

  /// Gives `own` the weights of particle k.
  template <class Own>
  BARCHAN_SIMD_INLINE void weigh(Own& own, std::size_t k) const {
    using V = std::remove_reference_t<decltype(own.p)>;
    for (std::size_t m = 0; m < kept; ++m) own.anisotropy[m] = simd::broadcast<V>(skew[m][k]);
    if constexpr (Dim == 2) own.anisotropy[2] = -own.anisotropy[0];
    for (std::size_t d = 0; d < Dim; ++d)
      for (std::size_t m = 0; m < d; ++m) own.anisotropy[moment_index(d, m)] *= simd::broadcast<V>(2.0);
  }

  BARCHAN_SIMD_INLINE std::array<Four, moments> anisotropy(const FourOf& at) const {
    std::array<Four, moments> a;
    if constexpr (Corrected) {
      for (std::size_t c = 0; c < kept; ++c) a[c] = load_four(skew[c], at.first, at.count);
      if constexpr (Dim == 2) a[2] = -a[0];
    }
    return a;
  }

  template <FluidTerms has>
  BARCHAN_SIMD_INLINE Place<Dim, Four> place(const FourOf& at, Four company) const {
    Place<Dim, Four> place{};
    if constexpr (!has.ends) return place;
    place.company = company;
    place.pressure = load_four(pressure, at.first, at.count);
    place.ends = near_void ? load_four(near_void, at.first, at.count) : Four(1.0);
    for (std::size_t d = 0; d < Dim; ++d) place.velocity[d] = load_four(velocity[d], at.first, at.count);
    for (std::size_t d = 0; d < Dim; ++d)
      place.normal[d] = surface.wholeness ? load_four(surface.normal[d], at.first, at.count) : Four(0.0);
    return place;
  }

  template <FluidTerms has>
  BARCHAN_SIMD_INLINE void store(const FourOf& at, const Rates<Dim, Four>& r, const std::array<Four, moments>& a,
                                 const Place<Dim, Four>& place, const std::array<Four, Dim>& concentration,
                                 const FluidParameters& q) const {
    if constexpr (Corrected)
      if (q.loose && simd::any(place.loose)) note_loose(at, place, *q.loose);
    if (has.ends && surface.wholeness) {
      store_four(place.wholeness, surface.wholeness, at.first, at.count);
      for (std::size_t d = 0; d < Dim; ++d) store_four(concentration[d], surface.normal[d], at.first, at.count);
    }
    if constexpr (Corrected)
      for (std::size_t c = 0; c < kept; ++c) store_four(a[c], skew[c], at.first, at.count);
    for (std::size_t d = 0; d < Dim; ++d) {
      store_four(r.acceleration[d], acceleration[d], at.first, at.count);
      if (shift[d]) store_four(r.shift[d], shift[d], at.first, at.count);
    }
    store_four(r.density, rate, at.first, at.count);
  }

  static void note_loose(const FourOf& at, const Place<Dim, Four>& place, LooseParticles& loose) {
    alignas(32) std::array<double, 4> is{}, chi{};
    simd::select(place.loose, Four(1.0), Four(0.0)).store(is.data());
    place.wholeness.store(chi.data());
    for (std::size_t lane = 0; lane < at.count; ++lane)
      if (is[lane] > 0.0) loose.add(at.first + lane, chi[lane] < broken_below);
  }
};

}  // namespace barchan
