// Sizes of spheres: what follows from a distribution.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "scene/scene.hpp"

namespace barchan {

namespace {

constexpr double widths = 2.0;  // standard deviations at which a log-normal distribution is cut

/// Share of a normal distribution below x standard deviations, and its inverse, by bisection.
double below(double x) { return 0.5 * std::erfc(-x / std::numbers::sqrt2); }
double deviations(double share) {
  double low = -8.0, high = 8.0;
  for (int k = 0; k < 60; ++k) (below(0.5 * (low + high)) < share ? low : high) = 0.5 * (low + high);
  return 0.5 * (low + high);
}

/// Number of spheres between two diameters of a sieve curve, over 6/(pi density) and the mass of all: the mass is
/// spread evenly over the diameters between two sieves.
double number_between(const std::array<double, 2>& a, const std::array<double, 2>& b) {
  return (b[1] - a[1]) * 0.5 * (a[0] + b[0]) / (a[0] * a[0] * b[0] * b[0]);
}

}  // namespace

double SphereSize::least_share() const {
  if (!sieve.empty()) return sieve.front()[0] / mean;
  return log_normal > 0.0 ? std::exp(-widths * log_normal) : 1.0 - spread;
}

double SphereSize::largest_share() const {
  if (!sieve.empty()) return sieve.back()[0] / mean;
  return log_normal > 0.0 ? std::exp(widths * log_normal) : 1.0 + spread;
}

double SphereSize::mean_cube() const {
  if (!sieve.empty()) {
    double number = 0.0;
    for (std::size_t k = 1; k < sieve.size(); ++k) number += number_between(sieve[k - 1], sieve[k]);
    return 1.0 / (number * mean * mean * mean);
  }
  if (log_normal > 0.0)
    return std::exp(4.5 * log_normal * log_normal) *
           (below(widths - 3.0 * log_normal) - below(-widths - 3.0 * log_normal)) / (below(widths) - below(-widths));
  return 1.0 + spread * spread;
}

double SphereSize::quantile(double share) const {
  if (log_normal > 0.0) {
    const double cut = below(-widths);
    return std::exp(log_normal * deviations(cut + share * (1.0 - 2.0 * cut)));
  }
  if (sieve.empty()) return (1.0 - spread) + 2.0 * spread * share;
  double number = 0.0;
  for (std::size_t k = 1; k < sieve.size(); ++k) number += number_between(sieve[k - 1], sieve[k]);
  double left = share * number;
  for (std::size_t k = 1; k < sieve.size(); ++k) {
    const auto &a = sieve[k - 1], &b = sieve[k];
    const double here = number_between(a, b);
    if (left < here || k + 1 == sieve.size()) {
      // The number below d between a and b goes with 1/a^2 - 1/d^2.
      const double part = here > 0.0 ? std::min(left / here, 1.0) : 0.0;
      return 1.0 / (mean * std::sqrt((1.0 - part) / (a[0] * a[0]) + part / (b[0] * b[0])));
    }
    left -= here;
  }
  return 1.0;
}

}  // namespace barchan
