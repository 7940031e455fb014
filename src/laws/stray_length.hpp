// The length of a pair of a total Lagrangian body, beside the one that the gradient of the displacement gives it:
//
//   s = |y| - |z|,  y = x_a - x_b = X + u,  z = F X = X + H X        (m)
//
// with X the pair in the first shape, u = u_a - u_b, F = I + H of one of its particles. It stores kappa/2 w s^2 of each
// particle's volume; no turn of the body changes it. Its slopes are e = y/|y| by u and -z/|z| (x) X by H.
//
// Waves of compression along x have in the gradient's stiffness the share 1 - k^2 S4/(3 S2) of c^2 k^2, in that of the
// strays rho^-1 k^4 (kappa S4 + kappa_l S6)/4, with S2 = sum w X^2, S4 = sum w X^4, S6 = sum w X^6/r^2 of the lattice:
// their speed is exact to k^4 with kappa_l = [4/3 (lambda + 2 mu)/S2 - kappa] S4/S6. Waves of shear and bending, whose
// strays lie across their pairs, hardly feel it.
//
// s is (y - z).(y + z)/(|y| + |z|), and y - z = u - H X: single precision keeps the digits of a small one.
#pragma once

#include <cmath>

#include "laws/hyperelastic.hpp"

namespace barchan {

template <int Dim, class V>
struct StrayLength {
  V stray;                  // m
  std::array<V, Dim> y, z;  // m
  V inverse_y, inverse_z;   // 1/m

  BARCHAN_SIMD_INLINE StrayLength(const std::array<V, Dim>& x, const std::array<V, Dim>& u,
                                  const hyperelastic::Matrix<Dim, V>& h) {
    using hyperelastic::fma;
    using simd::sqrt;
    using std::sqrt;
    V y2(1e-30F), z2(1e-30F), between(0.0F);
    for (std::size_t d = 0; d < Dim; ++d) {
      V hx = h[d][0] * x[0];
      for (std::size_t e = 1; e < Dim; ++e) hx = fma(h[d][e], x[e], hx);
      y[d] = x[d] + u[d];
      z[d] = x[d] + hx;
      y2 = fma(y[d], y[d], y2);
      z2 = fma(z[d], z[d], z2);
      between = fma(u[d] - hx, y[d] + z[d], between);
    }
    const V long_y = sqrt(y2), long_z = sqrt(z2);
    inverse_y = V(1.0F) / long_y;
    inverse_z = V(1.0F) / long_z;
    stray = between / (long_y + long_z);
  }
};

}  // namespace barchan
