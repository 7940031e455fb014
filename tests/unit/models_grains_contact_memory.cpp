// What contacts of spheres remember goes with its pair: through new lists, another order of the spheres, and sides.
#include "models/grains/contact_memory.hpp"

#include <gtest/gtest.h>

#include "models/grains/sphere_work.hpp"

namespace barchan {
namespace {

/// A list of pairs; who is last of a batch is followed by padding.
SphereChunk list_of(std::size_t begin, std::size_t end, const std::vector<std::array<std::uint32_t, 2>>& pairs,
                    std::size_t numbers, std::uint32_t far) {
  constexpr std::size_t batch = ContactBatches::batch;
  const std::size_t batches = (pairs.size() + batch - 1) / batch;
  SphereChunk chunk;
  chunk.begin = begin;
  chunk.end = end;
  chunk.a.assign(batches * batch, far);
  chunk.b.assign(batches * batch, far + 1);
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    chunk.a[k] = pairs[k][0];
    chunk.b[k] = pairs[k][1];
  }
  chunk.clear(batches, numbers);
  return chunk;
}
void remember(ContactBatches& list, std::size_t place, std::size_t numbers, double value) {
  list.set_touching(place);
  for (std::size_t m = 0; m < numbers; ++m)
    list.of_pair(place, numbers)[m * ContactBatches::batch] = value + static_cast<double>(m);
}

TEST(ContactBatchesOfAList, KeepPairsApart) {
  ContactBatches list;
  list.clear(2, 3);
  for (const std::size_t place : {0u, 7u, 8u, 13u}) remember(list, place, 3, 10.0 * static_cast<double>(place));
  for (const std::size_t place : {0u, 7u, 8u, 13u})
    for (std::size_t m = 0; m < 3; ++m)
      EXPECT_EQ(list.of_pair(place, 3)[m * ContactBatches::batch],
                10.0 * static_cast<double>(place) + static_cast<double>(m));
  EXPECT_EQ(list.of_pair(8, 3) - list.memory.data(), 24) << "eight pairs of three numbers are before it";
  for (std::size_t place = 0; place < 16; ++place)
    EXPECT_EQ(list.touching(place), place == 0 || place == 7 || place == 8 || place == 13) << place;
  list.grow(1, 3);
  EXPECT_TRUE(list.touching(13));
  EXPECT_FALSE(list.touching(16));
  EXPECT_EQ(list.of_pair(13, 3)[0], 130.0);
  EXPECT_EQ(list.of_pair(16, 3)[0], 0.0);
  list.clear(1, 3);
  EXPECT_FALSE(list.touching(0));
  EXPECT_EQ(list.of_pair(0, 3)[0], 0.0);
}

TEST(ContactMemories, DescribeTheirColumn) {
  ContactMemory memory;
  memory.prepare(2);
  EXPECT_EQ(memory.numbers(), 2u);
}

// Six spheres in two chunks, a fixed one, and a side. Between the two lists they change places.
TEST(ContactMemories, GoWithTheirPairs) {
  constexpr std::size_t numbers = 2, moving = 6, all = 7, far = 7;
  ContactMemory memory;
  memory.prepare(numbers);
  const std::uint32_t before[] = {3, 1, 5, 0, 4, 2, 6};  // lasting numbers by place
  std::vector<SphereChunk> chunks{list_of(0, 3, {{1, 0}, {1, 5}, {1, 2}, {0, 6}}, numbers, far),
                                  list_of(3, 6, {{3, 4}, {1, 5}}, numbers, far)};
  remember(chunks[0], 0, numbers, 100.0);  // numbers 1, 3
  remember(chunks[0], 1, numbers, 200.0);  // numbers 1, 2: in both chunks
  remember(chunks[1], 1, numbers, 200.0);
  remember(chunks[0], 3, numbers, 300.0);  // numbers 3, 6: the fixed one
  SphereChunk::AtSide side;
  side.sphere = 5;  // number 2
  side.axis = 1;
  side.memory[0] = 7.0;
  side.memory[1] = 8.0;
  side.touches = 1;
  chunks[1].sides.push_back(side);
  memory.keep(0, moving, all, chunks, before);
  EXPECT_EQ(memory.kept().size(), 4u) << "the pair of two chunks once";
  const auto first_of = [&](std::uint32_t number, std::uint32_t with) {
    const double* values = memory.find(number, with);
    return values ? values[0] : -1.0;
  };
  EXPECT_EQ(first_of(1, 3), 100.0);
  EXPECT_EQ(first_of(1, 2), 200.0);
  EXPECT_EQ(first_of(3, 6), 300.0);
  EXPECT_EQ(first_of(2, ContactMemory::side(1, 1)), 7.0);
  EXPECT_EQ(first_of(2, ContactMemory::side(1, -1)), -1.0) << "the other side";
  EXPECT_EQ(first_of(1, 5), -1.0) << "listed, but they do not touch";
  EXPECT_EQ(first_of(0, 4), -1.0) << "listed, but they do not touch";

  ContactBatches list;
  list.clear(2, numbers);
  memory.recall(list, 9, 1, 2);
  memory.recall(list, 10, 1, 5);
  EXPECT_TRUE(list.touching(9));
  EXPECT_FALSE(list.touching(10));
  for (std::size_t m = 0; m < numbers; ++m)
    EXPECT_EQ(list.of_pair(9, numbers)[m * ContactBatches::batch], 200.0 + static_cast<double>(m));
}

// Spheres are taken away and others come: those that stay have other numbers, in the same order.
TEST(ContactMemories, FollowTheirPairsToOtherNumbers) {
  constexpr std::size_t numbers = 1, moving = 5, all = 6, far = 6;
  ContactMemory memory;
  memory.prepare(numbers);
  const std::uint32_t before[] = {0, 1, 2, 3, 4, 5};
  std::vector<SphereChunk> chunks{list_of(0, 5, {{0, 1}, {1, 2}, {2, 4}, {3, 5}, {1, 5}}, numbers, far)};
  for (std::size_t at = 0; at < 5; ++at) remember(chunks[0], at, numbers, static_cast<double>(10 * at + 1));
  SphereChunk::AtSide side;
  side.sphere = 4;
  side.memory[0] = 7.0;
  side.touches = 1;
  chunks[0].sides.push_back(side);
  memory.keep(0, moving, all, chunks, before);
  // 1 goes, three come behind 4; the fixed one is the last as before.
  constexpr std::uint32_t gone = ContactMemory::gone;
  std::vector<std::uint32_t> left_alone;
  memory.renumber({0, gone, 1, 2, 3, 7}, 8, left_alone);
  std::sort(left_alone.begin(), left_alone.end());
  EXPECT_EQ(left_alone, (std::vector<std::uint32_t>{0, 1, 7}));
  EXPECT_EQ(memory.kept().size(), 3u);
  ASSERT_NE(memory.find(1, 3), nullptr);
  EXPECT_EQ(memory.find(1, 3)[0], 21.0);
  ASSERT_NE(memory.find(2, 7), nullptr);
  EXPECT_EQ(memory.find(2, 7)[0], 31.0);
  ASSERT_NE(memory.find(3, ContactMemory::side(0, 1)), nullptr);
  EXPECT_EQ(memory.find(3, ContactMemory::side(0, 1))[0], 7.0);
  for (std::uint32_t n = 0; n < 8; ++n) EXPECT_EQ(memory.find(0, n), nullptr) << "its partner has gone";
}

}  // namespace
}  // namespace barchan
