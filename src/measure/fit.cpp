#include "measure/fit.hpp"

#include <cmath>

namespace barchan {
namespace {

constexpr std::size_t most = 5;  // terms of a basis
constexpr double least_pivot =
    1e-4;  // of what a term weighs by itself: below, the particles cannot tell it from others

using Basis = std::array<double, most>;
using Values = std::array<double, 4>;

/// Normal equations of a weighted least-squares fit of several values in one basis.
class Normal {
 public:
  explicit Normal(std::size_t values) : values_(values) {}

  void add(double weight, const Basis& basis, const Values& value) {
    for (std::size_t i = 0; i < most; ++i) {
      for (std::size_t j = 0; j <= i; ++j) matrix_[i][j] += weight * basis[i] * basis[j];
      for (std::size_t v = 0; v < values_; ++v) right_[i][v] += weight * basis[i] * value[v];
    }
  }

  /// The first term's coefficient of each value in a fit with the first `terms` terms, which are eliminated from the
  /// last to the first. False when the particles cannot tell the terms apart.
  bool first(std::size_t terms, Values& coefficient) const {
    auto matrix = matrix_;
    auto right = right_;
    for (std::size_t k = terms; k-- > 0;) {
      const double pivot = matrix[k][k];
      if (!(pivot > least_pivot * matrix_[k][k])) return false;
      for (std::size_t i = 0; i < k; ++i) {
        const double factor = matrix[k][i] / pivot;
        for (std::size_t j = 0; j <= i; ++j) matrix[i][j] -= factor * matrix[k][j];
        for (std::size_t v = 0; v < values_; ++v) right[i][v] -= factor * right[k][v];
      }
    }
    for (std::size_t v = 0; v < values_; ++v) coefficient[v] = right[0][v] / matrix[0][0];
    return true;
  }

 private:
  std::size_t values_;
  std::array<Basis, most> matrix_{};  // its lower triangle
  std::array<Values, most> right_{};
};

Values values_of(const FluidView& fluid, std::size_t i) {
  Values value{};
  for (std::size_t v = 0; v < fluid.values; ++v) value[v] = fluid.value[v][i];
  return value;
}

}  // namespace

FluidView::FluidView(const PhaseParticles& particles)
    : mass(particles.mass()),
      dimensions(particles.dimensions()),
      density(particles.column(Field::density)),
      values(static_cast<std::size_t>(particles.dimensions()) + 1) {
  for (int d = 0; d < dimensions; ++d) value[static_cast<std::size_t>(d)] = particles.column(Field::velocity, d);
  value[values - 1] = particles.column(Field::pressure);
}

Reading interpolate(const Vec3& x, const FluidView& fluid, const Lookup& lookup, const ReadyKernel& kernel,
                    double radius) {
  Reading reading;
  Normal normal(fluid.values);
  kernel([&](const auto& w) {
    lookup.neighbours(x, [&](std::size_t i, const Vec3& r, double r2) {
      const double weight = fluid.volume(i) * w.value(std::sqrt(r2));
      reading.fraction += weight;
      normal.add(weight, {1.0, r[0] / radius, r[1] / radius, r[2] / radius}, values_of(fluid, i));
    });
  });
  const std::size_t linear = static_cast<std::size_t>(fluid.dimensions) + 1;
  reading.found =
      reading.fraction >= least_fraction && (normal.first(linear, reading.value) || normal.first(1, reading.value));
  return reading;
}

Reading wall_slope(const Vec3& x, double inward, const Vec3& wall_velocity, const FluidView& fluid,
                   const Lookup& lookup, const ReadyKernel& kernel, double radius) {
  Reading reading = interpolate(x, fluid, lookup, kernel, radius);
  if (!reading.found) return reading;
  const auto dimensions = static_cast<std::size_t>(fluid.dimensions);
  Normal normal(dimensions);
  kernel([&](const auto& w) {
    lookup.neighbours(x, [&](std::size_t i, const Vec3& r, double r2) {
      const double n = inward * r[1] / radius;
      Values v = values_of(fluid, i);
      for (std::size_t d = 0; d < dimensions; ++d) v[d] -= wall_velocity[d];
      normal.add(fluid.volume(i) * w.value(std::sqrt(r2)), {n, 1.0, n * n, n * r[0] / radius, n * r[2] / radius}, v);
    });
  });
  const double pressure = reading.value[dimensions];
  reading.found =
      normal.first(dimensions + 2, reading.value) || normal.first(2, reading.value) || normal.first(1, reading.value);
  for (std::size_t d = 0; d < dimensions; ++d) reading.value[d] /= radius;
  reading.value[dimensions] = pressure;
  return reading;
}

}  // namespace barchan
