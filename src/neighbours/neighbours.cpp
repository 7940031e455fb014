#include "neighbours/neighbours.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace barchan {

Neighbours::Neighbours(const Bounds& bounds, std::vector<Direction> directions, std::size_t phases, double skin)
    : bounds_(bounds), directions_(std::move(directions)), grids_(phases), lists_(directions_.size()), skin_(skin) {
  for (std::size_t p = 0; p < phases; ++p) {
    // Cells suit the shortest search over a phase; longer ones look at more cells.
    double shortest = std::numeric_limits<double>::max(), longest = 0.0;
    for (const auto& d : directions_) {
      if (d.a == p || d.b == p) shortest = std::min(shortest, d.radius);
      if (d.a == p || d.b == p) longest = std::max(longest, d.radius);
    }
    if (longest == 0.0) continue;
    grids_[p] = std::make_unique<CellGrid>(bounds_, shortest * (1.0 + skin_), longest * (1.0 + skin_) * 1.001);
  }
}

bool Neighbours::still_valid(const std::vector<PhaseParticles>& particles) const {
  // Displacements since the last sort, by component: the relative displacement of two particles is at most the
  // distance between the corners of the box that holds both phases' displacements.
  struct Range {
    std::array<double, 3> low{0, 0, 0}, high{0, 0, 0};
  };
  thread_local std::vector<Range> ranges;
  ranges.assign(grids_.size(), Range{});
  for (std::size_t p = 0; p < grids_.size(); ++p) {
    if (!grids_[p]) continue;
    const auto n = static_cast<std::int64_t>(particles[p].size());
    for (int d = 0; d < bounds_.dimensions; ++d) {
      const double* x = particles[p].column(Field::position, d);
      const float* old = grids_[p]->search_position(d);
      const double low = bounds_.low[static_cast<std::size_t>(d)];
      double least = std::numeric_limits<double>::max(), most = -least;
#pragma omp parallel for simd schedule(static) reduction(min : least) reduction(max : most)
      for (std::int64_t k = 0; k < n; ++k) {
        const double moved = x[k] - low - static_cast<double>(old[k]);
        least = moved < least ? moved : least;
        most = moved > most ? moved : most;
      }
      if (n > 0) {
        ranges[p].low[static_cast<std::size_t>(d)] = least;
        ranges[p].high[static_cast<std::size_t>(d)] = most;
      }
    }
  }
  for (const auto& direction : directions_) {
    const Range &a = ranges[direction.a], &b = ranges[direction.b];
    double squared = 0.0;
    for (std::size_t d = 0; d < static_cast<std::size_t>(bounds_.dimensions); ++d) {
      const double apart = std::max(a.high[d], b.high[d]) - std::min(a.low[d], b.low[d]);
      if (!(apart < std::numeric_limits<double>::max())) return false;   // a non-finite position: sort and let it be found
      squared += apart * apart;
    }
    // A tenth of the skin is kept in hand for the step that follows the check.
    if (std::sqrt(squared) > 0.9 * skin_ * direction.radius) return false;
  }
  return true;
}

bool Neighbours::update(std::vector<PhaseParticles>& particles, bool force) {
  if (!force && rebuilds_ > 0 && still_valid(particles)) return false;
  for (std::size_t p = 0; p < grids_.size(); ++p)
    if (grids_[p]) grids_[p]->sort(particles[p]);
  for (std::size_t q = 0; q < directions_.size(); ++q) {
    const auto& d = directions_[q];
    const auto dummy = static_cast<std::uint32_t>(particles[d.b].size() + grids_[d.b]->images());
    lists_[q].build(*grids_[d.a], particles[d.a].size(), *grids_[d.b], d.a == d.b, d.radius * (1.0 + skin_), dummy,
                    bounds_.dimensions);
  }
  ++rebuilds_;
  return true;
}

std::size_t Neighbours::bytes() const {
  std::size_t total = 0;
  for (const auto& g : grids_)
    if (g) total += g->bytes();
  for (const auto& l : lists_) total += l.bytes();
  return total;
}

}  // namespace barchan
