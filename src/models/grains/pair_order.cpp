#include "models/grains/pair_order.hpp"

#include <bit>
#include <utility>

namespace barchan {

namespace {

constexpr std::size_t batch = SphereChunk::batch;

/// Exchanges two pairs of a list, with their memory and what is known of them.
void exchange(SphereChunk& chunk, std::size_t numbers, std::size_t one, std::size_t other) {
  std::swap(chunk.a[one], chunk.a[other]);
  std::swap(chunk.b[one], chunk.b[other]);
  double *of_one = chunk.of_pair(one, numbers), *of_other = chunk.of_pair(other, numbers);
  for (std::size_t k = 0; k < numbers * batch; k += batch) std::swap(of_one[k], of_other[k]);
  for (auto* bits : {&chunk.touches, &chunk.live}) {
    std::uint8_t &at = (*bits)[one / batch], &to = (*bits)[other / batch];
    const unsigned differ = (at >> one % batch ^ to >> other % batch) & 1u;
    at = static_cast<std::uint8_t>(at ^ differ << one % batch);
    to = static_cast<std::uint8_t>(to ^ differ << other % batch);
  }
}

/// Moves the pairs whose bits are set in `first(batch)` to the front of the places `begin` to `end`; returns the place
/// behind the last of them.
template <class Bits>
std::size_t to_front(SphereChunk& chunk, std::size_t numbers, std::size_t begin, std::size_t end, Bits&& first) {
  const auto has = [&](std::size_t place) { return (first(place / batch) >> place % batch & 1u) != 0; };
  for (;; ++begin) {
    while (begin < end && begin % batch == 0 && first(begin / batch) == 0xffu) begin += batch;
    while (begin < end && has(begin)) ++begin;
    while (end > begin && end % batch == 0 && end - begin >= batch && first(end / batch - 1) == 0u) end -= batch;
    while (end > begin && !has(end - 1)) --end;
    if (begin >= end) return begin;
    exchange(chunk, numbers, begin, --end);
  }
}

}  // namespace

void order_pairs(SphereChunk& chunk, std::size_t numbers, std::uint32_t far) {
  for (const SphereChunk::Group& group : chunk.groups) {
    for (std::size_t q = group.first; q < group.end; ++q)  // what was taken out of the list is nothing to evaluate
      for (unsigned left = chunk.live[q] & ~unsigned{chunk.touches[q]}; left != 0; left &= left - 1) {
        const unsigned lane = static_cast<unsigned>(std::countr_zero(left));
        if (chunk.a[q * batch + lane] == far) chunk.live[q] = static_cast<std::uint8_t>(chunk.live[q] & ~(1u << lane));
      }
    const std::size_t end = group.end * batch;
    const std::size_t touch = to_front(chunk, numbers, group.first * batch, end,
                                       [&](std::size_t q) { return unsigned{chunk.touches[q]} & chunk.live[q]; });
    to_front(chunk, numbers, touch, end, [&](std::size_t q) { return unsigned{chunk.live[q]}; });
  }
}

}  // namespace barchan
