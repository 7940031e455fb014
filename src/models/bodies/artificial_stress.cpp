#include "models/bodies/artificial_stress.hpp"

#include <Eigen/Eigenvalues>
#include <array>
#include <cmath>
#include <cstdint>

#include "laws/elastic.hpp"

namespace barchan {

namespace {

constexpr int column_of[3][3] = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}};  // xx yy zz xy yz xz

template <int Dim>
using StressMatrix = Eigen::Matrix<double, Dim, Dim>;

/// The part of a symmetric matrix with eigenvalues above zero.
StressMatrix<3> pulling(const StressMatrix<3>& s) {
  const Eigen::SelfAdjointEigenSolver<StressMatrix<3>> solver(s);
  const auto& axes = solver.eigenvectors();
  return axes * solver.eigenvalues().cwiseMax(0.0).asDiagonal() * axes.transpose();
}
StressMatrix<2> pulling(const StressMatrix<2>& s) {
  const double mean = 0.5 * s.trace(), half = std::hypot(0.5 * (s(0, 0) - s(1, 1)), s(0, 1));
  if (mean - half >= 0.0) return s;
  if (mean + half <= 0.0) return StressMatrix<2>::Zero();
  return (mean + half) / (2.0 * half) * (s - (mean - half) * StressMatrix<2>::Identity());
}

template <int Dim>
void pack(const PhaseParticles& body, double strength, RecordArray& records) {
  const double *rho = body.column(Field::density), *p = body.column(Field::pressure);
  const auto n = static_cast<std::int64_t>(body.size());
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < n; ++i) {
    const auto k = static_cast<std::size_t>(i);
    StressMatrix<Dim> s;
    for (int d = 0; d < Dim; ++d)
      for (int e = 0; e < Dim; ++e) s(d, e) = body.column(Field::stress, column_of[d][e])[k] - (d == e ? p[k] : 0.0);
    const StressMatrix<Dim> pulls = pulling(s);
    const double factor = -strength / (rho[k] * rho[k]);
    for (std::size_t d = 0; d < Dim; ++d)
      for (std::size_t e = 0; e <= d; ++e)
        records[k][stress_index<Dim>(d, e)] = factor * pulls(static_cast<int>(d), static_cast<int>(e));
  }
}

}  // namespace

void pack_artificial_stress(const PhaseParticles& body, double strength, RecordArray& records) {
  body.dimensions() == 2 ? pack<2>(body, strength, records) : pack<3>(body, strength, records);
}

}  // namespace barchan
