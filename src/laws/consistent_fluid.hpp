// Weakly compressible fluid, corrected operators: exact for linear fields on any particle arrangement, in one pass.
//
// Every operator is a local combination of raw sums over the neighbours (r = x_a - x_b, F = W'/r, V volume):
//   M = -sum V F r (x) r,   B = sum V F r,   P = sum V F (p_a - p_b) r,   U = sum V F v_ab (x) r
//   grad p = -M^-1 P ... (renormalised gradient: Randles & Libersky 1996; Bonet & Lok 1999)
//   lap f  = 2 (Dim/tr M) [ L_f - grad f . B ],  L_f = sum V F (f_a - f_b)      (after Basic et al. 2018)
// The second-order scheme of Negi & Ramachandran 2022 uses the same gradient; taking the corrections out of the sums is
// what saves its extra passes. The form is not antisymmetric: momentum is conserved to the order of the scheme only.
#pragma once

#include <array>

#include "simd/vec.hpp"

namespace barchan {

template <int Dim>
struct ConsistentFluid {
  static constexpr bool corrected = true;
  static constexpr int moments = Dim * (Dim + 1) / 2;

  template <class T>
  struct Sums {
    std::array<T, moments> moment{};                 // sum V F r r: xx xy yy | xx xy yy xz yz zz
    std::array<T, Dim> concentration{}, pressure{};  // B, P
    std::array<T, Dim * Dim> velocity{};             // U, row: component of v, column: of r
    std::array<T, Dim> viscous{};                    // L_v
    T diffusion{};                                   // sum V F (p_ab - rho0 g.r)
  };

  template <class T>
  struct Own {
    std::array<T, Dim> x, v, weight;
    T p, mu, diffusive;
  };

  template <class T>
  static void add(const Own<T>& a, const std::array<T, Dim>& r, T f, const T* v_b, T p_b, T volume_b, Sums<T>& s) {
    const T vf = volume_b * f;
    const T dp = a.p - p_b;
    std::array<T, Dim> g;
    for (std::size_t d = 0; d < Dim; ++d) {
      g[d] = vf * r[d];
      s.concentration[d] = s.concentration[d] + g[d];
      s.pressure[d] = fma(dp, g[d], s.pressure[d]);
    }
    std::size_t m = 0;
    for (std::size_t d = 0; d < Dim; ++d)
      for (std::size_t e = 0; e <= d; ++e, ++m) s.moment[m] = fma(g[d], r[e], s.moment[m]);
    T dynamic = dp;
    for (std::size_t d = 0; d < Dim; ++d) {
      const T dv = a.v[d] - v_b[d];
      for (std::size_t e = 0; e < Dim; ++e) s.velocity[d * Dim + e] = fma(dv, g[e], s.velocity[d * Dim + e]);
      s.viscous[d] = fma(vf, dv, s.viscous[d]);
      dynamic = fnma(a.weight[d], r[d], dynamic);
    }
    s.diffusion = fma(vf, dynamic, s.diffusion);
  }
};

}  // namespace barchan
