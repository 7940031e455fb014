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

/// A particle of a phase that is whole belongs to the rank whose cells it stands in: those of the first phase that it
/// looks for and that is shared out.
void Neighbours::find_owners() {
  for (std::size_t p = 0; p < grids_.size(); ++p) {
    std::vector<std::int32_t>& owners = owners_[p];
    owners.clear();
    const auto first = std::find_if(directions_.begin(), directions_.end(), [&](const Direction& d) {
      return d.a == p && !grids_[p]->is_shared() && grids_[d.b]->is_shared();
    });
    if (first == directions_.end()) continue;
    owners.resize(grids_[p]->particles());
    for (std::size_t k = 0; k < owners.size(); ++k) {
      std::array<float, 3> x{};
      for (std::size_t d = 0; d < static_cast<std::size_t>(bounds_.dimensions); ++d)
        x[d] = grids_[p]->search_position(static_cast<int>(d))[k];
      owners[k] = grids_[first->b]->rank_of(x);
    }
  }
}

void Neighbours::take_ghosts() {
  std::vector<char> needed;
  for (std::size_t b = 0; b < grids_.size(); ++b) {
    if (!grids_[b] || !grids_[b]->is_shared()) continue;
    needed.assign(grids_[b]->cells(), 0);
    for (const auto& d : directions_) {
      if (d.b != b) continue;
      // A little more than a search looks into (pair_list.cpp).
      const auto reach = static_cast<float>(d.radius * (1.0 + skin_) * 1.001);
      if (grids_[d.a]->is_shared()) grids_[b]->mark(*grids_[d.a], reach, needed);
      else grids_[b]->mark(*grids_[d.a], owners_[d.a], reach, needed);
    }
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
