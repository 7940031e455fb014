// Whose particles the ranks of a run have as ghosts: of a run and of its plan.
#include <algorithm>

#include "engine/neighbours.hpp"

namespace barchan {

/// A particle of a phase that is whole belongs to the rank whose cells it stands in: those of the first phase that it
/// looks for and that is shared out.
std::vector<std::vector<std::int32_t>> Neighbours::owners_of_whole(const std::vector<const CellOwners*>& cells) const {
  std::vector<std::vector<std::int32_t>> all(grids_.size());
  for (std::size_t p = 0; p < grids_.size(); ++p) {
    const auto first = std::find_if(directions_.begin(), directions_.end(),
                                    [&](const Direction& d) { return d.a == p && !cells[p] && cells[d.b]; });
    if (first == directions_.end()) continue;
    std::vector<std::int32_t>& owners = all[p];
    owners.resize(grids_[p]->particles());
    for (std::size_t k = 0; k < owners.size(); ++k) {
      std::array<float, 3> x{};
      for (std::size_t d = 0; d < static_cast<std::size_t>(bounds_.dimensions); ++d)
        x[d] = grids_[p]->search_position(static_cast<int>(d))[k];
      owners[k] = grids_[first->b]->rank_of(x, *cells[first->b]);
    }
  }
  return all;
}

/// Marks the cells of phase b that the searches of a rank look into. `whole`: owners of the particles of phases that
/// are whole.
void Neighbours::mark(std::size_t b, std::int32_t rank, const std::vector<const CellOwners*>& cells,
                      const std::vector<std::vector<std::int32_t>>& whole, std::vector<char>& needed) const {
  needed.assign(grids_[b]->cells(), 0);
  for (const auto& d : directions_) {
    if (d.b != b) continue;
    // A little more than a search looks into (pair_list.cpp).
    const auto reach = static_cast<float>(d.radius * (1.0 + skin_) * 1.001);
    if (cells[d.a]) grids_[b]->mark(*grids_[d.a], *cells[d.a], rank, reach, needed);
    else grids_[b]->mark(*grids_[d.a], whole[d.a], rank, reach, needed);
  }
}

std::vector<std::optional<CellOwners>> Neighbours::divided(std::size_t ranks, const std::vector<bool>& whole) const {
  std::vector<std::optional<CellOwners>> cells(grids_.size());
  for (std::size_t p = 0; p < grids_.size(); ++p)
    if (grids_[p] && !whole[p]) cells[p] = grids_[p]->divided(ranks);
  return cells;
}

void Neighbours::rebalance(std::vector<std::optional<CellOwners>>& owners) const {
  for (std::size_t p = 0; p < grids_.size(); ++p) {
    if (!owners[p]) continue;
    const std::vector<std::size_t> counts = grids_[p]->particles_by_rank(*owners[p]);
    if (CellOwners::must_rebalance(*std::max_element(counts.begin(), counts.end()), grids_[p]->particles(),
                                   counts.size()))
      owners[p] = grids_[p]->divided(counts.size());
  }
}

/// Marks a block and those beside it.
void Neighbours::mark_beside(std::size_t block, std::vector<char>& near) const {
  const long nx = static_cast<long>(blocks_.count[0]), ny = static_cast<long>(blocks_.count[1]),
             at = static_cast<long>(block);
  std::array<long, 3> xs{}, ys{}, zs{};
  const auto mx = static_cast<std::size_t>(places_beside(0, at % nx, xs)),
             my = static_cast<std::size_t>(places_beside(1, at / nx % ny, ys)),
             mz = static_cast<std::size_t>(places_beside(2, at / (nx * ny), zs));
  for (std::size_t z = 0; z < mz; ++z)
    for (std::size_t y = 0; y < my; ++y)
      for (std::size_t x = 0; x < mx; ++x) near[static_cast<std::size_t>((zs[z] * ny + ys[y]) * nx + xs[x])] = 1;
}

std::map<std::int32_t, SharedBlocks> Neighbours::shared_blocks(const std::vector<const CellOwners*>& cells,
                                                               std::int32_t rank) const {
  std::vector<char> own(blocks_.size(), 0), near(blocks_.size(), 0);
  for (std::size_t p = 0; p < grids_.size(); ++p)
    if (cells[p])
      grids_[p]->each_block(*cells[p], [&](std::size_t block, std::int32_t owner, std::uint32_t) {
        if (owner == rank) own[block] = 1;
      });
  for (std::size_t q = 0; q < own.size(); ++q)
    if (own[q] != 0) mark_beside(q, near);
  std::map<std::int32_t, SharedBlocks> told;
  for (std::size_t p = 0; p < grids_.size(); ++p)
    if (cells[p])
      grids_[p]->each_block(*cells[p], [&](std::size_t block, std::int32_t owner, std::uint32_t) {
        if (owner == rank || near[block] == 0) return;
        std::vector<std::size_t>& receives = told[owner].receives;
        if (receives.empty() || receives.back() != block) receives.push_back(block);
      });
  for (auto& [other, blocks] : told) {
    std::sort(blocks.receives.begin(), blocks.receives.end());
    blocks.receives.erase(std::unique(blocks.receives.begin(), blocks.receives.end()), blocks.receives.end());
    std::vector<char> beside(blocks_.size(), 0);
    for (const std::size_t q : blocks.receives) mark_beside(q, beside);
    for (std::size_t q = 0; q < own.size(); ++q)
      if (own[q] != 0 && beside[q] != 0) blocks.sends.push_back(q);
  }
  return told;
}

std::vector<RankHalo> Neighbours::halo_of(std::size_t phase,
                                          const std::vector<std::optional<CellOwners>>& owners) const {
  std::vector<const CellOwners*> cells;
  for (const auto& one : owners) cells.push_back(one ? &*one : nullptr);
  const CellGrid& grid = *grids_[phase];
  const CellOwners& own = *cells[phase];
  const auto whole = owners_of_whole(cells);
  std::vector<RankHalo> all(own.ranks());
  std::vector<char> needed;
  const std::vector<std::size_t> counts = grid.particles_by_rank(own);
  for (std::size_t r = 0; r < all.size(); ++r) {
    const auto rank = static_cast<std::int32_t>(r);
    all[r].particles = counts[r];
    mark(phase, rank, cells, whole, needed);
    grid.each_ghost_cell(own, rank, needed, [&](std::uint32_t, std::uint32_t source, std::int32_t owner) {
      all[r].ghosts += grid.count(source);
      if (owner == rank) return;
      if (const std::size_t count = grid.count(source); count > 0)
        all[static_cast<std::size_t>(owner)].to[rank] += count;
    });
  }
  return all;
}

}  // namespace barchan
