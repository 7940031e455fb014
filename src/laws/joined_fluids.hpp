// Two fluids that touch, corrected operators: what a pair across their interface adds to the rates of its first
// particle.
//
// Pressure is continuous there, its gradient is not: it jumps like the density. What is continuous is the acceleration
// grad p/rho, so with the interface between a and b
//   (p_a - p_i)/rho_a = (p_i - p_b)/rho_b,   p_i = (rho_b p_a + rho_a p_b)/(rho_a + rho_b)
// (Hu & Adams 2006; Adami et al. 2012), and a feels rho_a 2 (p_a - p_b)/(rho_a + rho_b) in place of p_a - p_b. Of
// particles a thousand times as heavy as a this is what a moving wall does; of particles a thousand times lighter, a
// free surface.
//
// Weight first. The interface is a plane near a, and b has the distance d_b from it (laws/interface_plane.hpp). At rest
//   p_a - p_b = W_ab = rho_a g.r + (rho_a - rho_b) g.n d_b,   n: the plane's normal, from a to b
// and only what is beyond W_ab accelerates:
//   p_ab = rho_a g.r + 2 rho_a/(rho_a + rho_b) J,   J = p_a - p_b - W_ab
// The place of the interface has an error: where particles are in disorder, its noise would throw a light fluid about,
// for a tenth of a spacing misplaced is a tenth of g. The noise is known, from what the distances about a are astray
// of a smooth interface. A difference of pressure within so much of W_ab, `deviations` of them, counts as weight:
//   J = (p_a - p_b) clamped out of [W_ab - delta, W_ab + delta],   delta = deviations |(rho_a - rho_b) g.n| spread
// On rows, moved by a smooth wave or not, delta is a hundredth of the interface's displacement. Within delta the
// pressure is drawn to W_ab, or it would drift there. Where no plane is found (a drop of a few particles) W_ab lies
// halfway between rho_a g.r and rho_b g.r, and all between the two is weight.
//
// Velocity is continuous too, and so is the shear stress mu grad v. The interface cuts the pair at the distances d
// that the particles have from it (models/fluid/interface_distance.hpp): theta = d_a/(d_a + d_b) of it lies in the
// fluid of a. A velocity that is linear in each fluid has there the stress of
//   mu_ab v_ab,   mu_ab = mu_a mu_b/(theta mu_b + (1 - theta) mu_a)
// (theta = 1/2: the harmonic mean of Cleary & Monaghan 1999). mu_ab is the same for a and b: what a gives, b gets. The
// viscous sum has it, and the flux of momentum that is taken off it has it in place of mu_a grad v, both in units of
// mu_a:
//   L_v = sum V F w mu_ab/mu_a v_ab,   K = sum V F (mu_ab/mu_a - 1) v_ab (x) r,   flux = (U + K) M^-1
#pragma once

#include "laws/consistent_fluid.hpp"

namespace barchan {

template <int Dim>
struct JoinedFluids {
  static constexpr bool needs_distance = true;
  static constexpr bool needs_root = true;  // the neighbour's distance to the interface
  static constexpr bool corrected = true;
  static constexpr double deviations = 3.0, middling = 0.01;

  template <class T>
  struct Sums : ConsistentFluid<Dim>::template Sums<T> {
    std::array<T, Dim * Dim> kink;  // K, row: component of v, column: of r

    BARCHAN_SIMD_INLINE void take(const Sums& s, double scale, double, double, const std::array<double, 3>& weight) {
      ConsistentFluid<Dim>::template Sums<T>::take(s, scale, 0.0, 0.0, weight);
      const T k = simd::broadcast<T>(scale);
      for (std::size_t m = 0; m < Dim * Dim; ++m) kink[m] = fma(k, s.kink[m], kink[m]);
    }
  };

  template <class T>
  struct Own : ConsistentFluid<Dim>::template Own<T> {
    std::array<T, Dim> weight;  // rho_a g, Pa/m
    T share;                    // 2 rho_a/(rho_a + rho_b)
    T lift, tolerance;          // (rho_a - rho_b) g.n, Pa/m; delta, Pa
    T halfway;                  // without a plane (rho_b/rho_a - 1)/2, else 0
    T rubbing;                  // mu_b/mu_a
    T distance, nearest;        // d_a, and the least distance in the friction, m
  };

  template <class T>
  static BARCHAN_SIMD_INLINE void add(const Own<T>& a, const std::array<T, Dim>& r, T r2, T f, const T* v_b, T p_b,
                                      T volume_b, T distance_b, Sums<T>& s) {
    T own = a.weight[0] * r[0];
    for (std::size_t d = 1; d < Dim; ++d) own = fma(a.weight[d], r[d], own);
    const T dp = a.p - p_b, one = simd::broadcast<T>(1.0), between = a.halfway * own;
    const T middle = fma(a.lift, distance_b, own + between);
    const T delta = a.tolerance + simd::max(between, simd::broadcast<T>(0.0) - between);
    const T weight = simd::max(middle - delta, simd::min(middle + delta, dp));
    const T jump = fma(simd::broadcast<T>(middling), weight - middle, dp - weight);
    const T theta = a.distance / (a.distance + simd::max(distance_b, a.nearest));
    const T mu = a.rubbing / fma(a.rubbing, theta, one - theta), more = mu - one;
    ConsistentFluid<Dim>::add_rubbing(
        a, r, r2, f, v_b, fma(a.share, jump, own), volume_b,
        s, [&](std::size_t d, T dv, T wvf, const std::array<T, Dim>& g) __attribute__((always_inline)) {
          s.viscous[d] = fma(wvf, mu * dv, s.viscous[d]);
          for (std::size_t e = 0; e < Dim; ++e) s.kink[d * Dim + e] = fma(more * dv, g[e], s.kink[d * Dim + e]);
        });
  }

  /// What the sums of pairs within one fluid, or with a solid, are here.
  template <class T>
  static BARCHAN_SIMD_INLINE Sums<T> without_kink(const typename ConsistentFluid<Dim>::template Sums<T>& raw) {
    Sums<T> s{raw, {}};
    for (auto& k : s.kink) k = simd::broadcast<T>(0.0);
    return s;
  }
};

}  // namespace barchan
