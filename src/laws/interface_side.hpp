// How much of the neighbourhood of a fluid's particle its own fluid fills, next to an interface with another fluid:
//   c = T_own/T,   T = -sum V F r^2
// c grows from about a half at the interface to 1 beyond the kernel's reach, and a strain of the particles leaves it
// as it is, so that it says how far the interface is (models/fluid/interface_distance.hpp).
#pragma once

#include "laws/pair.hpp"

namespace barchan {

struct InterfaceSide : PairLaw<Needs::gradient, Quantity::volume> {
  double own;  // 1: the neighbours are of the same fluid; 0: of the other one

  template <int Dim, class T>
  struct Sums {
    T own, all;
  };

  template <int Dim, class T>
  BARCHAN_SIMD_INLINE void add(const Particle<Dim, T, Reads>&, const Particle<Dim, T, Reads>& b, const Pair<Dim, T>& ab,
                               Sums<Dim, T>& s) const {
    const T filled = b.volume * ab.f * ab.r2;
    s.own = fma(T(own), filled, s.own);
    s.all += filled;
  }
};

}  // namespace barchan
