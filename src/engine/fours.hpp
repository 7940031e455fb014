// What follows a row's sums is done for four particles side by side, in double.
#pragma once

#include <algorithm>
#include <array>
#include <bit>

#include "engine/pair_loop.hpp"

namespace barchan {

using Four = simd::Vec<double, 4>;

/// The sums over the lanes of every member, for four particles: plain aggregates of the same shape.
template <class Reduced, class T, class Sums>
BARCHAN_SIMD_INLINE Reduced reduce(const std::array<Sums, 4>& from) {
  constexpr std::size_t count = sizeof(Sums) / sizeof(LanesOf<T>);
  static_assert(count == sizeof(Reduced) / sizeof(Four));
  using Members = std::array<LanesOf<T>, count>;
  const auto &a = reinterpret_cast<const Members&>(from[0]), &b = reinterpret_cast<const Members&>(from[1]),
             &c = reinterpret_cast<const Members&>(from[2]), &d = reinterpret_cast<const Members&>(from[3]);
  std::array<Four, count> x;
  for (std::size_t k = 0; k < count; ++k) x[k] = simd::convert<double>(simd::sum(a[k], b[k], c[k], d[k]));
  return std::bit_cast<Reduced>(x);
}

/// Four values of a column from k on, of which `count` exist.
BARCHAN_SIMD_INLINE Four load_four(const double* column, std::size_t k, std::size_t count) {
  if (count == 4) return Four::load(column + k);
  alignas(32) std::array<double, 4> x{1.0, 1.0, 1.0, 1.0};
  std::copy_n(column + k, count, x.data());
  return Four::load(x.data());
}
BARCHAN_SIMD_INLINE void store_four(Four v, double* column, std::size_t k, std::size_t count) {
  if (count == 4) return v.store(column + k);
  alignas(32) std::array<double, 4> x;
  v.store(x.data());
  std::copy_n(x.data(), count, column + k);
}

/// Writes fields of four records that stand side by side, `stride` apart: lane k of values[f] becomes field f of record
/// k.
template <std::size_t Fields>
BARCHAN_SIMD_INLINE void store_records(std::array<Four, Fields> values, double* records, std::size_t stride) {
  constexpr std::size_t whole = Fields / 4 * 4;
  for (std::size_t f = 0; f < whole; f += 4) {
    simd::transpose(values[f], values[f + 1], values[f + 2], values[f + 3]);
    for (std::size_t k = 0; k < 4; ++k) values[f + k].store(records + k * stride + f);
  }
  for (std::size_t f = whole; f < Fields; ++f)
    for (std::size_t k = 0; k < 4; ++k) records[k * stride + f] = values[f][static_cast<int>(k)];
}

}  // namespace barchan
