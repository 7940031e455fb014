// Elastic bodies: the momentum equation with a stress tensor, and the velocity gradient that drives it.
//
//   dv_a/dt   = sum m_b (s_a/rho_a^2 + s_b/rho_b^2) . grad W - sum m_b Pi_ab grad W    (eq. 12; Gray et al. 2001)
//   drho_a/dt = sum m_b v_ab . grad W,   grad v_a = -sum V_b v_ab (x) grad W
//   Pi_ab     = (-alpha c mu + beta mu^2) / rho,  mu = h v.r/(r^2 + 0.01 h^2) on approach, else 0   (Monaghan 1992)
// The stress rate is Hooke's law with Jaumann's rotation, s_dot = 2 G dev(D) + s.W^T + W.s (eq. 11 prints G for 2G and
// no rotation), in models/bodies/updated_lagrangian.cpp. No kernel corrections: momentum and angular momentum of a pair
// are exact. Where a body is pulled, particles of SPH clump (Swegle's tensile instability). With artificial stress a
// pair has besides
//   sum m_b (R_a + R_b) f^4 . grad W,   f = W(r)/W(dx),   R = -epsilon [s/rho^2]+      (Gray, Monaghan & Swift 2001)
// [ ]+ keeps the principal stresses that pull: particles nearer than dx repel each other.
//   de_a/dt   = -1/2 sum m_b v_ab . [s_a/rho_a^2 + s_b/rho_b^2 - Pi_ab] . grad W   (eq. 13 with the whole stress, and
//   the
//                                                                                   factor 1/2 that it lacks)
// Each particle of a pair gains half of what the pair takes from the motion: work against the stress, and heat of Pi.
#pragma once

#include <array>

#include "simd/vec.hpp"

namespace barchan {

/// Index of component (d, e) in a record's stress: 2D xx yy xy, 3D xx yy zz xy yz xz.
template <int Dim>
constexpr std::size_t stress_index(std::size_t d, std::size_t e) {
  if (d == e) return d;
  if (Dim == 2) return 2;
  const std::size_t sum = d + e;
  return sum == 1 ? 3 : sum == 3 ? 4 : 5;
}

template <int Dim>
struct ElasticForce {
  static constexpr std::size_t stresses = Dim == 2 ? 3 : 6;

  template <class T>
  struct Own {
    std::array<T, Dim> x, v;
    std::array<T, stresses> s;       // stress/density^2
    T mass_b;                        // kg, of a particle of the other phase
    T alpha, beta, smoothing, soft;  // viscosity: -alpha c h/rho, beta h^2/rho, -, 0.01 h^2
  };

  /// power [W/kg]: of the force on `a` in the frame of b, with WithPower.
  template <bool Viscous, bool WithPower, class T>
  static BARCHAN_SIMD_INLINE void add(const Own<T>& a, const std::array<T, Dim>& r, T r2, T f, const T* v_b,
                                      const T* s_b, T volume_b, std::array<T, Dim>& acceleration,
                                      [[maybe_unused]] T& power) {
    // The dummy has no volume; its mass must vanish as well.
    const T mf = select(volume_b > T(0.0), a.mass_b * f, T(0.0));
    T resistance(0.0);
    if constexpr (Viscous) {
      T vr(0.0);
      for (std::size_t d = 0; d < Dim; ++d) vr = fma(a.v[d] - v_b[d], r[d], vr);
      const T mu = min(vr, T(0.0)) / (r2 + a.soft);
      resistance = mu * fma(a.beta, mu, a.alpha);
    }
    std::array<T, stresses> s;
    for (std::size_t q = 0; q < stresses; ++q) s[q] = a.s[q] + s_b[q];
    for (std::size_t d = 0; d < Dim; ++d) {
      T traction = -(resistance * r[d]);
      for (std::size_t e = 0; e < Dim; ++e) traction = fma(s[stress_index<Dim>(d, e)], r[e], traction);
      acceleration[d] = fma(mf, traction, acceleration[d]);
      if constexpr (WithPower) power = fma(mf * traction, a.v[d] - v_b[d], power);
    }
  }
};

/// f^4 of the artificial stress; weight: W(r)/W(dx).
template <class T>
BARCHAN_SIMD_INLINE T nearness(T weight) {
  const T square = weight * weight;
  return square * square;
}

template <int Dim>
struct ElasticStrain {
  template <class T>
  struct Sums {
    std::array<T, Dim * Dim> gradient;  // sum V F v_ab (x) r
    T density;                          // sum m F v_ab . r
  };

  template <class T>
  static BARCHAN_SIMD_INLINE void add(const std::array<T, Dim>& v_a, T mass_b, const std::array<T, Dim>& r, T f,
                                      const T* v_b, T volume_b, Sums<T>& s) {
    const T vf = volume_b * f;
    T vr(0.0);
    for (std::size_t d = 0; d < Dim; ++d) {
      const T dv = v_a[d] - v_b[d];
      vr = fma(dv, r[d], vr);
      for (std::size_t e = 0; e < Dim; ++e) s.gradient[d * Dim + e] = fma(vf * dv, r[e], s.gradient[d * Dim + e]);
    }
    s.density = fma(select(volume_b > T(0.0), mass_b * f, T(0.0)), vr, s.density);
  }
};

}  // namespace barchan
