#include "models/coupling/border_neighbours.hpp"

#include <omp.h>

#include <algorithm>

#include "engine/exchange.hpp"
#include "models/coupling/spray.hpp"

namespace barchan {

PiecePlace piece_place(const Workspace& w, std::size_t solid, std::size_t particle, const Vec3& beside) {
  PiecePlace place{{}, {}, beside};
  for (std::size_t d = 0; d < static_cast<std::size_t>(w.layout.dimensions); ++d) {
    const int c = static_cast<int>(d);
    place.particle[d] = w.state.phases[solid].column(Field::position, c)[particle];
    place.sorted[d] = w.neighbours.grid(solid).search_position(c)[particle];
  }
  return place;
}

BorderNeighbours::BorderNeighbours(const Layout& layout, std::size_t fluid, double radius)
    : fluid_(fluid), radius_(radius), reach_(radius) {
  double widest = 0.0;
  for (const PlanEntry& e : layout.entries)
    if (e.pairs == Pairs::searched) widest = std::max(widest, layout.skin * e.radius);
  reach_ += widest;
}

void BorderNeighbours::look_from(const Workspace& w, const std::vector<PiecePlace>& pieces) {
  w_ = &w;
  pieces_ = &pieces;
  found_.resize(std::max(found_.size(), static_cast<std::size_t>(omp_get_max_threads())));
  for (auto& found : found_) found.reserve(w.layout.dimensions == 2 ? 64 : 256);  // twice as many as on a lattice
  if (!Exchange().is_shared()) return;
  find_owners();
  exchange();
}

const std::vector<BorderNeighbour>& BorderNeighbours::of(std::size_t piece) {
  std::vector<BorderNeighbour>& found = found_[static_cast<std::size_t>(omp_get_thread_num())];
  found.clear();
  find(piece, found);
  if (received_.empty() || first_received_[piece] == first_received_[piece + 1]) return found;
  const auto own = static_cast<std::ptrdiff_t>(found.size());
  const auto at = [this](std::size_t k) { return received_.begin() + static_cast<std::ptrdiff_t>(k); };
  found.insert(found.end(), at(first_received_[piece]), at(first_received_[piece + 1]));
  std::inplace_merge(found.begin(), found.begin() + own, found.end(), before);
  return found;
}

void BorderNeighbours::find(std::size_t piece, std::vector<BorderNeighbour>& found) const {
  w_->layout.dimensions == 2 ? find<2>(piece, found) : find<3>(piece, found);
}

/// Among the particles of this rank.
template <int Dim>
void BorderNeighbours::find(std::size_t piece, std::vector<BorderNeighbour>& found) const {
  const PiecePlace& place = (*pieces_)[piece];
  const Bounds& bounds = w_->layout.bounds;
  const PhaseParticles& fluid = w_->state.phases[fluid_];
  const CellGrid& grid = w_->neighbours.grid(fluid_);
  const std::size_t n = fluid.size();
  const double far = radius_ * radius_ * (1.0 + 1e-6);  // who asks decides what is just within the radius
  std::array<const double*, Dim> x{}, v{};
  for (std::size_t d = 0; d < Dim; ++d) {
    x[d] = fluid.column(Field::position, static_cast<int>(d));
    v[d] = fluid.column(Field::velocity, static_cast<int>(d));
  }
  const double* const pressure = fluid.column(Field::pressure);
  const double* const wholeness = fluid.has(Field::wholeness) ? fluid.column(Field::wholeness) : nullptr;
  const auto periodic = [&](std::size_t d) { return d < Dim && bounds.periodic[d]; };
  std::uint32_t turn = 0;
  const auto search = [&](const std::array<int, 3>& turns) {
    ++turn;
    Vec3 at{};
    std::array<float, 3> sorted{};
    for (std::size_t d = 0; d < Dim; ++d) {
      const double period = bounds.high[d] - bounds.low[d], turned = turns[d] * period + place.beside[d];
      at[d] = place.particle[d] + turned;
      sorted[d] = place.sorted[d] + static_cast<float>(turned);
      if (periodic(d) && !(sorted[d] > -reach_ && sorted[d] < period + reach_)) return;
    }
    grid.candidates(sorted, sorted, static_cast<float>(reach_), [&](std::uint32_t begin, std::uint32_t end) {
      for (std::size_t b = begin; b < std::min<std::size_t>(end, n); ++b) {
        BorderNeighbour near{
            {},   {}, pressure[b], wholeness ? Spray::share(wholeness[b]) : 1.0, static_cast<std::uint32_t>(piece),
            turn, 0};
        for (std::size_t d = 0; d < Dim; ++d) near.from[d] = x[d][b] - at[d];
        if (!(dot(near.from, near.from) < far)) continue;
        for (std::size_t d = 0; d < Dim; ++d) near.velocity[d] = v[d][b];
        if (grid.is_shared()) near.cell = grid.cell_of_particle(b);
        found.push_back(near);
      }
    });
  };
  std::array<int, 3> ways{};
  for (std::size_t d = 0; d < 3; ++d) ways[d] = periodic(d) ? 1 : 0;
  for (int k = -ways[2]; k <= ways[2]; ++k)
    for (int j = -ways[1]; j <= ways[1]; ++j)
      for (int i = -ways[0]; i <= ways[0]; ++i) search({i, j, k});
}

}  // namespace barchan
