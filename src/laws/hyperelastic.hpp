// Hyperelastic solids: the first Piola-Kirchhoff stress P [Pa] and the energy density psi [J/m3] of a deformation
// gradient F = I + H, plane strain in two dimensions.
//
//   neo-Hookean (Ciarlet & Geymonat 1982; Simo & Pister 1984):
//     psi = mu/2 (F:F - 3 - 2 ln J) + lambda/4 (J^2 - 1 - 2 ln J),   P = [mu (J F - cof F) + lambda/2 (J^2 - 1) cof
//     F]/J
//   St. Venant-Kirchhoff:
//     psi = lambda/2 (tr E)^2 + mu E:E,  E = (F^T F - I)/2,          P = F (lambda tr E I + 2 mu E)
//   Kelvin & Voigt's damping of both: S gains t_r (lambda tr E' I + 2 mu E'), E' = sym(F^T F'); a vibration of angular
//   frequency w then has the damping ratio w t_r/2.
//
// Everything is written in H: J - 1 = tr H + ... and F - cof F are sums of small terms, so that single precision keeps
// the digits of a small strain.
#pragma once

#include <array>
#include <cmath>

#include "simd/vec.hpp"

namespace barchan {

/// Lame's constants (Pa) and the retardation time of Kelvin & Voigt (s).
struct ElasticModuli {
  double lambda = 0.0, mu = 0.0, retardation = 0.0;

  static ElasticModuli of(double young, double poisson, double retardation) {
    return {young * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson)), young / (2.0 * (1.0 + poisson)), retardation};
  }
  /// Pa, of waves of compression without lateral strain.
  double compression() const { return lambda + 2.0 * mu; }
};

namespace hyperelastic {

using simd::fma;
using std::fma;

template <int Dim, class V>
using Matrix = std::array<std::array<V, Dim>, Dim>;

template <int Dim, class V>
BARCHAN_SIMD_INLINE V trace(const Matrix<Dim, V>& m) {
  V sum = m[0][0];
  for (std::size_t d = 1; d < Dim; ++d) sum += m[d][d];
  return sum;
}

/// A B, A^T B, A B^T.
template <int Dim, class V>
BARCHAN_SIMD_INLINE Matrix<Dim, V> product(const Matrix<Dim, V>& a, const Matrix<Dim, V>& b) {
  Matrix<Dim, V> c;
  for (std::size_t d = 0; d < Dim; ++d)
    for (std::size_t e = 0; e < Dim; ++e) {
      c[d][e] = a[d][0] * b[0][e];
      for (std::size_t f = 1; f < Dim; ++f) c[d][e] = fma(a[d][f], b[f][e], c[d][e]);
    }
  return c;
}
template <int Dim, class V>
BARCHAN_SIMD_INLINE Matrix<Dim, V> transposed(const Matrix<Dim, V>& a) {
  Matrix<Dim, V> c;
  for (std::size_t d = 0; d < Dim; ++d)
    for (std::size_t e = 0; e < Dim; ++e) c[d][e] = a[e][d];
  return c;
}

/// The cofactors of H; in two dimensions those of the plane.
template <int Dim, class V>
BARCHAN_SIMD_INLINE Matrix<Dim, V> cofactors(const Matrix<Dim, V>& h) {
  if constexpr (Dim == 2) {
    return {{{h[1][1], -h[1][0]}, {-h[0][1], h[0][0]}}};
  } else {
    Matrix<Dim, V> c;
    for (std::size_t d = 0; d < 3; ++d)
      for (std::size_t e = 0; e < 3; ++e) {
        const std::size_t p = (d + 1) % 3, q = (d + 2) % 3, r = (e + 1) % 3, s = (e + 2) % 3;
        c[d][e] = h[p][r] * h[q][s] - h[p][s] * h[q][r];
      }
    return c;
  }
}

/// J - 1 of F = I + H.
template <int Dim, class V>
BARCHAN_SIMD_INLINE V dilation(const Matrix<Dim, V>& h) {
  if constexpr (Dim == 2) return h[0][0] + h[1][1] + (h[0][0] * h[1][1] - h[0][1] * h[1][0]);
  const Matrix<Dim, V> c = cofactors<Dim>(h);
  V determinant = h[0][0] * c[0][0];
  for (std::size_t e = 1; e < Dim; ++e) determinant = fma(h[0][e], c[0][e], determinant);
  return trace<Dim>(h) + (trace<Dim>(c) + determinant);
}

/// Green & Lagrange's strain E = (H + H^T + H^T H)/2.
template <int Dim, class V>
BARCHAN_SIMD_INLINE Matrix<Dim, V> green_strain(const Matrix<Dim, V>& h) {
  Matrix<Dim, V> e = product<Dim>(transposed<Dim>(h), h);
  for (std::size_t d = 0; d < Dim; ++d)
    for (std::size_t f = 0; f < Dim; ++f) e[d][f] = V(0.5) * (e[d][f] + (h[d][f] + h[f][d]));
  return e;
}

/// F M of F = I + H.
template <int Dim, class V>
BARCHAN_SIMD_INLINE Matrix<Dim, V> pushed(const Matrix<Dim, V>& h, const Matrix<Dim, V>& m) {
  Matrix<Dim, V> p = product<Dim>(h, m);
  for (std::size_t d = 0; d < Dim; ++d)
    for (std::size_t e = 0; e < Dim; ++e) p[d][e] += m[d][e];
  return p;
}

/// lambda tr E I + 2 mu E.
template <int Dim, class V>
BARCHAN_SIMD_INLINE Matrix<Dim, V> hooke(const Matrix<Dim, V>& e, V lambda, V mu) {
  Matrix<Dim, V> s;
  const V pressure = lambda * trace<Dim>(e);
  for (std::size_t d = 0; d < Dim; ++d)
    for (std::size_t f = 0; f < Dim; ++f) {
      s[d][f] = (mu + mu) * e[d][f];
      if (d == f) s[d][f] += pressure;
    }
  return s;
}

/// P of Kelvin & Voigt's damping; `rate` is dH/dt.
template <int Dim, class V>
BARCHAN_SIMD_INLINE Matrix<Dim, V> damping_stress(const Matrix<Dim, V>& h, const Matrix<Dim, V>& rate, V lambda, V mu) {
  const Matrix<Dim, V> turned = pushed<Dim>(transposed<Dim>(h), rate);  // F^T F'
  Matrix<Dim, V> e;
  for (std::size_t d = 0; d < Dim; ++d)
    for (std::size_t f = 0; f < Dim; ++f) e[d][f] = V(0.5) * (turned[d][f] + turned[f][d]);
  return pushed<Dim>(h, hooke<Dim>(e, lambda, mu));
}

}  // namespace hyperelastic

namespace hyperelastic {

/// A bound on the square of the largest principal stretch, by the circles of Gershgorin (1931) about C = I + 2 E; exact
/// at rest and in any turn.
template <int Dim, class V>
BARCHAN_SIMD_INLINE V largest_stretch(const Matrix<Dim, V>& e) {
  using simd::max;
  V most(0.0);
  for (std::size_t d = 0; d < Dim; ++d) {
    V row = e[d][d];
    for (std::size_t f = 0; f < Dim; ++f)
      if (f != d) row += max(e[d][f], -e[d][f]);
    most = max(most, V(1.0) + row + row);
  }
  return most;
}

/// Bounds that no body comes to, 2^-40 and 2^40.
constexpr float smallest_square = 0x1p-40F, largest_square = 0x1p40F;

/// A bound on 1 over the square of the least principal stretch; `jacobian` is J - 1.
template <int Dim, class V>
BARCHAN_SIMD_INLINE V least_stretch_inverse(const Matrix<Dim, V>& e, V jacobian) {
  using simd::max;
  const V j = V(1.0) + jacobian, square = max(j * j, V(smallest_square));
  if constexpr (Dim == 2) return largest_stretch<Dim>(e) / square;  // the two make J
  V least(largest_square), trace(0.0), squares(0.0);
  for (std::size_t d = 0; d < Dim; ++d) {
    V row = e[d][d];
    for (std::size_t f = 0; f < Dim; ++f) {
      const V c = d == f ? V(1.0) + e[d][f] + e[d][f] : e[d][f] + e[d][f];
      squares = fma(c, c, squares);
      if (d == f) trace += c;
      else row -= max(e[d][f], -e[d][f]);
    }
    least = simd::min(least, V(1.0) + row + row);
  }
  // Or: the sum of the squares of 1/stretch is the second invariant of C over J^2.
  const V sum = V(0.5) * (trace * trace - squares) / square;
  return simd::min(sum, V(1.0) / max(least, V(smallest_square)));
}

}  // namespace hyperelastic

struct NeoHookean {
  /// A bound on a (x) N : dP/dF : a (x) N over lambda + 2 mu for unit vectors a, N, which is
  /// mu + [mu + lambda (J^2 + 1)/2] (a . F^-T N)^2: how much stiffer waves find the body than at rest.
  template <int Dim, class V>
  static BARCHAN_SIMD_INLINE V stiffening(const hyperelastic::Matrix<Dim, V>& e, V jacobian, V lambda, V mu) {
    const V j = V(1.0) + jacobian, inverse = hyperelastic::least_stretch_inverse<Dim>(e, jacobian);
    return (mu + (mu + V(0.5) * lambda * (j * j + V(1.0))) * inverse) / (lambda + mu + mu);
  }
  /// P in the plane or in space; `jacobian` is J - 1.
  template <int Dim, class V>
  static BARCHAN_SIMD_INLINE hyperelastic::Matrix<Dim, V> stress(const hyperelastic::Matrix<Dim, V>& h, V jacobian,
                                                                 V lambda, V mu) {
    using namespace hyperelastic;
    const Matrix<Dim, V> c = cofactors<Dim>(h);
    const V t = trace<Dim>(h), one(1.0), inverse = one / (one + jacobian);
    const V pressure = V(0.5) * lambda * jacobian * (V(2.0) + jacobian) * inverse, shear = mu * inverse;
    Matrix<Dim, V> p;
    for (std::size_t d = 0; d < Dim; ++d)
      for (std::size_t e = 0; e < Dim; ++e) {
        // cof F and F - cof F
        V cofactor, difference;
        if constexpr (Dim == 2) {
          cofactor = d == e ? one + c[d][e] : c[d][e];
          difference = h[d][e] - c[d][e];
        } else {
          cofactor = d == e ? one + (t - h[e][d] + c[d][e]) : c[d][e] - h[e][d];
          difference = d == e ? h[d][e] + h[e][d] - t - c[d][e] : h[d][e] + h[e][d] - c[d][e];
        }
        const V f = d == e ? one + h[d][e] : h[d][e];
        p[d][e] = fma(shear, fma(jacobian, f, difference), pressure * cofactor);
      }
    return p;
  }
  /// P_zz of plane strain.
  static double across(double, double jacobian, const ElasticModuli& m) {
    return 0.5 * m.lambda * jacobian * (2.0 + jacobian);
  }
  /// psi; `strain` is tr E.
  static double energy(double strain, double, double jacobian, const ElasticModuli& m) {
    const double l = std::log1p(jacobian);
    return m.mu * (strain - l) + 0.25 * m.lambda * (jacobian * (2.0 + jacobian) - 2.0 * l);
  }
};

struct SaintVenantKirchhoff {
  /// The same of this law: lambda (a . F N)^2 + mu [(a . F N)^2 + |F^T a|^2] + N . S N.
  template <int Dim, class V>
  static BARCHAN_SIMD_INLINE V stiffening(const hyperelastic::Matrix<Dim, V>& e, V, V lambda, V mu) {
    const V most = hyperelastic::largest_stretch<Dim>(e), modulus = lambda + mu + mu;
    const V pull = lambda * simd::max(hyperelastic::trace<Dim>(e), V(0.0)) + mu * simd::max(most - V(1.0), V(0.0));
    return (modulus * most + pull) / modulus;
  }
  template <int Dim, class V>
  static BARCHAN_SIMD_INLINE hyperelastic::Matrix<Dim, V> stress(const hyperelastic::Matrix<Dim, V>& h, V, V lambda,
                                                                 V mu) {
    using namespace hyperelastic;
    return pushed<Dim>(h, hooke<Dim>(green_strain<Dim>(h), lambda, mu));
  }
  /// P_zz of plane strain; `strain` is tr E.
  static double across(double strain, double, const ElasticModuli& m) { return m.lambda * strain; }
  /// psi; `square` is E:E.
  static double energy(double strain, double square, double, const ElasticModuli& m) {
    return 0.5 * m.lambda * strain * strain + m.mu * square;
  }
};

}  // namespace barchan
