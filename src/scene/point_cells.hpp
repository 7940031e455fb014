// Points with volumes in cells, for sums over those that are near. Internal to src/scene.
#pragma once

#include <algorithm>
#include <cmath>
#include <unordered_map>
#include <vector>

#include "scene/places.hpp"

namespace barchan {

/// The sums have one order, by cells and then by the order in which points were added: the same bits on any thread.
class PointCells {
 public:
  /// reach (m): as far as for_each_near looks.
  PointCells(const PeriodicSpace& space, double reach, int dimensions)
      : space_(space), reach_(reach), dimensions_(static_cast<std::size_t>(dimensions)) {
    for (std::size_t d = 0; d < 3; ++d) {
      width_[d] = reach;
      if (d >= dimensions_ || !space.domain().periodic[d]) continue;
      cells_[d] = std::max(1l, static_cast<long>(std::floor(space.domain().size[d] / reach)));
      width_[d] = space.domain().size[d] / static_cast<double>(cells_[d]);
    }
  }

  void clear() {
    for (auto& cell : grid_) cell.second.clear();
  }
  /// x inside the domain along periodic axes; volume in m2 or m3.
  void add(const Vec3& x, double volume) { grid_[cell_of(x)].push_back({x, volume}); }

  /// f(x - y, |x - y|, volume of y) of every point y nearer than the reach, x itself too if it is one.
  template <class F>
  void for_each_near(const Vec3& x, F&& f) const {
    const Cell centre = cell_of(x);
    std::array<std::array<long, 3>, 3> along{};  // cells along each axis, each once
    std::array<std::size_t, 3> count{1, 1, 1};
    for (std::size_t d = 0; d < dimensions_; ++d) {
      count[d] = 0;
      for (long step = -1; step <= 1; ++step) {
        long index = centre[d] + step;
        if (cells_[d] > 0) index = (index + cells_[d]) % cells_[d];
        const auto end = along[d].begin() + static_cast<std::ptrdiff_t>(count[d]);
        if (std::find(along[d].begin(), end, index) == end) along[d][count[d]++] = index;
      }
    }
    for (std::size_t k = 0; k < count[2]; ++k)
      for (std::size_t j = 0; j < count[1]; ++j)
        for (std::size_t i = 0; i < count[0]; ++i) {
          const auto found = grid_.find({along[0][i], along[1][j], along[2][k]});
          if (found == grid_.end()) continue;
          for (const Point& point : found->second) {
            Vec3 r = x - point.x;
            for (std::size_t d = 0; d < dimensions_; ++d)
              if (cells_[d] > 0) r[d] -= space_.domain().size[d] * std::round(r[d] / space_.domain().size[d]);
            if (dot(r, r) < reach_ * reach_) f(r, norm(r), point.volume);
          }
        }
  }

 private:
  using Cell = std::array<long, 3>;
  struct Hash {
    std::size_t operator()(const Cell& cell) const {
      std::size_t hash = 0;
      for (const long index : cell) hash = (hash ^ static_cast<std::size_t>(index)) * 0x9e3779b97f4a7c15ull;
      return hash ^ (hash >> 29);
    }
  };
  struct Point {
    Vec3 x;
    double volume;
  };
  Cell cell_of(const Vec3& x) const {
    Cell cell{};
    for (std::size_t d = 0; d < dimensions_; ++d) {
      cell[d] = static_cast<long>(std::floor((x[d] - space_.domain().origin[d]) / width_[d]));
      if (cells_[d] > 0) cell[d] = ((cell[d] % cells_[d]) + cells_[d]) % cells_[d];
    }
    return cell;
  }

  PeriodicSpace space_;
  double reach_;
  std::size_t dimensions_;
  std::array<double, 3> width_{};
  std::array<long, 3> cells_{};  // along periodic axes; 0: unlimited
  std::unordered_map<Cell, std::vector<Point>, Hash> grid_;
};

}  // namespace barchan
