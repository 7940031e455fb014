#include "models/fluid/flow_lanes.hpp"

#include <algorithm>
#include <cmath>

namespace barchan {

FlowLanes::FlowLanes(std::vector<Vec3> places, std::size_t axis, double spacing, const Vec3& periods)
    : places_(std::move(places)), across_{axis == 0 ? 1u : 0u, axis == 2 ? 1u : 2u}, cell_(spacing), periods_(periods) {
  if (places_.empty()) return;
  Vec3 high = places_.front();
  low_ = high;
  for (const Vec3& x : places_)
    for (std::size_t d = 0; d < 3; ++d) {
      low_[d] = std::min(low_[d], x[d]);
      high[d] = std::max(high[d], x[d]);
    }
  for (std::size_t c = 0; c < 2; ++c)
    count_[c] = 1 + static_cast<long>(std::floor((high[across_[c]] - low_[across_[c]]) / cell_));
  begin_.assign(static_cast<std::size_t>(count_[0] * count_[1]) + 1, 0);
  const auto number = [&](const Vec3& x) {
    const auto at = cell_of(x);
    return static_cast<std::size_t>(at[1] * count_[0] + at[0]);
  };
  for (const Vec3& x : places_) ++begin_[number(x) + 1];
  for (std::size_t k = 1; k < begin_.size(); ++k) begin_[k] += begin_[k - 1];
  std::vector<std::uint32_t> next(begin_.begin(), begin_.end() - 1);
  order_.resize(places_.size());
  for (std::size_t lane = 0; lane < places_.size(); ++lane)
    order_[next[number(places_[lane])]++] = static_cast<std::uint32_t>(lane);
}

std::array<long, 2> FlowLanes::cell_of(const Vec3& x) const {
  std::array<long, 2> at{};
  for (std::size_t c = 0; c < 2; ++c) {
    const double period = periods_[across_[c]];
    double over = x[across_[c]] - low_[across_[c]];
    if (period > 0.0) over -= period * std::floor(over / period);
    at[c] = std::clamp(static_cast<long>(std::floor(over / cell_)), 0l, count_[c] - 1);
  }
  return at;
}

double FlowLanes::squared(const Vec3& x, std::size_t lane) const {
  double sum = 0.0;
  for (const std::size_t d : across_) {
    double r = x[d] - places_[lane][d];
    if (periods_[d] > 0.0) r -= periods_[d] * std::round(r / periods_[d]);
    sum += r * r;
  }
  return sum;
}

/// Rings of cells about the place, until no farther cell can hold a nearer lane.
std::size_t FlowLanes::nearest(const Vec3& x) const {
  const auto at = cell_of(x);
  std::size_t best = 0;
  double least = 1e300;
  const auto look = [&](long i, long j) {
    for (std::size_t c = 0; c < 2; ++c) {
      long& k = c == 0 ? i : j;
      if (periods_[across_[c]] > 0.0) k = (k % count_[c] + count_[c]) % count_[c];
      if (k < 0 || k >= count_[c]) return;
    }
    const auto cell = static_cast<std::size_t>(j * count_[0] + i);
    for (std::uint32_t q = begin_[cell]; q < begin_[cell + 1]; ++q) {
      const double s = squared(x, order_[q]);
      if (s < least || (s == least && order_[q] < best)) {
        least = s;
        best = order_[q];
      }
    }
  };
  const long most = std::max(count_[0], count_[1]);
  for (long ring = 0; ring <= most; ++ring) {
    if (ring > 2 && least <= std::pow(static_cast<double>(ring - 2) * cell_, 2)) break;
    const long deep = count_[1] == 1 ? 0 : ring;  // of one row, all others repeat it or are not there
    for (long j = -deep; j <= deep; ++j)
      for (long i = -ring; i <= ring; ++i)
        if (std::max(std::abs(i), std::abs(j)) == ring) look(at[0] + i, at[1] + j);
  }
  return best;
}

std::size_t FlowLanes::bytes() const {
  return places_.capacity() * sizeof(Vec3) + (begin_.capacity() + order_.capacity()) * sizeof(std::uint32_t);
}

}  // namespace barchan
