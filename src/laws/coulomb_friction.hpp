// Tangential force of two spheres: a spring that remembers, and slides at Coulomb's limit (Cundall and Strack 1979).
//
//   F_t = -k_t xi - c/2 v_t, at most mu times the load; xi: the slip since they touched, dxi/dt = v_t
//   v_t = v - (v.n) n - (l_a w_a + l_b w_b) x n, l: the levers from the centres to the contact
//
// How k_t follows from the normal spring is a type of its own: laws/slip_stiffness.hpp. The slip turns with the
// contact: in 3D its part along the present normal is taken off. In 2D it is one number, along (-n_y, n_x).
#pragma once

#include <algorithm>
#include <array>
#include <span>

#include "laws/other_forces.hpp"
#include "laws/sliding_spring.hpp"
#include "laws/touching_spheres.hpp"
#include "scene/contact_words.hpp"

namespace barchan {

/// `Stiffness`: k_t over the normal stiffness, and what its changes do to the slip.
template <class Stiffness>
struct CoulombFriction {
  static constexpr bool rubs = true;
  /// The slip (m).
  template <std::size_t Dim>
  static constexpr std::size_t remembers = TouchingSpheres<double, Dim>::spin;
  Stiffness stiffness;
  double friction = 0.0;  // mu

  static CoulombFriction between(std::span<const SphereMaterial* const> grains) {
    double mu = 1e300;
    for (const SphereMaterial* g : grains) mu = std::min(mu, g->friction);
    return {Stiffness::between(grains), mu};
  }
  double stiffness_ratio() const { return stiffness.ratio; }

  template <class V>
  struct Constants {
    V ratio, friction;
    explicit Constants(const CoulombFriction& c) : ratio(c.stiffness.ratio), friction(c.friction) {}
  };

  /// k_t of this step; v_n: m/s, positive when they part.
  template <class V>
  static BARCHAN_SIMD_INLINE SlipStiffness<V> stiffness_of(const Constants<V>& c, const NormalForce<V>& n, V v_n,
                                                           const ContactStep<V>& dt) {
    return Stiffness::of(c.ratio, n, v_n, dt);
  }

  /// Adds force, torques, energy lost and stored; `memory`: the slip (m), `others`: what it remembers of other forces
  /// (m/s2); both are advanced.
  template <class V, std::size_t Dim>
  static BARCHAN_SIMD_INLINE void add(const Constants<V>& c, const TouchingSpheres<V, Dim>& s,
                                      const NormalForce<V>& normal, const SlipStiffness<V>& k, V v_n,
                                      const ContactStep<V>& dt, V* memory, V* others, ContactForces<V, Dim>& out) {
    using simd::fma;
    using simd::fnma;
    constexpr std::size_t spin = TouchingSpheres<V, Dim>::spin;
    const auto& n = s.normal;
    std::array<V, spin> v_t, slip, old, added, centred;
    if constexpr (Dim == 2) {
      v_t[0] = fnma(s.lever_a, s.spin_a[0], fnma(s.lever_b, s.spin_b[0], s.velocity[1] * n[0] - s.velocity[0] * n[1]));
      old[0] = memory[0];
      slip[0] = old[0] * k.shrink;
      added[0] = others[0];
    } else {
      std::array<V, 3> w;
      V along(0.0), of_others(0.0);
      for (std::size_t d = 0; d < 3; ++d) {
        w[d] = fma(s.lever_a, s.spin_a[d], s.lever_b * s.spin_b[d]);
        old[d] = memory[d];
        along = fma(old[d], n[d], along);
        of_others = fma(others[d], n[d], of_others);
      }
      for (std::size_t d = 0; d < 3; ++d) {
        const std::size_t e = (d + 1) % 3, f = (d + 2) % 3;
        v_t[d] = fnma(v_n, n[d], s.velocity[d]) - (w[e] * n[f] - w[f] * n[e]);
        slip[d] = fnma(along, n[d], old[d]) * k.shrink;
        added[d] = fnma(of_others, n[d], others[d]);
      }
    }
    for (std::size_t d = 0; d < spin; ++d) {
      added[d] = other_forces::in_step(added[d], v_t[d], dt);
      centred[d] = fma(V(0.5), added[d], v_t[d]);
    }
    // A tangential push turns solid spheres as well: 2/7 of the mass resists.
    const V inverse_mass = V(3.5) * s.inverse_mass;
    const auto f = slide<V, spin>(slip, old, v_t, centred, k.now, k.before, V(0.5) * normal.dashpot,
                                  c.friction * normal.load, inverse_mass, dt.whole, normal.share, out.lost, out.stored);
    for (std::size_t d = 0; d < spin; ++d) {
      memory[d] = slip[d];
      others[d] = other_forces::remember(added[d], v_t[d], f[d] * inverse_mass, dt);
    }
    if constexpr (Dim == 2) {
      out.force[0] = fnma(f[0], n[1], out.force[0]);
      out.force[1] = fma(f[0], n[0], out.force[1]);
      out.torque_a[0] = -s.lever_a * f[0];
      out.torque_b[0] = -s.lever_b * f[0];
    } else {
      for (std::size_t d = 0; d < 3; ++d) {
        const std::size_t e = (d + 1) % 3, g = (d + 2) % 3;
        const V moment = n[e] * f[g] - n[g] * f[e];
        out.force[d] += f[d];
        out.torque_a[d] = -s.lever_a * moment;
        out.torque_b[d] = -s.lever_b * moment;
      }
    }
  }
};

/// Smooth spheres.
struct NoFriction {
  static constexpr bool rubs = false;
  double stiffness_ratio() const { return 0.0; }
  template <class V>
  struct Constants {
    explicit Constants(const NoFriction&) {}
  };
};

}  // namespace barchan
