// The pairs of a chunk of spheres: the loop of a search.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "base/instructions.hpp"
#include "models/grains/sphere_work.hpp"

namespace barchan {

/// The spheres that are searched.
struct SphereSet {
  int dimensions = 2;
  const double* records = nullptr;         // SphereRecord
  std::size_t moving = 0, all = 0;         // the moving come first; two far away follow after all
  const std::uint32_t* numbers = nullptr;  // lasting, in the order of ids
  const std::uint8_t* kinds = nullptr;     // row and column in the table of laws
  const std::uint8_t* asleep = nullptr;    // 1: sleeps or is fixed; null: no sphere may sleep
  const double* places = nullptr;          // by sphere, of all axes; m, where the last search of it found it
  bool images = false;                     // two spheres may touch twice: pairs say which images meet
};

/// Spheres of one order of magnitude, in cells of their own, as wide as a search among them.
struct SphereLevel {
  std::array<std::size_t, 3> count{1, 1, 1};
  std::array<double, 3> inverse_cell{};  // 1/m
  std::size_t first = 0;                 // the number of its first cell among those of all levels
  double largest = 0.0;                  // m, across its largest sphere; of the coarsest level the largest sum of radii
};

/// All spheres by cells; cells of a row along x follow each other. Spheres whose diameters differ much stand in several
/// levels, the coarsest first. A sphere looks about itself in the cells of its own level and of the coarser ones, and
/// into those cells of a finer level that its ball reaches (Ogarko & Luding 2012, Comput. Phys. Commun. 183, 931; there
/// a pair is found from the finer level alone; here each sphere finds all of its pairs, because a pair stands in the
/// chunks of both).
struct SphereCells {
  static constexpr std::uint32_t none = 0xffffffffu;
  static constexpr std::size_t padding = 8;  // places behind the last sphere that may be read
  static constexpr std::size_t most_levels = 16;

  std::array<double, 3> low{}, period{};  // m, m (0: not periodic)
  std::size_t levels = 1;
  std::array<SphereLevel, most_levels> of_level{};
  const std::uint8_t* level = nullptr;  // by sphere; null: there is one level
  const std::uint32_t *begin = nullptr, *order = nullptr;
  const double* sorted[4] = {};         // x y z r in the order of cells
  const std::uint32_t* laws = nullptr;  // by kind and kind, none where two do not touch
  std::size_t kinds = 0;

  std::size_t level_of(std::size_t sphere) const { return level ? level[sphere] : 0; }
  std::size_t coordinate(const SphereLevel& of, double x, std::size_t axis) const {
    x -= low[axis];
    if (period[axis] > 0.0) x -= period[axis] * std::floor(x / period[axis]);
    const double c = x * of.inverse_cell[axis];
    if (!(c > 0.0)) return 0;  // NaN too
    return std::min(static_cast<std::size_t>(std::min(c, 1e9)), of.count[axis] - 1);
  }
  std::size_t cell(const SphereLevel& of, const double* x, std::size_t dimensions) const {
    std::size_t c = 0;
    for (std::size_t d = dimensions; d-- > 0;) c = c * of.count[d] + coordinate(of, x[d], d);
    return of.first + c;
  }
  /// Calls f(first, end) with the numbers of runs of cells of a level: together they have all places within `radius`
  /// (m) of x.
  template <std::size_t Dim, class F>
  BARCHAN_SIMD_INLINE void each_run(const SphereLevel& of, const double* x, double radius, F&& f) const;
};

template <std::size_t Dim, class F>
BARCHAN_SIMD_INLINE void SphereCells::each_run(const SphereLevel& of, const double* x, double radius, F&& f) const {
  constexpr double guard = 1e-6;  // of a cell, of what rounding may hide
  std::array<double, 3> from{};
  std::array<std::int64_t, 3> first{}, last{};
  std::array<bool, 3> whole{};  // along a periodic axis
  const auto reach_along = [&](std::size_t d, double reach) {
    const auto n = static_cast<std::int64_t>(of.count[d]);
    const double most = 2.0 * static_cast<double>(n);
    const auto number = [&](double at) {
      return static_cast<std::int64_t>(std::floor(std::min(std::max(at * of.inverse_cell[d], -most), most)));
    };
    first[d] = number(from[d] - reach);
    last[d] = number(from[d] + reach);
    whole[d] = period[d] > 0.0 && last[d] - first[d] >= n - 1;
    if (period[d] > 0.0 && !whole[d]) return;
    first[d] = whole[d] ? 0 : std::clamp<std::int64_t>(first[d], 0, n - 1);
    last[d] = whole[d] ? n - 1 : std::clamp<std::int64_t>(last[d], 0, n - 1);
  };
  // Distance along an axis from x to a cell. The outermost cells hold all that lies beyond them.
  const auto gap = [&](std::size_t d, std::int64_t c) {
    if (whole[d] || (!(period[d] > 0.0) && (c == 0 || c + 1 == static_cast<std::int64_t>(of.count[d])))) return 0.0;
    const double side = 1.0 / of.inverse_cell[d], begins = static_cast<double>(c) * side;
    return std::max(std::max(begins - from[d], from[d] - begins - side) - guard * side, 0.0);
  };
  const auto inside = [&](std::size_t d, std::int64_t c) {
    const auto n = static_cast<std::int64_t>(of.count[d]);
    return static_cast<std::size_t>(c < 0 ? c + n : c >= n ? c - n : c);
  };
  for (std::size_t d = 0; d < Dim; ++d) {
    from[d] = x[d] - low[d];
    if (period[d] > 0.0) from[d] -= period[d] * std::floor(from[d] / period[d]);
    reach_along(d, radius);
  }
  for (std::int64_t z = first[2]; z <= last[2]; ++z) {
    const double gap_z = Dim == 3 ? gap(2, z) : 0.0;
    for (std::int64_t y = first[1]; y <= last[1]; ++y) {
      const double gap_y = gap(1, y), left = radius * radius - gap_y * gap_y - gap_z * gap_z;
      if (!(left > 0.0)) continue;
      reach_along(0, std::sqrt(left) + guard / of.inverse_cell[0]);
      const std::size_t row = of.first + ((Dim == 3 ? inside(2, z) : 0) * of.count[1] + inside(1, y)) * of.count[0];
      const std::size_t begins = inside(0, first[0]), ends = inside(0, last[0]);
      if (begins <= ends) f(row + begins, row + ends + 1);
      else {
        f(row + begins, row + of.count[0]);
        f(row, row + ends + 1);
      }
    }
  }
}

/// `key`: four times the law, plus 2 where both are in different chunks, plus 1 where they do not touch yet. `image`:
/// of the second that the first meets (models/grains/sphere_work.hpp).
struct FoundPair {
  std::uint32_t a, b, key, image;
};

BARCHAN_PER_INSTRUCTION_SET(find_sphere_pairs,
                            /// The pairs of a chunk with a gap below `slack` (m), in the order in which its spheres
                            /// meet them. The first of a pair is that with the lower number.
                            void find_sphere_pairs(const SphereCells& cells, const SphereSet& spheres, double slack,
                                                   const SphereChunk& chunk, std::vector<FoundPair>& found);)

}  // namespace barchan
