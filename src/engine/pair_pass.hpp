// The loop over pairs, made from a law: laws/pair.hpp says what a law is. One pass goes over the particles of a phase;
// of each it sums a law's pairs in every entry, and hands the sums to the model.
//
// A particle's sums have one order: entry by entry, in a row as the list has it. Positions and ids decide that order,
// so the results have the same bits on any number of threads. Only for hot files, in whose namespace it stands: no
// function for one instruction set has the name of one for another (base/instructions.hpp).
#pragma once

#include <span>
#include <vector>

#include "engine/pair_entry.hpp"
#include "engine/pair_loop.hpp"
#include "engine/shares.hpp"
#include "kernels/kernel.hpp"
#include "laws/pair.hpp"
#include "state/particles.hpp"

namespace barchan::BARCHAN_TARGET {

namespace detail {

/// First: of the first particle, which has nothing beside its record.
template <Quantity q, bool first, int Dim, class T>
BARCHAN_SIMD_INLINE void take_quantity(barchan::detail::Has<q, Dim, T>& particle, const T* record,
                                       [[maybe_unused]] const double* beside,
                                       [[maybe_unused]] const std::uint32_t* at) {
  using R = MotionRecord<Dim>;
  if constexpr (q == Quantity::velocity)
    for (std::size_t d = 0; d < Dim; ++d) particle.v[d] = record[R::velocity + d];
  else if constexpr (q == Quantity::pressure) particle.p = record[R::pressure];
  else if constexpr (q == Quantity::volume) particle.volume = record[R::volume];
  else if constexpr (q == Quantity::beside && !first) particle.beside = gather_of<T::width>(beside, at);
}

/// How their bodies carry the neighbours, from their transposed record.
template <int Dim, class T>
BARCHAN_SIMD_INLINE void take_carried(barchan::detail::Has<Quantity::carried, Dim, T>& particle, const T* record) {
  using R = CarriedRecord<Dim>;
  for (std::size_t d = 0; d < Dim; ++d) {
    particle.u[d] = record[R::velocity + d];
    particle.c[d] = record[R::turning + d];
  }
  for (std::size_t d = 0; d < particle.rate.size(); ++d) {
    particle.rate[d] = record[R::rate + d];
    particle.old_rate[d] = record[R::old_rate + d];
  }
}

/// Neighbours from their transposed record; beside: of laws that read it, at: the list's entries.
template <int Dim, class T, Quantity... q>
BARCHAN_SIMD_INLINE void take(Particle<Dim, T, Quantities<q...>>& particle, const T* record,
                              [[maybe_unused]] const double* beside, [[maybe_unused]] const std::uint32_t* at) {
  for (std::size_t d = 0; d < Dim; ++d) particle.x[d] = record[MotionRecord<Dim>::position + d];
  (take_quantity<q, false, Dim, T>(particle, record, beside, at), ...);
}

/// The first particle, the same in all lanes.
template <int Dim, class T, Quantity... q>
BARCHAN_SIMD_INLINE void broadcast(Particle<Dim, T, Quantities<q...>>& particle, const double* record) {
  T lanes[MotionRecord<Dim>::size];
  for (std::size_t f = 0; f < MotionRecord<Dim>::size; ++f) lanes[f] = T(record[f]);
  for (std::size_t d = 0; d < Dim; ++d) particle.x[d] = lanes[MotionRecord<Dim>::position + d];
  (take_quantity<q, true, Dim, T>(particle, lanes, nullptr, nullptr), ...);
}

}  // namespace detail

/// The pairs of one row.
template <int Dim, class Law, class Kernel, class Own, class Sums>
BARCHAN_SIMD_INLINE void add_row(const Law& law, const Kernel& kernel, const Own& a, PairList::Row row,
                                 const PairEntry<Law>& e, Sums& sums) {
  using R = MotionRecord<Dim>;
  const double* data = e.records->data();
  for (const std::uint32_t* at = row.begin; at != row.end; at += Lanes::width) {
    Lanes record[R::size];
    simd::load_transposed<R::size>(data, R::size / PairList::stride, at, record);
    Particle<Dim, Lanes, typename Law::Reads> b;
    detail::take(b, record, e.beside, at);
    if constexpr (reads_quantity<typename Law::Reads, Quantity::carried>) {
      using C = CarriedRecord<Dim>;
      Lanes carried[C::size];
      simd::load_transposed<C::size>(e.carried->data(), C::size / PairList::stride, at, carried);
      detail::take_carried<Dim, Lanes>(b, carried);
    }
    Pair<Dim, Lanes> ab;
    ab.r2 = separation<Dim>(a.x, record + R::position, ab.r);
    if constexpr (Law::needs == Needs::value_and_gradient) kernel.value_and_gradient(ab.r2, ab.w, ab.f);
    else if constexpr (Law::needs == Needs::gradient) ab.f = kernel.gradient(ab.r2);
    else ab.f = kernel.slope(ab.r2);
    law.add(a, b, ab, sums);
  }
}

/// For each of the n particles: sums the law's pairs of all entries and calls finish(k, sums, met), met: whether it has
/// a neighbour. `own`: the particles' motion records, of which the pass may change its own (k). `prepare(k, a)` gives
/// the first particle what a law wants beside its record. `piece`: particles that a thread takes at once. A law with
/// close_entry gets its sums behind each entry.
template <int Dim, class Law, class Prepare, class Finish>
BARCHAN_SIMD_INLINE void pair_pass(std::size_t n, std::int64_t piece, const RecordArray& own,
                                   std::span<const PairEntry<Law>> entries, Prepare&& prepare, Finish&& finish) {
  thread_local std::vector<ReadyKernel> ready;
  std::vector<ReadyKernel>& kernels = ready;
  kernels.clear();
  for (const auto& e : entries) kernels.emplace_back(e.kernel, e.radius, Dim);
  Shares shares(static_cast<std::int64_t>(n), piece);
#pragma omp parallel
  for (const std::int64_t i : shares) {
    const auto k = static_cast<std::size_t>(i);
    typename Law::template Own<Dim, Lanes> a;
    detail::broadcast(a, own[k]);
    prepare(k, a);
    typename Law::template Sums<Dim, Lanes> sums{};
    bool met = false;
    for (std::size_t c = 0; c < entries.size(); ++c) {
      const auto& e = entries[c];
      const auto row = e.list->row(k);
      if (row.begin == row.end) continue;
      met = true;
      kernels[c]([&](const auto& kernel)
                     __attribute__((always_inline)) { add_row<Dim>(e.law, kernel, a, row, e, sums); });
      if constexpr (Law::closes_each_entry) e.law.close_entry(sums);
    }
    finish(k, sums, met);
  }
}

/// The pass of a law of forces, one entry: adds force over mass to the acceleration of `a`. A law of forces sums a
/// vector `force` [N].
template <int Dim, class Law>
BARCHAN_SIMD_INLINE void accelerate_in(PhaseParticles& a, const RecordArray& own, const PairEntry<Law>& entry) {
  std::array<double*, Dim> acceleration{};
  for (std::size_t d = 0; d < Dim; ++d) acceleration[d] = a.column(Field::acceleration, static_cast<int>(d));
  const double inverse_mass = 1.0 / a.mass();
  pair_pass<Dim, Law>(
      a.size(), 64, own, {&entry, 1}, [](std::size_t, auto&) {},
      [&](std::size_t k, const auto& sums, bool met) __attribute__((always_inline)) {
        if (!met) return;
        for (std::size_t d = 0; d < Dim; ++d) acceleration[d][k] += simd::sum(sums.force[d]) * inverse_mass;
      });
}
template <class Law>
BARCHAN_SIMD_INLINE void accelerate(PhaseParticles& a, const RecordArray& own, const PairEntry<Law>& entry) {
  if (a.dimensions() == 2) accelerate_in<2>(a, own, entry);
  else accelerate_in<3>(a, own, entry);
}

}  // namespace barchan::BARCHAN_TARGET
