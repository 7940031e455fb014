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

/// Of the pair at that place of a list.
std::uint32_t image_of(const SphereChunk& chunk, std::size_t pair) {
  for (const SphereChunk::Group& group : chunk.groups)
    if (pair < group.end * SphereChunk::batch) return group.image;
  return pair_image::nearest;
}

}  // namespace

void SphereStrays::prepare(const SphereSet& s, double reach, const std::vector<SphereChunk>& chunks,
                           std::size_t numbers_of_a_pair, double narrowest) {
  dimensions_ = static_cast<std::size_t>(s.dimensions);
  moving_ = s.moving;
  all_ = s.all;
  numbers_ = numbers_of_a_pair;
  stride_ = s.dimensions == 2 ? SphereRecord<2>::size : SphereRecord<3>::size;
  radius_ = s.dimensions == 2 ? SphereRecord<2>::radius : SphereRecord<3>::radius;
  reach_ = reach;
  most_ = std::min(most_of_reach * reach, narrowest / 8.0);
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
  widest_.fill(0.0);
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
  const SphereLevel& last = cells.of_level[cells.levels - 1];
  head_.assign(last.first + last.count[0] * last.count[1] * last.count[2], none);
  widest_.fill(0.0);
  for (std::uint32_t k = 0; k < moving_; ++k)
    if (is_stray_[k]) enter(k);
}

void SphereStrays::enter(std::uint32_t stray) {
  std::uint32_t& head = head_[cell_of(stray)];
  next_[stray] = head;
  head = stray;
  double& widest = widest_[cells_.level_of(stray)];
  widest = std::max(widest, allowance_[stray]);
}

void SphereStrays::leave(std::uint32_t stray) {
  std::uint32_t* at = &head_[cell_of(stray)];
  while (*at != stray) at = &next_[*at];
  *at = next_[stray];
}

/// Who may touch the stray before one of the two uses up its allowance, in the order of their places in memory.
template <std::size_t Dim>
void SphereStrays::look(const SphereSet& s, std::uint32_t stray) {
  constexpr double guard = 1.0 + 1e-6;  // of what rounding may hide
  const double *x = &places_[stray * Dim], own = allowance_[stray], radius = s.records[stray * stride_ + radius_];
  const std::uint32_t* laws = cells_.laws + s.kinds[stray] * cells_.kinds;
  near_.clear();
  const auto take = [&](std::uint32_t j, double allowance) {
    if (j == stray || laws[s.kinds[j]] == none) return;
    const double reach = radius + s.records[j * stride_ + radius_] + own + allowance;
    if (s.images) {
      const bool first = s.numbers[stray] < s.numbers[j];
      const double* const other = &places_[j * Dim];
      each_image<Dim>(first ? x : other, first ? other : x, cells_.period, reach, [&](std::uint32_t image, double) {
        near_.push_back({j, image});
      });
      return;
    }
    double r2 = 0.0;
    for (std::size_t d = 0; d < Dim; ++d) {
      double apart = x[d] - places_[j * Dim + d];
      if (cells_.period[d] > 0.0) apart -= cells_.period[d] * std::round(apart / cells_.period[d]);
      r2 += apart * apart;
    }
    if (r2 < reach * reach) near_.push_back({j, pair_image::nearest});
  };
  for (std::size_t m = 0; m < cells_.levels; ++m) {
    const SphereLevel& level = cells_.of_level[m];
    const double touch = m == 0 ? reach_ : radius + 0.5 * level.largest;  // walls may be larger than the reach
    cells_.each_run<Dim>(level, x, guard * (touch + own + least_), [&](std::size_t first, std::size_t end) {
      for (std::uint32_t q = cells_.begin[first]; q < cells_.begin[end]; ++q)
        if (!is_stray_[cells_.order[q]]) take(cells_.order[q], least_);
    });
    if (!(widest_[m] > 0.0)) continue;
    cells_.each_run<Dim>(level, x, guard * (touch + own + widest_[m]), [&](std::size_t first, std::size_t end) {
      for (std::size_t c = first; c < end; ++c)
        for (std::uint32_t j = head_[c]; j != none; j = next_[j]) take(j, allowance_[j]);
    });
  }
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
  const double most = std::max(least_, most_),
               allowance = std::clamp(steps_ahead * step * std::sqrt(speed2), least_, most);
  allowance_[stray] = allowance;
  tightness_[stray] = static_cast<float>(1.0 / (allowance * allowance));
  if (allowance == least_) ++slow_;
  enter(stray);
  dimensions_ == 2 ? look<2>(s, stray) : look<3>(s, stray);
  drop_others(stray, chunks, shares);
  add_new(s, stray, chunks, shares);
  if (shares.has(stray)) add_sides(s, stray, sides, chunks[chunk_[stray]]);
}

/// Adds the pairs that the lists do not have.
void SphereStrays::add_new(const SphereSet& s, std::uint32_t stray, std::span<SphereChunk> chunks,
                           SphereShares& shares) const {
  const bool own = shares.has(stray);
  for (std::size_t n = 0; n < near_.size(); ++n) {
    const std::uint32_t j = near_[n].sphere;
    if (listed_[n]) continue;
    const bool first = s.numbers[stray] < s.numbers[j], alone = j >= moving_ || chunk_[j] == chunk_[stray];
    const NewPair pair{first ? stray : j, first ? j : stray, cells_.laws[s.kinds[stray] * cells_.kinds + s.kinds[j]],
                       near_[n].image, alone ? 1.0 : 0.5};
    if (own) add(chunks[chunk_[stray]], pair);
    if (j >= moving_) continue;
    if (!shares.has(j)) {
      if (own) shares.meet(stray, j, chunk_[stray]);
      continue;
    }
    SphereChunk& other = chunks[chunk_[j]];
    if (!alone) add(other, pair);
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
      const Partner partner{chunk.a[pair] == stray ? chunk.b[pair] : chunk.a[pair], image_of(chunk, pair)};
      const auto at = std::lower_bound(near_.begin(), near_.end(), partner);
      if (at != near_.end() && *at == partner) {
        listed_[static_cast<std::size_t>(at - near_.begin())] = 1;
        return;
      }
      if (chunk.touching(pair)) return;
      drop(chunk, pair);
      out_of_reach(partner);
    });
  };
  if (!shares.has(stray)) {
    shares.each_chunk_with(stray, [&](std::size_t c) { look_at(chunks[c], [](Partner) {}); });
    return;
  }
  look_at(chunks[chunk_[stray]], [&](Partner p) {
    if (p.sphere >= moving_ || chunk_[p.sphere] == chunk_[stray] || !shares.has(p.sphere)) return;
    SphereChunk& other = chunks[chunk_[p.sphere]];
    each_pair_of(other, stray, [&](std::size_t same) {
      if ((other.a[same] == p.sphere || other.b[same] == p.sphere) && image_of(other, same) == p.image)
        drop(other, same);
    });
  });
}

void SphereStrays::drop(SphereChunk& chunk, std::size_t pair) const {
  chunk.a[pair] = static_cast<std::uint32_t>(all_);
  chunk.b[pair] = static_cast<std::uint32_t>(all_) + 1;
}

/// Puts a pair that does not touch yet where a batch of its law has room, or into a new one.
void SphereStrays::add(SphereChunk& chunk, const NewPair& p) const {
  constexpr std::size_t batch = SphereChunk::batch;
  const auto far = static_cast<std::uint32_t>(all_);
  for (std::size_t g = chunk.groups.size(); g-- > 0;) {
    const SphereChunk::Group& group = chunk.groups[g];
    if (group.law != p.law || group.weight != p.weight || group.image != p.image) continue;
    for (std::size_t q = group.end; q-- > group.first;) {
      const std::uint32_t* at = chunk.a.data() + q * batch;
      unsigned room = 0;
      for (std::size_t k = 0; k < batch; ++k) room |= unsigned{at[k] == far} << k;
      if (room == 0) continue;
      const std::size_t pair = q * batch + static_cast<std::size_t>(__builtin_ctz(room));
      chunk.a[pair] = p.a;
      chunk.b[pair] = p.b;
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
  if (!chunk.groups.empty() && chunk.groups.back().law == p.law && chunk.groups.back().weight == p.weight &&
      chunk.groups.back().image == p.image)
    chunk.groups.back().end = end;
  else chunk.groups.push_back({p.law, first, end, p.image, p.weight});
  chunk.a[batches * batch] = p.a;
  chunk.b[batches * batch] = p.b;
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
