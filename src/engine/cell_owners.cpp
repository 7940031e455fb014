// Which rank owns which cells of a grid, and whose particles a rank needs as ghosts: of a run and of its plan.
#include <algorithm>
#include <cmath>
#include <numeric>

#include "engine/cell_grid.hpp"

namespace barchan {

std::vector<std::uint32_t> CellGrid::rows_of_strips() const {
  const std::size_t low = bounds_.periodic[0] ? static_cast<std::size_t>(halo_[0]) : 0;
  std::vector<std::uint32_t> rows;
  for (std::size_t w = 0; w < walk_.size(); ++w)
    if ((walk_[w] % count_[0] - low) % strip == 0) rows.push_back(static_cast<std::uint32_t>(w));
  rows.push_back(static_cast<std::uint32_t>(walk_.size()));
  return rows;
}

CellOwners CellGrid::divided(std::size_t ranks) const {
  const std::vector<std::uint32_t> row = rows_of_strips();
  std::vector<std::int64_t> by_row(row.size() - 1, 0);
  for (std::size_t r = 0; r < by_row.size(); ++r)
    for (std::size_t w = row[r]; w < row[r + 1]; ++w) by_row[r] += static_cast<std::int64_t>(count(walk_[w]));
  return divided(by_row, ranks);
}

CellOwners CellGrid::divided(const std::vector<std::int64_t>& weights, std::size_t ranks) const {
  const std::vector<std::uint32_t> row = rows_of_strips();
  const std::int64_t total = std::accumulate(weights.begin(), weights.end(), std::int64_t{0});
  CellOwners owners;
  owners.first.assign(ranks + 1, static_cast<std::uint32_t>(walk_.size()));
  owners.first[0] = 0;
  std::int64_t before = 0;
  std::size_t rank = 1;
  for (std::size_t r = 0; r < weights.size(); ++r) {
    // A row belongs to the rank in whose share its middle lies.
    const std::int64_t middle = 2 * before + weights[r];
    while (rank < ranks && middle * static_cast<std::int64_t>(ranks) >= 2 * total * static_cast<std::int64_t>(rank))
      owners.first[rank++] = row[r];
    before += weights[r];
  }
  own_by_first(owners);
  return owners;
}

void CellGrid::own_by_first(CellOwners& owners) const {
  owners.owner.assign(begin_.size(), -1);
  for (std::size_t rank = 0; rank < owners.ranks(); ++rank)
    for (std::size_t w = owners.first[rank]; w < owners.first[rank + 1]; ++w)
      owners.owner[walk_[w]] = static_cast<std::int32_t>(rank);
}

std::vector<std::size_t> CellGrid::particles_by_rank(const CellOwners& owners) const {
  std::vector<std::size_t> counts(owners.ranks(), 0);
  for (std::size_t rank = 0; rank < counts.size(); ++rank)
    for (std::size_t w = owners.first[rank]; w < owners.first[rank + 1]; ++w) counts[rank] += count(walk_[w]);
  return counts;
}

std::vector<std::uint32_t> CellGrid::cells_of_particles() const {
  std::vector<std::uint32_t> cells;
  cells.reserve(particles());
  for (const std::uint32_t cell : walk_) cells.insert(cells.end(), count(cell), cell);
  return cells;
}

std::int32_t CellGrid::rank_of(const std::array<float, 3>& x, const CellOwners& owners) const {
  const auto cell = static_cast<std::uint32_t>(cell_of(x));
  return owners.owner[cell] >= 0 ? owners.owner[cell] : owners.owner[halo_cells_[halo_number(cell)].source];
}

/// Marks the cells of a box.
void CellGrid::mark_box(const std::array<float, 3>& low, const std::array<float, 3>& high,
                        std::vector<char>& needed) const {
  std::array<int, 3> first{0, 0, 0}, last{0, 0, 0};
  for (std::size_t d = 0; d < dimensions_; ++d) {
    first[d] = cell_coordinate(low[d], d);
    last[d] = cell_coordinate(high[d], d);
  }
  for (int z = first[2]; z <= last[2]; ++z)
    for (int y = first[1]; y <= last[1]; ++y) {
      const std::size_t row = (static_cast<std::size_t>(z) * count_[1] + static_cast<std::size_t>(y)) * count_[0];
      std::fill(needed.begin() + static_cast<std::ptrdiff_t>(row + static_cast<std::size_t>(first[0])),
                needed.begin() + static_cast<std::ptrdiff_t>(row + static_cast<std::size_t>(last[0]) + 1), char{1});
    }
}

void CellGrid::mark(const CellGrid& about, const CellOwners& owners, std::int32_t rank, float reach,
                    std::vector<char>& needed) const {
  const auto mark_about = [&](std::uint32_t cell) {
    if (about.begin_[cell] == about.end_[cell]) return;
    std::array<float, 3> first{}, last{};
    for (std::size_t d = 0; d < dimensions_; ++d) {
      const float* x = about.search_position(static_cast<int>(d));
      const auto [low, high] = std::minmax_element(x + about.begin_[cell], x + about.end_[cell]);
      first[d] = *low - reach;
      last[d] = *high + reach;
    }
    mark_box(first, last, needed);
  };
  // Of the division in use only cells near those of others count: marks of own cells say nothing.
  if (&about == this && &owners == shared_.get()) {
    for (const std::uint32_t cell : cells_at_border(reach)) mark_about(cell);
    return;
  }
  const auto r = static_cast<std::size_t>(rank);
  for (std::size_t w = owners.first[r]; w < owners.first[r + 1]; ++w) mark_about(about.walk_[w]);
}

/// Own cells within `reach` (m) of cells of others, or beyond periodic sides.
const std::vector<std::uint32_t>& CellGrid::cells_at_border(float reach) const {
  SharedCells& s = *shared_;
  int width = 0;
  for (std::size_t d = 0; d < dimensions_; ++d)
    width = std::max(width, static_cast<int>(std::ceil(reach * inverse_cell_[d])) + 1);
  if (width <= s.border_width && s.border_of == s.first) return s.border;
  const std::int32_t rank = ranks::active()->rank();
  std::vector<char> near(s.owner.size()), wider(s.owner.size());
  for (std::size_t c = 0; c < near.size(); ++c) near[c] = s.owner[c] != rank ? 1 : 0;
  std::size_t stride = 1;
  for (std::size_t d = 0; d < dimensions_; stride *= count_[d++]) {  // axis by axis
    for (std::size_t c = 0; c < near.size(); ++c) {
      const auto at = static_cast<long>(c / stride % count_[d]), last = static_cast<long>(count_[d]) - 1;
      const long from = std::max(-at, long{-width}), to = std::min(last - at, long{width});
      wider[c] = 0;
      for (long k = from; k <= to && wider[c] == 0; ++k)
        wider[c] = near[static_cast<std::size_t>(static_cast<long>(c) + k * static_cast<long>(stride))];
    }
    near.swap(wider);
  }
  s.border.clear();
  for (std::size_t w = s.first[static_cast<std::size_t>(rank)]; w < s.first[static_cast<std::size_t>(rank) + 1]; ++w)
    if (near[walk_[w]] != 0) s.border.push_back(walk_[w]);
  s.border_width = width;
  s.border_of = s.first;
  return s.border;
}

void CellGrid::mark(const CellGrid& about, const std::vector<std::int32_t>& owners, std::int32_t rank, float reach,
                    std::vector<char>& needed) const {
  for (std::size_t k = 0; k < owners.size(); ++k) {
    if (owners[k] != rank) continue;
    std::array<float, 3> first{}, last{};
    for (std::size_t d = 0; d < dimensions_; ++d) {
      first[d] = about.search_[d][k] - reach;
      last[d] = about.search_[d][k] + reach;
    }
    mark_box(first, last, needed);
  }
}

}  // namespace barchan
