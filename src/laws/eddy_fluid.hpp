// A fluid whose particles have viscosities of their own, corrected operators: div (mu grad v) for mu lap v.
//
// The sums of ConsistentFluid, with the pair's viscosity mu_ab (pair_viscosity) in L_v, and the flux of momentum
//   L_v = sum V F w mu_ab v_ab,   T' = sum V F mu_ab v_ab (x) r     (T' M^-1 is mu grad v as the pairs have it)
#pragma once

#include "laws/consistent_fluid.hpp"
#include "laws/eddies.hpp"

namespace barchan {

template <int Dim>
struct EddyFluid {
  static constexpr bool needs_distance = true;
  static constexpr bool needs_root = true;  // sqrt of the neighbour's viscosity
  static constexpr bool corrected = true;

  template <class T>
  struct Sums : ConsistentFluid<Dim>::template Sums<T> {
    std::array<T, Dim * Dim> flux;  // T', row: component of v, column: of r

    BARCHAN_SIMD_INLINE void take(const Sums& s, double scale, const std::array<double, 3>& weight) {
      ConsistentFluid<Dim>::template Sums<T>::take(s, scale, 0.0, 0.0, weight);
      const T k = simd::broadcast<T>(scale);
      for (std::size_t m = 0; m < Dim * Dim; ++m) flux[m] = fma(k, s.flux[m], flux[m]);
    }
  };

  template <class T>
  struct Own : ConsistentFluid<Dim>::template Own<T> {
    T root;  // sqrt(Pa s)
  };

  template <class T>
  static BARCHAN_SIMD_INLINE void add(const Own<T>& a, const std::array<T, Dim>& r, T r2, T f, const T* v_b, T p_b,
                                      T volume_b, T root_b, Sums<T>& s) {
    const T mu = pair_viscosity(a.root, root_b);
    const auto rub = [&](std::size_t d, T dv, T wvf, const std::array<T, Dim>& g) __attribute__((always_inline)) {
      const T mu_dv = mu * dv;
      s.viscous[d] = fma(wvf, mu_dv, s.viscous[d]);
      for (std::size_t e = 0; e < Dim; ++e) s.flux[d * Dim + e] = fma(mu_dv, g[e], s.flux[d * Dim + e]);
    };
    ConsistentFluid<Dim>::add_rubbing(a, r, r2, f, v_b, a.p - p_b, volume_b, s, rub);
  }
};

}  // namespace barchan
