// The order of the pairs of a list: those that are evaluated and touch, those that are evaluated, others; each keeps
// what it remembers.
#include "models/grains/pair_order.hpp"

#include <gtest/gtest.h>

#include <map>

#include "unit/particle_sets.hpp"

namespace barchan {
namespace {

constexpr std::size_t batch = SphereChunk::batch, numbers = 3;
constexpr std::uint32_t far = 1000;

struct Known {
  double memory[numbers];
  bool touches, live;
  bool operator==(const Known&) const = default;
};
using Pairs = std::map<std::pair<std::uint32_t, std::uint32_t>, Known>;

/// A list of two groups with pairs of each kind, and places without a pair.
SphereChunk some_list(double filled, unsigned seed) {
  sets::Uniform random{seed};
  SphereChunk chunk;
  chunk.groups = {{0, 0, 5, 0, 1.0}, {0, 5, 12, 0, 0.5}};
  const std::size_t batches = 12;
  chunk.a.assign(batches * batch, far);
  chunk.b.assign(batches * batch, far + 1);
  chunk.clear(batches, numbers);
  chunk.live.assign(batches, 0);
  for (std::size_t k = 0; k < batches * batch; ++k) {
    const bool live = random(0.0, 1.0) < 0.6;
    if (live) chunk.live[k / batch] = static_cast<std::uint8_t>(chunk.live[k / batch] | 1u << k % batch);
    if (random(0.0, 1.0) > filled) continue;
    chunk.a[k] = static_cast<std::uint32_t>(2 * k);
    chunk.b[k] = static_cast<std::uint32_t>(2 * k + 1);
    if (random(0.0, 1.0) > 0.5) continue;
    chunk.set_touching(k);
    for (std::size_t m = 0; m < numbers; ++m) chunk.of_pair(k, numbers)[m * batch] = random(0.0, 1.0);
  }
  return chunk;
}

bool live(const SphereChunk& chunk, std::size_t k) { return (chunk.live[k / batch] >> k % batch & 1u) != 0; }

Pairs pairs_of(const SphereChunk& chunk, const SphereChunk::Group& group) {
  Pairs pairs;
  for (std::size_t k = group.first * batch; k < group.end * batch; ++k) {
    if (chunk.a[k] == far) continue;
    Known known{{}, chunk.touching(k), live(chunk, k)};
    for (std::size_t m = 0; m < numbers; ++m) known.memory[m] = chunk.of_pair(k, numbers)[m * batch];
    pairs[{chunk.a[k], chunk.b[k]}] = known;
  }
  return pairs;
}

TEST(PairOrder, PutsPairsThatTouchFirstAndKeepsWhatTheyRemember) {
  for (unsigned seed = 1; seed < 40; ++seed)
    for (const double filled : {0.0, 0.3, 0.9, 1.0}) {
      SphereChunk chunk = some_list(filled, seed);
      const Pairs before[] = {pairs_of(chunk, chunk.groups[0]), pairs_of(chunk, chunk.groups[1])};
      order_pairs(chunk, numbers, far);
      for (std::size_t g = 0; g < 2; ++g) {
        const auto& group = chunk.groups[g];
        EXPECT_EQ(pairs_of(chunk, group), before[g]) << seed;
        int last = 0;
        for (std::size_t k = group.first * batch; k < group.end * batch; ++k) {
          const int kind = !live(chunk, k) ? 2 : chunk.touching(k) ? 0 : 1;
          EXPECT_GE(kind, last) << seed << ", place " << k;
          last = kind;
          EXPECT_TRUE(chunk.a[k] != far || kind == 2) << "a place without a pair is not evaluated";
        }
      }
    }
}

/// A list in order stays as it is.
TEST(PairOrder, ChangesNothingTwice) {
  SphereChunk chunk = some_list(0.8, 7);
  order_pairs(chunk, numbers, far);
  const SphereChunk once = chunk;
  order_pairs(chunk, numbers, far);
  EXPECT_EQ(chunk.a, once.a);
  EXPECT_EQ(chunk.b, once.b);
  EXPECT_EQ(chunk.memory, once.memory);
  EXPECT_EQ(chunk.touches, once.touches);
  EXPECT_EQ(chunk.live, once.live);
}

}  // namespace
}  // namespace barchan
