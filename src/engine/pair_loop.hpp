// The loop over one row of a pair list: loads neighbours' records, transposes them in registers, calls a law.
#pragma once

#include <array>
#include <cstdint>
#include <type_traits>
#include <utility>

#include "engine/pair_list.hpp"
#include "engine/records.hpp"
#include "simd/vec.hpp"

namespace barchan {

/// One register of T.
template <class T>
using LanesOf = simd::Vec<T, simd::native_width<T>>;
using Lanes = LanesOf<double>;

/// Calls f(record) for every vector of neighbours in the row; record[field] holds that field of each. Rows are padded
/// to whole vectors (see PairList).
template <int Fields, class T, class F>
BARCHAN_SIMD_INLINE void for_each_neighbour(PairList::Row row, const T* data, F&& f) {
  static_assert(Fields % PairList::stride == 0);
  for (const std::uint32_t* q = row.begin; q != row.end; q += LanesOf<T>::width) {
    LanesOf<T> record[Fields];
    simd::load_transposed<Fields>(data, Fields / PairList::stride, q, record);
    f(record);
  }
}
template <int Fields, class F>
BARCHAN_SIMD_INLINE void for_each_neighbour(PairList::Row row, const RecordArray& records, F&& f) {
  for_each_neighbour<Fields>(row, records.data(), std::forward<F>(f));
}

/// The same in two stages: `begin(record, the list's entries, stage)` (loads, distance, kernel) for several vectors,
/// then `end(stage)` for them. The long chain
/// of operations from a list's entry to the kernel's value is then off the way of the sums: a processor's window holds
/// two or three vectors, too few to hide that chain.
template <int Fields, class T, class Begin, class End>
BARCHAN_SIMD_INLINE void for_each_staged(PairList::Row row, const T* data, Begin&& begin, End&& end) {
  using V = LanesOf<T>;
  constexpr std::size_t most = 12, fields = 12;
  V stage[most * fields];
  for (const std::uint32_t* q = row.begin; q != row.end;) {
    std::size_t n = 0;
    for (; n < most && q != row.end; ++n, q += V::width) {
      V record[Fields];
      simd::load_transposed<Fields>(data, Fields / PairList::stride, q, record);
      begin(record, q, stage + n * fields);
    }
    for (std::size_t k = 0; k < n; ++k) end(stage + k * fields);
  }
}

/// One number of each of Width neighbours from `at` on. By halves: registers of two are filled without masks.
template <int Width>
BARCHAN_SIMD_INLINE simd::Vec<double, Width> gather_of(const double* values, const std::uint32_t* at) {
  if constexpr (Width == 1) return {values[at[0] / PairList::stride]};
  else return simd::join(gather_of<Width / 2>(values, at), gather_of<Width / 2>(values, at + Width / 2));
}

/// Added to every squared distance (m^2): particles in one place are 3e-19 m apart for the kernels and laws, which
/// divide by the distance. Their r is zero, so that a force along r is zero as well, in both precisions. Within the
/// range of simd::inverse_sqrt; lost in the rounding of every distance that matters.
inline constexpr double least_square = 1.0e-37;

/// x_a - x_b by component, and its square (plus least_square).
template <int Dim>
BARCHAN_SIMD_INLINE Lanes separation(const std::array<Lanes, Dim>& x_a, const Lanes* x_b, std::array<Lanes, Dim>& r) {
  Lanes r2(least_square);
  for (std::size_t d = 0; d < Dim; ++d) {
    r[d] = x_a[d] - x_b[d];
    r2 = simd::fma(r[d], r[d], r2);
  }
  return r2;
}

/// The same in double and in mixed precision, where positions are whole numbers of `unit` (see CompactRecords).
template <int Dim, class T>
BARCHAN_SIMD_INLINE LanesOf<T> separation(const std::array<LanesOf<T>, Dim>& x_a, const LanesOf<T>* x_b,
                                          [[maybe_unused]] LanesOf<T> unit, std::array<LanesOf<T>, Dim>& r) {
  if constexpr (std::is_same_v<T, double>) {
    return separation<Dim>(x_a, x_b, r);
  } else {
    auto r2 = simd::broadcast<LanesOf<T>>(least_square);
    for (std::size_t d = 0; d < Dim; ++d) {
      r[d] = unit * simd::convert<T>(simd::bit_cast<std::int32_t>(x_a[d]) - simd::bit_cast<std::int32_t>(x_b[d]));
      r2 = simd::fma(r[d], r[d], r2);
    }
    return r2;
  }
}

}  // namespace barchan
