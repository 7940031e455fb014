// Which particles of a body may touch others of the same body, and which hold it together.
#pragma once

#include <cstdint>
#include <vector>

#include "base/aligned.hpp"
#include "engine/cell_grid.hpp"
#include "engine/pair_list.hpp"

namespace barchan {

/// Neighbours in the first shape by id, in any order. `places` (m): the first ones, by id.
std::vector<std::vector<std::uint32_t>> first_neighbours(const std::vector<Vec3>& places, const Bounds& bounds,
                                                         double spacing, double radius);

/// The pairs of a list whose particles are far apart in the body's first shape: neither neighbours there nor with a
/// common neighbour. These are two steps along the material, not a distance: both sides of a narrow cut are far apart.
class FarPairs {
 public:
  FarPairs() = default;
  /// `places` (m): the first ones, by id; `radius` (m): of the kernel that holds the body together.
  FarPairs(const std::vector<Vec3>& places, const Bounds& bounds, double spacing, double radius);

  /// After every search: the far pairs of this list of the body with itself.
  void choose(const PhaseParticles& body, const PairList& list, const CellGrid& grid) { pick(body, list, grid, false); }
  /// The others: those between which stress acts. Every pair keeps its place in the row, dummies stand in place of far
  /// ones: sums are those of the whole list, to the bit, where the far ones are beyond the kernel.
  void choose_near(const PhaseParticles& body, const PairList& list, const CellGrid& grid) {
    pick(body, list, grid, true);
  }
  /// As of a PairList.
  PairList::Row row(std::size_t k) const { return {index_.data() + begin_[k], index_.data() + begin_[k + 1]}; }

 private:
  bool near(std::uint32_t a, std::uint32_t b) const;
  void pick(const PhaseParticles& body, const PairList& list, const CellGrid& grid, bool nearest);

  std::vector<std::size_t> near_begin_;  // by id
  std::vector<std::uint32_t> near_;      // ids, ascending; the particle itself too
  AlignedVector<std::uint32_t> index_;   // as the list has them, padded as there
  std::vector<std::size_t> begin_;       // by place
};

}  // namespace barchan
