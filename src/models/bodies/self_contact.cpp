#include "models/bodies/self_contact.hpp"

#include <algorithm>

#include "engine/exchange.hpp"
#include "engine/neighbours.hpp"

namespace barchan {

namespace {

/// Calls f(id, the row's entry) for every neighbour in the row; images have the ids of their sources.
template <class F>
void each_neighbour(const PhaseParticles& body, PairList::Row row, const CellGrid& grid, F&& f) {
  const auto& images = grid.image_list();
  for (const std::uint32_t* q = row.begin; q != row.end; ++q) {
    std::size_t at = *q / PairList::stride;
    if (at >= body.size() + images.size()) continue;  // pads the row
    if (at >= body.size()) at = images[at - body.size()].source;
    f(static_cast<std::uint32_t>(body.id()[at] - body.first_id()), *q);
  }
}

}  // namespace

std::vector<std::vector<std::uint32_t>> first_neighbours(const std::vector<Vec3>& places, const Bounds& bounds,
                                                         double spacing, double radius) {
  const ComputedByAll alone;  // a body is whole on every rank
  const std::size_t n = places.size();
  std::vector<PhaseParticles> all;
  all.emplace_back("body", bounds.dimensions, n, 1.0, 0);
  PhaseParticles& p = all[0];
  p.add(Field::position);
  for (int d = 0; d < bounds.dimensions; ++d)
    for (std::size_t k = 0; k < n; ++k) p.column(Field::position, d)[k] = places[k][static_cast<std::size_t>(d)];
  Neighbours search(bounds, {{0, 0, radius}}, 1e-3, {spacing}, simd::width_in_use<double>(), n);
  search.update(all, true);
  std::vector<std::vector<std::uint32_t>> result(n);
  for (std::size_t k = 0; k < n; ++k)
    each_neighbour(p, search.list(0).row(k), search.grid(0),
                   [&](std::uint32_t id, std::uint32_t) { result[static_cast<std::size_t>(p.id()[k])].push_back(id); });
  return result;
}

FarPairs::FarPairs(const std::vector<Vec3>& places, const Bounds& bounds, double spacing, double radius) {
  const auto first = first_neighbours(places, bounds, spacing, radius);
  near_begin_.push_back(0);
  std::vector<std::uint32_t> near;
  for (std::size_t a = 0; a < first.size(); ++a) {
    near.assign(1, static_cast<std::uint32_t>(a));
    for (const std::uint32_t b : first[a]) {
      near.push_back(b);
      near.insert(near.end(), first[b].begin(), first[b].end());
    }
    std::sort(near.begin(), near.end());
    near_.insert(near_.end(), near.begin(), std::unique(near.begin(), near.end()));
    near_begin_.push_back(near_.size());
  }
}

bool FarPairs::near(std::uint32_t a, std::uint32_t b) const {
  const auto at = [&](std::size_t k) { return near_.begin() + static_cast<std::ptrdiff_t>(near_begin_[k]); };
  return std::binary_search(at(a), at(a + 1), b);
}

void FarPairs::pick(const PhaseParticles& body, const PairList& list, const CellGrid& grid, bool nearest) {
  const auto dummy =
      static_cast<std::uint32_t>(PairList::stride * PairList::dummy_index(body.size(), grid.image_list().size()));
  index_.clear();
  begin_.assign(1, 0);
  for (std::size_t k = 0; k < body.size(); ++k) {
    const auto a = static_cast<std::uint32_t>(body.id()[k] - body.first_id());
    each_neighbour(body, list.row(k), grid, [&](std::uint32_t b, std::uint32_t entry) {
      if (near(a, b) == nearest) index_.push_back(entry);
      else if (nearest) index_.push_back(dummy);
    });
    while (index_.size() % list.padding() != 0) index_.push_back(dummy);
    begin_.push_back(index_.size());
  }
}

}  // namespace barchan
