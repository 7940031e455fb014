// Gusts of the wind near the ground, which a mean wind does not have: patterns of faster and slower air that the wind
// carries along x.
//
//   u = U (1 + g),   1 + g = exp(s n - s^2/2),   s^2 = ln(1 + I^2),   n = sqrt(2/N) sum cos(k_j (x - c_j t) + phi_j)
//
// so that the mean of u is U and its standard deviation I U; n is nearly Gaussian. Measured: I = 0.36 to 0.40 as the
// wall is reached, with skewness about 1 (Alfredsson, Johansson, Haritonidis & Eckelmann 1988), which the exponential
// gives. Wave lengths are even in their logarithm between 200 and 3000 nu/u*; patterns move at 7 to 13 u* (Kim &
// Hussain 1993: 10 u*), each wave at its own speed, so that they change. u* of both: Bagnold's threshold
// 0.1 sqrt((rho_s/rho - 1) g d), a number of the scene. Nothing is random at run time: x and t give g.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace barchan {

/// m/s, Bagnold's threshold (1936), whose u* gusts have; `heavier`: the density of the grains over the air's, less 1.
inline double bagnold_threshold(double heavier, double gravity, double diameter) {
  return 0.1 * std::sqrt(std::max(heavier, 1.0) * gravity * diameter);
}

class Gusts {
 public:
  /// intensity: I; viscosity: m2/s; friction_velocity: m/s; the domain is periodic, from `low`, `size` long (m); g is
  /// known on `nodes` even places and linear between them.
  Gusts(double intensity, double viscosity, double friction_velocity, double low, double size, std::size_t nodes);

  /// Makes g of a time (s).
  void blow(double time);
  /// g about a place (m).
  double at(double x) const;

  /// The deviation of the wind ends to grow with U where U = ceiling u*: beyond the buffer layer it is 2.3 u*
  /// (I U with I = 0.38; Marusic & Kunkel 2003).
  static constexpr double ceiling = 6.0;
  double largest_gusty_speed() const { return ceiling * friction_velocity_; }
  /// m/s, a mean wind with its gust about a place (m).
  double felt(double x, double wind) const {
    return wind + at(x) * std::clamp(wind, -largest_gusty_speed(), largest_gusty_speed());
  }

 private:
  struct Wave {
    double number, speed, phase;  // 1/m, m/s, rad
  };
  static constexpr std::size_t waves = 16;
  double spread_, friction_velocity_, low_, size_;
  std::array<Wave, waves> wave_{};
  std::vector<double> node_;
};

}  // namespace barchan
