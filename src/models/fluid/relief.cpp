#include "models/fluid/relief.hpp"

#include <algorithm>
#include <cmath>

namespace barchan {

Relief::Relief(const Bounds& bounds, const std::array<int, 2>& counts, std::vector<double> heights)
    : bounds_(bounds), counts_(counts), heights_(std::move(heights)) {
  for (std::size_t c = 0; c < 2; ++c)
    if (counts_[c] > 0) side_[c] = (bounds_.high[2 * c] - bounds_.low[2 * c]) / counts_[c];
  if (exists()) highest_ = *std::max_element(heights_.begin(), heights_.end());
}

std::array<double, 3> Relief::at(double x, double z) const {
  std::array<std::size_t, 2> node{};
  std::array<double, 2> share{};
  const std::array<double, 2> place{x, z};
  for (std::size_t c = 0; c < 2; ++c) {
    if (counts_[c] == 0) continue;
    double s = (place[c] - bounds_.low[2 * c]) / side_[c];
    if (bounds_.periodic[2 * c]) s -= counts_[c] * std::floor(s / counts_[c]);
    const int cell = std::clamp(static_cast<int>(std::floor(s)), 0, counts_[c] - 1);
    node[c] = static_cast<std::size_t>(cell);
    share[c] = std::clamp(s - cell, 0.0, 1.0);
  }
  const std::size_t row = static_cast<std::size_t>(counts_[0]) + 1, at = node[1] * row + node[0];
  const double a = heights_[at], b = heights_[at + 1];
  if (counts_[1] == 0) return {a + share[0] * (b - a), (b - a) / side_[0], 0.0};
  const double c = heights_[at + row], d = heights_[at + row + 1];
  const double near = a + share[0] * (b - a), far = c + share[0] * (d - c);
  return {near + share[1] * (far - near), ((1.0 - share[1]) * (b - a) + share[1] * (d - c)) / side_[0],
          (far - near) / side_[1]};
}

void hold_above(PhaseParticles& phase, const Relief& ground, double margin) {
  const auto n = static_cast<std::int64_t>(phase.size());
  const bool solid = phase.dimensions() == 3;
  std::array<double*, 3> x{}, v{};
  for (int d = 0; d < phase.dimensions(); ++d) {
    x[static_cast<std::size_t>(d)] = phase.column(Field::position, d);
    v[static_cast<std::size_t>(d)] = phase.column(Field::velocity, d);
  }
  const double high = ground.highest() + 2.0 * margin;
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < n; ++i) {
    const auto k = static_cast<std::size_t>(i);
    if (x[1][k] > high) continue;
    const auto [height, along_x, along_z] = ground.at(x[0][k], solid ? x[2][k] : 0.0);
    const double scale = 1.0 / std::sqrt(1.0 + along_x * along_x + along_z * along_z);
    const double missing = margin - (x[1][k] - height) * scale;
    if (missing <= 0.0) continue;
    const Vec3 normal{-along_x * scale, scale, -along_z * scale};
    double inwards = 0.0;
    for (std::size_t d = 0; d < (solid ? 3 : 2); ++d) inwards += v[d][k] * normal[d];
    inwards = std::min(inwards, 0.0);
    for (std::size_t d = 0; d < (solid ? 3 : 2); ++d) {
      x[d][k] += missing * normal[d];
      v[d][k] -= inwards * normal[d];
    }
  }
}

}  // namespace barchan
