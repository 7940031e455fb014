#include "models/fluid/interface_distance.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "kernels/kernel.hpp"

namespace barchan {

namespace {

/// -sum V F r^2 of what fills all beyond a plane at the distance d (m).
double filled_beyond(const InterfaceDistance::Side& side, int dimensions, double d) {
  constexpr int steps = 400;
  const double dr = side.radius / steps;
  double sum = 0.0;
  for (int i = 0; i < steps; ++i) {
    const double r = (i + 0.5) * dr, along = std::clamp(d / r, -1.0, 1.0);
    const double sphere = dimensions == 2 ? 2.0 * std::numbers::pi * r : 4.0 * std::numbers::pi * r * r;
    const double share = dimensions == 2 ? std::acos(along) / std::numbers::pi : 0.5 * (1.0 - along);
    const double slope =
        with_kernel<double>(side.kernel, side.radius, dimensions, [&](const auto& w) { return w.derivative(r); });
    sum -= slope * r * sphere * share * dr;
  }
  return sum;
}

/// The same of rows of a lattice, the first one at this height over the particle (m).
double filled_by_rows(const InterfaceDistance::Side& side, int dimensions, double first) {
  const int reach = static_cast<int>(std::ceil(side.radius / side.spacing));
  const double volume = std::pow(side.spacing, dimensions);
  double sum = 0.0;
  for (double y = first; y < side.radius; y += side.spacing)
    for (int i = -reach; i <= reach; ++i)
      for (int k = dimensions == 3 ? -reach : 0; k <= (dimensions == 3 ? reach : 0); ++k) {
        const double r = std::hypot(y, side.spacing * i, side.spacing * k);
        if (r < 1e-9 * side.spacing || r >= side.radius) continue;
        sum -= volume * r * with_kernel<double>(side.kernel, side.radius, dimensions, [&](const auto& w) {
                 return w.derivative(r);
               });
      }
  return sum;
}

}  // namespace

InterfaceDistance::InterfaceDistance(const Side& own, const Side& other, int dimensions) {
  const auto share_at = [&](double d) {
    const double mine = filled_beyond(own, dimensions, -d), theirs = filled_beyond(other, dimensions, d);
    return mine / (mine + theirs);
  };
  const auto share_of_row = [&](double d) {
    const double mine = filled_by_rows(own, dimensions, -(d - 0.5 * own.spacing));
    const double theirs = filled_by_rows(other, dimensions, d + 0.5 * other.spacing);
    return mine / (mine + theirs);
  };
  // Share against distance, of the rows where there are rows: a correction of the distance, linear between them.
  constexpr std::size_t points = 200;
  std::vector<double> distance, share;
  for (std::size_t i = 0; i <= points; ++i) {
    distance.push_back(other.radius * static_cast<double>(i) / points);
    share.push_back(share_at(distance.back()));
  }
  const auto plane = [&](double c) {
    const auto at = std::lower_bound(share.begin(), share.end(), c);
    if (at == share.begin()) return distance.front();
    if (at == share.end()) return distance.back();
    const auto i = static_cast<std::size_t>(at - share.begin());
    return distance[i - 1] + (distance[i] - distance[i - 1]) * (c - share[i - 1]) / (share[i] - share[i - 1]);
  };
  std::vector<double> seen, truth;
  for (double d = 0.5 * own.spacing; d + 0.5 * other.spacing < other.radius; d += own.spacing) {
    seen.push_back(plane(share_of_row(d)));
    truth.push_back(d);
  }
  const auto corrected = [&](double d) {
    if (seen.empty()) return d;
    const auto at = std::lower_bound(seen.begin(), seen.end(), d);
    if (at == seen.begin()) return d + truth.front() - seen.front();
    if (at == seen.end()) return d + truth.back() - seen.back();
    const auto i = static_cast<std::size_t>(at - seen.begin());
    return truth[i - 1] + (truth[i] - truth[i - 1]) * (d - seen[i - 1]) / (seen[i] - seen[i - 1]);
  };
  constexpr std::size_t cells = 4096;
  step_ = 1.0 / cells;
  for (std::size_t i = 0; i <= cells; ++i)
    values_.push_back(std::max(corrected(plane(step_ * static_cast<double>(i))), nearest * own.spacing));
}

double InterfaceDistance::operator()(double share) const {
  const double at = std::clamp(share, 0.0, 1.0) / step_;
  const auto i = std::min(static_cast<std::size_t>(at), values_.size() - 2);
  return values_[i] + (values_[i + 1] - values_[i]) * (at - static_cast<double>(i));
}

}  // namespace barchan
