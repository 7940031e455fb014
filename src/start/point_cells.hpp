// Points with volumes in cells, for sums over those that are near. Internal to src/start.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <unordered_map>
#include <vector>

#include "start/places.hpp"

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

  void clear() { added_.clear(); }
  /// x inside the domain along periodic axes; volume in m2 or m3.
  void add(const Vec3& x, double volume) { added_.push_back({x, volume, cell_of(x)}); }
  /// Puts the points into their cells: after the last add() and before for_each_near().
  void arrange() {
    order_.resize(added_.size());
    for (std::size_t i = 0; i < order_.size(); ++i) order_[i] = i;
    std::sort(order_.begin(), order_.end(), [this](std::size_t i, std::size_t j) {
      const Cell &a = added_[i].cell, &b = added_[j].cell;
      for (std::size_t d = 3; d-- > 0;)
        if (a[d] != b[d]) return a[d] < b[d];
      return i < j;
    });
    rows_.clear();
    in_row_.clear();
    volume_.clear();
    for (auto& x : position_) x.clear();
    for (const std::size_t i : order_) append(added_[i]);
  }

  /// f(x - y, |x - y|, volume of y) of every point y nearer than the reach, x itself too if it is one.
  template <class F>
  void for_each_near(const Vec3& x, F&& f) const {
    const Cell centre = cell_of(x);
    std::array<std::array<long, 3>, 3> along{};  // cells along each axis, each once
    std::array<std::size_t, 3> count{1, 1, 1};
    std::array<bool, 3>
        across{};  // some of them stand beyond a side, or so few that the other way may be the shorter one
    for (std::size_t d = 0; d < dimensions_; ++d) {
      count[d] = 0;
      across[d] = cells_[d] > 0 && cells_[d] < 5;
      for (long step = -1; step <= 1; ++step) {
        long index = centre[d] + step;
        if (cells_[d] > 0) {
          across[d] = across[d] || index < 0 || index >= cells_[d];
          index = (index + cells_[d]) % cells_[d];
        }
        const auto end = along[d].begin() + static_cast<std::ptrdiff_t>(count[d]);
        if (std::find(along[d].begin(), end, index) == end) along[d][count[d]++] = index;
      }
    }
    const bool wraps = across[0] || across[1] || across[2];
    for (std::size_t k = 0; k < count[2]; ++k)
      for (std::size_t j = 0; j < count[1]; ++j) {
        const auto row = rows_.find({along[1][j], along[2][k]});
        if (row == rows_.end()) continue;
        if (!across[0]) {  // three cells side by side
          look(x, first_from(row->second, along[0][0]), first_from(row->second, along[0][2] + 1), wraps, f);
          continue;
        }
        for (std::size_t i = 0; i < count[0]; ++i)
          look(x, first_from(row->second, along[0][i]), first_from(row->second, along[0][i] + 1), wraps, f);
      }
  }

 private:
  using Cell = std::array<long, 3>;
  using RowOfCells = std::array<long, 2>;  // along y and z
  struct Hash {
    std::size_t operator()(const RowOfCells& row) const {
      std::size_t hash = 0;
      for (const long index : row) hash = (hash ^ static_cast<std::size_t>(index)) * 0x9e3779b97f4a7c15ull;
      return hash ^ (hash >> 29);
    }
  };
  struct Point {
    Vec3 x;
    double volume;
    Cell cell;
  };
  struct CellInRow {
    long index;         // along x
    std::size_t begin;  // its first point
  };
  struct CellsOfRow {
    std::size_t begin, end;   // numbers in in_row_
    std::size_t last_points;  // behind its last point
  };

  void append(const Point& point) {
    const std::size_t place = volume_.size();
    const auto [row, fresh] =
        rows_.try_emplace({point.cell[1], point.cell[2]}, CellsOfRow{in_row_.size(), in_row_.size(), place});
    if (fresh || in_row_.back().index != point.cell[0]) {
      in_row_.push_back({point.cell[0], place});
      row->second.end = in_row_.size();
    }
    row->second.last_points = place + 1;
    for (std::size_t d = 0; d < 3; ++d) position_[d].push_back(point.x[d]);
    volume_.push_back(point.volume);
  }
  /// The first point of the row in a cell of this index or a later one.
  std::size_t first_from(const CellsOfRow& row, long index) const {
    const auto last = in_row_.begin() + static_cast<std::ptrdiff_t>(row.end);
    const auto found = std::lower_bound(in_row_.begin() + static_cast<std::ptrdiff_t>(row.begin), last, index,
                                        [](const CellInRow& c, long i) { return c.index < i; });
    return found == last ? row.last_points : found->begin;
  }
  /// The points begin .. end-1: few are near, so that the squares of all distances come first, side by side.
  template <class F>
  void look(const Vec3& x, std::size_t begin, std::size_t end, bool wraps, F& f) const {
    constexpr std::size_t most = 32;
    std::array<double, most> square;
    const double limit = reach_ * reach_;
    for (; begin < end; begin += most) {
      const std::size_t n = std::min(most, end - begin);
      const double *px = position_[0].data() + begin, *py = position_[1].data() + begin,
                   *pz = position_[2].data() + begin;
      if (wraps) {
        square.fill(0.0);
      } else {
        for (std::size_t p = 0; p < n; ++p) {
          const double rx = x[0] - px[p], ry = x[1] - py[p], rz = x[2] - pz[p];
          square[p] = rx * rx + ry * ry + rz * rz;
        }
      }
      for (std::size_t p = 0; p < n; ++p) {
        if (square[p] > 1.000001 * limit) continue;
        Vec3 r = x - Vec3{px[p], py[p], pz[p]};
        for (std::size_t d = 0; d < dimensions_ && wraps; ++d)
          if (cells_[d] > 0) r[d] -= space_.domain().size[d] * std::round(r[d] / space_.domain().size[d]);
        if (dot(r, r) < limit) f(r, norm(r), volume_[begin + p]);
      }
    }
  }
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
  std::vector<Point> added_;
  std::vector<std::size_t> order_;  // numbers of added points, by cell
  std::unordered_map<RowOfCells, CellsOfRow, Hash> rows_;
  std::vector<CellInRow> in_row_;                // of all rows, along x
  std::array<std::vector<double>, 3> position_;  // m, in the order of the cells
  std::vector<double> volume_;
};

}  // namespace barchan
