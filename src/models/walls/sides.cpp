#include "models/walls/sides.hpp"

#include <algorithm>
#include <cmath>

namespace barchan {

bool behind_a_side(const PhaseParticles& wall, std::size_t k, const Bounds& bounds, double spacing) {
  Vec3 out{};
  for (int d = 0; d < wall.dimensions(); ++d) {
    const auto c = static_cast<std::size_t>(d);
    if (bounds.periodic[c]) continue;
    const double x = wall.column(Field::position, d)[k];
    out[c] = std::max({bounds.low[c] - x, x - bounds.high[c], 0.0});
  }
  // Past the end of a side that no wall closes the depth is that of the walled one alone (wall.cpp).
  for (unsigned some = 1; some < 8; ++some) {
    Vec3 behind{};
    for (std::size_t d = 0; d < 3; ++d) behind[d] = (some >> d & 1u) != 0 ? out[d] : 0.0;
    const double depth = norm(behind);
    if (depth > 0.0 && std::abs(depth - wall.column(Field::wall_depth)[k]) < 1e-6 * spacing) return true;
  }
  return false;
}

void close_sides(Sides& sides, const PhaseParticles& wall, const Bounds& bounds, double spacing) {
  for (std::size_t k = 0; k < wall.size(); ++k) {
    if (!behind_a_side(wall, k, bounds, spacing)) continue;
    int outside = 0, axis = 0;
    bool above = false;
    for (int d = 0; d < wall.dimensions(); ++d) {
      const auto c = static_cast<std::size_t>(d);
      const double x = wall.column(Field::position, d)[k];
      if (bounds.periodic[c] || (x >= bounds.low[c] && x <= bounds.high[c])) continue;
      ++outside;
      axis = d;
      above = x > bounds.high[c];
    }
    if (outside != 1) continue;
    const auto c = static_cast<std::size_t>(axis);
    (above ? sides.high[c] : sides.low[c]) = above ? bounds.high[c] : bounds.low[c];
  }
}

}  // namespace barchan
