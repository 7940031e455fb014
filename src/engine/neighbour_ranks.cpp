// Grids and lists of a run on several ranks.
#include <stdexcept>

#include "engine/neighbours.hpp"

namespace barchan {

/// After the grids have been sorted: the particles of this rank, and the ghosts about them.
void Neighbours::share(std::vector<PhaseParticles>& particles) {
  for (std::size_t p = 0; p < grids_.size(); ++p) {
    if (!grids_[p]) throw std::logic_error("a phase without cells cannot be shared out among ranks");
    if (!grids_[p]->is_shared()) grids_[p]->share(particles[p]);
  }
  ranks::share();
  take_ghosts();
}

void Neighbours::take_ghosts() {
  std::vector<char> needed;
  for (std::size_t b = 0; b < grids_.size(); ++b) {
    needed.assign(grids_[b]->cells(), 0);
    for (const auto& d : directions_)
      if (d.b == b)  // a little more than a search looks into (pair_list.cpp)
        grids_[b]->mark(*grids_[d.a], static_cast<float>(d.radius * (1.0 + skin_) * 1.001), needed);
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
