// Normal damping of a contact: a dashpot that gives the restitution which a scene asks for.
//
//   F = c u,  u = -v_n,  c = D sqrt(m* k);  D = 2 zeta of a linear spring, sqrt(5) zeta of Hertz (Tsuji et al. 1992)
//
// Grains do not stick: the force is clipped to repulsion, and the contact ends where the clipped force does (Schwager
// and Poeschel 2007, eq. (16), (17)). Then a head-on impact keeps the share
//   e = exp(-2 zeta acos(zeta)/sqrt(1 - zeta^2))   of its speed, above zeta = 1 with acosh and sqrt(zeta^2 - 1).
// The same zeta serves both springs: with u = delta^(5/4), v dv/du of Hertz is that of the linear oscillator (Antypov
// and Elliott 2011), the place of the clip included.
//
// Velocities are half a step behind the places. The dashpot takes the one at t_n, with what others add
// (laws/other_forces.hpp) and with what the force itself adds:
//   v + F dt/(2 m*), so that F = (F_spring + c u)/(1 + c dt/(2 m*)).
#pragma once

#include <algorithm>
#include <cmath>
#include <span>

#include "scene/contact_words.hpp"
#include "simd/vec.hpp"

namespace barchan {

struct NormalDashpot {
  static constexpr bool damps = true;
  double ratio = 0.0;  // D, c over sqrt(m* k)

  /// The share of its speed that a head-on impact keeps; zeta > 0.
  static double restitution(double zeta) {
    const double w2 = 1.0 - zeta * zeta;
    if (std::abs(w2) < 1e-9) return std::exp(-2.0);
    const double angle = w2 > 0.0 ? std::acos(zeta) / std::sqrt(w2) : std::acosh(zeta) / std::sqrt(-w2);
    return std::exp(-2.0 * zeta * angle);
  }
  /// The zeta of a restitution 0.01 <= e <= 1.
  static double damping_ratio(double e) {
    double low = 0.0, high = 10.0;
    if (e >= 1.0) return 0.0;
    for (int k = 0; k < 200; ++k) (restitution(0.5 * (low + high)) > e ? low : high) = 0.5 * (low + high);
    return 0.5 * (low + high);
  }
  /// Steps in a contact (laws/contact_onset.hpp), so that every e from 0.05 is kept within 0.3 % of itself; most codes
  /// take 10 to 50. Below e = 0.3 they follow zeta. With fewer than 12 zeta the dashpots of packed spheres, up to four
  /// times one of them, gain energy (laws/other_forces.hpp).
  static double steps(double e) { return std::max(12.0, 20.5 * damping_ratio(e)); }
  /// Beside a spring, whose `dashpot_share()` is D/zeta.
  template <class Spring>
  static NormalDashpot of_restitution(double e) {
    return {Spring::dashpot_share() * damping_ratio(e)};
  }
  /// Of the smallest restitution of one or two phases of grains.
  template <class Spring>
  static NormalDashpot between(std::span<const SphereMaterial* const> grains) {
    double e = 1.0;
    for (const SphereMaterial* g : grains) e = std::min(e, g->restitution);
    return of_restitution<Spring>(e);
  }

  template <class V>
  struct Constants {
    V ratio;
    bool loses;  // not where another entry of the scene alone has a dashpot
    explicit Constants(const NormalDashpot& d) : ratio(d.ratio), loses(d.ratio > 0.0) {}

    /// c (N s/m) of the reduced mass times the stiffness (kg N/m).
    BARCHAN_SIMD_INLINE V coefficient(V mass_stiffness) const { return ratio * simd::sqrt(mass_stiffness); }
    /// The force (N) of spring and dashpot at the time of the places; `slow`: 1 + c dt/(2 m*).
    static BARCHAN_SIMD_INLINE V beside(V spring, V dashpot, V approach, V slow) {
      return simd::fma(dashpot, approach, spring) / slow;
    }
  };
};

/// Spheres that lose nothing along the normal.
struct NoDashpot {
  static constexpr bool damps = false;
  template <class V>
  struct Constants {
    V ratio{0.0};
    static constexpr bool loses = false;
    explicit Constants(const NoDashpot&) {}

    BARCHAN_SIMD_INLINE V coefficient(V) const { return V(0.0); }
    static BARCHAN_SIMD_INLINE V beside(V spring, V, V, V slow) { return spring / slow; }
  };
};

}  // namespace barchan
