#include "measure/fit.hpp"

#include <Eigen/Dense>
#include <cmath>

#include "laws/eddies.hpp"

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
  if (particles.has(Field::ground_distance)) ground_distance = particles.column(Field::ground_distance);
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

namespace {

/// v less its part along the normal.
Vec3 along_wall(const Vec3& v, const Vec3& normal) { return v - dot(v, normal) * normal; }

Vec3 velocity_of(const FluidView& fluid, std::size_t i) {
  Vec3 v{};
  for (std::size_t d = 0; d < static_cast<std::size_t>(fluid.dimensions); ++d) v[d] = fluid.value[d][i];
  return v;
}

}  // namespace

Reading wall_slope(const WallPoint& at, const FluidView& fluid, const Lookup& lookup, const ReadyKernel& kernel,
                   double radius) {
  Reading reading = interpolate(at.x, fluid, lookup, kernel, radius);
  if (!reading.found) return reading;
  const auto dimensions = static_cast<std::size_t>(fluid.dimensions);
  const Vec3 along_x = along_wall({1.0, 0.0, 0.0}, at.normal), along_z = along_wall({0.0, 0.0, 1.0}, at.normal);
  Normal normal;
  kernel([&](const auto& w) {
    lookup.neighbours(at.x, [&](std::size_t i, const Vec3& r, double r2) {
      const double n = dot(at.normal, r) / radius;
      Values v = values_of(fluid, i);
      for (std::size_t d = 0; d < dimensions; ++d) v[static_cast<int>(d)] -= at.velocity[d];
      normal.add(fluid.volume(i) * w.value(std::sqrt(r2)),
                 Basis{n, 1.0, n * n, n * dot(along_x, r) / radius, n * dot(along_z, r) / radius}, v);
    });
  });
  const double pressure = reading.value[dimensions];
  reading.found = normal.first(fluid.dimensions + 2, reading.value) || normal.first(2, reading.value) ||
                  normal.first(1, reading.value);
  Vec3 slope{};
  for (std::size_t d = 0; d < dimensions; ++d) slope[d] = reading.value[d] / radius;
  slope = along_wall(slope, at.normal);
  for (std::size_t d = 0; d < dimensions; ++d) reading.value[d] = slope[d];
  reading.value[dimensions] = pressure;
  return reading;
}

Reading rough_stress(const WallPoint& at, const RoughWall& wall, const FluidView& fluid, const Lookup& lookup,
                     const ReadyKernel& kernel, double radius) {
  Reading reading = interpolate(at.x, fluid, lookup, kernel, radius);
  if (!reading.found) return reading;
  const auto dimensions = static_cast<std::size_t>(fluid.dimensions);
  Vec3 stress{};
  kernel([&](const auto& w) {
    lookup.neighbours(at.x, [&](std::size_t i, const Vec3&, double r2) {
      const Vec3 u = along_wall(velocity_of(fluid, i) - at.velocity, at.normal);
      const double law = log_law_friction(fluid.ground_distance[i], wall.roughness, wall.spacing);
      stress = stress + fluid.volume(i) * w.value(std::sqrt(r2)) * wall.density * law * norm(u) * u;
    });
  });
  for (std::size_t d = 0; d < dimensions; ++d) reading.value[d] = stress[d] / reading.fraction;
  return reading;
}

}  // namespace barchan
