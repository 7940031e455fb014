// Internal energy of a fluid of the plain scheme: what a pair's pressure and friction take from the kinetic energy they
// give here, half to each.
//
//   de_a/dt = (1/rho_a) sum V_b [ 1/2 (p_a + p_b) v_ab . grad W - mu F v_ab^2 ]
//
// Eq. (13a) of Halik et al. 2015 with the factor 1/2 that it lacks (Monaghan 1992, eq. 3.8).
#pragma once

#include "laws/pair.hpp"

namespace barchan {

struct PlainEnergy : PairLaw<Needs::gradient, Quantity::velocity, Quantity::pressure, Quantity::volume> {
  static constexpr bool closes_each_entry = true;
  double viscosity;  // mu [Pa s], of the pair

  template <int Dim, class T>
  struct Sums {
    T work;        // W/m3, of an entry: rho_a de_a/dt
    double total;  // of the entries before
  };

  template <int Dim, class T>
  BARCHAN_SIMD_INLINE void add(const Own<Dim, T>& a, const Own<Dim, T>& b, const Pair<Dim, T>& ab,
                               Sums<Dim, T>& s) const {
    T vr(0.0), v2(0.0);
    for (std::size_t d = 0; d < Dim; ++d) {
      const T dv = a.v[d] - b.v[d];
      vr = fma(dv, ab.r[d], vr);
      v2 = fma(dv, dv, v2);
    }
    const T pressure = fma(T(0.5), b.p, T(0.5) * a.p);
    s.work = fma(b.volume * ab.f, fma(pressure, vr, -(T(viscosity) * v2)), s.work);
  }

  template <class S>
  static BARCHAN_SIMD_INLINE void close_entry(S& s) {
    s.total += simd::sum(s.work);
    s.work = {};
  }
};

}  // namespace barchan
