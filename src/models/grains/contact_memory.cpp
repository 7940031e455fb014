#include "models/grains/contact_memory.hpp"

#include <algorithm>

#include "base/ranks.hpp"
#include "models/grains/sphere_work.hpp"

namespace barchan {

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
                         const std::uint32_t* before) {
  constexpr std::size_t batch = ContactBatches::batch;
  const std::size_t numbers = column_.numbers;
  fit(begin_, all + 1);
  std::fill(begin_.begin(), begin_.end(), 0u);
  // Both chunks of a pair have the same bits: that of the first counts, or the only one.
  const auto pairs_of = [&](const SphereChunk& chunk, auto&& call) {
    for (std::size_t q = 0; q < chunk.touches.size(); ++q)
      for (unsigned bits = chunk.touches[q]; bits != 0; bits &= bits - 1) {
        const std::size_t at = q * batch + static_cast<std::size_t>(__builtin_ctz(bits));
        const std::uint32_t a = chunk.a[at];
        if (a >= begin && a < end && (a < chunk.begin || a >= chunk.end)) continue;
        call(before[a], before[chunk.b[at]], chunk.of_pair(at, numbers), batch);
      }
  };
  const auto each = [&](auto&& call) {
    for (const SphereChunk& chunk : chunks) {
      pairs_of(chunk, call);
      for (const auto& at : chunk.sides)
        if (at.touches != 0) call(before[at.sphere], side(at.axis, at.sign), at.memory, std::size_t{1});
    }
  };
  each([&](std::uint32_t number, std::uint32_t, const double*, std::size_t) { ++begin_[number + 1]; });
  for (std::size_t k = 0; k < all; ++k) begin_[k + 1] += begin_[k];
  fit(kept_, begin_[all]);
  each([&](std::uint32_t number, std::uint32_t with, const double* values, std::size_t apart) {
    Kept& k = kept_[begin_[number]++];
    k.number = number;
    k.with = with;
    for (std::size_t m = 0; m < numbers; ++m) k.values[m] = values[m * apart];
  });
  for (std::size_t k = all; k > 0; --k) begin_[k] = begin_[k - 1];
  begin_[0] = 0;
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
}

/// Where those of each number begin.
void ContactMemory::count(std::size_t all) {
  fit(begin_, all + 1);
  std::fill(begin_.begin(), begin_.end(), 0u);
  for (const Kept& k : kept_) ++begin_[k.number + 1];
  for (std::size_t k = 0; k < all; ++k) begin_[k + 1] += begin_[k];
}

void ContactMemory::share(const std::vector<std::uint32_t>& ranks) {
  std::vector<std::size_t> counts(static_cast<std::size_t>(ranks::active()->size()), 0);
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
  kept_ = ranks::exchanged(go, counts);
  order();
}

void ContactMemory::join() {
  ranks::join(kept_);
  order();
}

void ContactMemory::order() {
  std::stable_sort(kept_.begin(), kept_.end(), [](const Kept& a, const Kept& b) { return a.number < b.number; });
  count(begin_.size() - 1);
}

const double* ContactMemory::find(std::uint32_t number, std::uint32_t with) const {
  for (std::size_t k = begin_[number]; k < begin_[number + 1]; ++k)
    if (kept_[k].with == with) return kept_[k].values;
  return nullptr;
}

void ContactMemory::recall(ContactBatches& list, std::size_t place, std::uint32_t number, std::uint32_t with) const {
  const double* values = find(number, with);
  if (!values) return;
  list.set_touching(place);
  double* to = list.of_pair(place, column_.numbers);
  for (std::size_t m = 0; m < column_.numbers; ++m) to[m * ContactBatches::batch] = values[m];
}

}  // namespace barchan
