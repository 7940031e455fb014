// A fluid whose particles have viscosities of their own, corrected operators: div (mu grad v) for mu lap v.
//
// The sums of ConsistentFluid, with the pair's viscosity mu_ab (pair_viscosity) in L_v, and the flux of momentum
//   L_v = sum V F w mu_ab v_ab,   T' = sum V F mu_ab v_ab (x) r     (T' M^-1 is mu grad v as the pairs have it)
//
// Pairs with a solid have the sums of ConsistentFluid only; what the solid says of their friction makes L_v and T':
//   a viscosity mu of all its pairs:  L_v = mu sum V F w v_ab,   T' = mu U
//   a shear stress tau:  mu_ab v_ab = tau (r.n), n the normal into the fluid:  L_v = tau (C.n),   T' = tau (x) M n
#pragma once

#include <cmath>

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

  /// The normal into the fluid of a solid with these raw sums: against their B. Raw sums lack the kernel's constant,
  /// whose sign is that of `scale`. Zero where B is zero.
  template <class T>
  static std::array<T, Dim> normal_of(const typename ConsistentFluid<Dim>::template Sums<T>& raw, double scale) {
    const T size = T(std::copysign(1.0, scale)) * length_of<Dim, T>(raw.concentration);
    std::array<T, Dim> normal;
    for (std::size_t d = 0; d < Dim; ++d)
      normal[d] = simd::select(size != T(0.0), -raw.concentration[d] / size, T(0.0));
    return normal;
  }

  /// The sums of a solid's pairs that rub with the shear stress tau [Pa].
  template <class T>
  static Sums<T> with_stress(const typename ConsistentFluid<Dim>::template Sums<T>& raw,
                             const std::array<T, Dim>& normal, const std::array<T, Dim>& tau) {
    Sums<T> s{raw, {}};
    T across(0.0);
    for (std::size_t d = 0; d < Dim; ++d) across += raw.weighted[d] * normal[d];
    for (std::size_t f = 0; f < Dim; ++f) {
      T moment(0.0);
      for (std::size_t d = 0; d < Dim; ++d) moment += raw.moment[moment_index(f, d)] * normal[d];
      for (std::size_t d = 0; d < Dim; ++d) s.flux[d * Dim + f] = tau[d] * moment;
    }
    for (std::size_t d = 0; d < Dim; ++d) s.viscous[d] = tau[d] * across;
    return s;
  }

  /// The sums of a solid's pairs that rub with the viscosity mu [Pa s].
  template <class T>
  static Sums<T> with_viscosity(const typename ConsistentFluid<Dim>::template Sums<T>& raw, T mu) {
    Sums<T> s{raw, {}};
    for (auto& v : s.viscous) v *= mu;
    for (std::size_t m = 0; m < Dim * Dim; ++m) s.flux[m] = mu * raw.velocity[m];
    return s;
  }

  /// The friction that the sums make, L_v - T' M^-1 C; on the way, the squares of the stress mu |S| and of the strain
  /// |S|, |S|^2 = 2 S:S.
  template <class T>
  struct Stress {
    const Sums<T>& s;
    T phi2{0.0}, shear2{0.0};
    std::array<std::array<T, Dim>, Dim> t{}, gradient{};  // T M^-1, grad v

    template <class Matrix, class Gradient>
    BARCHAN_SIMD_INLINE std::array<T, Dim> operator()(const Matrix& inverse, const Gradient& grad_v) {
      gradient = grad_v;
      std::array<T, Dim> friction = s.viscous;
      for (std::size_t d = 0; d < Dim; ++d)
        for (std::size_t e = 0; e < Dim; ++e) {
          t[d][e] = s.flux[d * Dim] * inverse[e];
          for (std::size_t f = 1; f < Dim; ++f) t[d][e] = simd::fma(s.flux[d * Dim + f], inverse[f * Dim + e], t[d][e]);
          friction[d] -= t[d][e] * s.weighted[e];
        }
      for (std::size_t d = 0; d < Dim; ++d)
        for (std::size_t e = 0; e < Dim; ++e) {
          const T both = t[d][e] + t[e][d], strain = grad_v[d][e] + grad_v[e][d];
          phi2 += T(0.5) * both * both;
          shear2 += T(0.5) * strain * strain;
        }
      return friction;
    }
  };
};

}  // namespace barchan
