// Internal energy of a fluid of the plain scheme: what the forces of its pairs take out of the motion.
//
// Between particles of fluids, half to each:
//   de_a/dt = (1/rho_a) sum V_b [ 1/2 (p_a + p_b) v_ab . r F - mu F v_ab^2 ]
// Eq. (13a) of Halik et al. 2015 with the factor 1/2 that it lacks (Monaghan 1992, eq. 3.8).
//
// With a particle of a solid, all to the fluid. Its motion is that of the solid, u_b, not the velocity v_b that the
// fluid is continued with; of a rigid body with the angular velocity w, x_b from its place, the torque of the pair is
// that of laws/turning_friction.hpp:
//   de_a/dt = (1/rho_a) sum V_b { (p_a + p_b) (v_a - u_b) . r F - 2 mu F v_ab . (v_a - u_b)
//                                 + mu F [ (w x r) . v_ab - (w0 x r) . (2 w x x_b + w x r) ] }
//
// Pair by pair this is the power of the force on a and on b and of the torque on b, with the sign changed. A force is
// computed with velocities half a step old (v, w0), its power is that with the velocities of now: u_b and w are those,
// and of a the pass takes f_a . a_a dt/2 away, f_a = sum V_b F [2 mu v_ab - (p_a + p_b) r] (models/fluid/energy.hpp).
#pragma once

#include "laws/pair.hpp"

namespace barchan {

/// Sums of both laws.
template <int Dim, class T>
struct EnergySums {
  std::array<T, Dim> force;  // N/m3, f_a
  T work;                    // W/m3, of an entry: rho_a de_a/dt
  double total;              // of the entries before
};

struct PlainEnergy : PairLaw<Needs::gradient, Quantity::velocity, Quantity::pressure, Quantity::volume> {
  static constexpr bool closes_each_entry = true;
  double viscosity;  // mu [Pa s], of the pair

  template <int Dim, class T>
  using Sums = EnergySums<Dim, T>;

  template <int Dim, class T>
  BARCHAN_SIMD_INLINE void add(const Own<Dim, T>& a, const Particle<Dim, T, Reads>& b, const Pair<Dim, T>& ab,
                               Sums<Dim, T>& s) const {
    const T vf = b.volume * ab.f, pressures = a.p + b.p, friction(2.0 * viscosity);
    T power(0.0);
    for (std::size_t d = 0; d < Dim; ++d) {
      const T v = a.v[d] - b.v[d], force = vf * (friction * v - pressures * ab.r[d]);
      power = fma(force, v, power);
      s.force[d] += force;
    }
    s.work = fnma(T(0.5), power, s.work);
  }

  template <class S>
  static BARCHAN_SIMD_INLINE void close_entry(S& s) {
    s.total += simd::sum(s.work);
    s.work = {};
  }
};

/// w x r; in 2D w has one component, about z.
template <class T, std::size_t Dim, std::size_t Axes>
BARCHAN_SIMD_INLINE std::array<T, Dim> turned(const std::array<T, Axes>& w, const std::array<T, Dim>& r) {
  if constexpr (Dim == 2) return {-(w[0] * r[1]), w[0] * r[0]};
  else return {w[1] * r[2] - w[2] * r[1], w[2] * r[0] - w[0] * r[2], w[0] * r[1] - w[1] * r[0]};
}

struct SolidEnergy
    : PairLaw<Needs::gradient, Quantity::velocity, Quantity::pressure, Quantity::volume, Quantity::carried> {
  static constexpr bool closes_each_entry = true;
  double viscosity;  // mu [Pa s], of the pair

  /// The first particle is one of the fluid.
  template <int Dim, class T>
  using Own = PlainEnergy::Own<Dim, T>;
  template <int Dim, class T>
  using Sums = EnergySums<Dim, T>;

  template <int Dim, class T>
  BARCHAN_SIMD_INLINE void add(const Own<Dim, T>& a, const Particle<Dim, T, Reads>& b, const Pair<Dim, T>& ab,
                               Sums<Dim, T>& s) const {
    const T vf = b.volume * ab.f, pressures = a.p + b.p, friction(2.0 * viscosity);
    const auto turn = turned(b.rate, ab.r), old_turn = turned(b.old_rate, ab.r);
    T power(0.0), turning(0.0);
    for (std::size_t d = 0; d < Dim; ++d) {
      const T v = a.v[d] - b.v[d], force = vf * (friction * v - pressures * ab.r[d]);
      power = fma(force, a.v[d] - b.u[d], power);
      turning += turn[d] * v - old_turn[d] * (T(2.0) * b.c[d] + turn[d]);
      s.force[d] += force;
    }
    s.work += fma(vf * T(viscosity), turning, -power);
  }

  template <class S>
  static BARCHAN_SIMD_INLINE void close_entry(S& s) {
    PlainEnergy::close_entry(s);
  }
};

}  // namespace barchan
