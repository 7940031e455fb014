#include "models/grains/contact_memory.hpp"

#include <algorithm>
#include <cmath>

#include "engine/exchange.hpp"
#include "models/grains/sphere_work.hpp"

namespace barchan {

namespace {

constexpr std::size_t few = 32;  // partners of a sphere that are looked through

}  // namespace

void ContactBatches::clear(std::size_t batches, std::size_t numbers) {
  fit(touches, batches);
  fit(memory, batches * batch * numbers);
  std::fill(touches.begin(), touches.end(), std::uint8_t{0});
  std::fill(memory.begin(), memory.end(), 0.0);
}

void ContactBatches::reserve(std::size_t batches, std::size_t numbers) {
  touches.reserve(batches);
  memory.reserve(batches * batch * numbers);
}

void ContactBatches::grow(std::size_t batches, std::size_t numbers) {
  touches.resize(touches.size() + batches, 0);
  memory.resize(touches.size() * batch * numbers, 0.0);
}

void ContactMemory::keep(std::size_t begin, std::size_t end, std::size_t all, std::span<const SphereChunk> chunks,
                         const std::uint32_t* before, const double* places) {
  constexpr std::size_t batch = ContactBatches::batch;
  const std::size_t numbers = numbers_;
  fit(begin_, all + 1);
  std::fill(begin_.begin(), begin_.end(), 0u);
  // Both chunks of a pair have the same bits: that of the first counts, or the only one.
  const auto pairs_of = [&](const SphereChunk& chunk, auto&& call) {
    auto group = chunk.groups.begin();
    for (std::size_t q = 0; q < chunk.touches.size(); ++q) {
      while (places && group != chunk.groups.end() && q >= group->end) ++group;
      for (unsigned bits = chunk.touches[q]; bits != 0; bits &= bits - 1) {
        const std::size_t at = q * batch + static_cast<std::size_t>(__builtin_ctz(bits));
        const std::uint32_t a = chunk.a[at], b = chunk.b[at];
        if (a >= begin && a < end && (a < chunk.begin || a >= chunk.end)) continue;
        call(before[a], before[b], chunk.of_pair(at, numbers), batch, a, b,
             places ? group->image : pair_image::nearest);
      }
    }
  };
  const auto each = [&](auto&& call) {
    for (const SphereChunk& chunk : chunks) {
      pairs_of(chunk, call);
      for (const auto& at : chunk.sides)
        if (at.touches != 0)
          call(before[at.sphere], side(at.axis, at.sign), at.memory, std::size_t{1}, at.sphere, at.sphere,
               pair_image::nearest);
    }
  };
  each([&](std::uint32_t number, auto&&...) { ++begin_[number + 1]; });
  for (std::size_t k = 0; k < all; ++k) begin_[k + 1] += begin_[k];
  fit(kept_, begin_[all]);
  each([&](std::uint32_t number, std::uint32_t with, const double* values, std::size_t distance, std::uint32_t a,
           std::uint32_t b, std::uint32_t image) {
    Kept& k = kept_[begin_[number]++];
    k.number = number;
    k.with = with;
    k.apart = places ? apart(places + a * dimensions_, places + b * dimensions_, image) : std::array<float, 3>{};
    for (std::size_t m = 0; m < numbers; ++m) k.values[m] = values[m * distance];
  });
  for (std::size_t k = all; k > 0; --k) begin_[k] = begin_[k - 1];
  begin_[0] = 0;
  order_partners();
}

/// A sphere much larger than others touches many of them: its partners are found by their order.
void ContactMemory::order_partners() {
  for (std::size_t n = 0; n + 1 < begin_.size(); ++n)
    if (begin_[n + 1] - begin_[n] > few)
      std::sort(kept_.begin() + begin_[n], kept_.begin() + begin_[n + 1],
                [](const Kept& a, const Kept& b) { return a.with < b.with; });
}

std::array<float, 3> ContactMemory::apart(const double* a, const double* b, std::uint32_t image) const {
  std::array<float, 3> apart{};
  for (std::size_t d = 0; d < dimensions_ && image != pair_image::nearest; ++d)
    apart[d] = static_cast<float>(pair_image::apart(a[d] - b[d], period_[d], image, d));
  return apart;
}

void ContactMemory::renumber(const std::vector<std::uint32_t>& to, std::size_t all,
                             std::vector<std::uint32_t>& left_alone) {
  std::size_t stay = 0;
  for (const Kept& k : kept_) {
    const std::uint32_t number = to[k.number], with = k.with >= first_side ? k.with : to[k.with];
    if (number == gone && with < first_side) left_alone.push_back(with);
    if (with == gone && number != gone) left_alone.push_back(number);
    if (number == gone || with == gone) continue;
    kept_[stay] = k;
    kept_[stay].number = number;
    kept_[stay++].with = with;
  }
  kept_.resize(stay);
  count(all);
  order_partners();
}

/// Where those of each number begin.
void ContactMemory::count(std::size_t all) {
  fit(begin_, all + 1);
  std::fill(begin_.begin(), begin_.end(), 0u);
  for (const Kept& k : kept_) ++begin_[k.number + 1];
  for (std::size_t k = 0; k < all; ++k) begin_[k + 1] += begin_[k];
}

void ContactMemory::share(const std::vector<std::uint32_t>& ranks) {
  std::vector<std::size_t> counts(static_cast<std::size_t>(Exchange().size()), 0);
  const auto each = [&](auto&& call) {
    for (const Kept& k : kept_) {
      const std::uint32_t first = ranks[k.number];
      call(first, k);
      if (k.with < ranks.size() && ranks[k.with] != first) call(ranks[k.with], k);
    }
  };
  each([&](std::uint32_t rank, const Kept&) { ++counts[rank]; });
  std::vector<std::size_t> next(counts.size(), 0);
  for (std::size_t r = 1; r < counts.size(); ++r) next[r] = next[r - 1] + counts[r - 1];
  std::vector<Kept> go(next.back() + counts.back());
  each([&](std::uint32_t rank, const Kept& k) { go[next[rank]++] = k; });
  kept_ = Exchange().exchanged(go, counts);
  order();
}

void ContactMemory::join() {
  Exchange().join(kept_);
  order();
}

void ContactMemory::order() {
  std::stable_sort(kept_.begin(), kept_.end(), [](const Kept& a, const Kept& b) { return a.number < b.number; });
  count(begin_.size() - 1);
  order_partners();
}

const double* ContactMemory::find(std::uint32_t number, std::uint32_t with, const std::array<float, 3>& apart) const {
  auto k = kept_.begin() + begin_[number], end = kept_.begin() + begin_[number + 1];
  if (begin_[number + 1] - begin_[number] > few)
    k = std::lower_bound(k, end, with, [](const Kept& kept, std::uint32_t w) { return kept.with < w; });
  for (; k != end; ++k) {
    bool same = k->with == with;  // another image is a period further
    for (std::size_t d = 0; d < dimensions_ && same; ++d)
      same = !(2.0 * std::abs(k->apart[d] - apart[d]) > period_[d] && period_[d] > 0.0);
    if (same) return k->values;
    if (begin_[number + 1] - begin_[number] > few && k->with > with) break;
  }
  return nullptr;
}

void ContactMemory::recall(ContactBatches& list, std::size_t place, std::uint32_t number, std::uint32_t with,
                           const std::array<float, 3>& apart) const {
  const double* values = find(number, with, apart);
  if (!values) return;
  list.set_touching(place);
  double* to = list.of_pair(place, numbers_);
  for (std::size_t m = 0; m < numbers_; ++m) to[m * ContactBatches::batch] = values[m];
}

}  // namespace barchan
