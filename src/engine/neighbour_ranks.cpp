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

/// The ranges of displacements of all ranks.
void Neighbours::widen_by_ranks() {
  Communicator* const all = ranks::active();
  if (!all) return;
  for (auto& ranges : ranges_) {
    std::vector<float> bounds;
    for (const Range& range : ranges)
      for (std::size_t d = 0; d < 3; ++d) {
        bounds.push_back(-range.low[d]);
        bounds.push_back(range.high[d]);
      }
    all->reduce(bounds.data(), bounds.size(), Communicator::Take::largest);
    std::size_t k = 0;
    for (Range& range : ranges)
      for (std::size_t d = 0; d < 3; ++d) {
        range.low[d] = -bounds[k++];
        range.high[d] = bounds[k++];
      }
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
