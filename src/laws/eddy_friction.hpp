// What the logarithmic law of rough ground adds to the friction between a fluid and grains (laws/eddies.hpp): the
// viscous force of a pair with the viscosity that the fluid particle has in its pairs with grains, less the molecular
// one, which the fluid's own law counts.
//
//   f_ab = 2 V_a V_b (mu_b - mu) F v_ab                                         (Morris et al. 1997)
#pragma once

#include "laws/pair.hpp"

namespace barchan {

/// a is a grain, b a particle of the fluid; beside: mu_b [Pa s].
struct EddyFriction : PairLaw<Needs::slope, Quantity::velocity, Quantity::volume, Quantity::beside> {
  double molecular;  // mu [Pa s]

  template <int Dim, class T>
  struct Sums {
    std::array<T, Dim> drawn;  // sum V_b (mu_b - mu) F v_ab, without the slope's factor
  };

  template <int Dim, class T>
  BARCHAN_SIMD_INLINE void add(const Own<Dim, T>& a, const Own<Dim, T>& b, const Pair<Dim, T>& ab,
                               Sums<Dim, T>& s) const {
    const T f = ab.f * b.volume * (b.beside - T(molecular));
    for (std::size_t d = 0; d < Dim; ++d) s.drawn[d] = fma(f, a.v[d] - b.v[d], s.drawn[d]);
  }
};

}  // namespace barchan
