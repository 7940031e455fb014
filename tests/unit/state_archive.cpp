// Rows of an archive: what ranks save apart is, put together, what one process saves; a rank loads its own range.
#include "state/archive.hpp"

#include <gtest/gtest.h>

#include <numeric>

#include "base/errors.hpp"

namespace barchan {
namespace {

using Numbers = std::vector<std::int32_t>;

Numbers from_to(std::int32_t first, std::int32_t last) {
  Numbers numbers(static_cast<std::size_t>(last - first));
  std::iota(numbers.begin(), numbers.end(), first);
  return numbers;
}

/// A state of rows first .. last - 1 of seven, numbers before, between and behind, and two values behind the rows.
void name_state(Archive& a, std::int32_t first, std::int32_t last, Numbers& one, Numbers& other, bool rest = true) {
  const Rows rows{static_cast<std::uint64_t>(first), static_cast<std::uint64_t>(last - first), 7};
  long before = 3, between = 4, behind = 5;
  a.number("before", before);
  a.rows("one", one.data(), rows);
  a.number("between", between);
  const Numbers two{-1, -2};
  a.rows("other", other.data(), rows, two.data(), rest ? two.size() : 0);
  a.number("behind", behind);
}

std::vector<char> of_one_process() {
  Archive a;
  Numbers one = from_to(0, 7), other = from_to(100, 107);
  name_state(a, 0, 7, one, other);
  return a.bytes();
}

TEST(ArchiveRows, AreThoseOfOneProcessWhenTheyArePutTogether) {
  std::vector<char> whole;  // the first rank's bytes, with the rows of all in their places
  std::vector<std::vector<char>> rows(2);
  const std::int32_t cuts[][2] = {{0, 3}, {3, 3}, {3, 7}};  // a rank may have none
  for (const auto& [first, last] : cuts) {
    Numbers one = from_to(first, last), other = from_to(100 + first, 100 + last);
    std::size_t item = 0;
    Archive a([](const void*, std::size_t) {},
              [&](const void* data, std::size_t size, std::uint64_t all) {
                EXPECT_EQ(all, 7 * sizeof(std::int32_t));
                const char* bytes = static_cast<const char*>(data);
                if (size > 0) rows[item].insert(rows[item].end(), bytes, bytes + size);
                ++item;
              });
    name_state(a, first, last, one, other);
    EXPECT_EQ(item, 2u);
  }
  std::size_t item = 0;
  Archive a(
      [&](const void* data, std::size_t size) {
        const char* bytes = static_cast<const char*>(data);
        whole.insert(whole.end(), bytes, bytes + size);
      },
      [&](const void*, std::size_t, std::uint64_t) {
        whole.insert(whole.end(), rows[item].begin(), rows[item].end());
        ++item;
      });
  Numbers one = from_to(0, 3), other = from_to(100, 103);
  const auto state = [&](Archive& archive) { name_state(archive, 0, 3, one, other); };
  EXPECT_EQ(size_of(state), of_one_process().size()) << "with the rows of all ranks";
  state(a);
  EXPECT_EQ(whole, of_one_process());
}

TEST(ArchiveRows, OfOthersNeedAnArchiveForThem) {
  Archive a;
  Numbers one = from_to(0, 3), other = from_to(100, 103);
  EXPECT_THROW(name_state(a, 0, 3, one, other), std::logic_error);
}

/// Counts what is read.
struct Reader {
  std::vector<char> bytes = of_one_process();
  std::size_t read = 0;
  Archive::Source source() {
    return {bytes.size(), [this](std::uint64_t at, void* to, std::size_t size) {
              read += size;
              std::memcpy(to, bytes.data() + at, size);
            }};
  }
};

TEST(ArchiveRows, ARankLoadsItsRange) {
  Reader reader;
  for (const bool from_memory : {true, false})
    for (const auto& range : {std::pair{0, 7}, std::pair{2, 5}, std::pair{4, 4}}) {
      const int first = range.first, last = range.second;
      Archive a = from_memory ? Archive(reader.bytes) : Archive(reader.source());
      Numbers one(static_cast<std::size_t>(last - first)), other = one;
      long before = 0, between = 0, behind = 0;
      const Rows rows{static_cast<std::uint64_t>(first), static_cast<std::uint64_t>(last - first), 7};
      a.number("before", before);
      const std::uint64_t here = a.place();
      a.rows("one", one.data(), {0, 0, 7});  // skipped, and come back to
      a.number("between", between);
      const std::uint64_t next = a.place();
      a.go_to(here);
      a.rows("one", one.data(), rows);
      a.go_to(next);
      a.parts<std::int32_t>("other", [&](std::uint64_t count, auto&& read) {
        EXPECT_EQ(count, 9u);
        std::int32_t two[2];
        read(7, two, 2);
        EXPECT_EQ(two[0], -1);
        EXPECT_EQ(two[1], -2);
        read(static_cast<std::uint64_t>(first), other.data(), other.size());
        EXPECT_THROW(read(8, two, 2), SceneError);
        EXPECT_THROW(read(10, two, 0), SceneError);
      });
      a.number("behind", behind);
      a.finish();
      EXPECT_EQ(one, from_to(first, last));
      EXPECT_EQ(other, from_to(100 + first, 100 + last));
      EXPECT_EQ(before + between + behind, 12);
    }
}

TEST(ArchiveRows, AnotherNumberIsRefused) {
  Archive a(of_one_process());
  Numbers one(8);
  long before = 0;
  a.number("before", before);
  EXPECT_THROW(a.rows("one", one.data(), {0, 8, 8}), SceneError);
  a.load_again();
  a.number("before", before);
  EXPECT_THROW(a.rows("one", one.data(), {5, 3, 7}), SceneError);
}

TEST(ArchiveSource, IsReadWhereItIsAskedFor) {
  Archive saved;
  std::vector<char> large(1 << 20, 'x');
  long small = 7;
  saved.array("large", large);
  saved.number("small", small);
  std::size_t read = 0;
  Archive a(Archive::Source{saved.bytes().size(), [&](std::uint64_t at, void* to, std::size_t size) {
                              read += size;
                              std::memcpy(to, saved.bytes().data() + at, size);
                            }});
  a.rows("large", large.data(), {1000, 5, large.size()});
  small = 0;
  a.number("small", small);
  a.finish();
  EXPECT_EQ(small, 7);
  EXPECT_LT(read, large.size() / 4) << "what is skipped is not read";
}

}  // namespace
}  // namespace barchan
