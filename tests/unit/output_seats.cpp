// Where the ranks of a run compute: lists of cores, lines, warnings.
#include <gtest/gtest.h>

#include "output/placement.hpp"

namespace barchan {
namespace {

TEST(Seats, ListsOfCores) {
  EXPECT_EQ(list_of_cores({}), "");
  EXPECT_EQ(list_of_cores({0}), "0");
  EXPECT_EQ(list_of_cores({0, 1, 2, 3, 8, 10, 11}), "0-3,8,10-11");
  EXPECT_EQ(cores_of_list("0-3,8,10-11"), (std::set<int>{0, 1, 2, 3, 8, 10, 11}));
  EXPECT_EQ(cores_of_list(""), std::set<int>{});
}

TEST(Seats, ALineForRanksThatSayTheSame) {
  EXPECT_EQ(to_text(std::vector<RunReport::Placement>{}), "");
  EXPECT_EQ(to_text(std::vector<RunReport::Placement>{{2, "dune1", "0-1", 1}, {1, "dune2", "0-7", 8}}),
            "ranks\n  2 ranks on dune1, 1 thread each, cores 0-1\n  1 rank on dune2, 8 threads, cores 0-7\n");
}

TEST(Seats, WarnsOfMoreThreadsThanCores) {
  EXPECT_TRUE(warnings_of({{2, "dune1", "0-1", 1}}).empty());
  EXPECT_TRUE(warnings_of({{4, "dune1", "", 1}}).empty());  // a system that does not say
  EXPECT_TRUE(warnings_of({{1, "dune1", "0-3", 4}, {1, "dune1", "4-7", 4}}).empty());
  const auto warnings = warnings_of({{2, "dune1", "0-1", 1}, {1, "dune1", "0-1", 1}, {1, "dune2", "0-7", 8}});
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_NE(warnings[0].find("the ranks on dune1 have 3 threads on 2 cores"), std::string::npos) << warnings[0];
}

TEST(Seats, ARankTakesItsPartOfTheCoresThatItMayUse) {
  using Seats = std::vector<RunReport::Placement>;
  EXPECT_EQ(threads_of_placement(Seats{{2, "dune1", "0-7", 0}}, 1, 8), 4);
  EXPECT_EQ(threads_of_placement(Seats{{3, "dune1", "0-1", 0}}, 2, 2), 1);
  // Bound to sockets, four ranks to each.
  EXPECT_EQ(threads_of_placement(Seats{{4, "dune1", "0-31", 0}, {4, "dune1", "32-63", 0}}, 5, 32), 8);
  // Each has cores of its own.
  EXPECT_EQ(threads_of_placement(Seats{{1, "dune1", "0-3", 0}, {1, "dune1", "4-7", 0}}, 1, 4), 4);
  // A job has a part of the machine; the same numbers on another machine are other cores.
  EXPECT_EQ(threads_of_placement(Seats{{4, "dune1", "8-15", 0}, {4, "dune2", "8-15", 0}}, 6, 8), 2);
  // OMP_NUM_THREADS is the most.
  EXPECT_EQ(threads_of_placement(Seats{{2, "dune1", "0-7", 0}}, 0, 3), 3);
  // A system that does not say which cores.
  EXPECT_EQ(threads_of_placement(Seats{{2, "dune1", "", 0}}, 1, 8), 4);
}

}  // namespace
}  // namespace barchan
