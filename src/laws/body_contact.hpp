// Contact of two particles of bodies that touch where their spacings end. Sign: r = x_a - x_b, n = r/|r| points at a,
// v = v_a - v_b; forces are on a.
//
//   normal      F_n = max(phi K delta + 8 K max(delta - 0.35 d, 0) - psi c v.n, 0),  delta = d - |r|, d half the sum of
//               the two spacings; the second spring keeps a corner, which one particle holds, from passing a wall
//   tangential  F_t = -min(c_t |v_t|, mu F_n) v_t/|v_t|, v_t = v - (v.n) n: Coulomb, with a creep of mu F_n/c_t
//   c = 2 zeta sqrt(m* K), c_t = 2 sqrt(m* K); zeta from the restitution, as of spheres (laws/normal_dashpot.hpp)
//
// A contact begins and ends within a step. With s = delta/(|v.n| dt) <= 1, the step in which it begins or ends has
//   phi = (1 + s)/2:  the leapfrog then keeps its own energy, 1/2 m v^2 + 1/2 K delta^2 (1 - (w dt)^2/4), to (w dt)^4
//                     across the kink of the force; without it a restitution of 1 is off by up to (w dt)^2/8;
//   psi = 1/2 + s:    the dashpot acts for the time since the contact began, half of the next step included.
// Both are 1 otherwise. With w dt = 0.1, w^2 = K/m*, the restitution of two particles is within 0.003 of the written
// one, and 1 within 5e-5. Velocities are half a step behind the places: as of spheres the dashpot takes them at the
// time of the places, with what the force itself adds.
#pragma once

#include <array>
#include <cmath>

#include "laws/normal_dashpot.hpp"
#include "simd/vec.hpp"

namespace barchan {

struct BodyContactLaw {
  static constexpr double deep = 0.35, hardening = 8.0;  // of d, of K: the second spring

  double distance = 0;      // m, d
  double stiffness = 0;     // N/m, K
  double reduced_mass = 0;  // kg, m*
  double dashpot = 0;       // N s/m, c
  double rub = 0;           // N s/m, c_t
  double friction = 0;      // mu

  static BodyContactLaw of(double distance, double stiffness, double reduced_mass, double restitution,
                           double friction) {
    const double root = std::sqrt(stiffness * reduced_mass);
    return {distance,   stiffness, reduced_mass, 2.0 * NormalDashpot::damping_ratio(restitution) * root,
            2.0 * root, friction};
  }
  /// s, by which 0.1 of it is a step that keeps the restitution.
  double time_scale() const { return std::sqrt(reduced_mass / stiffness); }

  template <class V>
  struct Constants {
    V distance, stiffness, deep_distance, second_stiffness, dashpot, rub, friction, dt, slow;
    BARCHAN_SIMD_INLINE Constants(const BodyContactLaw& law, double step)
        : distance(law.distance),
          stiffness(law.stiffness),
          deep_distance(deep * law.distance),
          second_stiffness(hardening * law.stiffness),
          dashpot(law.dashpot),
          rub(law.rub),
          friction(law.friction),
          dt(step),
          slow(0.5 * step / law.reduced_mass) {}
  };

  /// F_n of an overlap, at this speed along the normal; above zero: they part.
  template <class V>
  static BARCHAN_SIMD_INLINE V normal_force(const Constants<V>& c, V overlap, V normal_speed) {
    const V one(1.0);
    const V way = simd::max(normal_speed, -normal_speed) * c.dt, share = overlap / simd::max(way, V(1e-300));
    const auto first = share <= one;
    const V phi = select(first, V(0.5) * (one + share), one), psi = select(first, V(0.5) + share, one);
    const V damping = c.dashpot * psi;
    const V second = c.second_stiffness * simd::max(overlap - c.deep_distance, V(0.0));
    const V push = simd::fma(phi * c.stiffness, overlap, simd::fnma(damping, normal_speed, second)) /
                   simd::fma(damping, c.slow, one);
    return select(overlap > V(0.0), simd::max(push, V(0.0)), V(0.0));
  }
  /// |F_t|/|v_t|; `square`: |v_t|^2 > 0.
  template <class V>
  static BARCHAN_SIMD_INLINE V grip(const Constants<V>& c, V normal, V square) {
    const V sticking = c.rub / simd::fma(c.rub, c.slow, V(1.0));
    return simd::min(sticking, c.friction * normal / simd::sqrt(square));
  }

  /// Adds the force [N]; r2 = |r|^2 > 0. Nothing where the particles are further apart than d.
  template <bool Rubs, class V, std::size_t Dim>
  static BARCHAN_SIMD_INLINE void add(const Constants<V>& c, const std::array<V, Dim>& r, V r2,
                                      const std::array<V, Dim>& v, std::array<V, Dim>& force) {
    const V one(1.0), distance = simd::sqrt(r2), inverse = one / distance, overlap = c.distance - distance;
    V normal_speed(0.0);
    for (std::size_t d = 0; d < Dim; ++d) normal_speed = simd::fma(v[d], r[d], normal_speed);
    normal_speed = normal_speed * inverse;
    const V normal = normal_force(c, overlap, normal_speed);
    for (std::size_t d = 0; d < Dim; ++d) force[d] = simd::fma(normal * inverse, r[d], force[d]);
    if constexpr (Rubs) {
      std::array<V, Dim> along;
      V square(1e-300);
      for (std::size_t d = 0; d < Dim; ++d) {
        along[d] = v[d] - normal_speed * inverse * r[d];
        square = simd::fma(along[d], along[d], square);
      }
      const V held = grip(c, normal, square);
      for (std::size_t d = 0; d < Dim; ++d) force[d] = force[d] - held * along[d];
    }
  }
};

}  // namespace barchan
