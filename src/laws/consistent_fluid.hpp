// Weakly compressible fluid, corrected operators: exact for linear fields on any particle arrangement, in one pass.
//
// Every operator is a local combination of raw sums over the neighbours (r = x_a - x_b, F = W'/r, V volume):
//   M = sum V F r (x) r,   B = sum V F r,   P = sum V F (p_a - p_b) r,   U = sum V F v_ab (x) r    (M tends to -1)
//   w = 1 + r.A.r/r^2,     C = sum V F w r,   L_v = sum V F w v_ab,         L_p = sum V F p_ab
//   grad p = M^-1 P,  grad v = U M^-1     (renormalised gradient: Randles & Libersky 1996; Bonet & Lok 1999)
//   lap v  = -2 Dim [L_v - grad v . C] / (tr M + A:M)
//   A      = -(Dim+2)/2 (Dim M/tr M - 1), of the step before: weights that make the second moment isotropic, so that
//   the
//            Laplacian is exact for quadratic fields too (first-order correction after Basic et al. 2018)
// The second-order scheme of Negi & Ramachandran 2022 uses the same gradient; taking the corrections out of the sums is
// what saves its extra passes. The form is not antisymmetric: momentum is conserved to the order of the scheme only.
#pragma once

#include <array>

#include "simd/vec.hpp"

namespace barchan {

/// Place of (d, e) in a moment: xx xy yy | xx xy yy xz yz zz.
constexpr std::size_t moment_index(std::size_t d, std::size_t e) {
  return d >= e ? d * (d + 1) / 2 + e : e * (e + 1) / 2 + d;
}

/// Trace of a moment.
template <int Dim, class V>
BARCHAN_SIMD_INLINE V trace_of(const std::array<V, Dim*(Dim + 1) / 2>& m) {
  if constexpr (Dim == 2) return m[0] + m[2];
  else return m[0] + m[2] + m[5];
}

/// Length of a vector.
template <int Dim, class V>
BARCHAN_SIMD_INLINE V length_of(const std::array<V, Dim>& x) {
  V square = x[0] * x[0];
  for (std::size_t d = 1; d < Dim; ++d) square = simd::fma(x[d], x[d], square);
  return simd::sqrt(square);
}

template <int Dim>
struct ConsistentFluid {
  static constexpr bool needs_distance = true;
  static constexpr bool corrected = true;
  static constexpr int moments = Dim * (Dim + 1) / 2;

  template <class T>
  struct Sums {
    std::array<T, moments> moment;               // sum V F r r: xx xy yy | xx xy yy xz yz zz
    std::array<T, Dim> concentration, pressure;  // B, P
    std::array<T, Dim * Dim> velocity;           // U, row: component of v, column: of r
    std::array<T, Dim> viscous, weighted;        // L_v, C
    T diffusion;                                 // L_p less its hydrostatic part

    /// Adds the sums of one entry; see PlainFluid. The viscosity is the phase's, not the entry's.
    BARCHAN_SIMD_INLINE void take(const Sums& s, double scale, double, double, const std::array<double, 3>& weight) {
      const T k = simd::broadcast<T>(scale);
      for (std::size_t m = 0; m < moments; ++m) moment[m] = fma(k, s.moment[m], moment[m]);
      for (std::size_t m = 0; m < Dim * Dim; ++m) velocity[m] = fma(k, s.velocity[m], velocity[m]);
      T hydrostatic = simd::broadcast<T>(0.0);
      for (std::size_t d = 0; d < Dim; ++d) {
        concentration[d] = fma(k, s.concentration[d], concentration[d]);
        pressure[d] = fma(k, s.pressure[d], pressure[d]);
        viscous[d] = fma(k, s.viscous[d], viscous[d]);
        weighted[d] = fma(k, s.weighted[d], weighted[d]);
        hydrostatic = fma(simd::broadcast<T>(weight[d]), s.concentration[d], hydrostatic);
      }
      diffusion = fma(k, s.diffusion - hydrostatic, diffusion);
    }
  };

  template <class T>
  struct Own {
    std::array<T, Dim> x, v;
    T p;
    std::array<T, moments> anisotropy;  // A, the order of the moment; off the diagonal doubled
  };

  template <class T>
  static BARCHAN_SIMD_INLINE void add(const Own<T>& a, const std::array<T, Dim>& r, T r2, T f, const T* v_b, T p_b,
                                      T volume_b, Sums<T>& s) {
    add_difference(a, r, r2, f, v_b, a.p - p_b, volume_b, s);
  }

  /// The same for a given difference of pressure.
  template <class T>
  static BARCHAN_SIMD_INLINE void add_difference(const Own<T>& a, const std::array<T, Dim>& r, T r2, T f, const T* v_b,
                                                 T dp, T volume_b, Sums<T>& s) {
    add_rubbing(
        a, r, r2, f, v_b, dp, volume_b,
        s, [&](std::size_t d, T dv, T wvf, const std::array<T, Dim>&) __attribute__((always_inline)) {
          s.viscous[d] = fma(wvf, dv, s.viscous[d]);
        });
  }

  /// The same with a given friction: `rub(d, component d of v_ab, V F w, V F r)` adds to the viscous sum.
  template <class T, class Rub>
  static BARCHAN_SIMD_INLINE void add_rubbing(const Own<T>& a, const std::array<T, Dim>& r, T r2, T f, const T* v_b,
                                              T dp, T volume_b, Sums<T>& s, Rub&& rub) {
    const T vf = volume_b * f;
    T lopsided = simd::broadcast<T>(0.0);  // r.A.r
    std::size_t q = 0;
    for (std::size_t d = 0; d < Dim; ++d) {
      T along = simd::broadcast<T>(0.0);
      for (std::size_t e = 0; e <= d; ++e, ++q)
        along = e == 0 ? a.anisotropy[q] * r[e] : fma(a.anisotropy[q], r[e], along);
      lopsided = d == 0 ? along * r[d] : fma(along, r[d], lopsided);
    }
    const T wvf = fma(vf, lopsided / r2, vf);
    std::array<T, Dim> g;
    for (std::size_t d = 0; d < Dim; ++d) {
      g[d] = vf * r[d];
      s.concentration[d] = s.concentration[d] + g[d];
      s.pressure[d] = fma(dp, g[d], s.pressure[d]);
      s.weighted[d] = fma(wvf, r[d], s.weighted[d]);
    }
    std::size_t m = 0;
    for (std::size_t d = 0; d < Dim; ++d)
      for (std::size_t e = 0; e <= d; ++e, ++m) s.moment[m] = fma(g[d], r[e], s.moment[m]);
    for (std::size_t d = 0; d < Dim; ++d) {
      const T dv = a.v[d] - v_b[d];
      for (std::size_t e = 0; e < Dim; ++e) s.velocity[d * Dim + e] = fma(dv, g[e], s.velocity[d * Dim + e]);
      rub(d, dv, wvf, g);
    }
    s.diffusion = fma(vf, dp, s.diffusion);
  }
};

}  // namespace barchan
