#include "engine/cell_grid.hpp"

#include <omp.h>

#include <algorithm>
#include <atomic>
#include <cmath>

namespace barchan {

/// Divides the domain and its halo into cells of about this size; returns how many they are, also where they are more
/// than can be numbered.
double CellGrid::divide(double cell, double reach, const Blocks& blocks) {
  double cells = 1.0;
  for (std::size_t d = 0; d < dimensions_; ++d) {
    const double size = bounds_.high[d] - bounds_.low[d];
    period_[d] = bounds_.periodic[d] ? size : 0.0;
    const double n = static_cast<double>(blocks.count[d]) * std::max(std::floor(blocks.side[d] / cell), 1.0);
    const double side = size / n;
    inverse_cell_[d] = static_cast<float>(1.0 / side);
    side_[d] = static_cast<float>(side);
    halo_[d] = bounds_.periodic[d] ? static_cast<int>(std::ceil(reach / side)) + 1 : 1;
    count_[d] = static_cast<std::size_t>(std::min(n, 1e15)) + 2 * static_cast<std::size_t>(halo_[d]);
    cells *= static_cast<double>(count_[d]);
  }
  return cells;
}

CellGrid::CellGrid(const Bounds& bounds, double cell, double reach, const Blocks& blocks, std::size_t most)
    : dimensions_(static_cast<std::size_t>(bounds.dimensions)), bounds_(bounds) {
  double widest = 0.0;  // a cell as wide as a block cannot grow
  for (std::size_t d = 0; d < dimensions_; ++d) widest = std::max(widest, blocks.side[d]);
  while (divide(cell, reach, blocks) > static_cast<double>(std::min(most, most_cells)) && cell < widest) cell *= 1.25;
  const std::size_t cells = count_[0] * count_[1] * count_[2];
  first_run_.assign(blocks.size() + 1, 0);
  begin_.assign(cells, 0);
  end_.assign(cells, 0);
  order_interior(blocks);
  if (bounds_.periodic[0] || bounds_.periodic[1] || bounds_.periodic[2]) find_halo();
}

void CellGrid::order_interior(const Blocks& blocks) {
  // Non-periodic sides: the padding cells are real cells (they catch what lies outside), so they are walked as well.
  std::array<std::size_t, 3> low{0, 0, 0}, high = count_;
  for (std::size_t d = 0; d < dimensions_; ++d)
    if (bounds_.periodic[d]) {
      low[d] = static_cast<std::size_t>(halo_[d]);
      high[d] = count_[d] - static_cast<std::size_t>(halo_[d]);
    }
  walk_.clear();
  const std::size_t wide = strip, across = dimensions_ == 3 ? strip : count_[1];
  for (std::size_t y0 = low[1]; y0 < high[1]; y0 += across)
    for (std::size_t x0 = low[0]; x0 < high[0]; x0 += wide)
      for (std::size_t z = low[2]; z < high[2]; ++z)
        for (std::size_t y = y0; y < std::min(y0 + across, high[1]); ++y)
          for (std::size_t x = x0; x < std::min(x0 + wide, high[0]); ++x)
            walk_.push_back(static_cast<std::uint32_t>((z * count_[1] + y) * count_[0] + x));
  // Strips as walked; the halo of a periodic side is made row by row, so it is contiguous on either side of them.
  strip_last_.resize(count_[0]);
  for (std::size_t c = 0; c < count_[0]; ++c) {
    const std::size_t end = c < low[0]     ? low[0]
                            : c >= high[0] ? count_[0]
                                           : std::min(low[0] + ((c - low[0]) / wide + 1) * wide, high[0]);
    strip_last_[c] = static_cast<int>(end) - 1;
  }
  walk_block_.reserve(walk_.size());
  for (const std::uint32_t cell : walk_) {
    const std::array<std::size_t, 3> at{cell % count_[0], cell / count_[0] % count_[1], cell / (count_[0] * count_[1])};
    std::size_t block = 0;
    for (std::size_t d = 3; d-- > 0;) {
      std::size_t b = 0;
      if (d < dimensions_) {
        const double centre = (static_cast<double>(at[d]) - halo_[d] + 0.5) / static_cast<double>(inverse_cell_[d]);
        b = static_cast<std::size_t>(
            std::clamp(centre / blocks.side[d], 0.0, static_cast<double>(blocks.count[d] - 1)));
      }
      block = block * blocks.count[d] + b;
    }
    walk_block_.push_back(static_cast<std::uint32_t>(block));
  }
}

void CellGrid::sort(PhaseParticles& particles, Division division) {
  if (shared_) migrate(particles, division);
  else count_cells(particles);
  find_order(particles);
  make_runs();
  particles.permute(order_.data());
  if (shared_) make_own_images(particles);
  else make_images(particles);
}

/// The cell of each particle, and in end_ how many each cell has.
void CellGrid::count_cells(PhaseParticles& particles) {
  make_room(particles.size());
#pragma omp parallel
  find_cells(particles);
}

void CellGrid::make_room(std::size_t particles) {
  if (cell_of_.size() >= particles) return;
  cell_of_.resize(particles);
  order_.resize(particles);
}

/// Fills order_, and begin_ and end_ of the interior cells, from what count_cells() has found.
void CellGrid::find_order(const PhaseParticles& particles) {
#pragma omp parallel
  {
#pragma omp single
    place_cells();
    fill_cells(particles.id());
  }
}

/// Wraps a position and finds its cell.
std::uint32_t CellGrid::find_cell(const std::array<double*, 3>& x, std::size_t k) const {
  std::size_t cell = 0;
  for (std::size_t d = dimensions_; d-- > 0;) {
    double& place = x[d][k];
    if (bounds_.periodic[d] && !(place >= bounds_.low[d] && place < bounds_.high[d])) {
      place -= period_[d] * std::floor((place - bounds_.low[d]) / period_[d]);
      if (place < bounds_.low[d] || place >= bounds_.high[d]) place = bounds_.low[d];  // rounding at a side
    }
    // Rounding may put a wrapped position onto the upper bound: the interior range is enforced for periodic sides.
    int c = cell_coordinate(static_cast<float>(place - bounds_.low[d]), d);
    if (bounds_.periodic[d]) c = std::clamp(c, halo_[d], static_cast<int>(count_[d]) - halo_[d] - 1);
    cell = cell * count_[d] + static_cast<std::size_t>(c);
  }
  return static_cast<std::uint32_t>(cell);
}

/// Finds the cell of each particle and counts those of each cell in end_. All threads of a team call it.
void CellGrid::find_cells(PhaseParticles& particles) {
  const auto n = static_cast<std::int64_t>(particles.size()), cells = static_cast<std::int64_t>(end_.size());
  const bool alone = omp_get_num_threads() == 1;
  const std::array<double*, 3> x = positions_of(particles);
#pragma omp for schedule(static)
  for (std::int64_t c = 0; c < cells; ++c) end_[static_cast<std::size_t>(c)] = 0;
#pragma omp for schedule(static)
  for (std::int64_t k = 0; k < n; ++k) {
    const std::uint32_t cell = find_cell(x, static_cast<std::size_t>(k));
    cell_of_[static_cast<std::size_t>(k)] = cell;
    if (alone) ++end_[cell];
    else std::atomic_ref(end_[cell]).fetch_add(1, std::memory_order_relaxed);
  }
}

std::array<double*, 3> CellGrid::positions_of(PhaseParticles& particles) const {
  std::array<double*, 3> x{};
  for (std::size_t d = 0; d < dimensions_; ++d) x[d] = particles.column(Field::position, static_cast<int>(d));
  return x;
}

/// From the counts in end_: where each cell begins, in the order of the walk, also in end_.
void CellGrid::place_cells() {
  std::uint32_t sum = 0;
  for (const std::uint32_t cell : walk_) {
    begin_[cell] = sum;
    sum += end_[cell];
    end_[cell] = begin_[cell];
  }
}

void CellGrid::make_runs() {
  runs_.clear();
  runs_.reserve(std::min<std::size_t>(walk_.size(), 4096));  // their number comes and goes
  const auto [first, last] = own_walk();
  for (std::size_t w = first; w < last; ++w) {
    const std::uint32_t begin = begin_[walk_[w]], end = end_[walk_[w]];
    if (begin == end) continue;
    if (!runs_.empty() && runs_.back().block == walk_block_[w] && runs_.back().end == begin) runs_.back().end = end;
    else runs_.push_back({begin, end, walk_block_[w]});
  }
  // By blocks, so that threads share the blocks out.
  std::fill(first_run_.begin(), first_run_.end(), 0u);
  for (const BlockRun& run : runs_) ++first_run_[run.block + 1];
  for (std::size_t b = 0; b + 1 < first_run_.size(); ++b) first_run_[b + 1] += first_run_[b];
  if (runs_by_block_.capacity() < runs_.size()) runs_by_block_.reserve(runs_.size() + runs_.size() / 2 + 64);
  runs_by_block_.resize(runs_.size());
  for (const BlockRun& run : runs_) runs_by_block_[first_run_[run.block]++] = run;
  for (std::size_t b = first_run_.size() - 1; b > 0; --b) first_run_[b] = first_run_[b - 1];
  first_run_[0] = 0;
}

/// Fills order_: by cell, within a cell by id, whatever the storage was and whichever thread came first. All threads of
/// a team call it.
void CellGrid::fill_cells(const std::vector<std::int64_t>& id) {
  const auto n = static_cast<std::int64_t>(id.size()), cells = static_cast<std::int64_t>(walk_.size());
  if (omp_get_num_threads() == 1) {
    for (std::size_t k = 0; k < id.size(); ++k) order_[end_[cell_of_[k]]++] = static_cast<std::uint32_t>(k);
  } else {
#pragma omp for schedule(static)
    for (std::int64_t i = 0; i < n; ++i) {
      const auto k = static_cast<std::size_t>(i);
      order_[std::atomic_ref(end_[cell_of_[k]]).fetch_add(1, std::memory_order_relaxed)] =
          static_cast<std::uint32_t>(k);
    }
  }
#pragma omp for schedule(static)
  for (std::int64_t w = 0; w < cells; ++w) {
    const std::uint32_t cell = walk_[static_cast<std::size_t>(w)];
    std::uint32_t *const first = order_.data() + begin_[cell], *const last = order_.data() + end_[cell];
    if (last - first < 2) continue;
    const auto before = [&id](std::uint32_t a, std::uint32_t b) { return id[a] < id[b]; };
    if (!std::is_sorted(first, last, before)) std::sort(first, last, before);
  }
}

/// The cells of the halo beyond periodic sides, in the order of their numbers, each with the cell that it repeats.
void CellGrid::find_halo() {
  std::array<std::size_t, 3> interior{1, 1, 1};
  for (std::size_t d = 0; d < dimensions_; ++d) interior[d] = count_[d] - 2 * static_cast<std::size_t>(halo_[d]);
  std::size_t cell = 0;
  for (std::size_t z = 0; z < count_[2]; ++z)
    for (std::size_t y = 0; y < count_[1]; ++y)
      for (std::size_t c = 0; c < count_[0]; ++c, ++cell) {
        const std::array<std::size_t, 3> at{c, y, z};
        std::array<std::size_t, 3> from = at;
        HaloCell halo{static_cast<std::uint32_t>(cell), 0, {0, 0, 0}};
        bool outside = false;
        for (std::size_t d = 0; d < dimensions_; ++d) {
          if (!bounds_.periodic[d]) continue;
          const auto inside = static_cast<long>(interior[d]);
          const long relative = static_cast<long>(at[d]) - halo_[d];
          const long turns = relative >= 0 ? relative / inside : -((inside - 1 - relative) / inside);
          if (turns == 0) continue;
          outside = true;
          halo.shift[d] = static_cast<std::int8_t>(turns);
          from[d] = static_cast<std::size_t>(relative - turns * inside + halo_[d]);
        }
        if (!outside) continue;
        halo.source = static_cast<std::uint32_t>((from[2] * count_[1] + from[1]) * count_[0] + from[0]);
        halo_cells_.push_back(halo);
      }
}

/// Room for the search positions of particles and images, `used` in all; nothing is left of earlier ones behind them.
void CellGrid::fit_search(std::size_t particles, std::size_t room, std::size_t used) {
  const std::size_t needed = particles + room + 16;  // the search reads whole vectors
  for (std::size_t d = 0; d < dimensions_; ++d) {
    auto& s = search_[d];
    if (s.capacity() < needed) s.reserve(needed + needed / 8);
    s.resize(needed);
    std::fill(s.begin() + static_cast<std::ptrdiff_t>(used), s.end(), 0.0f);
  }
}

/// The cells of this process in the walk: from, to.
std::array<std::size_t, 2> CellGrid::own_walk() const {
  if (!shared_) return {0, walk_.size()};
  const auto rank = static_cast<std::size_t>(ranks::available()->rank());
  return {shared_->first[rank], shared_->first[rank + 1]};
}

void CellGrid::make_images(const PhaseParticles& particles) {
  const std::size_t n = particles.size();
  std::size_t total = n;
  for (const HaloCell& h : halo_cells_) {
    begin_[h.cell] = static_cast<std::uint32_t>(total);
    total += end_[h.source] - begin_[h.source];
    end_[h.cell] = static_cast<std::uint32_t>(total);
  }
  // Their number comes and goes: a body that crosses a periodic side has none before and many then.
  const std::size_t room = std::max(total - n, n <= 4096 ? n : 0);
  if (images_.capacity() < room) images_.reserve(room + room / 8 + 16);
  images_.resize(total - n);
  fit_search(n, room, total);
  std::array<const double*, 3> x{};
  for (std::size_t d = 0; d < dimensions_; ++d) x[d] = particles.column(Field::position, static_cast<int>(d));
  const auto particles_end = static_cast<std::int64_t>(n), halo_end = static_cast<std::int64_t>(halo_cells_.size());
#pragma omp parallel
  {
    for (std::size_t d = 0; d < dimensions_; ++d) {
      const double low = bounds_.low[d];
      float* s = search_[d].data();
#pragma omp for schedule(static) nowait
      for (std::int64_t k = 0; k < particles_end; ++k) s[k] = static_cast<float>(x[d][k] - low);
    }
#pragma omp for schedule(static) nowait
    for (std::int64_t h = 0; h < halo_end; ++h) {
      const HaloCell& halo = halo_cells_[static_cast<std::size_t>(h)];
      std::size_t q = begin_[halo.cell];
      for (std::uint32_t k = begin_[halo.source]; k < end_[halo.source]; ++k, ++q) {
        images_[q - n] = {k, halo.shift};
        for (std::size_t d = 0; d < dimensions_; ++d)
          search_[d][q] = static_cast<float>(x[d][k] - bounds_.low[d] + halo.shift[d] * period_[d]);
      }
    }
  }
}

std::size_t CellGrid::bytes_of_cells() const {
  return (begin_.size() + end_.size() + walk_.size() + walk_block_.size()) * sizeof(std::uint32_t) +
         halo_cells_.size() * sizeof(HaloCell);
}

std::size_t CellGrid::bytes() const {
  std::size_t total = bytes_of_cells() + (cell_of_.size() + order_.size()) * 4;
  for (const auto& s : search_) total += s.size() * sizeof(float);
  return total + images_.capacity() * sizeof(Image);
}

}  // namespace barchan
