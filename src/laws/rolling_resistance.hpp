// Rolling resistance of two spheres: a torque that remembers, and gives way at a limit (Luding 2008, section 3.2).
//
//   v_r = R* (w_a - w_b) across n; F_r = -k_t xi_r - c/2 v_r, at most mu_r times the load; torques +- R* F_r, no force
#pragma once

#include <algorithm>
#include <array>
#include <span>

#include "laws/other_forces.hpp"
#include "laws/sliding_spring.hpp"
#include "laws/touching_spheres.hpp"
#include "scene/contact_words.hpp"

namespace barchan {

struct RollingResistance {
  static constexpr bool rolls = true;
  /// The rolling slip (m).
  template <std::size_t Dim>
  static constexpr std::size_t remembers = TouchingSpheres<double, Dim>::spin;
  double friction = 0.0;  // mu_r

  static RollingResistance between(std::span<const SphereMaterial* const> grains) {
    double mu = 1e300;
    for (const SphereMaterial* g : grains) mu = std::min(mu, g->rolling_friction);
    return {mu};
  }

  template <class V>
  struct Constants {
    V friction;
    explicit Constants(const RollingResistance& r) : friction(r.friction) {}
  };

  /// Adds torques, energy lost and stored; `memory`: the rolling slip (m), `others`: what it remembers of other forces
  /// (m/s2); both are advanced.
  template <class V, std::size_t Dim>
  static BARCHAN_SIMD_INLINE void add(const Constants<V>& c, const TouchingSpheres<V, Dim>& s,
                                      const NormalForce<V>& normal, const SlipStiffness<V>& k, const ContactStep<V>& dt,
                                      V* memory, V* others, ContactForces<V, Dim>& out) {
    using simd::fma;
    using simd::fnma;
    constexpr std::size_t spin = TouchingSpheres<V, Dim>::spin;
    std::array<V, spin> roll, slip, old, added, centred;
    V twist(0.0), along(0.0), of_others(0.0);
    if constexpr (Dim == 3)
      for (std::size_t d = 0; d < 3; ++d) {
        twist = fma(s.spin_a[d] - s.spin_b[d], s.normal[d], twist);
        along = fma(memory[d], s.normal[d], along);
        of_others = fma(others[d], s.normal[d], of_others);
      }
    for (std::size_t d = 0; d < spin; ++d) {
      const V turn = s.spin_a[d] - s.spin_b[d];
      old[d] = memory[d];
      if constexpr (Dim == 3) {
        roll[d] = s.reduced_radius * fnma(twist, s.normal[d], turn);
        slip[d] = fnma(along, s.normal[d], old[d]) * k.shrink;
        added[d] = fnma(of_others, s.normal[d], others[d]);
      } else {
        roll[d] = s.reduced_radius * turn;
        slip[d] = old[d] * k.shrink;
        added[d] = others[d];
      }
      added[d] = other_forces::in_step(added[d], roll[d], dt);
      centred[d] = fma(V(0.5), added[d], roll[d]);
    }
    const V inverse_mass = V(0.625) * s.inverse_mass;
    const auto f = slide<V, spin>(slip, old, roll, centred, k.now, k.before, V(0.5) * normal.dashpot,
                                  c.friction * normal.load, inverse_mass, dt.whole, normal.share, out.lost, out.stored);
    for (std::size_t d = 0; d < spin; ++d) {
      memory[d] = slip[d];
      others[d] = other_forces::remember(added[d], roll[d], f[d] * inverse_mass, dt);
      out.torque_a[d] = fma(s.reduced_radius, f[d], out.torque_a[d]);
      out.torque_b[d] = fnma(s.reduced_radius, f[d], out.torque_b[d]);
    }
  }
};

/// Spheres that roll freely.
struct NoRolling {
  static constexpr bool rolls = false;
  template <class V>
  struct Constants {
    explicit Constants(const NoRolling&) {}
  };
};

}  // namespace barchan
