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
// A step of the contacts (leapfrog) takes the force at x_n for the time from t_n - dt/2 to t_n + dt/2, with velocities
// that are half a step behind. Twelve steps a contact are few, so the force is that which makes the step exact:
//   the mean over t_n - dt .. t_n + dt with the weight 1 - |s|/dt, because x_(n+1) - 2 x_n + x_(n-1) = dt^2 mean(F)/m.
//     A spring that begins inside of that time, while the spheres go a = |v_n| dt, gives K ramp(delta, a) with
//     ramp = max(delta, 0) + a w^3/6, w = max(1 - |delta|/a, 0); a dashpot c v_n begin(delta, a), begin = w^2/2 before
//     and 1 - w^2/2 after the touch. So contacts have a force up to one step before and after they overlap. The same
//     ramp rounds the end of the clipped force.
//   the spring and the dashpot for which the discrete oscillator has the decay and the frequency of the continuous one:
//     with T^2 = k dt^2/m*, D = c/sqrt(m* k): K = k (1 - T^2 (1 + D^2)/12), C = c (1 - T^2 D^2/12), to order T^4.
//   the dashpot's velocity at t_n: with what the force itself adds, v + F dt/(2 m*), F = (K delta - C v)/(1 + C dt/(2
//   m*)).
// Found for 12 steps a contact, all phases of the first touch (tests/unit/laws_sphere_contact.cpp): e = 0.3 within 0.3 %,
// 0.5 to 0.9 within 0.2 %; the plain force missed them by 14 and 2 to 8 %. Spheres without a dashpot take the plain
// force at x_n, so that the steps stay those of a mechanical system: where many touch at once, a force that knows
// velocities gains energy (1 % in 10^4 steps of a dense gas).
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

/// Of the sum of radii: beyond this overlap a law of contact means nothing.
inline constexpr double most_sphere_overlap = 0.3;

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
  V overlap;           // m; below 0 a gap
  V lever_a, lever_b;  // m, from the centres to the contact
  V reduced_mass;      // kg
  V inverse_mass;      // 1/kg, of the reduced mass
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

/// What one step sees of a force that sets in where a length x (m) passes 0, while x changes by a (m) in a step.
template <class V>
struct Onset {
  V ratio, left;  // x/a; 1 - |x|/a, at least 0
  Onset(V x, V a) : ratio(x / a), left(simd::max(V(1.0) - simd::max(ratio, -ratio), V(0.0))) {}
};
/// Of a force in proportion to x: its mean in place of max(x, 0).
template <class V>
BARCHAN_SIMD_INLINE V ramp(V x, V a) {
  const V w = Onset<V>(x, a).left;
  return fma(a * (w * w), w * V(1.0 / 6.0), simd::max(x, V(0.0)));
}
/// The same in the budget of energy: the work of the steps through x = 0 is then that of the spring, at any speed.
template <class V>
BARCHAN_SIMD_INLINE V ramp_of_work(V x, V a) {
  const V w = Onset<V>(x, a).left;
  return fnma(V(0.25) * a, w * (V(1.0) - w), simd::max(x, V(0.0)));
}
/// Of a force that is there from x = 0: the share of the step.
template <class V>
BARCHAN_SIMD_INLINE V begin(V x, V a) {
  const V w = Onset<V>(x, a).left, half = V(0.5) * (w * w);
  return select(x > V(0.0), V(1.0) - half, half);
}
/// Of x^(3/2) and x^(1/4), for a = 1: ((x + 1)^q - 2 x^q + (x - 1)^q)/(q (q - 1)), q = 7/2 and 9/4, bases at least 0.
template <class V>
struct HertzOnset {
  V force, root;
  explicit HertzOnset(V x) {
    const V weights[3] = {V(1.0), V(-2.0), V(1.0)}, at[3] = {x + V(1.0), x, x - V(1.0)};
    force = root = V(0.0);
    for (int k = 0; k < 3; ++k) {
      const V y = simd::max(at[k], V(0.0)), r = simd::sqrt(y), y2 = y * y;
      force = fma(weights[k], y2 * (y * r), force);
      root = fma(weights[k], y2 * simd::sqrt(r), root);
    }
    force = force * V(1.0 / 8.75);
    root = root * V(1.0 / 2.8125);
  }
};

/// The normal force of a step and what it consists of.
template <class V>
struct Normal {
  V force, elastic;  // N; elastic: its part that is stored
  V depth;           // m, the overlap, of a contact that begins part of a step's way
  V stiffness;       // N/m, at that depth
  V inverse_depth;   // 1/m; Hertz only
  V dashpot;         // N s/m
  V share;           // of the step in which they touch
};

template <class V>
BARCHAN_SIMD_INLINE Normal<V> linear_normal(const Constants<V>& c, V x, V approach, V mass, V inverse_mass) {
  const V twelfth(1.0 / 12.0), damping2 = c.dashpot * c.dashpot;
  const V turn2 = c.stiffness * (c.dt * c.dt) * inverse_mass;
  const V k = c.stiffness * fnma(turn2 * twelfth, V(1.0) + damping2, V(1.0));
  const V dashpot = c.dashpot * simd::sqrt(mass * c.stiffness) * fnma(turn2 * twelfth, damping2, V(1.0));
  const V least(1e-30), drag = dashpot * inverse_mass * c.half_dt;
  const V before = fma(simd::max(approach, -approach), c.dt, least);
  const V centred = fnma(k * ramp(x, before) * inverse_mass, c.half_dt, approach);
  const V a = fma(simd::max(centred, -centred), c.dt, least);
  Normal<V> n;
  n.elastic = k * ramp_of_work(x, a);
  n.share = begin(x, a);
  n.depth = simd::max(x, V(0.0));
  n.stiffness = c.stiffness;
  n.dashpot = dashpot;
  const V loading = fma(dashpot * n.share, approach, k * ramp(x, a)) / fma(drag, n.share, V(1.0));
  const V ending = k * ramp(fma(dashpot, approach, k * x) / (fma(drag, k, k)), a);
  const auto loses = c.dashpot > V(0.0);
  n.elastic = select(loses, n.elastic, k * n.depth);
  n.force = select(loses, select(approach > V(0.0), loading, ending), n.elastic);
  return n;
}

// Each root and quotient stands here once; what only an onset needs is found there.
template <class V>
BARCHAN_SIMD_INLINE Normal<V> hertz_normal(const Constants<V>& c, V x, V approach, V mass, V inverse_mass, V radius) {
  const V least(1e-30), overlap = simd::max(x, least), near(4.0);
  Normal<V> n;
  const V here = c.stiffness * simd::sqrt(radius * overlap), inverse = V(1.0) / overlap;
  const V turn2 = V(1.5) * here * (c.dt * c.dt) * inverse_mass, slower = fnma(turn2, V(1.0 / 12.0), V(1.0));
  const V before = fma(simd::max(approach, -approach), c.dt, least);
  const auto begins = x < near * before;
  n.depth = overlap;
  n.inverse_depth = inverse;
  n.stiffness = here;
  n.elastic = here * overlap * slower;
  n.dashpot = c.dashpot * simd::sqrt(mass * here);
  n.share = V(1.0);
  // Far from the onset x^(3/2) + a^2/(16 sqrt(x)), which is what the weights make of it.
  const V small = V(1.0 / 16.0) * (inverse * inverse);
  const auto far_of = [&](V a) { return here * overlap * fma(a * a, small, slower); };
  const auto near_of = [&](V a, V onset) { return c.stiffness * (a * simd::sqrt(radius * a)) * slower * onset; };
  V first = far_of(before);
  if (to_bits(begins) != 0) {
    const V ratio = x / before;
    const HertzOnset<V> early(simd::min(ratio, near));
    first = select(begins, near_of(before, early.force), first);
    n.dashpot = select(begins, c.dashpot * simd::sqrt(mass * c.stiffness * simd::sqrt(radius * before)) * early.root,
                       n.dashpot);
    n.share = begin(x, before);
    n.depth = simd::max(overlap, V(0.25) * before);
    n.inverse_depth = V(1.0) / n.depth;
    n.stiffness = c.stiffness * simd::sqrt(radius * n.depth);
  }
  const V centred = fnma(first * inverse_mass, c.half_dt, approach);
  const V a = fma(simd::max(centred, -centred), c.dt, least);
  const auto begins_still = x < near * a;
  V elastic = far_of(a);
  if (to_bits(begins_still) != 0)
    elastic = select(begins_still, near_of(a, HertzOnset<V>(simd::min(x / a, near)).force), elastic);
  const V drag = n.dashpot * inverse_mass;
  n.dashpot = n.dashpot * fnma(drag * drag, c.dt * c.dt * V(1.0 / 12.0), V(1.0));
  const V force = fma(n.dashpot, approach, elastic) / fma(n.dashpot * inverse_mass, c.half_dt, V(1.0));
  const V ending = select(x > V(0.0), ramp(force, V(1.5) * here * before), V(0.0));
  n.force = select(c.dashpot > V(0.0), select(approach > V(0.0), force, ending), n.elastic);
  return n;
}

/// A spring that gives way at a limit. `slip` (m) is that before the step and becomes that after it; `grown` is k_t
/// over that of the step before; `in_touch`: the share of the step that counts for the slip. Returns the force (N);
/// adds what is lost.
template <class V, std::size_t N>
BARCHAN_SIMD_INLINE std::array<V, N> slide(std::array<V, N>& slip, const std::array<V, N>& old,
                                           const std::array<V, N>& velocity, V stiffness, V old_stiffness, V dashpot,
                                           V limit, V inverse_mass, V dt, V in_touch, V& lost, V& stored) {
  std::array<V, N> force;
  const V slower = fma(dashpot * inverse_mass, V(0.5) * dt, V(1.0)), inverse = V(1.0) / (slower * stiffness);
  const V centred = inverse * stiffness, back = inverse * slower;
  V f2(1e-200), was(0.0), now(0.0), work(0.0);
  for (std::size_t k = 0; k < N; ++k) {
    slip[k] = fma(velocity[k], dt * in_touch, slip[k]);
    force[k] = -fma(stiffness, slip[k], dashpot * velocity[k]) * centred;
    f2 = fma(force[k], force[k], f2);
  }
  const auto slides = f2 > limit * limit;
  const V share = select(slides, limit / simd::sqrt(f2), V(1.0));
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
  const V inverse_mass = s.inverse_mass;
  sphere_contact::Normal<V> along_n;
  if constexpr (Hertz)
    along_n = sphere_contact::hertz_normal(c, s.overlap, -v_n, s.reduced_mass, inverse_mass, s.reduced_radius);
  else along_n = sphere_contact::linear_normal(c, s.overlap, -v_n, s.reduced_mass, inverse_mass);
  const V k = along_n.stiffness, normal = along_n.force, dashpot = along_n.dashpot;
  out.lost = (along_n.elastic - normal) * fma(normal * inverse_mass, c.half_dt, v_n) * c.dt;
  out.stored = V(Hertz ? 0.4 : 0.5) * along_n.elastic * simd::max(s.overlap, V(0.0));
  for (std::size_t d = 0; d < Dim; ++d) out.force[d] = normal * s.normal[d];
  for (std::size_t d = 0; d < spin; ++d) out.torque_a[d] = out.torque_b[d] = V(0.0);
  if constexpr (Rubs) {
    const auto& n = s.normal;
    std::array<V, spin> v_t, slip, old;
    V k_t = c.tangential * k, old_k_t = k_t, shrink(1.0);
    if constexpr (Hertz) {
      // k_t of the step before over that of now; the overlap was delta + v_n dt.
      const V ratio = simd::sqrt(simd::max(fma(v_n * c.dt, along_n.inverse_depth, V(1.0)), V(0.0)));
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
                                                  V(3.5) * inverse_mass, c.dt, along_n.share, out.lost, out.stored);
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
                                                    V(0.625) * inverse_mass, c.dt, along_n.share, out.lost, out.stored);
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
