// Grids and lists of a run on several ranks.
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "engine/neighbours.hpp"
#include "engine/rank_load.hpp"

namespace barchan {

namespace {

/// What a step does once for a particle takes as long as so many entries of its rows: measured in a dam break in 3D.
constexpr double entries_a_particle = 4.0;

}  // namespace

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

/// What a step does for the particles of a phase, in entries of rows. The lists are those of the steps so far.
double Neighbours::work_of(std::size_t phase, std::size_t particles) const {
  double work = entries_a_particle * static_cast<double>(particles);
  for (std::size_t q = 0; q < directions_.size(); ++q)
    if (directions_[q].a == phase) work += static_cast<double>(lists_[q].padded_entries());
  return work;
}

/// The same of each of these particles, in whole numbers; `unit`: of an entry. Where particles were made or removed
/// since the lists, all have the same.
std::vector<std::int64_t> Neighbours::weights_of(std::size_t phase, std::size_t particles, double unit) const {
  std::vector<double> work(particles, entries_a_particle);
  for (std::size_t q = 0; q < directions_.size(); ++q) {
    if (directions_[q].a != phase || searches_[q].size_a != particles) continue;
    for (std::size_t k = 0; k < particles; ++k) {
      const PairList::Row row = lists_[q].row(k);
      work[k] += static_cast<double>(row.end - row.begin);
    }
  }
  std::vector<std::int64_t> weights;
  weights.reserve(particles);
  for (const double w : work) weights.push_back(std::llround(unit * w));
  return weights;
}

/// Divides the cells of all phases that are shared out by the time of the steps, if a rank takes too long.
void Neighbours::divide_anew(std::vector<PhaseParticles>& particles) {
  if (!ranks::active()) return;
  const auto is_divided = [this](std::size_t p) { return grids_[p] && grids_[p]->is_shared(); };
  double work = 0.0;
  for (std::size_t p = 0; p < grids_.size(); ++p)
    if (is_divided(p)) work += work_of(p, particles[p].size());
  const std::optional<double> cost = load_->look(work);
  if (!cost) return;
  constexpr double fineness = 16.0;  // of weights, which are whole numbers
  for (std::size_t p = 0; p < grids_.size(); ++p)
    if (is_divided(p)) grids_[p]->divide(particles[p], weights_of(p, particles[p].size(), fineness * *cost));
  load_->divided();
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
  if (pieces != shared_for_) {
    shared_blocks_ = shared_blocks(cells, ranks::active()->rank());
    shared_for_ = std::move(pieces);
  }
  std::vector<char> watched(blocks_.size(), 0);
  for (std::size_t q = 0; q < blocks_.size(); ++q)
    watched[q] = std::any_of(grids_.begin(), grids_.end(), [q](const auto& g) { return g && !g->runs(q).empty(); });
  for (const auto& [rank, blocks] : shared_blocks_)
    for (const std::size_t q : blocks.receives) watched[q] = 1;
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
  sent_.clear();
  send_counts_.assign(static_cast<std::size_t>(others->size()), 0);
  receive_counts_ = send_counts_;
  std::size_t heard = 0;
  for (const auto& [rank, blocks] : shared_blocks_) {
    for (const std::vector<Range>* ranges : shared)
      for (const std::size_t q : blocks.sends) sent_.push_back((*ranges)[q]);
    send_counts_[static_cast<std::size_t>(rank)] = blocks.sends.size() * shared.size();
    heard += receive_counts_[static_cast<std::size_t>(rank)] = blocks.receives.size() * shared.size();
  }
  received_.resize(heard);
  others->exchange(sent_.data(), send_counts_, received_.data(), receive_counts_, sizeof(Range));
  const Range* from = received_.data();
  for (const auto& [rank, blocks] : shared_blocks_)
    for (std::vector<Range>* ranges : shared)
      for (const std::size_t q : blocks.receives) (*ranges)[q].widen(*from++);
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
