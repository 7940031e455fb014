#include "models/coupling/air_grid.hpp"

#include <algorithm>
#include <cmath>

#include "engine/exchange.hpp"

namespace barchan {

namespace {

/// The coordinates of particles by axis; zero along z in two dimensions.
std::array<const double*, 3> columns_of(const PhaseParticles& p, Field field) {
  std::array<const double*, 3> of{};
  for (int d = 0; d < p.dimensions(); ++d) of[static_cast<std::size_t>(d)] = p.column(field, d);
  return of;
}
template <std::size_t Dim>
Vec3 at(const std::array<const double*, 3>& columns, std::size_t k) {
  Vec3 x{};
  for (std::size_t d = 0; d < Dim; ++d) x[d] = columns[d][k];
  return x;
}

}  // namespace

AirGrid::AirGrid(const Bounds& bounds, double spacing)
    : bounds_(bounds), dimensions_(static_cast<std::size_t>(bounds.dimensions)) {
  for (std::size_t d = 0; d < dimensions_; ++d) {
    const double size = bounds.high[d] - bounds.low[d];
    cells_[d] = static_cast<std::size_t>(std::max(1.0, std::round(size / spacing)));
    nodes_[d] = cells_[d] + (bounds.periodic[d] ? 0 : 1);
    width_[d] = size / static_cast<double>(cells_[d]);
  }
  mass_.assign(nodes_[0] * nodes_[1] * nodes_[2], 0.0);
  velocity_.assign(mass_.size(), {});
  force_.assign(mass_.size(), {});
}

template <std::size_t Dim>
std::array<AirGrid::Corner, std::size_t{1} << Dim> AirGrid::corners(const Vec3& x) const {
  std::array<std::array<std::size_t, 2>, 3> at{};
  Vec3 share{};
  for (std::size_t d = 0; d < Dim; ++d) {
    const double s = (x[d] - bounds_.low[d]) / width_[d];
    const double last = static_cast<double>(cells_[d]) - 1.0;
    const double cell = bounds_.periodic[d] ? std::floor(s) : std::clamp(std::floor(s), 0.0, last);
    share[d] = std::clamp(s - cell, 0.0, 1.0);
    const auto n = static_cast<long>(cells_[d]), k = static_cast<long>(cell);
    at[d][0] = static_cast<std::size_t>(bounds_.periodic[d] ? ((k % n) + n) % n : k);
    at[d][1] = bounds_.periodic[d] ? (at[d][0] + 1) % cells_[d] : at[d][0] + 1;
  }
  std::array<Corner, std::size_t{1} << Dim> corners;
  for (std::size_t c = 0; c < corners.size(); ++c) {
    const std::size_t i = c % 2, j = c / 2 % 2, k = c / 4;
    double weight = (i ? share[0] : 1.0 - share[0]) * (j ? share[1] : 1.0 - share[1]);
    if constexpr (Dim == 3) weight *= k ? share[2] : 1.0 - share[2];
    corners[c] = {(at[2][k] * nodes_[1] + at[1][j]) * nodes_[0] + at[0][i], weight};
  }
  return corners;
}

void AirGrid::gather(const PhaseParticles& air) {
  std::fill(mass_.begin(), mass_.end(), 0.0);
  std::fill(velocity_.begin(), velocity_.end(), Vec3{});
  if (kept_.empty()) std::fill(force_.begin(), force_.end(), Vec3{});
  else force_ = kept_;
  lost_ = {};
  std::fill(grains_.begin(), grains_.end(), std::array<double, 2>{});
  const auto x = columns_of(air, Field::position), v = columns_of(air, Field::velocity);
  const double m = air.mass();
  const auto add = [&] {
    by_dimension([&](auto dim) {
      constexpr std::size_t Dim = dim;
      for (std::size_t k = 0; k < air.size(); ++k)
        for (const auto& [node, weight] : corners<Dim>(at<Dim>(x, k))) {
          mass_[node] += m * weight;
          for (std::size_t d = 0; d < Dim; ++d) velocity_[node][d] += m * weight * v[d][k];
        }
    });
  };
  Exchange().in_turn({Exchange::Sums{mass_.data(), mass_.size() * sizeof(double)},
                      Exchange::Sums{velocity_.data(), velocity_.size() * sizeof(Vec3)}},
                     add);
  for (std::size_t n = 0; n < mass_.size(); ++n)
    for (double& c : velocity_[n]) c = mass_[n] > 0.0 ? c / mass_[n] : 0.0;
}

Vec3 AirGrid::velocity(const Vec3& x) const {
  return by_dimension([&](auto dim) {
    constexpr std::size_t Dim = dim;
    Vec3 sum{};
    double all = 0.0;
    for (const auto& [node, weight] : corners<Dim>(x)) {
      if (!(mass_[node] > 0.0)) continue;
      all += weight;
      for (std::size_t d = 0; d < Dim; ++d) sum[d] += weight * velocity_[node][d];
    }
    for (std::size_t d = 0; d < Dim; ++d) sum[d] = all > 0.0 ? sum[d] / all : 0.0;
    return sum;
  });
}

/// A node on a side of the domain stands for half a cell, one in its corner for a quarter.
double AirGrid::density(const Vec3& x) const {
  return by_dimension([&](auto dim) {
    constexpr std::size_t Dim = dim;
    double sum = 0.0;
    for (const auto& [node, weight] : corners<Dim>(x)) {
      std::array<std::size_t, 3> at{node % nodes_[0], node / nodes_[0], 0};
      double room = width_[0] * width_[1];
      if constexpr (Dim == 3) {
        at = {at[0], at[1] % nodes_[1], at[1] / nodes_[1]};
        room *= width_[2];
      }
      for (std::size_t d = 0; d < Dim; ++d)
        if (!bounds_.periodic[d] && (at[d] == 0 || at[d] == cells_[d])) room *= 0.5;
      sum += weight * mass_[node] / room;
    }
    return sum;
  });
}

void AirGrid::push(const Vec3& x, const Vec3& force) {
  by_dimension([&](auto dim) {
    constexpr std::size_t Dim = dim;
    const auto about = corners<Dim>(x);
    double all = 0.0;
    for (const auto& [node, weight] : about) all += mass_[node] > 0.0 ? weight : 0.0;
    for (std::size_t d = 0; d < Dim && !(all > 0.0); ++d) lost_[d] += force[d];
    for (const auto& [node, weight] : about)
      for (std::size_t d = 0; d < Dim && mass_[node] > 0.0 && all > 0.0; ++d)
        force_[node][d] += weight / all * force[d];
  });
}

void AirGrid::give(PhaseParticles& air) const {
  const auto x = columns_of(air, Field::position);
  std::array<double*, 3> to{};
  for (std::size_t d = 0; d < dimensions_; ++d) to[d] = air.column(Field::drag_acceleration, static_cast<int>(d));
  const auto n = static_cast<std::int64_t>(air.size());
  by_dimension([&](auto dim) {
    constexpr std::size_t Dim = dim;
#pragma omp parallel for schedule(static)
    for (std::int64_t i = 0; i < n; ++i) {
      const auto k = static_cast<std::size_t>(i);
      Vec3 a{};
      for (const auto& [node, weight] : corners<Dim>(at<Dim>(x, k)))
        for (std::size_t d = 0; d < Dim; ++d) a[d] += weight * force_[node][d] / std::max(mass_[node], 1e-300);
      for (std::size_t d = 0; d < Dim; ++d) to[d][k] = a[d];
    }
  });
}

void AirGrid::put(const Vec3& x, double mass, double rate) {
  grains_.resize(mass_.size());
  by_dimension([&](auto dim) {
    for (const auto& [node, weight] : corners<dim>(x)) {
      grains_[node][0] += weight * mass * rate;
      grains_[node][1] += weight * mass;
    }
  });
}

void AirGrid::give_grains(const PhaseParticles& air, GrainsInEddies* of) const {
  const auto x = columns_of(air, Field::position);
  const auto n = static_cast<std::int64_t>(air.size());
  by_dimension([&](auto dim) {
    constexpr std::size_t Dim = dim;
#pragma omp parallel for schedule(static)
    for (std::int64_t i = 0; i < n; ++i) {
      const auto k = static_cast<std::size_t>(i);
      double rate = 0.0, drag = 0.0, mass = 0.0;
      for (const auto& [node, weight] : corners<Dim>(at<Dim>(x, k))) {
        if (grains_.empty()) break;
        rate += weight * grains_[node][0] / std::max(mass_[node], 1e-300);
        drag += weight * grains_[node][0];
        mass += weight * grains_[node][1];
      }
      of[k] = {rate, drag > 0.0 ? mass / drag : 0.0};
    }
  });
}

}  // namespace barchan
