// Grids and lists of a run on several ranks.
#include <algorithm>
#include <stdexcept>

#include "engine/neighbours.hpp"

namespace barchan {

/// After the grids have been sorted: the particles of this rank, and the ghosts about them. Phases that are whole stay.
void Neighbours::share(std::vector<PhaseParticles>& particles) {
  for (std::size_t p = 0; p < grids_.size(); ++p) {
    if (particles[p].is_whole()) continue;
    if (!grids_[p] || !grids_[p]->is_shared())
      throw std::logic_error("a phase without cells cannot be shared out among ranks");
  }
  ranks::share();
  find_owners();
  take_ghosts();
  find_watched();
}

void Neighbours::find_owners() { owners_ = owners_of_whole(cell_owners()); }

/// Who owns the cells of each phase; null: the phase is whole, or has none.
std::vector<const CellOwners*> Neighbours::cell_owners() const {
  std::vector<const CellOwners*> cells;
  for (const auto& grid : grids_) cells.push_back(grid ? grid->owners() : nullptr);
  return cells;
}

void Neighbours::take_ghosts() {
  const std::vector<const CellOwners*> cells = cell_owners();
  std::vector<char> needed;
  for (std::size_t b = 0; b < grids_.size(); ++b) {
    if (!cells[b]) continue;
    mark(b, ranks::active()->rank(), cells, owners_, needed);
    grids_[b]->take_ghosts(needed);
  }
}

void Neighbours::find_watched() {
  const std::vector<const CellOwners*> cells = cell_owners();
  std::vector<std::vector<std::uint32_t>> pieces;
  for (const CellOwners* owners : cells)
    if (owners) pieces.push_back(owners->first);
  if (pieces != told_for_) {
    told_blocks_ = told_blocks(cells, ranks::active()->rank());
    told_for_ = std::move(pieces);
  }
  std::vector<char> watched(blocks_.size(), 0);
  for (std::size_t q = 0; q < blocks_.size(); ++q)
    watched[q] = std::any_of(grids_.begin(), grids_.end(), [q](const auto& g) { return g && !g->runs(q).empty(); });
  for (const auto& [rank, blocks] : told_blocks_)
    for (const std::size_t q : blocks.hears) watched[q] = 1;
  watched_.clear();
  for (std::size_t q = 0; q < watched.size(); ++q)
    if (watched[q] != 0) watched_.push_back(q);
  for (auto& ranges : ranges_)  // of blocks that nobody watches any more
    for (Range& range : ranges) range.clear();
}

/// Makes `all` the range of all ranks, and the ranges of blocks in and beside the own ones those of all ranks.
void Neighbours::widen_by_ranks(Range& all) {
  Communicator* const others = ranks::active();
  if (!others) return;
  std::vector<std::vector<Range>*> shared;
  for (std::size_t p = 0; p < grids_.size(); ++p)
    if (grids_[p] && grids_[p]->is_shared()) shared.push_back(&ranges_[p]);
  told_.clear();
  told_counts_.assign(static_cast<std::size_t>(others->size()), 0);
  heard_counts_ = told_counts_;
  std::size_t heard = 0;
  for (const auto& [rank, blocks] : told_blocks_) {
    for (const std::vector<Range>* ranges : shared)
      for (const std::size_t q : blocks.tells) told_.push_back((*ranges)[q]);
    told_counts_[static_cast<std::size_t>(rank)] = blocks.tells.size() * shared.size();
    heard += heard_counts_[static_cast<std::size_t>(rank)] = blocks.hears.size() * shared.size();
  }
  heard_.resize(heard);
  others->exchange(told_.data(), told_counts_, heard_.data(), heard_counts_, sizeof(Range));
  const Range* from = heard_.data();
  for (const auto& [rank, blocks] : told_blocks_)
    for (std::vector<Range>* ranges : shared)
      for (const std::size_t q : blocks.hears) (*ranges)[q].widen(*from++);
  std::array<float, 6> bounds{};
  for (std::size_t d = 0; d < 3; ++d) {
    bounds[2 * d] = -all.low[d];
    bounds[2 * d + 1] = all.high[d];
  }
  others->reduce(bounds.data(), bounds.size(), Communicator::Take::largest);
  for (std::size_t d = 0; d < 3; ++d) {
    all.low[d] = -bounds[2 * d];
    all.high[d] = bounds[2 * d + 1];
  }
}

void Neighbours::gather() {
  for (auto& grid : grids_)
    if (grid) grid->gather();
}

void Neighbours::forget_gathered() {
  for (auto& grid : grids_)
    if (grid) grid->forget_gathered();
}

}  // namespace barchan
