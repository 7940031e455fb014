#include "models/walls/wall_normals.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

#include "kernels/kernel.hpp"

namespace barchan {

namespace {

/// The places of wall particles in cells as wide as the kernel reaches. Cells divide periodic sides and stand in a map:
/// walls are thin, domains large.
class WallPlaces {
 public:
  WallPlaces(const Bounds& bounds, double reach) : bounds_(bounds), side_{reach, reach, reach} {
    for (std::size_t d = 0; d < dimensions(); ++d) {
      if (!bounds.periodic[d]) continue;
      count_[d] = std::max(1, static_cast<int>(std::floor(period(d) / reach)));
      side_[d] = period(d) / count_[d];
    }
  }

  void add(const Vec3& x, double volume) { cells_[cell_of(x)].push_back({x, volume}); }

  /// Calls f(x - y, volume) with the nearest image of each place y in the cells about x.
  template <class F>
  void for_each_about(const Vec3& x, F&& f) const {
    for (const Cell& cell : about(cell_of(x))) {
      const auto found = cells_.find(cell);
      if (found == cells_.end()) continue;
      for (const auto& [y, volume] : found->second) {
        Vec3 r = x - y;
        for (std::size_t d = 0; d < dimensions(); ++d)
          if (bounds_.periodic[d]) r[d] -= period(d) * std::round(r[d] / period(d));
        f(r, volume);
      }
    }
  }

 private:
  using Cell = std::array<int, 3>;
  std::size_t dimensions() const { return static_cast<std::size_t>(bounds_.dimensions); }
  double period(std::size_t d) const { return bounds_.high[d] - bounds_.low[d]; }
  Cell wrap(Cell c) const {
    for (std::size_t d = 0; d < 3; ++d)
      if (count_[d] > 0) c[d] = (c[d] % count_[d] + count_[d]) % count_[d];
    return c;
  }
  Cell cell_of(const Vec3& x) const {
    Cell c{0, 0, 0};
    for (std::size_t d = 0; d < dimensions(); ++d)
      c[d] = static_cast<int>(std::floor((x[d] - bounds_.low[d]) / side_[d]));
    return wrap(c);
  }
  /// The cell and its neighbours, each once.
  std::vector<Cell> about(const Cell& centre) const {
    const bool solid = bounds_.dimensions == 3;
    std::vector<Cell> cells;
    cells.reserve(27);
    for (int c = 0; c < (solid ? 27 : 9); ++c)
      cells.push_back(wrap({centre[0] + c % 3 - 1, centre[1] + c / 3 % 3 - 1, centre[2] + (solid ? c / 9 - 1 : 0)}));
    std::sort(cells.begin(), cells.end());
    cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
    return cells;
  }

  const Bounds& bounds_;
  std::array<int, 3> count_{0, 0, 0};
  std::array<double, 3> side_;
  struct Place {
    Vec3 x;
    double volume;
  };
  std::map<Cell, std::vector<Place>> cells_;
};

Vec3 vector_of(const PhaseParticles& p, Field field, std::size_t k) {
  Vec3 x{};
  for (int d = 0; d < p.dimensions(); ++d) x[static_cast<std::size_t>(d)] = p.column(field, d)[k];
  return x;
}

}  // namespace

void find_wall_normals(PhaseParticles& wall, std::span<const WallPart> parts, const Bounds& bounds, double spacing) {
  const double reach = 4.0 * spacing;
  WallPlaces places(bounds, reach);
  for (const WallPart& part : parts)
    for (std::size_t k = 0; k < part.particles->size(); ++k)
      places.add(vector_of(*part.particles, Field::position, k), part.volume);
  for (std::size_t k = 0; k < wall.size(); ++k) {
    if (wall.column(Field::wall_depth)[k] > 0.0 || norm(vector_of(wall, Field::wall_normal, k)) > 0.0) continue;
    Vec3 out{};
    double size = 0.0;
    with_kernel<double>(KernelKind::cubic_spline, reach, bounds.dimensions, [&](const auto& kernel) {
      places.for_each_about(vector_of(wall, Field::position, k), [&](const Vec3& r, double volume) {
        const double length = norm(r);
        if (!(length > 0.0) || length >= reach) return;
        const double slope = volume * std::abs(kernel.derivative(length));
        out = out + slope / length * r;
        size += slope;
      });
    });
    const double length = norm(out);
    if (length > 1e-3 * size)
      for (int d = 0; d < bounds.dimensions; ++d)
        wall.column(Field::wall_normal, d)[k] = out[static_cast<std::size_t>(d)] / length;
  }
}

}  // namespace barchan
