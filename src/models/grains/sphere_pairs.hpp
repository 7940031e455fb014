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
};

/// All spheres by cells as wide as a search; cells of a row along x follow each other.
struct SphereCells {
  static constexpr std::uint32_t none = 0xffffffffu;
  static constexpr std::size_t padding = 8;  // places behind the last sphere that may be read

  std::array<std::size_t, 3> count{1, 1, 1};
  std::array<double, 3> low{}, inverse_cell{}, period{};  // m, 1/m, m (0: not periodic)
  const std::uint32_t *begin = nullptr, *order = nullptr;
  const double* sorted[4] = {};         // x y z r in the order of cells
  const std::uint32_t* laws = nullptr;  // by kind and kind, none where two do not touch
  std::size_t kinds = 0;

  std::size_t coordinate(double x, std::size_t axis) const {
    x -= low[axis];
    if (period[axis] > 0.0) x -= period[axis] * std::floor(x / period[axis]);
    const double c = x * inverse_cell[axis];
    if (!(c > 0.0)) return 0;  // NaN too
    return std::min(static_cast<std::size_t>(std::min(c, 1e9)), count[axis] - 1);
  }
};

/// `key`: four times the law, plus 2 where both are in different chunks, plus 1 where they do not touch yet.
struct FoundPair {
  std::uint32_t a, b, key;
};

BARCHAN_PER_INSTRUCTION_SET(find_sphere_pairs,
                            /// The pairs of a chunk with a gap below `slack` (m), in the order in which its spheres
                            /// meet them. The first of a pair is that with the lower number.
                            void find_sphere_pairs(const SphereCells& cells, const SphereSet& spheres, double slack,
                                                   const SphereChunk& chunk, std::vector<FoundPair>& found);)

}  // namespace barchan
