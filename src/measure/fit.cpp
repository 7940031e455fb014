#include "measure/fit.hpp"

#include <Eigen/Dense>
#include <cmath>

namespace barchan {
namespace {

constexpr int most = 5;               // terms of a basis
constexpr double least_pivot = 1e-4;  // of a term that weighs 1 by itself: below, the particles cannot tell it apart

using Basis = Eigen::Matrix<double, most, 1>;
using Values = Eigen::Matrix<double, 4, 1>;

/// Normal equations of a weighted least-squares fit of several values in one basis.
class Normal {
 public:
  void add(double weight, const Basis& basis, const Values& value) {
    matrix_ += weight * basis * basis.transpose();
    right_ += weight * basis * value.transpose();
  }

  /// The first term's coefficient of each value in a fit with the first `terms` terms. False when the particles cannot
  /// tell the terms apart.
  bool first(int terms, std::array<double, 4>& coefficient) const {
    using Square = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, most, most>;
    using Column = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, most, 1>;
    const Column weight = matrix_.diagonal().head(terms);
    if (!(weight.minCoeff() > 0.0)) return false;
    const Column scale = weight.array().rsqrt();  // every term weighs 1
    const Eigen::LDLT<Square> solver(scale.asDiagonal() * matrix_.topLeftCorner(terms, terms) * scale.asDiagonal());
    if (!(solver.vectorD().minCoeff() > least_pivot)) return false;
    const Eigen::Matrix<double, Eigen::Dynamic, 4, 0, most, 4> fitted =
        solver.solve(scale.asDiagonal() * right_.topRows(terms));
    for (int v = 0; v < 4; ++v) coefficient[static_cast<std::size_t>(v)] = scale[0] * fitted(0, v);
    return true;
  }

 private:
  Eigen::Matrix<double, most, most> matrix_ = Eigen::Matrix<double, most, most>::Zero();
  Eigen::Matrix<double, most, 4> right_ = Eigen::Matrix<double, most, 4>::Zero();
};

Values values_of(const FluidView& fluid, std::size_t i) {
  Values value = Values::Zero();
  for (std::size_t v = 0; v < fluid.values; ++v) value[static_cast<int>(v)] = fluid.value[v][i];
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
  Normal normal;
  kernel([&](const auto& w) {
    lookup.neighbours(x, [&](std::size_t i, const Vec3& r, double r2) {
      const double weight = fluid.volume(i) * w.value(std::sqrt(r2));
      reading.fraction += weight;
      normal.add(weight, Basis{1.0, r[0] / radius, r[1] / radius, r[2] / radius, 0.0}, values_of(fluid, i));
    });
  });
  const int linear = fluid.dimensions + 1;
  reading.found =
      reading.fraction >= least_fraction && (normal.first(linear, reading.value) || normal.first(1, reading.value));
  return reading;
}

Reading wall_slope(const Vec3& x, double inward, const Vec3& wall_velocity, const FluidView& fluid,
                   const Lookup& lookup, const ReadyKernel& kernel, double radius) {
  Reading reading = interpolate(x, fluid, lookup, kernel, radius);
  if (!reading.found) return reading;
  const auto dimensions = static_cast<std::size_t>(fluid.dimensions);
  Normal normal;
  kernel([&](const auto& w) {
    lookup.neighbours(x, [&](std::size_t i, const Vec3& r, double r2) {
      const double n = inward * r[1] / radius;
      Values v = values_of(fluid, i);
      for (std::size_t d = 0; d < dimensions; ++d) v[static_cast<int>(d)] -= wall_velocity[d];
      normal.add(fluid.volume(i) * w.value(std::sqrt(r2)), Basis{n, 1.0, n * n, n * r[0] / radius, n * r[2] / radius},
                 v);
    });
  });
  const double pressure = reading.value[dimensions];
  reading.found = normal.first(fluid.dimensions + 2, reading.value) || normal.first(2, reading.value) ||
                  normal.first(1, reading.value);
  for (std::size_t d = 0; d < dimensions; ++d) reading.value[d] /= radius;
  reading.value[dimensions] = pressure;
  return reading;
}

}  // namespace barchan
