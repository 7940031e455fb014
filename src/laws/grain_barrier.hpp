// What keeps the air out of grains. The consistent scheme has no pressure that keeps a fluid particle out of the gap
// between two grains: the pressure of a solid is the fluid's own, continued. Under the stagnation pressure of a dune a
// bed of touching grains, which nothing passes, took up a tenth of the air above it in 20 ms. So a particle of the
// fluid that comes nearer to a grain's centre than r0 is pushed back, by a spring and a dashpot that acts on approach:
//
//   f_ab = m_f [ omega^2 max(r0 - r, 0) - omega min(v_n, 0) (r < r0) ] max(1 - (2 v/speed)^2, 0) e_r,   omega =
//   speed/r0
//
// The last factor leaves a grain in flight alone: the air that passes it is fast, the air that seeps into a bed slow.
// m_f is the mass of the fluid particle, v_n the speed along e_r = r/|r|. r0 = 0.6 spacings is a little more than half
// the gap between two touching grains of one spacing, and the distance of the hollow among three (0.577).
// Antisymmetric.
#pragma once

#include <array>

#include "simd/vec.hpp"

namespace barchan {

struct GrainBarrier {
  static constexpr double reach = 0.6;  // r0 in spacings
  double distance;                      // r0 [m]
  double rate;                          // omega [1/s]
  double fast;                          // (2/speed)^2 [s2/m2]

  /// Adds the force on a [N]: r = x_a - x_b, v = v_a - v_b, mass that of the fluid particle [kg].
  template <class T, std::size_t Dim>
  BARCHAN_SIMD_INLINE void add(const std::array<T, Dim>& r, T r2, const std::array<T, Dim>& v, T mass,
                               std::array<T, Dim>& force) const {
    const T inverse = inverse_sqrt(r2), gap = max(T(distance) - r2 * inverse, T(0.0));
    T approach = v[0] * r[0], v2 = v[0] * v[0];
    for (std::size_t d = 1; d < Dim; ++d) {
      approach = fma(v[d], r[d], approach);
      v2 = fma(v[d], v[d], v2);
    }
    const T slow = max(fnma(T(fast), v2, T(1.0)), T(0.0));
    approach = select(gap > T(0.0), min(approach, T(0.0)) * inverse, T(0.0));
    const T push = slow * mass * T(rate) * (T(rate) * gap - approach) * inverse;
    for (std::size_t d = 0; d < Dim; ++d) force[d] = fma(push, r[d], force[d]);
  }
};

}  // namespace barchan
