// Cubic B-spline kernel (Monaghan & Lattanzio 1985); eq. (14) of Halik et al. 2015 in the equivalent form
//   W = sigma [ (2-q)^3/4 - (1-q)^3 ],  each bracket only where positive,  q = r/h,
//   sigma = 2/(3h), 10/(7 pi h^2), 1/(pi h^3) in one, two, three dimensions.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

#include "simd/vec.hpp"

namespace barchan {

template <class T>
class CubicSpline {
 public:
  static constexpr const char* name = "cubic-spline";

  CubicSpline(double radius, int dimensions) {
    const double h = radius / 2.0, pi = std::numbers::pi;
    const double sigma = dimensions == 1   ? 2.0 / (3.0 * h)
                         : dimensions == 2 ? 10.0 / (7.0 * pi * h * h)
                                           : 1.0 / (pi * h * h * h);
    inverse_h_ = static_cast<T>(1.0 / h);
    sigma_ = static_cast<T>(sigma);
    gradient_ = static_cast<T>(sigma / h);
  }

  /// W and F at squared distances r2 > 0.
  template <int W>
  void value_and_gradient(simd::Vec<T, W> r2, simd::Vec<T, W>& w, simd::Vec<T, W>& f) const {
    using V = simd::Vec<T, W>;
    const V inverse_r = simd::inverse_sqrt(r2);
    const V q = r2 * inverse_r * V(inverse_h_);
    const V outer = simd::max(V(T(2)) - q, V(T(0))), inner = simd::max(V(T(1)) - q, V(T(0)));
    const V outer2 = outer * outer, inner2 = inner * inner;
    w = V(sigma_) * (V(T(0.25)) * outer2 * outer - inner2 * inner);
    f = V(gradient_) * inverse_r * (V(T(3)) * inner2 - V(T(0.75)) * outer2);
  }
  template <int W>
  simd::Vec<T, W> gradient(simd::Vec<T, W> r2) const {
    return simd::Vec<T, W>(gradient_) * slope(r2);
  }
  /// F without its constant factor: F = slope * slope_factor(). Sums over pairs take the factor out.
  template <int W>
  simd::Vec<T, W> slope(simd::Vec<T, W> r2) const {
    using V = simd::Vec<T, W>;
    const V inverse_r = V(T(1)) / simd::sqrt(r2);
    const V q = r2 * inverse_r * V(inverse_h_);
    const V outer = simd::max(V(T(2)) - q, V(T(0))), inner = simd::max(V(T(1)) - q, V(T(0)));
    return inverse_r * simd::fnma(V(T(0.75)) * outer, outer, V(T(3)) * inner * inner);
  }
  T slope_factor() const { return gradient_; }

  /// W at distance r (scalar, for set-up and tests).
  T value(T r) const {
    const T q = r * inverse_h_, outer = std::max(T(2) - q, T(0)), inner = std::max(T(1) - q, T(0));
    return sigma_ * (T(0.25) * outer * outer * outer - inner * inner * inner);
  }
  /// dW/dr at distance r.
  T derivative(T r) const {
    const T q = r * inverse_h_, outer = std::max(T(2) - q, T(0)), inner = std::max(T(1) - q, T(0));
    return gradient_ * (T(3) * inner * inner - T(0.75) * outer * outer);
  }

 private:
  T inverse_h_, sigma_, gradient_;
};

}  // namespace barchan
