#include "scene/places.hpp"

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

Places::Places(const PeriodicSpace& space, double widest) : space_(space) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    width_[axis] = widest;
    if (!space.domain().periodic[axis]) continue;
    cells_[axis] = std::max(1l, static_cast<long>(std::floor(space.domain().size[axis] / widest)));
    width_[axis] = space.domain().size[axis] / static_cast<double>(cells_[axis]);
  }
}

Places::Cell Places::cell_of(const Vec3& x) const {
  Cell cell{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    cell[axis] = static_cast<long>(std::floor((x[axis] - space_.domain().origin[axis]) / width_[axis]));
    if (cells_[axis] > 0) cell[axis] = ((cell[axis] % cells_[axis]) + cells_[axis]) % cells_[axis];
  }
  return cell;
}

void Places::add(const Vec3& x, double spacing, int owner) { grid_[cell_of(x)].push_back({x, spacing, owner}); }

int Places::owner_near(const Vec3& x, double spacing, double distance, int except) const {
  return nearest_owner(x, spacing, distance, [&](int owner) { return owner == except; });
}
int Places::owner_near(const Vec3& x, double spacing, double distance, const std::vector<bool>& except) const {
  return nearest_owner(x, spacing, distance, [&](int owner) { return except[static_cast<std::size_t>(owner)]; });
}

template <class Except>
int Places::nearest_owner(const Vec3& x, double spacing, double distance, const Except& except) const {
  if (grid_.empty()) return -1;
  const Cell centre = cell_of(x);
  int owner = -1;
  double nearest = 1e300;
  const bool flat = !(space_.domain().size[2] > 0.0);
  for (int k = 0; k < (flat ? 9 : 27); ++k) {
    Cell cell = centre;
    const std::array<int, 3> step{k % 3 - 1, k / 3 % 3 - 1, flat ? 0 : k / 9 - 1};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      cell[axis] += step[axis];
      if (cells_[axis] > 0) cell[axis] = (cell[axis] + cells_[axis]) % cells_[axis];
    }
    const auto found = grid_.find(cell);
    if (found == grid_.end()) continue;
    for (const Point& point : found->second) {
      const double r = space_.distance(x, point.x);
      if (except(point.owner) || !(r < nearest) || !(r < distance * (0.5 * (spacing + point.spacing)))) continue;
      nearest = r;
      owner = point.owner;
    }
  }
  return owner;
}

}  // namespace barchan
