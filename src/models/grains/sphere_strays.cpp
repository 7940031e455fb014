#include "models/grains/sphere_strays.hpp"

#include <algorithm>
#include <cmath>

namespace barchan {

namespace {

constexpr std::uint32_t none = SphereCells::none;

/// Calls f with the place of each pair of the chunk that has the sphere.
template <class F>
void each_pair_of(const SphereChunk& chunk, std::uint32_t sphere, F&& f) {
  constexpr std::size_t block = 32;
  const std::uint32_t *a = chunk.a.data(), *b = chunk.b.data();
  const std::size_t n = chunk.a.size();
  for (std::size_t q = 0; q < n; q += block) {
    const std::size_t end = std::min(q + block, n);
    unsigned any = 0;
    if (end - q == block)
      for (std::size_t k = 0; k < block; ++k) any |= unsigned{a[q + k] == sphere} | unsigned{b[q + k] == sphere};
    else any = 1;
    for (std::size_t k = q; any != 0 && k < end; ++k)
      if (a[k] == sphere || b[k] == sphere) f(k);
  }
}

}  // namespace

void SphereStrays::prepare(const SphereSet& s, double reach, const std::vector<SphereChunk>& chunks,
                           std::size_t numbers_of_a_pair) {
  dimensions_ = static_cast<std::size_t>(s.dimensions);
  moving_ = s.moving;
  all_ = s.all;
  numbers_ = numbers_of_a_pair;
  stride_ = s.dimensions == 2 ? SphereRecord<2>::size : SphereRecord<3>::size;
  radius_ = s.dimensions == 2 ? SphereRecord<2>::radius : SphereRecord<3>::radius;
  reach_ = reach;
  chunk_.resize(moving_);
  for (std::size_t c = 0; c < chunks.size(); ++c)
    for (std::size_t k = chunks[c].begin; k < chunks[c].end; ++k) chunk_[k] = static_cast<std::uint32_t>(c);
  places_.assign(all_ * dimensions_, 0.0);
  tightness_.assign(moving_, 0.0f);
  allowance_.assign(moving_, 0.0);
  is_stray_.assign(all_, 0);
  next_.assign(moving_, none);
  head_.reserve(8 * all_ + 4096);
  near_.reserve(std::min<std::size_t>(all_, 4096));
  listed_.reserve(near_.capacity());
}

void SphereStrays::begin(const SphereSet& s, double slack) {
  least_ = 0.5 * slack;
  slow_ = 0;
  const auto n = static_cast<std::int64_t>(all_);
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < n; ++i) {
    const auto k = static_cast<std::size_t>(i);
    for (std::size_t d = 0; d < dimensions_; ++d) places_[k * dimensions_ + d] = s.records[k * stride_ + d];
  }
  std::fill(is_stray_.begin(), is_stray_.end(), std::uint8_t{0});
  std::fill(allowance_.begin(), allowance_.end(), least_);
  std::fill(tightness_.begin(), tightness_.end(), static_cast<float>(1.0 / (least_ * least_)));
}

void SphereStrays::take_cells(const SphereCells& cells) {
  cells_ = cells;
  head_.assign(cells.count[0] * cells.count[1] * cells.count[2], none);
  for (std::uint32_t k = 0; k < moving_; ++k)
    if (is_stray_[k]) enter(k);
}

std::size_t SphereStrays::cell_of(const double* x) const {
  std::size_t c = 0;
  for (std::size_t d = dimensions_; d-- > 0;) c = c * cells_.count[d] + cells_.coordinate(x[d], d);
  return c;
}

void SphereStrays::enter(std::uint32_t stray) {
  std::uint32_t& head = head_[cell_of(&places_[stray * dimensions_])];
  next_[stray] = head;
  head = stray;
}

void SphereStrays::leave(std::uint32_t stray) {
  std::uint32_t* at = &head_[cell_of(&places_[stray * dimensions_])];
  while (*at != stray) at = &next_[*at];
  *at = next_[stray];
}

/// Calls f with each cell that has a place within `radius` (m) of x.
template <class F>
void SphereStrays::each_cell(const double* x, double radius, F&& f) const {
  std::array<std::size_t, 3> low{0, 0, 0}, many{1, 1, 1};
  for (std::size_t d = 0; d < dimensions_; ++d) {
    const std::size_t n = cells_.count[d];
    const double period = cells_.period[d], at = x[d] - cells_.low[d],
                 from = period > 0.0 ? at - period * std::floor(at / period) : at;
    const double most = static_cast<double>(n) - 1.0, first = std::floor((from - radius) * cells_.inverse_cell[d]),
                 last = std::floor((from + radius) * cells_.inverse_cell[d]);
    if (period > 0.0) {
      if (!(last - first < most)) {
        many[d] = n;
        continue;
      }
      low[d] = static_cast<std::size_t>(first < 0.0 ? first + most + 1.0 : first);
      many[d] = static_cast<std::size_t>(last - first) + 1;
    } else {
      low[d] = static_cast<std::size_t>(std::clamp(first, 0.0, most));
      many[d] = static_cast<std::size_t>(std::clamp(last, 0.0, most)) - low[d] + 1;
    }
  }
  for (std::size_t dz = 0; dz < many[2]; ++dz)
    for (std::size_t dy = 0; dy < many[1]; ++dy) {
      const std::size_t row = (low[2] + dz) % cells_.count[2] * cells_.count[1] + (low[1] + dy) % cells_.count[1];
      for (std::size_t dx = 0; dx < many[0]; ++dx) f(row * cells_.count[0] + (low[0] + dx) % cells_.count[0]);
    }
}

/// Who may touch the stray before one of the two uses up its allowance, in the order of their places in memory.
void SphereStrays::look(const SphereSet& s, std::uint32_t stray) {
  constexpr double guard = 1.0 + 1e-6;  // of what rounding may hide
  const double *x = &places_[stray * dimensions_], own = allowance_[stray],
               radius = s.records[stray * stride_ + radius_];
  const std::uint32_t* laws = cells_.laws + s.kinds[stray] * cells_.kinds;
  near_.clear();
  const auto take = [&](std::uint32_t j, double allowance) {
    if (j == stray || laws[s.kinds[j]] == none) return;
    const double reach = radius + s.records[j * stride_ + radius_] + own + allowance;
    double r2 = 0.0;
    for (std::size_t d = 0; d < dimensions_; ++d) {
      double apart = x[d] - places_[j * dimensions_ + d];
      if (cells_.period[d] > 0.0) apart -= cells_.period[d] * std::round(apart / cells_.period[d]);
      r2 += apart * apart;
    }
    if (r2 < reach * reach) near_.push_back(j);
  };
  each_cell(x, guard * (reach_ + own + least_), [&](std::size_t c) {
    for (std::uint32_t q = cells_.begin[c]; q < cells_.begin[c + 1]; ++q)
      if (!is_stray_[cells_.order[q]]) take(cells_.order[q], least_);
  });
  each_cell(x, guard * (reach_ + own + std::max(least_, most_of_reach * reach_)), [&](std::size_t c) {
    for (std::uint32_t j = head_[c]; j != none; j = next_[j]) take(j, allowance_[j]);
  });
  std::sort(near_.begin(), near_.end());
  listed_.assign(near_.size(), 0);
}

void SphereStrays::renew(const SphereSet& s, std::uint32_t stray, double step,
                         std::span<const SphereSearch::Side> sides, std::span<SphereChunk> chunks,
                         SphereShares& shares) {
  const double* r = s.records + stray * stride_;
  sleep_ = s.asleep != nullptr;
  if (is_stray_[stray]) leave(stray);
  is_stray_[stray] = 1;
  double speed2 = 0.0;
  for (std::size_t d = 0; d < dimensions_; ++d) {
    places_[stray * dimensions_ + d] = r[d];
    speed2 += r[SphereRecord<2>::velocity + d] * r[SphereRecord<2>::velocity + d];
  }
  const double most = std::max(least_, most_of_reach * reach_),
               allowance = std::clamp(steps_ahead * step * std::sqrt(speed2), least_, most);
  allowance_[stray] = allowance;
  tightness_[stray] = static_cast<float>(1.0 / (allowance * allowance));
  if (allowance == least_) ++slow_;
  enter(stray);
  look(s, stray);
  drop_others(stray, chunks, shares);
  add_new(s, stray, chunks, shares);
  if (shares.has(stray)) add_sides(s, stray, sides, chunks[chunk_[stray]]);
}

/// Adds the pairs that the lists do not have.
void SphereStrays::add_new(const SphereSet& s, std::uint32_t stray, std::span<SphereChunk> chunks,
                           SphereShares& shares) const {
  const bool own = shares.has(stray);
  for (std::size_t n = 0; n < near_.size(); ++n) {
    const std::uint32_t j = near_[n];
    if (listed_[n]) continue;
    const bool first = s.numbers[stray] < s.numbers[j], alone = j >= moving_ || chunk_[j] == chunk_[stray];
    const std::uint32_t a = first ? stray : j, b = first ? j : stray,
                        law = cells_.laws[s.kinds[stray] * cells_.kinds + s.kinds[j]];
    if (own) add(chunks[chunk_[stray]], a, b, law, alone ? 1.0 : 0.5);
    if (j >= moving_) continue;
    if (!shares.has(j)) {
      if (own) shares.meet(stray, j, chunk_[stray]);
      continue;
    }
    SphereChunk& other = chunks[chunk_[j]];
    if (!alone) add(other, a, b, law, 0.5);
    if (!own) shares.meet(j, stray, chunk_[j]);
    if (!s.asleep || !s.asleep[j]) continue;
    const auto at = std::lower_bound(other.border.begin(), other.border.end(), j);
    if (at == other.border.end() || *at != j) other.border.insert(at, j);
  }
}

/// Marks the pairs that the lists have, and takes those away that are out of reach.
void SphereStrays::drop_others(std::uint32_t stray, std::span<SphereChunk> chunks, const SphereShares& shares) {
  const auto look_at = [&](SphereChunk& chunk, auto&& out_of_reach) {
    each_pair_of(chunk, stray, [&](std::size_t pair) {
      const std::uint32_t j = chunk.a[pair] == stray ? chunk.b[pair] : chunk.a[pair];
      const auto at = std::lower_bound(near_.begin(), near_.end(), j);
      if (at != near_.end() && *at == j) {
        listed_[static_cast<std::size_t>(at - near_.begin())] = 1;
        return;
      }
      if (chunk.touching(pair)) return;
      drop(chunk, pair);
      out_of_reach(j);
    });
  };
  if (!shares.has(stray)) {
    shares.each_chunk_with(stray, [&](std::size_t c) { look_at(chunks[c], [](std::uint32_t) {}); });
    return;
  }
  look_at(chunks[chunk_[stray]], [&](std::uint32_t j) {
    if (j >= moving_ || chunk_[j] == chunk_[stray] || !shares.has(j)) return;
    SphereChunk& other = chunks[chunk_[j]];
    each_pair_of(other, stray, [&](std::size_t same) {
      if (other.a[same] == j || other.b[same] == j) drop(other, same);
    });
  });
}

void SphereStrays::drop(SphereChunk& chunk, std::size_t pair) const {
  chunk.a[pair] = static_cast<std::uint32_t>(all_);
  chunk.b[pair] = static_cast<std::uint32_t>(all_) + 1;
}

/// Puts a pair that does not touch yet where a batch of its law has room, or into a new one.
void SphereStrays::add(SphereChunk& chunk, std::uint32_t a, std::uint32_t b, std::uint32_t law, double weight) const {
  constexpr std::size_t batch = SphereChunk::batch;
  const auto far = static_cast<std::uint32_t>(all_);
  for (std::size_t g = chunk.groups.size(); g-- > 0;) {
    const SphereChunk::Group& group = chunk.groups[g];
    if (group.law != law || group.weight != weight) continue;
    for (std::size_t q = group.end; q-- > group.first;) {
      const std::uint32_t* at = chunk.a.data() + q * batch;
      unsigned room = 0;
      for (std::size_t k = 0; k < batch; ++k) room |= unsigned{at[k] == far} << k;
      if (room == 0) continue;
      const std::size_t pair = q * batch + static_cast<std::size_t>(__builtin_ctz(room));
      chunk.a[pair] = a;
      chunk.b[pair] = b;
      evaluate(chunk, pair);
      return;
    }
  }
  const std::size_t batches = chunk.touches.size();
  chunk.a.resize((batches + more_batches) * batch, far);
  chunk.b.resize((batches + more_batches) * batch, far + 1);
  chunk.grow(more_batches, numbers_);
  if (sleep_) chunk.live.resize(batches + more_batches, 0);
  const auto first = static_cast<std::uint32_t>(batches), end = static_cast<std::uint32_t>(batches + more_batches);
  if (!chunk.groups.empty() && chunk.groups.back().law == law && chunk.groups.back().weight == weight)
    chunk.groups.back().end = end;
  else chunk.groups.push_back({law, first, end, 0, weight});
  chunk.a[batches * batch] = a;
  chunk.b[batches * batch] = b;
  evaluate(chunk, batches * batch);
}

/// A stray is awake: its pairs are evaluated.
void SphereStrays::evaluate(SphereChunk& chunk, std::size_t pair) const {
  constexpr std::size_t batch = SphereChunk::batch;
  if (!sleep_) return;
  chunk.any_live = true;
  chunk.live[pair / batch] = static_cast<std::uint8_t>(chunk.live[pair / batch] | 1u << pair % batch);
}

void SphereStrays::add_sides(const SphereSet& s, std::uint32_t stray, std::span<const SphereSearch::Side> sides,
                             SphereChunk& chunk) const {
  const double* r = s.records + stray * stride_;
  for (const SphereSearch::Side& side : sides) {
    const std::uint32_t law = cells_.laws[s.kinds[stray] * cells_.kinds + side.kind];
    if (law == none || !(side.sign * (r[side.axis] - side.place) < r[radius_] + allowance_[stray])) continue;
    const bool there = std::any_of(chunk.sides.begin(), chunk.sides.end(), [&](const auto& at) {
      return at.sphere == stray && at.axis == side.axis && at.sign == side.sign;
    });
    if (there) continue;
    SphereChunk::AtSide& at = chunk.sides.emplace_back();
    at.sphere = stray;
    at.law = law;
    at.axis = side.axis;
    at.sign = side.sign;
    at.place = side.place;
  }
}

void SphereStrays::archive(Archive& a) {
  a.number("allowance", least_);
  a.number("slow strays", slow_);
  a.array("places of spheres", places_);
  a.array("allowances", allowance_);
  a.array("tightness", tightness_);
  a.array("strays", is_stray_);
}

}  // namespace barchan
