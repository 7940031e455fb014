#include "models/coupling/air_grid.hpp"

#include <algorithm>
#include <cmath>

#include "engine/exchange.hpp"

namespace barchan {

AirGrid::AirGrid(const Bounds& bounds, double spacing) : bounds_(bounds) {
  for (std::size_t d = 0; d < 2; ++d) {
    const double size = bounds.high[d] - bounds.low[d];
    cells_[d] = static_cast<std::size_t>(std::max(1.0, std::round(size / spacing)));
    nodes_[d] = cells_[d] + (bounds.periodic[d] ? 0 : 1);
    width_[d] = size / static_cast<double>(cells_[d]);
  }
  mass_.assign(nodes_[0] * nodes_[1], 0.0);
  velocity_.assign(mass_.size(), {});
  force_.assign(mass_.size(), {});
}

std::array<AirGrid::Corner, 4> AirGrid::corners(const Flat& x) const {
  std::array<std::array<std::size_t, 2>, 2> at{};
  std::array<double, 2> share{};
  for (std::size_t d = 0; d < 2; ++d) {
    const double s = (x[d] - bounds_.low[d]) / width_[d];
    const double last = static_cast<double>(cells_[d]) - 1.0;
    const double cell = bounds_.periodic[d] ? std::floor(s) : std::clamp(std::floor(s), 0.0, last);
    share[d] = std::clamp(s - cell, 0.0, 1.0);
    const auto n = static_cast<long>(cells_[d]), k = static_cast<long>(cell);
    at[d][0] = static_cast<std::size_t>(bounds_.periodic[d] ? ((k % n) + n) % n : k);
    at[d][1] = bounds_.periodic[d] ? (at[d][0] + 1) % cells_[d] : at[d][0] + 1;
  }
  std::array<Corner, 4> corners{};
  for (std::size_t c = 0; c < 4; ++c) {
    const std::size_t i = c % 2, j = c / 2;
    corners[c] = {at[1][j] * nodes_[0] + at[0][i], (i ? share[0] : 1.0 - share[0]) * (j ? share[1] : 1.0 - share[1])};
  }
  return corners;
}

void AirGrid::gather(const PhaseParticles& air) {
  std::fill(mass_.begin(), mass_.end(), 0.0);
  std::fill(velocity_.begin(), velocity_.end(), Flat{});
  if (kept_.empty()) std::fill(force_.begin(), force_.end(), Flat{});
  else force_ = kept_;
  lost_ = {};
  const double *x = air.column(Field::position, 0), *y = air.column(Field::position, 1);
  const double *u = air.column(Field::velocity, 0), *v = air.column(Field::velocity, 1);
  const double m = air.mass();
  const auto add = [&] {
    for (std::size_t k = 0; k < air.size(); ++k)
      for (const auto& [node, weight] : corners({x[k], y[k]})) {
        mass_[node] += m * weight;
        velocity_[node][0] += m * weight * u[k];
        velocity_[node][1] += m * weight * v[k];
      }
  };
  Exchange().in_turn({Exchange::Sums{mass_.data(), mass_.size() * sizeof(double)},
                      Exchange::Sums{velocity_.data(), velocity_.size() * sizeof(Flat)}},
                     add);
  for (std::size_t n = 0; n < mass_.size(); ++n)
    for (double& c : velocity_[n]) c = mass_[n] > 0.0 ? c / mass_[n] : 0.0;
}

AirGrid::Flat AirGrid::velocity(const Flat& x) const {
  Flat sum{};
  double all = 0.0;
  for (const auto& [node, weight] : corners(x)) {
    if (!(mass_[node] > 0.0)) continue;
    all += weight;
    for (std::size_t d = 0; d < 2; ++d) sum[d] += weight * velocity_[node][d];
  }
  return all > 0.0 ? Flat{sum[0] / all, sum[1] / all} : Flat{};
}

/// A node on a side of the domain stands for half a cell, one in its corner for a quarter.
double AirGrid::density(const Flat& x) const {
  double sum = 0.0;
  for (const auto& [node, weight] : corners(x)) {
    const std::array<std::size_t, 2> at{node % nodes_[0], node / nodes_[0]};
    double area = width_[0] * width_[1];
    for (std::size_t d = 0; d < 2; ++d)
      if (!bounds_.periodic[d] && (at[d] == 0 || at[d] == cells_[d])) area *= 0.5;
    sum += weight * mass_[node] / area;
  }
  return sum;
}

void AirGrid::push(const Flat& x, const Flat& force) {
  const auto about = corners(x);
  double all = 0.0;
  for (const auto& [node, weight] : about) all += mass_[node] > 0.0 ? weight : 0.0;
  for (std::size_t d = 0; d < 2 && !(all > 0.0); ++d) lost_[d] += force[d];
  for (const auto& [node, weight] : about)
    for (std::size_t d = 0; d < 2 && mass_[node] > 0.0 && all > 0.0; ++d) force_[node][d] += weight / all * force[d];
}

void AirGrid::give(PhaseParticles& air) const {
  const double *x = air.column(Field::position, 0), *y = air.column(Field::position, 1);
  double *ax = air.column(Field::drag_acceleration, 0), *ay = air.column(Field::drag_acceleration, 1);
  const auto n = static_cast<std::int64_t>(air.size());
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < n; ++i) {
    const auto k = static_cast<std::size_t>(i);
    Flat a{};
    for (const auto& [node, weight] : corners({x[k], y[k]}))
      for (std::size_t d = 0; d < 2; ++d) a[d] += weight * force_[node][d] / std::max(mass_[node], 1e-300);
    ax[k] = a[0];
    ay[k] = a[1];
  }
}

}  // namespace barchan
