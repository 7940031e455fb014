#include "models/fluid/inflow_fluctuations.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "start/random.hpp"

namespace barchan {
namespace {

using std::numbers::pi;

Vec3 vec3(const Eigen::Vector3d& v) { return {v[0], v[1], v[2]}; }

/// Two normal random numbers (Box & Muller 1958).
std::array<double, 2> normals(Random& random) {
  const double r = std::sqrt(-2.0 * std::log(1.0 - random.uniform(0.0, 1.0))), angle = random.uniform(0.0, 2.0 * pi);
  return {r * std::cos(angle), r * std::sin(angle)};
}

/// Directions of the same weight: in 2D evenly spaced, in 3D random.
Eigen::Vector3d direction(Random& random, std::size_t n, int dimensions) {
  if (dimensions == 2) {
    const double angle = pi * (static_cast<double>(n) + 0.5) / static_cast<double>(InflowFluctuations::modes);
    return {std::cos(angle), std::sin(angle), 0.0};
  }
  const double z = random.uniform(-1.0, 1.0), angle = random.uniform(0.0, 2.0 * pi), flat = std::sqrt(1.0 - z * z);
  return {flat * std::cos(angle), flat * std::sin(angle), z};
}

/// A wave across p. `k`: 1/m, parameter of the Rayleigh distribution of its length.
Eigen::Vector3d wave_across(const Eigen::Vector3d& p, Random& random, double k, int dimensions) {
  const auto [a, b] = normals(random);
  const Eigen::Vector3d q = p.normalized();
  if (dimensions == 2) return (a < 0.0 ? -k : k) * std::hypot(a, b) * Eigen::Vector3d(-q[1], q[0], 0.0);
  const Eigen::Vector3d first = q.unitOrthogonal();
  return k * (a * first + b * q.cross(first));
}

}  // namespace

InflowFluctuations::InflowFluctuations(const Fluctuations& given, double density, int dimensions, const Vec3& periods) {
  Random random(given.seed);
  std::array<Eigen::Vector3d, modes> xi;
  Eigen::Matrix3d mean = Eigen::Matrix3d::Zero();
  for (std::size_t n = 0; n < modes; ++n) {
    xi[n] = direction(random, n, dimensions);
    mean += xi[n] * xi[n].transpose() / static_cast<double>(modes);
  }
  Eigen::Matrix3d stress = Eigen::Matrix3d::Zero();
  for (int d = 0; d < 3; ++d) stress(d, d) = std::pow(given.rms[static_cast<std::size_t>(d)], 2);
  stress(0, 1) = stress(1, 0) = covariance_of(given, density);
  if (dimensions == 2) mean(2, 2) = stress(2, 2) = 1.0;  // nothing is there
  const Eigen::Matrix3d whiten = mean.llt().matrixL().solve(Eigen::Matrix3d::Identity());
  const Eigen::Matrix3d to_stress = Eigen::Matrix3d(stress.llt().matrixL()) * whiten;
  const double k = (dimensions == 2 ? std::sqrt(2.0 * pi) : 0.75 * pi * std::sqrt(0.5 * pi)) / given.length;
  for (std::size_t n = 0; n < modes; ++n) {
    const Eigen::Vector3d p = to_stress * xi[n];
    Vec3 wave = vec3(wave_across(p, random, k, dimensions));
    for (std::size_t d = 0; d < 3; ++d)
      if (periods[d] > 0.0) wave[d] = 2.0 * pi / periods[d] * std::round(wave[d] * periods[d] / (2.0 * pi));
    modes_[n] = {wave, vec3(std::sqrt(2.0 / static_cast<double>(modes)) * p), random.uniform(0.0, 2.0 * pi)};
  }
}

Vec3 InflowFluctuations::operator()(const Vec3& x) const {
  Vec3 u{};
  for (const Mode& mode : modes_) u = u + std::cos(dot(mode.wave, x) + mode.phase) * mode.amplitude;
  return u;
}

void EnteringFluctuations::carry(const FlowLanes& lanes, const GivenVelocity& velocity, double time, double dt) {
  const std::size_t axis = end_.axis();
  const double inwards = end_.upper() ? -1.0 : 1.0;
  const auto mean = [&](const auto& value) {
    double sum = 0.0;
    for (std::size_t k = 0; k < lanes.size(); ++k) {
      Vec3 x = lanes.place(k);
      x[axis] = end_.at(end_.layer);
      sum += value(x, velocity(x, time));
    }
    return sum / static_cast<double>(lanes.size());
  };
  speed_ = mean([&](const Vec3&, const Vec3& v) { return inwards * v[axis]; });
  way_ += std::max(speed_, 0.0) * dt;
  surplus_ = 0.0;
  const double part = mean([&](const Vec3&, const Vec3& v) { return part_at(v); });
  if (part > 0.0) surplus_ = mean([&](const Vec3& x, const Vec3& v) { return (*this)(x, v)[axis]; }) / part;
}

double EnteringFluctuations::part_at(const Vec3& given) const {
  return speed_ > 0.0 ? std::min(1.0, 2.0 * norm(given) / speed_) : 0.0;
}

Vec3 EnteringFluctuations::operator()(const Vec3& x, const Vec3& given) const {
  const std::size_t axis = end_.axis();
  const double part = part_at(given);
  if (part == 0.0) return {};
  Vec3 at = x;
  at[axis] -= (end_.upper() ? -1.0 : 1.0) * way_;
  Vec3 u = field_(at);
  u[axis] -= surplus_;
  return part * u;
}

void EnteringFluctuations::archive(Archive& a, const std::string& zone) {
  a.number(zone + ": way of the fluctuations", way_);
  a.number(zone + ": mean speed through the side", speed_);
  a.number(zone + ": surplus of the fluctuations", surplus_);
}

}  // namespace barchan
