// Who the spheres are: their lasting numbers, and what has a place for each of them. Spheres are made and removed
// between two steps by whoever does (PhaseParticles::create, remove_if); what was remembered of those that stay goes
// with them.
#include <algorithm>
#include <atomic>

#include "engine/exchange.hpp"
#include "models/grains/spheres.hpp"

namespace barchan {

namespace {

constexpr std::uint8_t asks = 1, done = 2;  // a chunk to be sorted out, and one that is

}  // namespace

/// Ids of the particles that are there, phase after phase, in their order; the parts become as large.
std::vector<std::int64_t> Spheres::present_ids() {
  std::vector<std::int64_t> ids;
  for (Part& part : parts_) {
    const PhaseParticles& p = w_->particles(part.phase);
    part.first = ids.size();
    part.count = p.size();
    part.changes = p.changes();
    ids.insert(ids.end(), p.id().begin(), p.id().end());
    std::sort(ids.begin() + static_cast<std::ptrdiff_t>(part.first), ids.end());
  }
  moving_ = ids.size();
  return ids;
}

/// Whether particles were made or removed since the last step of contacts.
bool Spheres::others_are_there() const {
  return std::any_of(parts_.begin(), parts_.end(),
                     [&](const Part& part) { return w_->particles(part.phase).changes() != part.changes; });
}

/// Lasting numbers of the spheres, by their present places: phase after phase in the order of ids.
void Spheres::number() {
  for (const Part& part : parts_) {
    if (part.count == 0) continue;
    const auto& id = w_->particles(part.phase).id();
    const auto begin = ids_.begin() + static_cast<std::ptrdiff_t>(part.first),
               end = begin + static_cast<std::ptrdiff_t>(part.count);
    const bool gaps = *(end - 1) - *begin + 1 != static_cast<std::int64_t>(part.count);
    for (std::size_t k = 0; k < part.count; ++k) {
      const auto n = gaps ? std::lower_bound(begin, end, id[k]) - begin : id[k] - *begin;
      numbers_[part.first + k] = static_cast<std::uint32_t>(part.first + static_cast<std::size_t>(n));
    }
  }
}

/// Takes over the particles that are there now.
void Spheres::renumber() {
  keep_memory(true);
  const std::vector<Part> before = parts_;
  const std::size_t moved = moving_, fixed = fixed_kind_.size();
  const std::vector<std::int64_t> old = std::move(ids_);
  ids_ = present_ids();
  std::vector<std::uint32_t> to(moved + fixed, ContactMemory::gone);
  for (std::size_t q = 0; q < parts_.size(); ++q) {
    std::size_t now = parts_[q].first;
    const std::size_t end = now + parts_[q].count;
    for (std::size_t n = before[q].first; n < before[q].first + before[q].count; ++n) {
      while (now < end && ids_[now] < old[n]) ++now;
      if (now < end && ids_[now] == old[n]) to[n] = static_cast<std::uint32_t>(now);
    }
  }
  for (std::size_t k = 0; k < fixed; ++k) to[moved + k] = static_cast<std::uint32_t>(moving_ + k);
  std::vector<std::uint32_t> left_alone;
  search_.renumber(to, all(), left_alone);
  if (shares_.on()) Exchange().join(left_alone);
  rest_.renumber(to);
  const std::size_t slept = sleep_.sleeping();
  sleep_.renumber(to, moving_);
  sleep_.wake(left_alone);
  others_sleep_ = others_sleep_ || sleep_.sleeping() != slept;
  make_room();
  must_search_ = kept_memory_ = true;
}

/// Others sleep than before: the chunks that this concerns, or all, learn it.
void Spheres::sort_out_sleepers(bool all) {
  sleep_.mark(numbers_.data());
  sorted_out_.assign(chunks_.size(), all ? asks : std::uint8_t{0});
  for (std::size_t c = 0; c < chunks_.size() && !all; ++c)
    for (std::size_t k = chunks_[c].begin; k < chunks_[c].end && sorted_out_[c] == 0; ++k)
      if (sleep_.changed(k)) sorted_out_[c] = asks;
  sort_out_chunks();
}

/// Those woke and nobody fell asleep.
void Spheres::sort_out_woken(std::span<const std::uint32_t> woken) {
  sleep_.mark_woken();
  sorted_out_.assign(chunks_.size(), std::uint8_t{0});
  for (const std::uint32_t k : woken) sorted_out_[strays_.chunk_of(k)] = asks;
  sort_out_chunks();
}

/// The chunks that ask, and those that hold partners of their spheres that changed. Each writes what is its own.
void Spheres::sort_out_chunks() {
  const SphereSet s = set();
  const auto n = static_cast<std::int64_t>(own_chunks().size());
  for (bool more = true; more;) {
    more = false;
#pragma omp parallel for schedule(static) reduction(|| : more)
    for (std::int64_t i = 0; i < n; ++i) {
      const std::size_t c = shares_.first_chunk() + static_cast<std::size_t>(i);
      const auto flag = [this](std::size_t chunk) { return std::atomic_ref(sorted_out_[chunk]); };
      if (flag(c).load(std::memory_order_relaxed) != asks) continue;
      flag(c).store(done, std::memory_order_relaxed);
      sleep_.sort_out(s, chunks_[c], [&](std::uint32_t k) {
        std::uint8_t untouched = 0;
        if (flag(strays_.chunk_of(k)).compare_exchange_strong(untouched, asks, std::memory_order_relaxed)) more = true;
      });
    }
    share_flags(more);
  }
  sleep_.settled();
  others_sleep_ = false;
}

std::vector<SphereSleep::Part> Spheres::parts_that_may_sleep() const {
  std::vector<SphereSleep::Part> parts;
  for (const Part& part : parts_)
    if (scene_.phases[part.phase].grains().sleep)
      parts.push_back({part.phase, part.first, part.count, 2.0 * part.mean_radius});
  return parts;
}

/// Of all spheres.
SphereSizes Spheres::sizes() const {
  SphereSizes sizes(laws_.reach());
  for (const Part& part : parts_) {
    const PhaseParticles& p = w_->particles(part.phase);
    const double* radius = p.has(Field::radius) ? p.column(Field::radius) : nullptr;
    for (std::size_t k = 0; k < p.size(); ++k) sizes.add(radius ? radius[k] : part.mean_radius, true);
  }
  for (std::size_t k = 0; k < fixed_kind_.size(); ++k) sizes.add(fixed_[4 * k + 3], false);
  return sizes;
}

/// Gives everything by sphere the sizes of the parts; the fixed spheres stand behind them.
void Spheres::make_room() {
  fit(numbers_, all());
  fit(kinds_, all());
  fit(passive_, (all() + 2) * passive_size);
  std::fill(passive_.begin(), passive_.end(), 0.0);
  std::size_t chunk = 0;
  for (const Part& part : parts_) {
    std::fill_n(kinds_.begin() + static_cast<std::ptrdiff_t>(part.first), part.count,
                static_cast<std::uint8_t>(part.phase));
    for (std::size_t from = 0; from < part.count; from += SphereChunk::most, ++chunk) {
      if (chunk == chunks_.size()) chunks_.emplace_back();
      SphereChunk& c = chunks_[chunk];
      c.begin = part.first + from;
      c.end = part.first + std::min(from + SphereChunk::most, part.count);
      c.phase = part.phase;
      c.pushed.assign(watched_.size(), {});
      c.gone.reserve(SphereChunk::most);
    }
  }
  chunks_.resize(chunk);
  divide();
  for (std::size_t k = moving_; k < all(); ++k) {
    kinds_[k] = fixed_kind_[k - moving_];
    numbers_[k] = static_cast<std::uint32_t>(k);
  }
  layout_.dimensions == 2 ? make_records<2>() : make_records<3>();
  sleep_.make_room(parts_that_may_sleep(), moving_, all());
  for (const SphereWall& wall : walls_) sleep_.keep_awake(moving_ + wall.first, wall.count);
  search_.take_sizes(sizes());
  search_.reserve(all(), own_chunks(), sleep_.on());
  strays_.prepare(set(), laws_.reach(), chunks_, step_.numbers, search_.narrowest());
  step_.tightness = strays_.tightness();
  gone_.reserve(moving_);
}

/// Where the middle of each chunk's work stands in that of all: each thread takes chunks side by side, so that they
/// stay in its core's cache, and about as much work as the others.
void Spheres::share_out() {
  constexpr double touching = 36.0, near = 10.0;  // a batch, against a sphere that moves
  const std::span<const SphereChunk> chunks = own_chunks();
  middles_.resize(chunks.size());
  double all = 0.0;
  for (std::size_t c = 0; c < chunks.size(); ++c) {
    const SphereChunk& chunk = chunks[c];
    std::size_t touch = 0, live = 0;
    for (std::size_t q = 0; q < chunk.touches.size(); ++q) {
      touch += (chunk.live_of(q) & chunk.touches[q]) != 0;
      live += chunk.live_of(q) != 0;
    }
    const std::size_t moves = chunk.all_awake ? chunk.end - chunk.begin : chunk.awake.size();
    const double work = touching * static_cast<double>(touch) + near * static_cast<double>(live) +
                        static_cast<double>(moves + chunk.border.size()) + 1.0;
    middles_[c] = all + 0.5 * work;
    all += work;
  }
  for (double& middle : middles_) middle /= all;
}

/// Both sets of records, with what never changes in them.
template <int Dim>
void Spheres::make_records() {
  using R = SphereRecord<Dim>;
  for (auto& records : records_) {
    fit(records, (all() + 2) * R::size);
    std::fill(records.begin(), records.end(), 0.0);
    for (std::size_t k = moving_; k < all(); ++k) {
      double* r = records.data() + k * R::size;
      for (std::size_t d = 0; d < Dim; ++d) r[d] = fixed_[4 * (k - moving_) + d];
      r[R::radius] = fixed_[4 * (k - moving_) + 3];
    }
    // What pads the lists: two points that are apart by half of every period.
    for (std::size_t d = 0; d < Dim; ++d)
      records[(all() + 1) * R::size + d] = 0.5 * (layout_.bounds.high[d] - layout_.bounds.low[d]);
  }
}

}  // namespace barchan
