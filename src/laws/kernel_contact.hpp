// Contact of two grains through the kernel of their entry: the small-radius entries of the matrix are contact laws, not
// approximations of a continuum (a kernel of 1.1 spacings sees 14 % of a gradient).
//
// A pair repels with the potential
//   U(r) = 1/2 K g(r)^2,  g(r) = max(W(r) - W(d), 0) / |W'(d)|,
// zero at the rest distance d, so that U ~ 1/2 K (d - r)^2 for a small overlap and stiffer beyond. That is eq. (12) of
// Halik et al. 2015 for two particles, whose density rises by m (W(r) - W(d)), without its tension: grains do not
// stick. The dashpot c v_n acts while they overlap, scaled like the stiffness, so that the restitution does not depend
// on speed:
//   c = 2 zeta sqrt(K m*) W'(r)/W'(d),  e = exp(-pi zeta / sqrt(1 - zeta^2))   (linear spring and dashpot).
#pragma once

#include <array>
#include <cmath>
#include <numbers>

#include "laws/pair.hpp"

namespace barchan {

struct KernelContact {
  double stiffness;      // K [N/m] (N/m per metre of depth in 2D)
  double damping;        // 2 zeta sqrt(K m*) [N s/m]
  double rest_value;     // W(d)
  double inverse_slope;  // 1/|W'(d)|

  /// Damping ratio for a restitution 0 < e <= 1.
  static double damping_ratio(double restitution) {
    const double l = std::log(restitution);
    return -l / std::sqrt(std::numbers::pi * std::numbers::pi + l * l);
  }

  template <class T>
  struct Constants {
    T stiffness, damping, rest_value, inverse_slope;
    BARCHAN_SIMD_INLINE explicit Constants(const KernelContact& c)
        : stiffness(c.stiffness), damping(c.damping), rest_value(c.rest_value), inverse_slope(c.inverse_slope) {}
  };

  /// Adds the force [N] on a: r = x_a - x_b, v = v_a - v_b, w and f the kernel and its gradient factor at r. r2 > 0, in
  /// the range of simd::inverse_sqrt.
  template <class T, std::size_t Dim>
  static BARCHAN_SIMD_INLINE void add(const Constants<T>& c, const std::array<T, Dim>& r, T r2,
                                      const std::array<T, Dim>& v, T w, T f, std::array<T, Dim>& force) {
    const T overlap = max(w - c.rest_value, T(0.0)) * c.inverse_slope;  // g [m]
    const T slope = f * c.inverse_slope;                                // W'(r)/|W'(d)| / r, negative
    T vr(0.0);
    for (std::size_t d = 0; d < Dim; ++d) vr = fma(v[d], r[d], vr);
    // -dU/dr e_r = -K g g' e_r; dashpot -c |W'(r)/W'(d)| v_n e_r with v_n = v.r/r: one factor 1/r of each is in slope.
    const T inverse_r = inverse_sqrt(r2);
    const T touching = touch(overlap);
    const T magnitude = slope * fma(c.damping * touching, vr * inverse_r, -c.stiffness * overlap);
    for (std::size_t d = 0; d < Dim; ++d) force[d] = fma(magnitude, r[d], force[d]);
  }

 private:
  template <class T>
  static BARCHAN_SIMD_INLINE T touch(T overlap) {
    return select(overlap > T(0.0), T(1.0), T(0.0));
  }
};

/// An entry of contacts through its kernel.
struct KernelContacts : PairLaw<Needs::value_and_gradient, Quantity::velocity> {
  KernelContact contact;

  template <int Dim, class T>
  struct Sums {
    std::array<T, Dim> force;  // N, on a
  };

  template <int Dim, class T>
  BARCHAN_SIMD_INLINE void add(const Own<Dim, T>& a, const Own<Dim, T>& b, const Pair<Dim, T>& ab,
                               Sums<Dim, T>& s) const {
    KernelContact::add(KernelContact::Constants<T>(contact), ab.r, ab.r2, difference(a.v, b.v), ab.w, ab.f, s.force);
  }
};

}  // namespace barchan
