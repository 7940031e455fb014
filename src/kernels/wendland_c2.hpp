// Wendland C2 kernel (Wendland 1995; Dehnen & Aly 2012) with support 2h:
//   W = sigma (1-q/2)^4 (2q+1),  sigma = 7/(4 pi h^2), 21/(16 pi h^3) in two, three dimensions (3/(4h) for the same
//   polynomial in one);  F = (1/r) dW/dr = -(5 sigma/h^2) (1-q/2)^3: one square root, no division.
// It does not pair particles however many neighbours it has.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

#include "simd/vec.hpp"

namespace barchan {

template <class T>
class WendlandC2 {
 public:
  static constexpr const char* name = "wendland-c2";

  WendlandC2(double radius, int dimensions) {
    const double h = radius / 2.0, pi = std::numbers::pi;
    const double sigma = dimensions == 1   ? 3.0 / (4.0 * h)
                         : dimensions == 2 ? 7.0 / (4.0 * pi * h * h)
                                           : 21.0 / (16.0 * pi * h * h * h);
    inverse_radius_ = static_cast<T>(1.0 / radius);
    sigma_ = static_cast<T>(sigma);
    gradient_ = static_cast<T>(-5.0 * sigma / (h * h));
  }

  /// W and F at squared distances r2 >= 0.
  template <int W>
  void value_and_gradient(simd::Vec<T, W> r2, simd::Vec<T, W>& w, simd::Vec<T, W>& f) const {
    using V = simd::Vec<T, W>;
    const V s = simd::sqrt(r2) * V(inverse_radius_);  // q/2
    const V t = simd::max(V(T(1)) - s, V(T(0))), t3 = t * t * t;
    w = V(sigma_) * t3 * t * simd::fma(V(T(4)), s, V(T(1)));
    f = V(gradient_) * t3;
  }
  template <int W>
  simd::Vec<T, W> gradient(simd::Vec<T, W> r2) const {
    return simd::Vec<T, W>(gradient_) * slope(r2);
  }
  /// F without its constant factor: F = slope * slope_factor(). Sums over pairs take the factor out.
  template <int W>
  simd::Vec<T, W> slope(simd::Vec<T, W> r2) const {
    using V = simd::Vec<T, W>;
    const V t = simd::max(simd::fnma(simd::sqrt(r2), V(inverse_radius_), V(T(1))), V(T(0)));
    return t * t * t;
  }
  T slope_factor() const { return gradient_; }

  /// W at distance r (scalar, for set-up and tests).
  T value(T r) const {
    const T s = r * inverse_radius_, t = std::max(T(1) - s, T(0));
    return sigma_ * t * t * t * t * (T(4) * s + T(1));
  }
  /// dW/dr at distance r.
  T derivative(T r) const {
    const T t = std::max(T(1) - r * inverse_radius_, T(0));
    return gradient_ * t * t * t * r;
  }

 private:
  T inverse_radius_, sigma_, gradient_;
};

}  // namespace barchan
