// Torque on a rigid body of the friction with a fluid, beyond that of the pair forces at the places of its particles.
//
// The friction of pairs (Morris et al. 1997) is the surface integral of mu n.grad v. Its force on a closed surface is
// that of the whole stress mu (grad v + grad v^T), its torque is not: the part of grad v^T on a surface that turns with
// the body, v = w x r, is -mu w x n, and a body that turns with the fluid about it would be braked. And a force of a
// pair acts between the two particles, not at that of the body. So the torque of a pair is, about the body's place,
//
//   (x_b - r/2) x 2 mu V_a V_b F (v_ba - w x r),   r = x_b - x_a
//
// of which x_b x 2 mu V_a V_b F v_ba is there already. The force stays as it is: what is left out of it has no sum.
#pragma once

#include "laws/pair.hpp"

namespace barchan {

/// Numbers of r x v: in 2D the one about z.
constexpr std::size_t twists(int dimensions) { return dimensions == 2 ? 1 : 3; }

/// The first particle is one of the body, the second one of the fluid.
struct TurningFriction : PairLaw<Needs::gradient, Quantity::velocity, Quantity::volume> {
  double viscosity;  // mu [Pa s], of the pair

  template <int Dim, class T>
  struct Sums {
    std::array<T, Dim> area;                  // sum mu V_a F r
    std::array<T, Dim*(Dim + 1) / 2> moment;  // sum mu V_a F r r: xx yx yy zx zy zz
    std::array<T, twists(Dim)> twist;         // sum mu V_a F r x v_ba
  };

  template <int Dim, class T>
  BARCHAN_SIMD_INLINE void add(const Own<Dim, T>& b, const Own<Dim, T>& a, const Pair<Dim, T>& ba,
                               Sums<Dim, T>& s) const {
    const T f = T(viscosity) * a.volume * ba.f;
    const auto v = difference(b.v, a.v);
    std::size_t m = 0;
    for (std::size_t d = 0; d < Dim; ++d) {
      const T fr = f * ba.r[d];
      s.area[d] += fr;
      for (std::size_t e = 0; e <= d; ++e, ++m) s.moment[m] = fma(fr, ba.r[e], s.moment[m]);
    }
    for (std::size_t d = 0; d < twists(Dim); ++d) {
      const std::size_t i = Dim == 2 ? 0 : (d + 1) % 3, j = Dim == 2 ? 1 : (d + 2) % 3;
      s.twist[d] = fma(f, ba.r[i] * v[j] - ba.r[j] * v[i], s.twist[d]);
    }
  }
};

}  // namespace barchan
