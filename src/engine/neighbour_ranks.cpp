// Grids and lists of a run on several ranks.
#include <algorithm>
#include <stdexcept>

#include "engine/neighbours.hpp"

namespace barchan {

/// After the grids have been sorted: the particles of this rank, and the ghosts about them. Phases that are whole stay.
void Neighbours::share(std::vector<PhaseParticles>& particles) {
  for (std::size_t p = 0; p < grids_.size(); ++p) {
    if (particles[p].is_whole()) continue;
    if (!grids_[p]) throw std::logic_error("a phase without cells cannot be shared out among ranks");
    if (!grids_[p]->is_shared()) grids_[p]->share(particles[p]);
  }
  ranks::share();
  find_owners();
  take_ghosts();
  find_contested();
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

/// Two blocks side by side are compared by every rank that has particles in them. So only blocks in or beside which
/// several ranks have particles need the displacements of all ranks.
void Neighbours::find_contested() {
  std::vector<float> near(blocks_.size(), 0.0f);
  std::vector<char> own(blocks_.size(), 0);
  for (std::size_t q = 0; q < blocks_.size(); ++q) {
    if (std::any_of(grids_.begin(), grids_.end(), [q](const auto& grid) { return grid && !grid->runs(q).empty(); }))
      own[q] = 1;
    if (std::none_of(grids_.begin(), grids_.end(),
                     [q](const auto& grid) { return grid && grid->is_shared() && !grid->runs(q).empty(); }))
      continue;
    mark_beside(q, near);
  }
  ranks::active()->reduce(near.data(), near.size(), Communicator::Take::sum);
  contested_.clear();
  watched_.clear();
  for (std::size_t q = 0; q < near.size(); ++q) {
    if (near[q] > 1.0f) contested_.push_back(q);
    if (near[q] > 1.0f || own[q] != 0) watched_.push_back(q);
  }
  for (auto& ranges : ranges_)  // of blocks that nobody watches any more
    for (Range& range : ranges) range.clear();
}

/// Makes `all` the range of all ranks, and likewise the ranges of contested blocks.
void Neighbours::widen_by_ranks(Range& all) {
  Communicator* const others = ranks::active();
  if (!others) return;
  std::vector<Range*> told{&all};
  for (std::size_t p = 0; p < grids_.size(); ++p)
    if (grids_[p] && grids_[p]->is_shared())
      for (const std::size_t q : contested_) told.push_back(&ranges_[p][q]);
  told_.clear();
  for (const Range* range : told)
    for (std::size_t d = 0; d < 3; ++d) {
      told_.push_back(-range->low[d]);
      told_.push_back(range->high[d]);
    }
  others->reduce(told_.data(), told_.size(), Communicator::Take::largest);
  std::size_t k = 0;
  for (Range* range : told)
    for (std::size_t d = 0; d < 3; ++d) {
      range->low[d] = -told_[k++];
      range->high[d] = told_[k++];
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
