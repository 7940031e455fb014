// Contact of two spheres: a normal spring with a dashpot, a tangential spring that slides (Coulomb), and a rolling
// spring that slides. Sign: r_ab = x_a - x_b; the normal n = r_ab/|r_ab| points at a; forces and torques are on a.
//
//   normal      F_n = max(k delta - c v_n, 0)     delta: overlap, v_n = (v_a - v_b).n, positive when they part
//   tangential  F_t = -k_t xi - c_t v_t, at most mu F_n; xi: the slip since they touched, dxi/dt = v_t
//   rolling     the same form of R* (w_a - w_b) across n, at most mu_r F_n, with the lever R* (Luding 2008,
//   section 3.2)
//
//   linear: k = K,                      c = 2 zeta sqrt(m* k),       k_t = 2/7 k
//   Hertz:  k = 4/3 E* sqrt(R* delta),  c = sqrt(5) zeta sqrt(m* k), k_t = 3 (1 - nu)/(2 - nu) k   (Mindlin 1949)
//   c_t = c/2
//
// Velocities of a step are half a step behind its positions. A dashpot takes them at the time of the positions: with
// what the force itself adds, v + F dt/(2 m*), which gives F = (k delta - c v)/(1 + c dt/(2 m*)).
//
// Grains do not stick: the force is clipped to repulsion, and the contact ends where the clipped force does (Schwager
// and Poeschel 2007). Then a head-on impact keeps the share
//   e = exp(-2 zeta acos(zeta)/sqrt(1 - zeta^2))   of its speed, above zeta = 1 with acosh and sqrt(zeta^2 - 1).
// The same zeta serves both laws: with u = delta^(5/4), v dv/du of Hertz is that of the linear oscillator (Antypov and
// Elliott 2011), the place of the clip included.
//
// Where a Hertzian contact is loaded, its slip shrinks as k_t grows (new surface carries no strain); unloaded, the
// force shrinks with k_t (Thornton, Cummins and Cleary 2013): a cycle of loads gains no energy.
#pragma once

#include <array>
#include <cmath>
#include <numbers>

#include "simd/vec.hpp"

namespace barchan {

struct SphereContact {
  bool hertz = false;
  double stiffness = 0;   // N/m: K; of Hertz Pa: 4/3 E*
  double dashpot = 0;     // c over sqrt(m* k)
  double tangential = 0;  // k_t over k
  double friction = 0;    // mu
  double rolling = 0;     // mu_r

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
  /// The constants of a linear contact: K in N/m.
  static SphereContact linear(double stiffness, double restitution) {
    return {false, stiffness, 2.0 * damping_ratio(restitution), 2.0 / 7.0};
  }
  /// Of a Hertzian contact of two spheres of one material, E in Pa: E* = E/(2 (1 - nu^2)).
  static SphereContact hertzian(double young, double poisson, double restitution) {
    const double reduced = 0.5 * young / (1.0 - poisson * poisson);
    return {true, 4.0 / 3.0 * reduced, std::sqrt(5.0) * damping_ratio(restitution),
            3.0 * (1.0 - poisson) / (2.0 - poisson)};
  }
  /// The duration (s) of a head-on impact without damping and its overlap (m); reduced mass in kg, radius in m, speed
  /// in m/s. Hertz: delta = (15 m* v^2/(16 E* sqrt R*))^(2/5), t = 2.943275 delta/v.
  double largest_overlap(double mass, double radius, double speed) const {
    if (!hertz) return speed * std::sqrt(mass / stiffness);
    return std::pow(1.25 * mass * speed * speed / (stiffness * std::sqrt(radius)), 0.4);
  }
  double duration(double mass, double radius, double speed) const {
    if (!hertz) return std::numbers::pi * std::sqrt(mass / stiffness);
    return 2.943275 * largest_overlap(mass, radius, speed) / speed;
  }
};

/// What a contact is evaluated from. V: a number or a vector of them; Spin: 1 in 2D (about z), 3 in 3D.
template <class V, std::size_t Dim>
struct TouchingSpheres {
  static constexpr std::size_t spin = Dim == 2 ? 1 : 3;
  std::array<V, Dim> normal;    // from b to a
  std::array<V, Dim> velocity;  // v_a - v_b, m/s
  std::array<V, spin> spin_a, spin_b;
  V overlap;           // m, > 0
  V lever_a, lever_b;  // m, from the centres to the contact
  V reduced_mass;      // kg
  V reduced_radius;    // m
};

/// Force on a (N), torques on a and b (N m), the energy that the contact took in the step and what it stores (J).
template <class V, std::size_t Dim>
struct ContactForces {
  static constexpr std::size_t spin = TouchingSpheres<V, Dim>::spin;
  std::array<V, Dim> force;
  std::array<V, spin> torque_a, torque_b;
  V lost, stored;
};

namespace sphere_contact {

using simd::fma;
using simd::fnma;

/// The constants of a law in all lanes.
template <class V>
struct Constants {
  V stiffness, dashpot, tangential, friction, rolling, dt, half_dt;
  Constants(const SphereContact& c, double step)
      : stiffness(c.stiffness),
        dashpot(c.dashpot),
        tangential(c.tangential),
        friction(c.friction),
        rolling(c.rolling),
        dt(step),
        half_dt(0.5 * step) {}
};

/// A spring that gives way at a limit. `slip` (m) is that before the step and becomes that after it; `grown` is k_t
/// over that of the step before. Returns the force (N); adds what is lost.
template <class V, std::size_t N>
BARCHAN_SIMD_INLINE std::array<V, N> slide(std::array<V, N>& slip, const std::array<V, N>& old,
                                           const std::array<V, N>& velocity, V stiffness, V old_stiffness, V dashpot,
                                           V limit, V inverse_mass, V dt, V& lost, V& stored) {
  std::array<V, N> force;
  const V centred = V(1.0) / fma(dashpot * inverse_mass, V(0.5) * dt, V(1.0));
  V f2(1e-200), was(0.0), now(0.0), work(0.0);
  for (std::size_t k = 0; k < N; ++k) {
    slip[k] = fma(velocity[k], dt, slip[k]);
    force[k] = -fma(stiffness, slip[k], dashpot * velocity[k]) * centred;
    f2 = fma(force[k], force[k], f2);
  }
  const auto slides = f2 > limit * limit;
  const V share = select(slides, limit / simd::sqrt(f2), V(1.0));
  const V back = V(1.0) / stiffness;
  for (std::size_t k = 0; k < N; ++k) {
    force[k] = force[k] * share;
    slip[k] = select(slides, -force[k] * back, slip[k]);
    was = fma(old[k], old[k], was);
    now = fma(slip[k], slip[k], now);
    work = fma(force[k], fma(force[k] * inverse_mass, V(0.5) * dt, velocity[k]), work);
  }
  const V energy = V(0.5) * stiffness * now;
  stored += energy;
  lost += fnma(work, dt, V(0.5) * old_stiffness * was - energy);
  return force;
}

}  // namespace sphere_contact

/// The force of a contact in a step of dt. `memory`: tangential slip (1 number in 2D, 3 in 3D) and, if it rolls,
/// rolling slip (as many), of the contact so far; they are advanced. Rubs: has friction; Rolls: has rolling resistance
/// too.
template <bool Hertz, bool Rubs, bool Rolls, class V, std::size_t Dim, std::size_t N>
BARCHAN_SIMD_INLINE ContactForces<V, Dim> touch(const sphere_contact::Constants<V>& c, const TouchingSpheres<V, Dim>& s,
                                                std::array<V, N>& memory) {
  using simd::fma;
  using simd::fnma;
  constexpr std::size_t spin = TouchingSpheres<V, Dim>::spin;
  ContactForces<V, Dim> out;
  V v_n(0.0);
  for (std::size_t d = 0; d < Dim; ++d) v_n = fma(s.velocity[d], s.normal[d], v_n);
  const V k = Hertz ? c.stiffness * simd::sqrt(s.reduced_radius * s.overlap) : c.stiffness;
  const V dashpot = c.dashpot * simd::sqrt(s.reduced_mass * k);
  const V elastic = k * s.overlap;
  const V inverse_mass = V(1.0) / s.reduced_mass;
  const V normal = simd::max(fnma(dashpot, v_n, elastic), V(0.0)) / fma(dashpot * inverse_mass, c.half_dt, V(1.0));
  out.lost = (elastic - normal) * fma(normal * inverse_mass, c.half_dt, v_n) * c.dt;
  out.stored = V(Hertz ? 0.4 : 0.5) * elastic * s.overlap;
  for (std::size_t d = 0; d < Dim; ++d) out.force[d] = normal * s.normal[d];
  for (std::size_t d = 0; d < spin; ++d) out.torque_a[d] = out.torque_b[d] = V(0.0);
  if constexpr (Rubs) {
    const auto& n = s.normal;
    std::array<V, spin> v_t, slip, old;
    V k_t = c.tangential * k, old_k_t = k_t, shrink(1.0);
    if constexpr (Hertz) {
      // k_t of the step before over that of now; the overlap was delta + v_n dt.
      const V ratio = simd::sqrt(simd::max(fma(v_n, c.dt, s.overlap), V(0.0)) / s.overlap);
      old_k_t = k_t * ratio;
      shrink = simd::min(ratio, V(1.0));
    }
    const V c_t = V(0.5) * dashpot;
    if constexpr (Dim == 2) {
      v_t[0] = fnma(s.lever_a, s.spin_a[0], fnma(s.lever_b, s.spin_b[0], s.velocity[1] * n[0] - s.velocity[0] * n[1]));
      old[0] = memory[0];
      slip[0] = old[0] * shrink;
    } else {
      std::array<V, 3> w;
      V along(0.0);
      for (std::size_t d = 0; d < 3; ++d) {
        w[d] = fma(s.lever_a, s.spin_a[d], s.lever_b * s.spin_b[d]);
        old[d] = memory[d];
        along = fma(old[d], n[d], along);
      }
      for (std::size_t d = 0; d < 3; ++d) {
        const std::size_t e = (d + 1) % 3, f = (d + 2) % 3;
        v_t[d] = fnma(v_n, n[d], s.velocity[d]) - (w[e] * n[f] - w[f] * n[e]);
        slip[d] = fnma(along, n[d], old[d]) * shrink;
      }
    }
    // A tangential push turns solid spheres as well: 2/7 of the mass resists.
    const auto f = sphere_contact::slide<V, spin>(slip, old, v_t, k_t, old_k_t, c_t, c.friction * normal,
                                                  V(3.5) * inverse_mass, c.dt, out.lost, out.stored);
    for (std::size_t d = 0; d < spin; ++d) memory[d] = slip[d];
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
    if constexpr (Rolls) {
      std::array<V, spin> roll;
      V twist(0.0), along_roll(0.0);
      if constexpr (Dim == 3)
        for (std::size_t d = 0; d < 3; ++d) {
          twist = fma(s.spin_a[d] - s.spin_b[d], n[d], twist);
          along_roll = fma(memory[spin + d], n[d], along_roll);
        }
      for (std::size_t d = 0; d < spin; ++d) {
        const V turn = s.spin_a[d] - s.spin_b[d];
        old[d] = memory[spin + d];
        if constexpr (Dim == 3) {
          roll[d] = s.reduced_radius * fnma(twist, n[d], turn);
          slip[d] = fnma(along_roll, n[d], old[d]) * shrink;
        } else {
          roll[d] = s.reduced_radius * turn;
          slip[d] = old[d] * shrink;
        }
      }
      const auto g = sphere_contact::slide<V, spin>(slip, old, roll, k_t, old_k_t, c_t, c.rolling * normal,
                                                    V(0.625) * inverse_mass, c.dt, out.lost, out.stored);
      for (std::size_t d = 0; d < spin; ++d) {
        memory[spin + d] = slip[d];
        out.torque_a[d] = fma(s.reduced_radius, g[d], out.torque_a[d]);
        out.torque_b[d] = fnma(s.reduced_radius, g[d], out.torque_b[d]);
      }
    }
  }
  return out;
}

}  // namespace barchan
