// Weighted least squares over the fluid about a place of a border: the pressure there, and how the velocity rises.
#pragma once

#include <Eigen/Dense>
#include <array>
#include <cmath>
#include <optional>

#include "base/vec3.hpp"

namespace barchan {

/// How far about a place of a border the fluid is fitted, in spacings.
constexpr double border_fit_radius = 3.0;

/// Two unit vectors across a normal; in 2D the first one.
inline std::array<Vec3, 2> along_border(const Vec3& normal, int dimensions) {
  if (dimensions == 2) return {Vec3{-normal[1], normal[0], 0.0}, Vec3{}};
  const Vec3 other = std::abs(normal[0]) < 0.6 ? Vec3{1, 0, 0} : Vec3{0, 1, 0}, first = cross(normal, other);
  const Vec3 along = 1.0 / norm(first) * first;
  return {along, cross(normal, along)};
}

/// Fits values to `N` functions of the place. Values: numbers of a sample.
template <int N, int Values>
class BorderFit {
 public:
  using Basis = Eigen::Matrix<double, N, 1>;
  using Value = Eigen::Matrix<double, 1, Values>;

  void add(const Basis& basis, double weight, const Value& value) {
    moment_.noalias() += weight * basis * basis.transpose();
    sums_.noalias() += weight * basis * value;
    ++count_;
  }
  /// The factors of the first function; nothing where the samples do not tell it from the others.
  std::optional<Value> first() const {
    if (count_ < N) return std::nullopt;
    const Eigen::LDLT<Eigen::Matrix<double, N, N>> ldlt(moment_);
    const Basis pivots = ldlt.vectorD();
    if (!(pivots.minCoeff() > least_pivot * pivots.maxCoeff())) return std::nullopt;
    const Eigen::Matrix<double, N, Values> factors = ldlt.solve(sums_);
    return Value(factors.row(0));
  }

 private:
  static constexpr double least_pivot = 1e-5;  // of the largest
  Eigen::Matrix<double, N, N> moment_ = Eigen::Matrix<double, N, N>::Zero();
  Eigen::Matrix<double, N, Values> sums_ = Eigen::Matrix<double, N, Values>::Zero();
  int count_ = 0;
};

/// What the fluid about a place of a border says of it. Dim: dimensions. Lengths in spacings, so that the numbers of
/// the fits are of one size.
template <int Dim>
class BorderSample {
 public:
  using Vector = Eigen::Matrix<double, 1, Dim>;

  /// A particle with the weight w at r from the place: its pressure less the hydrostatic part from the place to it
  /// (Pa).
  void press(const Vector& r, double w, double pressure) {
    Eigen::Matrix<double, Dim + 1, 1> basis;
    basis << 1.0, r.transpose();
    pressure_.add(basis, w, Eigen::Matrix<double, 1, 1>(pressure));
    weights_ += w;
    pressures_ += w * pressure;
  }
  /// Of a particle outside: its distance to the border, its place along it, and its velocity in the body's own motion.
  void rub(double distance, const Eigen::Matrix<double, Dim - 1, 1>& along, double w, const Vector& velocity) {
    Eigen::Matrix<double, Dim + 1, 1> basis;
    basis << distance, 0.5 * distance * distance, distance * along;
    velocity_.add(basis, w, velocity);
    squares_ += w * distance * distance;
    rises_ += w * distance * velocity;
  }

  bool any() const { return weights_ > 0.0; }
  /// Linear; of few particles their mean.
  double pressure() const {
    const auto fitted = pressure_.first();
    return fitted ? (*fitted)(0) : pressures_ / weights_;
  }
  /// By the spacing; quadratic in the distance, linear in the place along the border; of few particles linear.
  Vector rise() const {
    const auto fitted = velocity_.first();
    if (fitted) return *fitted;
    return squares_ > 0.0 ? Vector(rises_ / squares_) : Vector(Vector::Zero());
  }

 private:
  BorderFit<Dim + 1, 1> pressure_;
  BorderFit<Dim + 1, Dim> velocity_;
  double weights_ = 0.0, pressures_ = 0.0, squares_ = 0.0;
  Vector rises_ = Vector::Zero();
};

}  // namespace barchan
