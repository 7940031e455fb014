#include "models/fluid/velocity_gradient.hpp"

#include <Eigen/Dense>
#include <cmath>

#include "kernels/kernel.hpp"

namespace barchan {

namespace {

/// Of a whole neighbourhood the determinant of the moment is 1, of a plane surface a quarter or more.
constexpr double least_determinant = 0.02;

template <int Dim>
using Matrix = Eigen::Matrix<double, Dim, Dim>;

template <int Dim>
Matrix<Dim> gradient_of(const double* own, std::size_t k, std::span<const FluidNeighbour> neighbours) {
  using R = MotionRecord<Dim>;
  using Vector = Eigen::Matrix<double, Dim, 1>;
  Matrix<Dim> moment = Matrix<Dim>::Zero(), rise = Matrix<Dim>::Zero();
  for (const FluidNeighbour& e : neighbours)
    with_kernel<double>(e.kernel, e.radius, Dim, [&](const auto& kernel) {
      const PairList::Row row = e.list->row(k);
      for (const std::uint32_t* q = row.begin; q != row.end; ++q) {
        const double* other = (*e.records)[*q / PairList::stride];
        Vector r, dv;
        for (int d = 0; d < Dim; ++d) {
          r[d] = own[R::position + d] - other[R::position + d];
          dv[d] = own[R::velocity + d] - other[R::velocity + d];
        }
        const double distance = r.norm();
        if (!(distance > 0.0) || !(distance < e.radius)) continue;  // the dummies of a row stand far away
        const Vector weighted = other[R::volume] * kernel.derivative(distance) / distance * r;
        moment -= r * weighted.transpose();
        rise -= dv * weighted.transpose();
      }
    });
  if (!(moment.determinant() > least_determinant)) return Matrix<Dim>::Zero();
  return rise * moment.inverse();
}

template <int Dim>
void derive(PhaseParticles& fluid, const RecordArray& own, std::span<const FluidNeighbour> neighbours,
            bool shear_rate) {
  const auto n = static_cast<std::int64_t>(fluid.size());
  std::array<double*, Dim * Dim> to{};
  const bool all = fluid.has(Field::velocity_gradient);
  for (int c = 0; all && c < Dim * Dim; ++c)
    to[static_cast<std::size_t>(c)] = fluid.column(Field::velocity_gradient, c);
  double* const shear = shear_rate ? fluid.column(Field::shear_rate) : nullptr;
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < n; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const Matrix<Dim> g = gradient_of<Dim>(own[k], k, neighbours);
    for (int c = 0; all && c < Dim * Dim; ++c) to[static_cast<std::size_t>(c)][k] = g(c / Dim, c % Dim);
    if (shear) shear[k] = std::sqrt(0.5) * (g + g.transpose()).norm();
  }
}

}  // namespace

void derive_velocity_gradient(PhaseParticles& fluid, const RecordArray& own, std::span<const FluidNeighbour> neighbours,
                              bool shear_rate) {
  fluid.dimensions() == 2 ? derive<2>(fluid, own, neighbours, shear_rate)
                          : derive<3>(fluid, own, neighbours, shear_rate);
}

}  // namespace barchan
