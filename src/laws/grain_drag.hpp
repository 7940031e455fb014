// Form drag between a fluid and grains of about its spacing: the wake of a single particle is not resolved, and at
// grain Reynolds numbers of hundreds it carries nearly all of the drag.
//
//   f_ab = -K V_f W(r_ab) |v_ab| v_ab,   K = 1/2 C_D rho_f A
// A is the grain's cross section (d in 2D, per metre of depth; pi d^2/4 in 3D), V_f the fluid particle's volume. Over a
// full neighbourhood sum V_f W = 1 and a grain feels the quadratic drag 1/2 C_D rho A U^2; one that is half buried
// feels what the fluid on its free side exerts. Antisymmetric: the fluid loses what the grain gains.
#pragma once

#include <array>

#include "laws/grain_barrier.hpp"
#include "laws/pair.hpp"

namespace barchan {

struct GrainDrag {
  /// Adds the force on a [N]: v = v_a - v_b, strength K V_f W >= 0.
  template <class T, std::size_t Dim>
  static BARCHAN_SIMD_INLINE void add(const std::array<T, Dim>& v, T strength, std::array<T, Dim>& force) {
    T v2 = v[0] * v[0];
    for (std::size_t d = 1; d < Dim; ++d) v2 = fma(v[d], v[d], v2);
    const T factor = strength * sqrt(v2);
    for (std::size_t d = 0; d < Dim; ++d) force[d] = fnma(factor, v[d], force[d]);
  }
};

/// The drag and the barrier of an entry of a fluid and grains, one side at a time.
struct DragAndBarrier : PairLaw<Needs::value_and_gradient, Quantity::velocity, Quantity::volume> {
  double strength;  // K = 1/2 C_D rho_f A [kg/m]
  double density;   // kg/m3, of the fluid
  GrainBarrier barrier;
  bool a_is_fluid = false;  // whose volume V_f is

  template <int Dim, class T>
  struct Sums {
    std::array<T, Dim> force;  // N, on a
  };

  template <int Dim, class T>
  BARCHAN_SIMD_INLINE void add(const Own<Dim, T>& a, const Own<Dim, T>& b, const Pair<Dim, T>& ab,
                               Sums<Dim, T>& s) const {
    const auto v = difference(a.v, b.v);
    const T volume = a_is_fluid ? a.volume : b.volume;
    GrainDrag::add(v, T(strength) * ab.w * volume, s.force);
    barrier.add(ab.r, ab.r2, v, T(density) * volume, s.force);
  }
};

}  // namespace barchan
