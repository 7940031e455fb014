#include "models/grains/sphere_search.hpp"

#include <omp.h>

#include <algorithm>
#include <cmath>
#include <tuple>

namespace barchan {

namespace {

std::size_t stride_of(const SphereSet& s) { return s.dimensions == 2 ? SphereRecord<2>::size : SphereRecord<3>::size; }
std::size_t radius_of(const SphereSet& s) {
  return s.dimensions == 2 ? SphereRecord<2>::radius : SphereRecord<3>::radius;
}

constexpr double room_for_two = 2.1;  // of the largest sum of radii: on a shorter axis pairs say which images meet

/// Levels of spheres: of each class of sizes the level.
using Levels = std::array<std::uint8_t, SphereSizes::classes>;

/// What a search costs under these levels, in candidates of a dense packing. A row of cells costs as much as some
/// candidates, because they are looked at a vector at a time.
double cost_of(const SphereSizes& sizes, const Levels& level_of, std::size_t dimensions) {
  constexpr double row = 6.0, skin = 1.1;
  const auto dim = static_cast<double>(dimensions);
  std::array<double, SphereSizes::classes> count{}, moving{}, largest{};
  double room = 0.0;
  for (std::size_t c = SphereSizes::classes; c-- > 0;) {
    if (sizes.count[c] == 0) continue;
    const std::size_t m = level_of[c];
    count[m] += static_cast<double>(sizes.count[c]);
    moving[m] += static_cast<double>(sizes.moving[c]);
    largest[m] = sizes.largest[c];
    room += static_cast<double>(sizes.count[c]) * std::pow(sizes.largest[c], dim);
  }
  double cost = 0.0;
  for (std::size_t own = 0; own < SphereSizes::classes; ++own)
    for (std::size_t m = 0; m < SphereSizes::classes && moving[own] > 0.0; ++m) {
      if (count[m] == 0.0) continue;
      const double cell = skin * largest[m], wide = m <= own ? 3.0 * cell : skin * largest[own] + 2.0 * cell;
      cost += moving[own] * (row * std::pow(wide / cell, dim - 1.0) + count[m] / room * std::pow(wide, dim));
    }
  return cost;
}

}  // namespace

/// Each class that has spheres is a level of its own, unless it costs less to have it in one with the next larger one.
void SphereSearch::take_sizes(const SphereSizes& sizes) {
  sizes_ = sizes;
  const auto dimensions = static_cast<std::size_t>(bounds_.dimensions);
  Levels best{};
  std::size_t levels = 0;
  for (std::size_t c = 0; c < SphereSizes::classes; ++c) {
    levels += sizes.count[c] > 0 ? 1u : 0u;
    best[c] = static_cast<std::uint8_t>(std::max<std::size_t>(levels, 1) - 1);
  }
  for (std::size_t m = levels; m-- > 1;) {
    Levels joined = best;
    for (auto& level : joined)
      if (level >= m) --level;
    if (cost_of(sizes, joined, dimensions) > cost_of(sizes, best, dimensions)) continue;
    best = joined;
    --levels;
  }
  level_of_class_ = best;
  cells_.levels = std::max<std::size_t>(levels, 1);
  for (std::size_t c = SphereSizes::classes; c-- > 0;)
    if (sizes.count[c] > 0) cells_.of_level[best[c]].largest = sizes.largest[c];
  if (levels == 0) cells_.of_level[0].largest = reach_;
  double all = 0.0, inverse = 0.0;  // of those that move; over the diameter of the coarsest
  const double coarsest = cells_.of_level[0].largest;
  for (std::size_t c = 0; c < SphereSizes::classes; ++c) {
    const auto n = static_cast<double>(sizes.moving[c]);
    all += n;
    inverse += n * (coarsest / cells_.of_level[best[c]].largest);
  }
  scale_ = all > 0.0 ? coarsest * (all / inverse) : coarsest;
}

void SphereSearch::prepare(const Bounds& bounds, double reach, std::size_t kinds, std::vector<std::uint32_t> laws,
                           std::vector<Side> sides, std::size_t numbers_of_a_pair) {
  bounds_ = bounds;
  reach_ = reach;
  kinds_ = kinds;
  laws_ = std::move(laws);
  sides_ = std::move(sides);
  cells_.low = bounds.low;
  cells_.levels = 1;
  cells_.of_level[0].largest = scale_ = reach;
  level_of_class_ = {};
  sizes_ = SphereSizes(reach);
  cells_.kinds = kinds;
  cells_.laws = laws_.data();
  images_ = false;
  for (std::size_t d = 0; d < 3; ++d) {
    cells_.period[d] = bounds.periodic[d] ? bounds.high[d] - bounds.low[d] : 0.0;
    images_ = images_ || (bounds.periodic[d] && cells_.period[d] < room_for_two * reach);
  }
  narrowest_ = 1e300;
  for (const double period : cells_.period)
    if (images_ && period > 0.0) narrowest_ = std::min(narrowest_, period);
  memory_.prepare(numbers_of_a_pair, bounds.dimensions, cells_.period);
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

/// Cells of a level as wide as its search, or wider where they would be many more than its spheres.
void SphereSearch::divide(SphereLevel& level, std::size_t spheres, double slack) {
  double cell = level.largest + slack;
  for (;; cell *= 1.3) {
    std::size_t cells = 1;
    for (std::size_t d = 0; d < static_cast<std::size_t>(bounds_.dimensions); ++d) {
      const double size = bounds_.high[d] - bounds_.low[d];
      level.count[d] = static_cast<std::size_t>(std::clamp(std::floor(size / cell), 1.0, 1e6));
      level.inverse_cell[d] = static_cast<double>(level.count[d]) / size;
      cells *= level.count[d];
    }
    if (cells <= 8 * spheres + 4096) return;
  }
}

/// Sorts all spheres into the cells of their levels.
void SphereSearch::sort(const SphereSet& s, double slack) {
  const auto dimensions = static_cast<std::size_t>(s.dimensions);
  const std::size_t stride = stride_of(s), radius = radius_of(s);
  std::array<std::size_t, SphereCells::most_levels> spheres{s.all};
  if (cells_.levels > 1) {
    spheres[0] = 0;
    for (std::size_t c = 0; c < SphereSizes::classes; ++c) spheres[level_of_class_[c]] += sizes_.count[c];
  }
  std::size_t cells = 0;
  for (std::size_t m = 0; m < cells_.levels; ++m) {
    SphereLevel& level = cells_.of_level[m];
    divide(level, spheres[m], slack);
    level.first = cells;
    cells += level.count[0] * level.count[1] * level.count[2];
  }
  fit(cell_of_, s.all);
  fit(order_, s.all);
  fit(begin_, cells + 1);
  if (cells_.levels > 1) fit(level_, s.all);
  for (auto& sorted : sorted_) fit(sorted, s.all + SphereCells::padding);
  std::fill(begin_.begin(), begin_.end(), 0u);
  const auto n = static_cast<std::int64_t>(s.all);
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < n; ++i) {
    const auto k = static_cast<std::size_t>(i);
    std::size_t m = 0;
    if (cells_.levels > 1) {
      m = level_of_class_[sizes_.class_of(s.records[k * stride + radius])];
      level_[k] = static_cast<std::uint8_t>(m);
    }
    cell_of_[k] = static_cast<std::uint32_t>(cells_.cell(cells_.of_level[m], s.places + k * dimensions, dimensions));
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
  cells_.level = cells_.levels > 1 ? level_.data() : nullptr;
  cells_.begin = begin_.data();
  cells_.order = order_.data();
  for (std::size_t d = 0; d < 4; ++d) cells_.sorted[d] = sorted_[d].data();
}

/// Makes the groups of pairs of one image, from the place `at` of the list on: by law, those of the chunk alone before
/// those of two, those that touch before others. `next`: becomes where the pairs of each key begin. Returns the end.
std::uint32_t SphereSearch::add_groups(SphereChunk& chunk, std::span<const FoundPair> found, std::uint32_t at,
                                       Places& next) const {
  constexpr std::size_t batch = SphereChunk::batch;
  Places count{};
  for (const FoundPair& f : found) ++count[f.key];
  // A batch belongs to one law and one weight: pairs of the keys 2k and 2k + 1 stand together.
  for (std::uint32_t key = 0; key < most_keys; key += 2) {
    const std::uint32_t all = count[key] + count[key + 1];
    if (all == 0) continue;
    const auto batches = static_cast<std::uint32_t>((all + batch - 1) / batch);
    const auto first = at / static_cast<std::uint32_t>(batch);
    if (chunk.groups.capacity() == chunk.groups.size()) chunk.groups.reserve(2 * chunk.groups.size() + 8);
    chunk.groups.push_back({key / 4, first, first + batches, found.front().image, key % 4 == 0 ? 1.0 : 0.5});
    next[key] = at;
    next[key + 1] = at + count[key];
    at += batches * static_cast<std::uint32_t>(batch);
  }
  return at;
}

/// Calls f with the pairs of each image, which follow each other.
template <class F>
static void each_image_of(std::span<const FoundPair> found, F&& f) {
  for (std::size_t first = 0, end = 0; first < found.size(); first = end) {
    while (end < found.size() && found[end].image == found[first].image) ++end;
    f(found.subspan(first, end - first));
  }
}

/// Orders the pairs by image and law, and gives them their memory.
void SphereSearch::place(const SphereSet& s, SphereChunk& chunk, std::vector<FoundPair>& found) const {
  constexpr std::size_t batch = SphereChunk::batch;
  if (images_)
    std::sort(found.begin(), found.end(), [](const FoundPair& one, const FoundPair& other) {
      return std::tie(one.image, one.a, one.b) < std::tie(other.image, other.a, other.b);
    });
  Places next{};
  chunk.groups.clear();
  std::uint32_t end = 0;
  each_image_of(found, [&](std::span<const FoundPair> some) { end = add_groups(chunk, some, end, next); });
  const std::uint32_t far = static_cast<std::uint32_t>(s.all);
  fit(chunk.a, end);
  fit(chunk.b, end);
  std::fill(chunk.a.begin(), chunk.a.end(), far);
  std::fill(chunk.b.begin(), chunk.b.end(), far + 1);
  chunk.clear(end / batch, memory_.numbers());
  const std::size_t stride = stride_of(s);
  std::uint32_t at = 0;
  if (images_) chunk.groups.clear();
  each_image_of(found, [&](std::span<const FoundPair> some) {
    if (images_) at = add_groups(chunk, some, at, next);
    for (const FoundPair& f : some) {
      const std::uint32_t to = next[f.key]++;
      chunk.a[to] = f.a;
      chunk.b[to] = f.b;
      memory_.recall(chunk, to, s.numbers[f.a], s.numbers[f.b],
                     memory_.apart(s.records + f.a * stride, s.records + f.b * stride, f.image));
    }
  });
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
  SphereLevel level;
  double cell = scale_;
  std::size_t cells = 0;
  for (;; cell *= 1.3) {
    cells = 1;
    for (std::size_t d = 0; d < dimensions; ++d) {
      const double size = bounds_.high[d] - bounds_.low[d];
      level.count[d] = static_cast<std::size_t>(std::clamp(std::floor(size / cell), 1.0, 1e6));
      level.inverse_cell[d] = static_cast<double>(level.count[d]) / size;
      blocks[d] = (level.count[d] + side - 1) / side;
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
      const std::size_t c = cells_.coordinate(level, x[d][k], d);
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
