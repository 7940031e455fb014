#include "models/walls/wall_normals.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

#include "kernels/kernel.hpp"

namespace barchan {

void find_wall_normals(std::span<PhaseParticles* const> walls, const Bounds& bounds, double spacing) {
  const double reach = 4.0 * spacing;
  const auto dimensions = static_cast<std::size_t>(bounds.dimensions);
  // Cells that divide periodic sides, in a map: walls are thin, domains large.
  std::array<int, 3> count{0, 0, 0};
  std::array<double, 3> side{reach, reach, reach};
  for (std::size_t d = 0; d < dimensions; ++d) {
    if (!bounds.periodic[d]) continue;
    count[d] = std::max(1, static_cast<int>(std::floor((bounds.high[d] - bounds.low[d]) / reach)));
    side[d] = (bounds.high[d] - bounds.low[d]) / count[d];
  }
  using Cell = std::array<int, 3>;
  const auto wrap = [&](Cell c) {
    for (std::size_t d = 0; d < 3; ++d)
      if (count[d] > 0) c[d] = (c[d] % count[d] + count[d]) % count[d];
    return c;
  };
  const auto cell_of = [&](const Vec3& x) {
    Cell c{0, 0, 0};
    for (std::size_t d = 0; d < dimensions; ++d) c[d] = static_cast<int>(std::floor((x[d] - bounds.low[d]) / side[d]));
    return wrap(c);
  };
  const auto place = [&](const PhaseParticles& p, std::size_t k) {
    Vec3 x{};
    for (std::size_t d = 0; d < dimensions; ++d) x[d] = p.column(Field::position, static_cast<int>(d))[k];
    return x;
  };
  std::map<Cell, std::vector<Vec3>> cells;
  for (const PhaseParticles* p : walls)
    for (std::size_t k = 0; k < p->size(); ++k) cells[cell_of(place(*p, k))].push_back(place(*p, k));
  for (PhaseParticles* p : walls)
    for (std::size_t k = 0; k < p->size(); ++k) {
      Vec3 known{};
      for (std::size_t d = 0; d < dimensions; ++d) known[d] = p->column(Field::wall_normal, static_cast<int>(d))[k];
      if (p->column(Field::wall_depth)[k] > 0.0 || norm(known) > 0.0) continue;
      const Vec3 x = place(*p, k);
      const Cell centre = cell_of(x);
      std::vector<Cell> about;
      about.reserve(27);
      for (int c = 0; c < (dimensions == 3 ? 27 : 9); ++c)
        about.push_back(
            wrap({centre[0] + c % 3 - 1, centre[1] + c / 3 % 3 - 1, centre[2] + (dimensions == 3 ? c / 9 - 1 : 0)}));
      std::sort(about.begin(), about.end());
      about.erase(std::unique(about.begin(), about.end()), about.end());
      Vec3 out{};
      double size = 0.0;
      with_kernel<double>(KernelKind::cubic_spline, reach, bounds.dimensions, [&](const auto& kernel) {
        for (const Cell& c : about) {
          const auto found = cells.find(c);
          if (found == cells.end()) continue;
          for (const Vec3& y : found->second) {
            Vec3 r = x - y;
            for (std::size_t d = 0; d < dimensions; ++d)
              if (bounds.periodic[d]) {
                const double period = bounds.high[d] - bounds.low[d];
                r[d] -= period * std::round(r[d] / period);
              }
            const double length = norm(r);
            if (!(length > 0.0) || length >= reach) continue;
            const double slope = std::abs(kernel.derivative(length));
            out = out + slope / length * r;
            size += slope;
          }
        }
      });
      const double length = norm(out);
      if (length > 1e-3 * size)
        for (std::size_t d = 0; d < dimensions; ++d)
          p->column(Field::wall_normal, static_cast<int>(d))[k] = out[d] / length;
    }
}

}  // namespace barchan
