// The cells of a grid on several ranks: who owns which, particles that change their rank, ghosts.
#include <algorithm>
#include <cstring>
#include <numeric>

#include "engine/cell_grid.hpp"

namespace barchan {

namespace {

std::vector<std::size_t> counts_from_others(const std::vector<std::size_t>& mine) {
  Communicator& all = *ranks::active();
  const auto size = static_cast<std::size_t>(all.size());
  std::vector<std::size_t> ones(size, 1), theirs(size, 0);
  all.exchange(mine.data(), ones, theirs.data(), ones, sizeof(std::size_t));
  return theirs;
}

std::size_t sum(const std::vector<std::size_t>& counts) {
  return std::accumulate(counts.begin(), counts.end(), std::size_t{0});
}

std::size_t sum_before(const std::vector<std::size_t>& counts, std::size_t number) {
  return std::accumulate(counts.begin(), counts.begin() + static_cast<std::ptrdiff_t>(number), std::size_t{0});
}

}  // namespace

void SharedCells::sort_out_own_images(std::size_t rank) {
  own_images = {sum_before(send_counts, rank), sum_before(receive_counts, rank), receive_counts[rank]};
  away_counts = send_counts;
  come_counts = receive_counts;
  away_counts[rank] = come_counts[rank] = 0;
}

/// Divides the cells of one process. From now on begin_ and end_ of this rank's count its own particles; those stood
/// at first .. second - 1.
std::array<std::size_t, 2> CellGrid::take_own_cells() {
  auto shared = std::make_unique<SharedCells>();
  static_cast<CellOwners&>(*shared) = divided(static_cast<std::size_t>(ranks::available()->size()));
  shared_ = std::move(shared);
  const auto [from, to] = own_walk();
  const std::size_t first = from < to ? begin_[walk_[from]] : 0, last = from < to ? end_[walk_[to - 1]] : 0;
  for (std::size_t w = from; w < to; ++w) {
    begin_[walk_[w]] -= static_cast<std::uint32_t>(first);
    end_[walk_[w]] -= static_cast<std::uint32_t>(first);
  }
  return {first, last};
}

void CellGrid::sort_and_share(PhaseParticles& particles) {
  count_cells(particles);
  find_order(particles);
  give_back(cell_of_);
  const auto [first, last] = take_own_cells();
  particles.keep(order_.data() + first, last - first);
  give_back(order_);  // as long as the particles of all ranks
  make_runs();
  make_own_images(particles);
}

void CellGrid::sort_pieces(PhaseParticles& particles) {
  count_cells(particles);
  shared_ = std::make_unique<SharedCells>();
  static_cast<CellOwners&>(*shared_) =
      divided(particles_by_row(), static_cast<std::size_t>(ranks::available()->size()));
  migrate(particles, Division::particles);
  find_order(particles);
  particles.keep(order_.data(), particles.size());
  make_runs();
  make_own_images(particles);
}

/// Sums of what the cells of all ranks have, in each row of strips.
template <class Of>
std::vector<std::int64_t> CellGrid::by_row(Of&& of_cell) const {
  const std::vector<std::uint32_t> row = rows_of_strips();
  std::vector<std::int64_t> sums(row.size() - 1, 0);
  for (std::size_t r = 0; r < sums.size(); ++r)
    for (std::size_t w = row[r]; w < row[r + 1]; ++w) sums[r] += of_cell(walk_[w]);
  ranks::active()->reduce(sums.data(), sums.size(), Communicator::Take::sum);
  return sums;
}

/// find_cells() has counted those of each cell.
std::vector<std::int64_t> CellGrid::particles_by_row() const {
  return by_row([this](std::uint32_t cell) { return std::int64_t{end_[cell]}; });
}

void CellGrid::divide(PhaseParticles& particles, const std::vector<std::int64_t>& weights) {
  count_cells(particles);
  std::vector<std::int64_t> of_cell(begin_.size(), 0);
  for (std::size_t k = 0; k < weights.size(); ++k) of_cell[cell_of_[k]] += weights[k];
  static_cast<CellOwners&>(*shared_) = divided(by_row([&](std::uint32_t c) { return of_cell[c]; }), shared_->ranks());
  move_to_owners(particles);
}

/// Gives rows away where a rank has too many particles. find_cells() has counted those of each cell.
void CellGrid::balance() {
  const auto [from, to] = own_walk();
  std::int64_t own = 0;
  for (std::size_t w = from; w < to; ++w) own += end_[walk_[w]];
  const std::int64_t most = ranks::largest(own), total = ranks::total(own);
  if (!CellOwners::must_rebalance(static_cast<std::size_t>(most), static_cast<std::size_t>(total), shared_->ranks()))
    return;
  static_cast<CellOwners&>(*shared_) = divided(particles_by_row(), shared_->ranks());
}

/// Particles that stand in cells of other ranks go there.
void CellGrid::migrate(PhaseParticles& particles, Division division) {
  count_cells(particles);
  if (division == Division::particles) balance();
  move_to_owners(particles);
}

/// count_cells() has found the cells of the particles. Those that come stand behind those that stay, in no order; then
/// the cells of all are known and counted again.
void CellGrid::move_to_owners(PhaseParticles& particles) {
  Communicator& all = *ranks::active();
  const SharedCells& s = *shared_;
  const std::size_t n = particles.size(), width = particles.packed_width();
  std::vector<std::uint32_t> leavers;
  std::vector<std::size_t> leaving(static_cast<std::size_t>(all.size()), 0);
  for (std::size_t k = 0; k < n; ++k)
    if (const std::int32_t to = s.owner[cell_of_[k]]; to != all.rank()) {
      leavers.push_back(static_cast<std::uint32_t>(k));
      ++leaving[static_cast<std::size_t>(to)];
      --end_[cell_of_[k]];
    }
  const std::vector<std::size_t> coming = counts_from_others(leaving);
  std::vector<std::size_t> next(leaving.size(), 0);
  std::partial_sum(leaving.begin(), leaving.end() - 1, next.begin() + 1);
  std::vector<std::byte> out(leavers.size() * width), in(sum(coming) * width);
  for (const std::uint32_t k : leavers)
    particles.pack(k, out.data() + next[static_cast<std::size_t>(s.owner[cell_of_[k]])]++ * width);
  all.exchange(out.data(), leaving, in.data(), coming, width);
  const std::size_t kept = n - leavers.size();
  fill_places(particles, leavers, kept);
  particles.resize(kept + sum(coming));
  make_room(particles.size());
  for (std::size_t k = 0; k < sum(coming); ++k) particles.unpack(kept + k, in.data() + k * width);
  const std::array<double*, 3> x = positions_of(particles);
  for (std::size_t k = kept; k < particles.size(); ++k) ++end_[cell_of_[k] = find_cell(x, k)];
}

/// Moves the last particles that stay into the places of those that leave (ascending), so that the first `kept` stay.
void CellGrid::fill_places(PhaseParticles& particles, const std::vector<std::uint32_t>& leavers, std::size_t kept) {
  std::vector<std::byte> one(particles.packed_width());
  auto leaver = std::lower_bound(leavers.begin(), leavers.end(), kept);
  std::size_t from = kept;
  for (const std::uint32_t to : leavers) {
    if (to >= kept) break;
    for (; leaver != leavers.end() && *leaver == from; ++leaver) ++from;
    particles.pack(from, one.data());
    particles.unpack(to, one.data());
    cell_of_[to] = cell_of_[from++];
  }
}

/// After a sort: search positions of the particles, and of their images beyond periodic sides.
void CellGrid::make_own_images(const PhaseParticles& particles) {
  SharedCells& s = *shared_;
  const std::size_t n = particles.size();
  const auto rank = ranks::available()->rank();
  fit_search(n, 0, n);
  std::array<const double*, 3> x{};
  for (std::size_t d = 0; d < dimensions_; ++d) {
    x[d] = particles.column(Field::position, static_cast<int>(d));
    for (std::size_t k = 0; k < n; ++k) search_[d][k] = static_cast<float>(x[d][k] - bounds_.low[d]);
    s.image_search[d].clear();
  }
  s.image_begin.assign(1, 0);
  for (const HaloCell& halo : halo_cells_) {
    for (std::uint32_t k = begin_[halo.source]; s.owner[halo.source] == rank && k < end_[halo.source]; ++k)
      for (std::size_t d = 0; d < dimensions_; ++d)
        s.image_search[d].push_back(static_cast<float>(x[d][k] - bounds_.low[d] + halo.shift[d] * period_[d]));
    s.image_begin.push_back(static_cast<std::uint32_t>(s.image_search[0].size()));
  }
}

std::size_t CellGrid::halo_number(std::uint32_t cell) const {
  const auto found = std::lower_bound(halo_cells_.begin(), halo_cells_.end(), cell,
                                      [](const HaloCell& halo, std::uint32_t c) { return halo.cell < c; });
  return static_cast<std::size_t>(found - halo_cells_.begin());
}

void CellGrid::take_ghosts(const std::vector<char>& needed) {
  const SharedCells::Question question = ask_owners(needed);
  const std::size_t n = place_ghosts(question);
  bring_search_positions(question, n);
}

/// Asks the owners for needed cells, by their numbers, those beyond a periodic side too: how many are in them.
SharedCells::Question CellGrid::ask_owners(const std::vector<char>& needed) {
  const SharedCells& s = *shared_;
  Communicator& all = *ranks::active();
  SharedCells::Question q;
  std::vector<std::vector<std::uint32_t>> from(static_cast<std::size_t>(all.size()));
  each_ghost_cell(s, all.rank(), needed, [&](std::uint32_t cell, std::uint32_t, std::int32_t owner) {
    from[static_cast<std::size_t>(owner)].push_back(cell);
  });
  for (const auto& cells : from) {
    q.ask.insert(q.ask.end(), cells.begin(), cells.end());
    q.ask_counts.push_back(cells.size());
  }
  q.asked_counts = counts_from_others(q.ask_counts);
  q.asked.resize(sum(q.asked_counts));
  q.numbers.resize(q.ask.size());
  all.exchange(q.ask.data(), q.ask_counts, q.asked.data(), q.asked_counts, sizeof(std::uint32_t));
  answer(q.asked, q.asked_counts);
  std::vector<std::uint32_t> answers;
  for (const std::uint32_t c : q.asked) {
    const std::uint32_t source = s.owner[c] >= 0 ? c : halo_cells_[halo_number(c)].source;
    answers.push_back(end_[source] - begin_[source]);
  }
  all.exchange(answers.data(), q.asked_counts, q.numbers.data(), q.ask_counts, sizeof(std::uint32_t));
  return q;
}

/// Own cells keep their places; all others stand behind the particles in the order of their numbers. Returns the number
/// of own particles.
std::size_t CellGrid::place_ghosts(const SharedCells::Question& question) {
  SharedCells& s = *shared_;
  const int rank = ranks::active()->rank();
  const auto [from, to] = own_walk();
  const std::size_t n = from < to ? std::size_t{end_[walk_[to - 1]]} : 0;
  for (std::size_t c = 0; c < begin_.size(); ++c)
    if (s.owner[c] != rank) begin_[c] = end_[c] = 0;
  for (std::size_t q = 0; q < question.ask.size(); ++q) end_[question.ask[q]] = question.numbers[q];
  std::size_t total = n;
  for (std::size_t c = 0; c < begin_.size(); ++c) {
    if (s.owner[c] == rank) continue;
    begin_[c] = static_cast<std::uint32_t>(total);
    total += end_[c];
    end_[c] = static_cast<std::uint32_t>(total);
  }
  s.slots.clear();
  s.receive_counts.assign(question.ask_counts.size(), 0);
  images_.assign(total - n, {0, {0, 0, 0}});
  std::size_t q = 0;
  for (std::size_t r = 0; r < question.ask_counts.size(); ++r)
    for (std::size_t k = 0; k < question.ask_counts[r]; ++k, ++q) {
      const std::uint32_t cell = question.ask[q];
      for (std::uint32_t at = begin_[cell]; at < end_[cell]; ++at) {
        s.slots.push_back(static_cast<std::uint32_t>(at - n));
        if (s.owner[cell] < 0) images_[at - n].shift = halo_cells_[halo_number(cell)].shift;
        ++s.receive_counts[r];
      }
    }
  s.sort_out_own_images(static_cast<std::size_t>(rank));
  fit_search(n, total - n, total);
  return n;
}

/// Behind the n of the own particles.
void CellGrid::bring_search_positions(const SharedCells::Question& question, std::size_t n) {
  const SharedCells& s = *shared_;
  std::vector<std::size_t> begins;  // of the answered search positions: by sent image
  for (const std::uint32_t c : question.asked) {
    const bool beyond = s.owner[c] < 0;
    const std::size_t first = beyond ? s.image_begin[halo_number(c)] : begin_[c];
    const std::uint32_t source = beyond ? halo_cells_[halo_number(c)].source : c;
    for (std::size_t k = 0; k < end_[source] - begin_[source]; ++k) begins.push_back(first + k);
  }
  const Image* const first = s.sends.data();
  fill_ghosts(
      dimensions_ * sizeof(float),
      [&](const Image& image, std::byte* to) {
        const std::size_t at = begins[static_cast<std::size_t>(&image - first)];
        for (std::size_t d = 0; d < dimensions_; ++d) {
          const float* const from = image.shifted() ? s.image_search[d].data() : search_[d].data();
          std::memcpy(to + d * sizeof(float), from + at, sizeof(float));
        }
      },
      [&](std::size_t slot, const std::byte* come) {
        for (std::size_t d = 0; d < dimensions_; ++d)
          std::memcpy(&search_[d][n + slot], come + d * sizeof(float), sizeof(float));
      });
}

void CellGrid::take_places(const PhaseParticles& particles, std::array<std::vector<double>, 3>& ghosts) const {
  const auto axes = static_cast<std::size_t>(particles.dimensions());
  if (!is_shared()) return;
  std::array<const double*, 3> x{};
  for (std::size_t d = 0; d < axes; ++d) {
    x[d] = particles.column(Field::position, static_cast<int>(d));
    ghosts[d].resize(images_.size());
  }
  fill_ghosts(
      axes * sizeof(double),
      [&](const Image& image, std::byte* to) {
        for (std::size_t d = 0; d < axes; ++d)
          std::memcpy(to + d * sizeof(double), x[d] + image.source, sizeof(double));
      },
      [&](std::size_t slot, const std::byte* come) {
        for (std::size_t d = 0; d < axes; ++d) std::memcpy(&ghosts[d][slot], come + d * sizeof(double), sizeof(double));
      });
}

/// What other ranks have asked for is what they get from now on when images are filled.
void CellGrid::answer(const std::vector<std::uint32_t>& asked, const std::vector<std::size_t>& asked_counts) {
  SharedCells& s = *shared_;
  s.sends.clear();
  s.send_counts.assign(asked_counts.size(), 0);
  std::size_t q = 0;
  for (std::size_t r = 0; r < asked_counts.size(); ++r)
    for (std::size_t k = 0; k < asked_counts[r]; ++k, ++q) {
      Image image{0, {0, 0, 0}};
      std::uint32_t source = asked[q];
      if (s.owner[source] < 0) {
        const HaloCell& halo = halo_cells_[halo_number(source)];
        source = halo.source;
        image.shift = halo.shift;
      }
      for (image.source = begin_[source]; image.source < end_[source]; ++image.source) s.sends.push_back(image);
      s.send_counts[r] += end_[source] - begin_[source];
    }
}

}  // namespace barchan
