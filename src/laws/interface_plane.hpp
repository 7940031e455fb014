// The plane that the interface with another fluid is near a particle, and how far the particles are astray of it.
//
// Of the distances s that the particles about it have from the interface (positive in its own fluid, negative in the
// other; laws/interface_side.hpp), with the weights V W (reach - |s|), both are least squares:
//   plane:   s(x) = s_a + n.(x - x_a)
//   astray:  what is left of s by a fit of 1, r, (r^2 - z^2), z^2 and z^3, z = r.g/|g|: a smooth wave bends the
//            interface and strains the rows about it, disorder does what no such fit follows
// The sums are those of the products of the functions and of s, all in units of the reach. A particle farther from the
// interface than the reach has no distance, and no weight.
#pragma once

#include "laws/pair.hpp"

namespace barchan {

struct InterfacePlane : PairLaw<Needs::value_and_gradient, Quantity::volume, Quantity::beside> {
  double side;                 // 1: the neighbours are of the same fluid; -1: of the other one
  double reach;                // m
  std::array<double, 3> down;  // g/|g|; zero without gravity

  /// The functions and, last, s.
  template <int Dim>
  static constexpr std::size_t functions = static_cast<std::size_t>(Dim) + 5;

  template <int Dim, class T>
  struct Sums {
    std::array<T, functions<Dim>*(functions<Dim> + 1) / 2> products;  // lower triangle, row by row
  };

  template <int Dim, class T>
  BARCHAN_SIMD_INLINE void add(const Particle<Dim, T, Reads>&, const Particle<Dim, T, Reads>& b, const Pair<Dim, T>& ab,
                               Sums<Dim, T>& s) const {
    const T unit(1.0 / reach), distance = b.beside * unit;
    std::array<T, functions<Dim>> f;
    T z(0.0), r2(0.0);
    f[0] = T(1.0);
    for (std::size_t d = 0; d < Dim; ++d) {
      f[1 + d] = ab.r[d] * unit;
      z = fma(T(down[d]), f[1 + d], z);
      r2 = fma(f[1 + d], f[1 + d], r2);
    }
    const T deep = z * z;
    f[Dim + 1] = r2 - deep;
    f[Dim + 2] = deep;
    f[Dim + 3] = deep * z;
    f[Dim + 4] = T(side) * distance;
    const T weight = b.volume * ab.w * simd::max(T(1.0) - distance, T(0.0));
    std::size_t m = 0;
    for (std::size_t i = 0; i < f.size(); ++i) {
      const T weighted = weight * f[i];
      for (std::size_t j = 0; j <= i; ++j, ++m) s.products[m] = fma(weighted, f[j], s.products[m]);
    }
  }
};

}  // namespace barchan
