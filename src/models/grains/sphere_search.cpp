#include "models/grains/sphere_search.hpp"

#include <omp.h>

#include <algorithm>
#include <cmath>

namespace barchan {

namespace {

std::size_t stride_of(const SphereSet& s) { return s.dimensions == 2 ? SphereRecord<2>::size : SphereRecord<3>::size; }
std::size_t radius_of(const SphereSet& s) {
  return s.dimensions == 2 ? SphereRecord<2>::radius : SphereRecord<3>::radius;
}

constexpr std::size_t most_keys = 256;  // four a law

}  // namespace

void SphereSearch::prepare(const Bounds& bounds, double reach, std::size_t kinds, std::vector<std::uint32_t> laws,
                           std::vector<Side> sides, std::size_t numbers_of_a_pair) {
  bounds_ = bounds;
  reach_ = reach;
  kinds_ = kinds;
  laws_ = std::move(laws);
  sides_ = std::move(sides);
  memory_.prepare(numbers_of_a_pair);
  cells_.low = bounds.low;
  cells_.kinds = kinds;
  cells_.laws = laws_.data();
  for (std::size_t d = 0; d < 3; ++d) cells_.period[d] = bounds.periodic[d] ? bounds.high[d] - bounds.low[d] : 0.0;
  make_room_for_threads();
}

/// The number of threads may change between two searches.
void SphereSearch::make_room_for_threads() {
  const auto threads = static_cast<std::size_t>(std::max(omp_get_max_threads(), omp_get_num_procs()));
  const std::size_t pairs = bounds_.dimensions == 2 ? 6 : 11;  // of a sphere, of two in different chunks both
  while (found_.size() < threads) found_.emplace_back().reserve(pairs * SphereChunk::most + 64);
}

void SphereSearch::reserve(std::size_t all, std::span<SphereChunk> chunks, bool sleep) {
  constexpr std::size_t batch = SphereChunk::batch;
  const std::size_t pairs = bounds_.dimensions == 2 ? 6 : 11;  // of a sphere, of two in different chunks both
  for (SphereChunk& chunk : chunks) {
    const std::size_t spheres = chunk.end - chunk.begin, room = pairs * spheres + 64;
    chunk.a.reserve(room);
    chunk.b.reserve(room);
    chunk.reserve(room / batch + 1, memory_.numbers());
    chunk.groups.reserve(2 * kinds_ * kinds_ + 2);
    if (!sides_.empty()) chunk.sides.reserve(spheres);
    if (!sleep) continue;
    chunk.live.reserve(room / batch + 1);
    chunk.awake.reserve(spheres);
    chunk.border.reserve(spheres);
  }
  for (auto& sorted : sorted_) sorted.reserve(all + SphereCells::padding);
  memory_.reserve(pairs * all / 2 + 64);
  begin_.reserve(8 * all + 65536 + 1);
  cell_of_.reserve(all);
  order_.reserve(all);
}

/// Sorts all spheres into cells as wide as a search.
void SphereSearch::sort(const SphereSet& s, double slack) {
  const auto dimensions = static_cast<std::size_t>(s.dimensions);
  double cell = reach_ + slack;
  std::size_t cells = 0;
  for (;; cell *= 1.3) {
    cells = 1;
    for (std::size_t d = 0; d < dimensions; ++d) {
      const double size = bounds_.high[d] - bounds_.low[d];
      cells_.count[d] = static_cast<std::size_t>(std::clamp(std::floor(size / cell), 1.0, 1e6));
      cells_.inverse_cell[d] = static_cast<double>(cells_.count[d]) / size;
      cells *= cells_.count[d];
    }
    if (cells <= 8 * s.all + 4096) break;
  }
  const std::size_t stride = stride_of(s), radius = radius_of(s);
  fit(cell_of_, s.all);
  fit(order_, s.all);
  fit(begin_, cells + 1);
  for (auto& sorted : sorted_) fit(sorted, s.all + SphereCells::padding);
  std::fill(begin_.begin(), begin_.end(), 0u);
  const auto n = static_cast<std::int64_t>(s.all);
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < n; ++i) {
    const auto k = static_cast<std::size_t>(i);
    std::size_t c = 0;
    for (std::size_t d = dimensions; d-- > 0;)
      c = c * cells_.count[d] + cells_.coordinate(s.places[k * dimensions + d], d);
    cell_of_[k] = static_cast<std::uint32_t>(c);
  }
  for (std::size_t k = 0; k < s.all; ++k) ++begin_[cell_of_[k] + 1];
  for (std::size_t c = 0; c < cells; ++c) begin_[c + 1] += begin_[c];
  for (std::size_t k = 0; k < s.all; ++k) {
    const std::size_t at = begin_[cell_of_[k]]++;
    order_[at] = static_cast<std::uint32_t>(k);
    for (std::size_t d = 0; d < dimensions; ++d) sorted_[d][at] = s.places[k * dimensions + d];
    sorted_[3][at] = s.records[k * stride + radius];
  }
  for (std::size_t c = cells; c > 0; --c) begin_[c] = begin_[c - 1];
  begin_[0] = 0;
  cells_.begin = begin_.data();
  cells_.order = order_.data();
  for (std::size_t d = 0; d < 4; ++d) cells_.sorted[d] = sorted_[d].data();
}

/// Orders the pairs by law, those of the chunk alone before those of two, those that touch before others, and gives
/// them their memory.
void SphereSearch::place(const SphereSet& s, SphereChunk& chunk, const std::vector<FoundPair>& found) const {
  constexpr std::size_t batch = SphereChunk::batch;
  std::array<std::uint32_t, most_keys> count{}, next{};
  for (const FoundPair& f : found) ++count[f.key];
  // A batch belongs to one law and one weight: pairs of the keys 2k and 2k + 1 stand together.
  chunk.groups.clear();
  std::uint32_t at = 0;
  for (std::uint32_t key = 0; key < most_keys; key += 2) {
    const std::uint32_t all = count[key] + count[key + 1];
    if (all == 0) continue;
    const auto batches = static_cast<std::uint32_t>((all + batch - 1) / batch);
    const auto first = at / static_cast<std::uint32_t>(batch);
    if (chunk.groups.capacity() == chunk.groups.size()) chunk.groups.reserve(2 * chunk.groups.size() + 8);
    chunk.groups.push_back({key / 4, first, first + batches, 0, key % 4 == 0 ? 1.0 : 0.5});
    next[key] = at;
    next[key + 1] = at + count[key];
    at += batches * static_cast<std::uint32_t>(batch);
  }
  const std::uint32_t far = static_cast<std::uint32_t>(s.all);
  fit(chunk.a, at);
  fit(chunk.b, at);
  std::fill(chunk.a.begin(), chunk.a.end(), far);
  std::fill(chunk.b.begin(), chunk.b.end(), far + 1);
  chunk.clear(at / batch, memory_.numbers());
  for (const FoundPair& f : found) {
    const std::uint32_t to = next[f.key]++;
    chunk.a[to] = f.a;
    chunk.b[to] = f.b;
    memory_.recall(chunk, to, s.numbers[f.a], s.numbers[f.b]);
  }
}

void SphereSearch::place_sides(const SphereSet& s, double slack, SphereChunk& chunk) const {
  const std::size_t stride = stride_of(s), radius = radius_of(s);
  chunk.sides.clear();
  for (std::size_t k = chunk.begin; k < chunk.end; ++k)
    for (const Side& side : sides_) {
      const double* r = s.records + k * stride;
      const std::uint32_t law = laws_[s.kinds[k] * kinds_ + side.kind];
      if (law == none || !(side.sign * (r[side.axis] - side.place) < r[radius] + slack)) continue;
      if (chunk.sides.capacity() == chunk.sides.size()) chunk.sides.reserve(2 * chunk.sides.size() + 64);
      SphereChunk::AtSide& at = chunk.sides.emplace_back();
      at.sphere = static_cast<std::uint32_t>(k);
      at.law = law;
      at.axis = side.axis;
      at.sign = side.sign;
      at.place = side.place;
      if (const double* memory = memory_.find(s.numbers[k], ContactMemory::side(side.axis, side.sign))) {
        std::copy_n(memory, memory_.numbers(), at.memory);
        at.touches = 1;
      }
    }
}

void SphereSearch::find(const SphereSet& s, double slack, std::span<SphereChunk> chunks) {
  sort(s, slack);
  make_room_for_threads();
  const auto n = static_cast<std::int64_t>(chunks.size());
#pragma omp parallel for schedule(dynamic, 1)
  for (std::int64_t c = 0; c < n; ++c) {
    SphereChunk& chunk = chunks[static_cast<std::size_t>(c)];
    std::vector<FoundPair>& found = found_[static_cast<std::size_t>(omp_get_thread_num())];
    find_sphere_pairs(cells_, s, slack, chunk, found);
    place(s, chunk, found);
    place_sides(s, slack, chunk);
  }
}

void SphereSearch::order(const std::array<const double*, 3>& x, const std::vector<std::int64_t>& id,
                         std::vector<std::uint32_t>& order) {
  const std::size_t count = id.size();
  // Blocks of about a chunk: 22 x 22 or 8 x 8 x 8 cells of a sphere each.
  const bool flat = bounds_.dimensions == 2;
  const std::size_t side = flat ? 22 : 8;
  const auto dimensions = static_cast<std::size_t>(bounds_.dimensions);
  std::array<std::size_t, 3> blocks{1, 1, 1};
  double cell = reach_;
  std::size_t cells = 0;
  for (;; cell *= 1.3) {
    cells = 1;
    for (std::size_t d = 0; d < dimensions; ++d) {
      const double size = bounds_.high[d] - bounds_.low[d];
      cells_.count[d] = static_cast<std::size_t>(std::clamp(std::floor(size / cell), 1.0, 1e6));
      cells_.inverse_cell[d] = static_cast<double>(cells_.count[d]) / size;
      blocks[d] = (cells_.count[d] + side - 1) / side;
      cells *= blocks[d] * side;
    }
    if (cells <= 8 * count + 65536) break;
  }
  fit(cell_of_, count);
  fit(begin_, cells + 1);
  fit(order, count);
  std::fill(begin_.begin(), begin_.end(), 0u);
  for (std::size_t k = 0; k < count; ++k) {
    std::size_t block = 0, within = 0;
    for (std::size_t d = dimensions; d-- > 0;) {
      const std::size_t c = cells_.coordinate(x[d][k], d);
      block = block * blocks[d] + c / side;
      within = within * side + c % side;
    }
    cell_of_[k] = static_cast<std::uint32_t>(block * (flat ? side * side : side * side * side) + within);
    ++begin_[cell_of_[k] + 1];
  }
  for (std::size_t c = 0; c < cells; ++c) begin_[c + 1] += begin_[c];
  for (std::size_t k = 0; k < count; ++k) order[begin_[cell_of_[k]]++] = static_cast<std::uint32_t>(k);
  const auto before = [&id](std::uint32_t a, std::uint32_t b) { return id[a] < id[b]; };
  for (std::size_t c = 0, first = 0; c < cells; first = begin_[c++])
    if (begin_[c] - first > 1)
      std::sort(order.begin() + static_cast<std::ptrdiff_t>(first),
                order.begin() + static_cast<std::ptrdiff_t>(begin_[c]), before);
}

}  // namespace barchan
