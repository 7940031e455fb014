// What the sums of a total Lagrangian body share: its slots, and the gradient of the displacement.
#pragma once

#include <algorithm>

#include "engine/pair_loop.hpp"
#include "laws/hyperelastic.hpp"
#include "models/bodies/total_lagrangian.hpp"

namespace barchan::BARCHAN_TARGET {

namespace {

using hyperelastic::Matrix;

template <class T>
constexpr std::size_t margin = TotalWork<T>::margin;

/// A column from its first particle on.
template <class T, class C>
BARCHAN_SIMD_INLINE const C* from(const AlignedVector<C>& column) {
  return column.data() + margin<T>;
}

/// Calls f(w, wX, load) for every slot of a group; load(column) has the neighbours' values.
template <int Dim, class T, class F>
BARCHAN_SIMD_INLINE void sweep(const ReferenceBody<T>& body, std::size_t group, F&& f) {
  using V = LanesOf<T>;
  constexpr std::size_t width = static_cast<std::size_t>(V::width), stride = width * (1 + Dim);
  using Group = typename ReferenceBody<T>::Group;
  const Group begin = group > 0 ? body.groups[group - 1] : Group{}, end = body.groups[group];
  const auto first = static_cast<std::ptrdiff_t>(group * width);
  std::array<V, Dim> wx;
  for (std::uint32_t s = begin.whole; s < end.whole; ++s) {
    const auto& slot = body.wholes[s];
    for (std::size_t d = 0; d < Dim; ++d) wx[d] = V(slot.weights.wx[d]);
    f(
        V(slot.weights.w), wx, [at = first + slot.delta]<class C>(const C* column) __attribute__((always_inline)) {
          return simd::Vec<C, V::width>::load(column + at);
        });
  }
  const auto weights = [&](const T* from) __attribute__((always_inline)) {
    for (std::size_t d = 0; d < Dim; ++d) wx[d] = V::load(from + (1 + d) * width);
    return V::load(from);
  };
  for (std::uint32_t s = begin.part; s < end.part; ++s) {
    const V w = weights(body.part_weights.data() + s * stride);
    f(
        w, wx, [at = first + body.part_delta[s]]<class C>(const C* column) __attribute__((always_inline)) {
          return simd::Vec<C, V::width>::load(column + at);
        });
  }
  for (std::uint32_t s = begin.scattered; s < end.scattered; ++s) {
    const V w = weights(body.scattered_weights.data() + s * stride);
    f(
        w, wx, [index = body.index.data() + s * width]<class C>(const C* column) __attribute__((always_inline)) {
          return simd::gather<C, V::width>(column, index);
        });
  }
}

/// u_a - u_b in the units of the work.
template <class T, class P>
BARCHAN_SIMD_INLINE LanesOf<T> apart(P a, P b) {
  return simd::convert<T>(a - b);
}

/// M^-1 of a group.
template <int Dim, class T>
BARCHAN_SIMD_INLINE Matrix<Dim, LanesOf<T>> inverse_of(const ReferenceBody<T>& body, std::size_t first) {
  Matrix<Dim, LanesOf<T>> l;
  std::size_t c = 0;
  for (std::size_t d = 0; d < Dim; ++d)
    for (std::size_t e = d; e < Dim; ++e) l[d][e] = l[e][d] = LanesOf<T>::load(body.inverse[c++].data() + first);
  return l;
}

/// sum w u_ab (x) X_ab of columns of vectors u.
template <int Dim, class T, class Column>
BARCHAN_SIMD_INLINE Matrix<Dim, LanesOf<T>> gradient_sum(const ReferenceBody<T>& body, std::size_t group,
                                                         const std::array<Column, 3>& columns) {
  using V = LanesOf<T>;
  using Place = simd::Vec<typename Column::value_type, V::width>;
  std::array<Place, Dim> own;
  Matrix<Dim, V> g;
  const std::size_t first = group * static_cast<std::size_t>(V::width);
  for (std::size_t d = 0; d < Dim; ++d) {
    own[d] = Place::load(from<T>(columns[d]) + first);
    for (std::size_t e = 0; e < Dim; ++e) g[d][e] = V(T(0));
  }
  sweep<Dim>(
      body, group, [&](V, const std::array<V, Dim>& wx, auto&& load) __attribute__((always_inline)) {
        for (std::size_t d = 0; d < Dim; ++d) {
          const V u = apart<T>(own[d], load(from<T>(columns[d])));
          for (std::size_t e = 0; e < Dim; ++e) g[d][e] = simd::fma(u, wx[e], g[d][e]);
        }
      });
  return g;
}

/// H = unit G M^-1.
template <int Dim, class V>
BARCHAN_SIMD_INLINE Matrix<Dim, V> gradient_of(const Matrix<Dim, V>& sums, const Matrix<Dim, V>& inverse, V unit) {
  Matrix<Dim, V> h = hyperelastic::product<Dim>(sums, inverse);
  for (std::size_t d = 0; d < Dim; ++d)
    for (std::size_t e = 0; e < Dim; ++e) h[d][e] = h[d][e] * unit;
  return h;
}

/// Writes a group's values to a column of the phase.
template <class T>
BARCHAN_SIMD_INLINE void put(LanesOf<T> value, const TotalWork<T>& work, std::size_t first, std::size_t count,
                             double* column) {
  constexpr int width = LanesOf<T>::width;
  const simd::Vec<double, width> wide = simd::convert<double>(value);
  if (work.in_order && count == width) return wide.store(column + first);
  alignas(64) std::array<double, static_cast<std::size_t>(width)> each;
  wide.store(each.data());
  for (std::size_t k = 0; k < count; ++k) column[work.at[first + k]] = each[k];
}

}  // namespace

}  // namespace barchan::BARCHAN_TARGET
