#include "start/places.hpp"

#include <algorithm>
#include <cmath>

namespace barchan {

Vec3 PeriodicSpace::wrapped(Vec3 x) const {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (!domain_.periodic[axis]) continue;
    const double low = domain_.origin[axis], size = domain_.size[axis];
    x[axis] -= size * std::floor((x[axis] - low) / size);
    if (x[axis] >= low + size) x[axis] = low;  // round-off of a tiny negative number
  }
  return x;
}

double PeriodicSpace::distance(const Vec3& a, const Vec3& b) const {
  Vec3 d = a - b;
  for (std::size_t axis = 0; axis < 3; ++axis)
    if (domain_.periodic[axis]) d[axis] -= domain_.size[axis] * std::round(d[axis] / domain_.size[axis]);
  return norm(d);
}

std::size_t Places::Hash::operator()(const Cell& cell) const {
  std::size_t hash = 0;
  for (const long index : cell) hash = (hash ^ static_cast<std::size_t>(index)) * 0x9e3779b97f4a7c15ull;
  return hash ^ (hash >> 29);
}

Places::Places(const PeriodicSpace& space, double widest) : space_(space), levels_{level_of(widest)} {}

Places::Level Places::level_of(double widest) const {
  Level level;
  level.widest = widest;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    level.width[axis] = widest;
    if (!space_.domain().periodic[axis]) continue;
    level.cells[axis] = std::max(1l, static_cast<long>(std::floor(space_.domain().size[axis] / widest)));
    level.width[axis] = space_.domain().size[axis] / static_cast<double>(level.cells[axis]);
  }
  return level;
}

Places::Cell Places::cell_of(const Level& level, const Vec3& x) const {
  Cell cell{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    cell[axis] = static_cast<long>(std::floor((x[axis] - space_.domain().origin[axis]) / level.width[axis]));
    if (level.cells[axis] > 0) cell[axis] = ((cell[axis] % level.cells[axis]) + level.cells[axis]) % level.cells[axis];
  }
  return cell;
}

void Places::add(const Vec3& x, double spacing, int owner) {
  constexpr std::size_t most_levels = 30;
  std::size_t m = 0;
  for (double half = 0.5 * levels_[0].widest; spacing <= half && m + 1 < most_levels; half *= 0.5) {
    if (++m == levels_.size()) levels_.push_back(level_of(half));
  }
  Level& level = levels_[m];
  level.grid[cell_of(level, x)].push_back({x, spacing, owner});
}

int Places::owner_near(const Vec3& x, double spacing, double distance, int except) const {
  return nearest_owner(x, spacing, distance, [&](int owner) { return owner == except; });
}
int Places::owner_near(const Vec3& x, double spacing, double distance, const std::vector<bool>& except) const {
  return nearest_owner(x, spacing, distance, [&](int owner) { return except[static_cast<std::size_t>(owner)]; });
}

/// Calls look with each filled cell that is at most `steps` cells away from that of x along each axis: perhaps twice
/// across a narrow periodic domain, and with all filled cells where these are fewer.
template <class Look>
void Places::each_cell_near(const Level& level, const Vec3& x, double steps, const Look& look) const {
  const bool flat = !(space_.domain().size[2] > 0.0);
  if (steps > 1.0 && std::pow(2.0 * steps + 1.0, flat ? 2 : 3) > static_cast<double>(level.grid.size())) {
    for (const auto& [cell, points] : level.grid) look(points);
    return;
  }
  const long way = std::lround(steps), side = 2 * way + 1, all = side * side * (flat ? 1 : side);
  const Cell centre = cell_of(level, x);
  for (long k = 0; k < all; ++k) {
    Cell cell = centre;
    const std::array<long, 3> step{k % side - way, k / side % side - way, flat ? 0 : k / (side * side) - way};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      cell[axis] += step[axis];
      const long cells = level.cells[axis];
      if (cells > 0) cell[axis] = (cell[axis] % cells + cells) % cells;
    }
    if (const auto found = level.grid.find(cell); found != level.grid.end()) look(found->second);
  }
}

/// Of two that are as near, the one whose cell comes first; among cells of far smaller particles, which come in no
/// order, the one with the lower owner.
template <class Except>
int Places::nearest_owner(const Vec3& x, double spacing, double distance, const Except& except) const {
  int owner = -1;
  double nearest = 1e300;
  for (const Level& level : levels_) {
    if (level.grid.empty()) continue;
    const double reach = distance * (0.5 * (spacing + level.widest));
    const double steps = std::max(std::ceil(reach / level.widest), 1.0);
    each_cell_near(level, x, steps, [&](const std::vector<Point>& points) {
      compared_ += points.size();
      for (const Point& point : points) {
        const double r = space_.distance(x, point.x);
        const bool nearer = r < nearest || (steps > 1.0 && r == nearest && point.owner < owner);
        if (except(point.owner) || !nearer || !(r < distance * (0.5 * (spacing + point.spacing)))) continue;
        nearest = r;
        owner = point.owner;
      }
    });
  }
  return owner;
}

}  // namespace barchan
