// The loop over one row of a pair list: loads neighbours' records, transposes them in registers, calls a law.
#pragma once

#include <array>
#include <cstdint>

#include "neighbours/pair_list.hpp"
#include "passes/records.hpp"
#include "simd/vec.hpp"

namespace barchan {

inline constexpr int lanes = simd::native_width<double>;
using Lanes = simd::Vec<double, lanes>;
static_assert(PairList::padding % lanes == 0);

/// Calls f(record) for every vector of `lanes` neighbours in the row; record[field] holds that field of each.
template <int Fields, class F>
BARCHAN_SIMD_INLINE void for_each_neighbour(PairList::Row row, const RecordArray& records, F&& f) {
  const double* data = records.data();
  for (const std::uint32_t* q = row.begin; q != row.end; q += lanes) {
    Lanes record[Fields];
    simd::load_transposed<Fields>(data, static_cast<std::size_t>(Fields), q, record);
    f(record);
  }
}

/// x_a - x_b by component, and its square.
template <int Dim>
BARCHAN_SIMD_INLINE Lanes separation(const std::array<Lanes, Dim>& x_a, const Lanes* x_b, std::array<Lanes, Dim>& r) {
  Lanes r2(0.0);
  for (std::size_t d = 0; d < Dim; ++d) {
    r[d] = x_a[d] - x_b[d];
    r2 = d == 0 ? r[d] * r[d] : simd::fma(r[d], r[d], r2);
  }
  return r2;
}

}  // namespace barchan
