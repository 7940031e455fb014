// How ranks would share the particles of a run, against the lists of one process: no rank lacks a neighbour, what is
// sent is what arrives, and a strip has no more ghosts than stand in the cells on its sides.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <numeric>
#include <set>
#include <tuple>

#include "engine/neighbours.hpp"
#include "unit/particle_sets.hpp"

namespace barchan {
namespace {

using namespace sets;

struct HaloCase {
  std::string name;
  int dimensions;
  Vec3 size;
  std::array<bool, 3> periodic;
};
void PrintTo(const HaloCase& c, std::ostream* out) { *out << c.name; }

class RankHalos : public ::testing::TestWithParam<HaloCase> {
 protected:
  static constexpr double radius = 2.1;
  /// A phase that is shared out, and one that is whole and looks for it.
  Cast cast() const {
    const Bounds b = box(GetParam().dimensions, GetParam().size, GetParam().periodic);
    Uniform random(7);
    std::vector<PhaseParticles> two;
    two.push_back(phase(b.dimensions, lattice(b, 1.0, 0.3, random), 1.0));
    two.push_back(phase(b.dimensions, scattered(b, 20, random), 1.0, {}, 100000));
    return Cast(b, std::move(two), {{0, 0, radius}, {1, 0, radius}});
  }
};

using Ghost = std::tuple<std::size_t, int, int, int>;  // particle and the periods it is moved by

/// Particles of each rank's searches that are not its own, and images.
std::vector<std::set<Ghost>> in_lists(const Cast& cast, const CellOwners& owners) {
  const CellGrid& grid = cast.neighbours.grid(0);
  const std::vector<std::uint32_t> cells = grid.cells_of_particles();
  std::vector<std::set<Ghost>> ghosts(owners.ranks());
  for (std::size_t d = 0; d < cast.directions.size(); ++d) {
    const PhaseParticles& from = cast.phases[cast.directions[d].a];
    for (std::size_t k = 0; k < from.size(); ++k) {
      std::array<float, 3> x{};
      for (int axis = 0; axis < from.dimensions(); ++axis)
        x[static_cast<std::size_t>(axis)] = cast.neighbours.grid(cast.directions[d].a).search_position(axis)[k];
      const std::int32_t rank = cast.directions[d].a == 0 ? owners.owner[cells[k]] : grid.rank_of(x, owners);
      const auto row = cast.list(static_cast<int>(d)).row(k);
      for (const auto* entry = row.begin; entry != row.end; ++entry) {
        const std::size_t q = *entry / PairList::stride;
        if (q == cast.motion[0].dummy()) continue;
        auto& mine = ghosts[static_cast<std::size_t>(rank)];
        if (q >= cells.size()) {
          const Image& image = grid.image_list()[q - cells.size()];
          mine.insert({image.source, image.shift[0], image.shift[1], image.shift[2]});
        } else if (owners.owner[cells[q]] != rank) {
          mine.insert({q, 0, 0, 0});
        }
      }
    }
  }
  return ghosts;
}

TEST_P(RankHalos, AreThoseOfTheListsAndOfTheCellsAboutThem) {
  const Cast c = cast();
  const std::size_t n = c.phases[0].size();
  for (const std::size_t ranks : {std::size_t{1}, std::size_t{2}, std::size_t{3}, std::size_t{7}}) {
    const auto owners = c.neighbours.divided(ranks, {false, true});
    ASSERT_TRUE(owners[0] && !owners[1]);
    const std::vector<RankHalo> halo = c.neighbours.halo_of(0, owners);
    ASSERT_EQ(halo.size(), ranks);
    const auto listed = in_lists(c, *owners[0]);
    std::size_t particles = 0, ghosts = 0, sent = 0, images_of_own = 0;
    for (std::size_t r = 0; r < ranks; ++r) {
      particles += halo[r].particles;
      ghosts += halo[r].ghosts;
      EXPECT_GE(halo[r].ghosts, listed[r].size()) << "rank " << r << " of " << ranks << " lacks a neighbour";
      std::size_t from_others = 0;
      for (std::size_t other = 0; other < ranks; ++other) {
        EXPECT_EQ(halo[other].to.count(static_cast<std::int32_t>(other)), 0u);
        if (const auto to = halo[other].to.find(static_cast<std::int32_t>(r)); to != halo[other].to.end())
          from_others += to->second;
      }
      ASSERT_LE(from_others, halo[r].ghosts);
      images_of_own += halo[r].ghosts - from_others;
      for (const auto& [to, what] : halo[r].to) sent += what;
      EXPECT_LE(static_cast<double>(halo[r].particles) * static_cast<double>(ranks), 2.0 * static_cast<double>(n));
    }
    EXPECT_EQ(particles, n);
    EXPECT_EQ(ghosts, sent + images_of_own);
    if (ranks == 1) {
      EXPECT_EQ(sent, 0u);
      EXPECT_LE(ghosts, c.neighbours.grid(0).images()) << "no more than the images of one process";
    }
  }
}

/// Two ranks that have two neighbours apart hear of each other's blocks, and each tells what the other one hears.
TEST_P(RankHalos, TellDisplacementsToTheRanksBeside) {
  const Cast c = cast();
  const CellGrid& grid = c.neighbours.grid(0);
  const std::vector<std::uint32_t> cells = grid.cells_of_particles();
  for (const std::size_t ranks : {std::size_t{1}, std::size_t{2}, std::size_t{3}, std::size_t{7}}) {
    const auto owners = c.neighbours.divided(ranks, {false, true});
    std::vector<std::map<std::int32_t, SharedBlocks>> told;
    for (std::size_t r = 0; r < ranks; ++r)
      told.push_back(c.neighbours.shared_blocks({&*owners[0], nullptr}, static_cast<std::int32_t>(r)));
    for (std::size_t r = 0; r < ranks; ++r)
      for (const auto& [other, blocks] : told[r]) {
        ASSERT_NE(other, static_cast<std::int32_t>(r));
        EXPECT_EQ(blocks.sends, told[static_cast<std::size_t>(other)][static_cast<std::int32_t>(r)].receives);
      }
    std::vector<std::size_t> block_of(grid.cells());
    grid.each_block(*owners[0], [&](std::size_t block, std::int32_t, std::uint32_t cell) { block_of[cell] = block; });
    std::size_t apart = 0;
    for (std::size_t k = 0; k < cells.size(); ++k) {
      const auto row = c.list(0).row(k);
      for (const auto* entry = row.begin; entry != row.end; ++entry) {
        std::size_t q = *entry / PairList::stride;
        if (q == c.motion[0].dummy()) continue;
        if (q >= cells.size()) q = grid.image_list()[q - cells.size()].source;
        const std::int32_t own = owners[0]->owner[cells[k]], other = owners[0]->owner[cells[q]];
        if (own == other) continue;
        ++apart;
        const auto& hears = told[static_cast<std::size_t>(own)][other].receives;
        ASSERT_TRUE(std::binary_search(hears.begin(), hears.end(), block_of[cells[q]]));
      }
    }
    EXPECT_EQ(apart > 0, ranks > 1);
  }
}

TEST(RankHalosOfAStrip, AreTwoSidesOfIt) {
  // A long channel of unit spacing, 32 high: four ranks have a quarter of its length, and ghosts on both sides.
  const Bounds b = box(2, {1024, 32, 0}, {true, false, false});
  Uniform random(1);
  std::vector<PhaseParticles> one;
  one.push_back(phase(2, lattice(b, 1.0, 0.0, random), 1.0));
  const Cast c(b, std::move(one), {{0, 0, 2.1}});
  for (const RankHalo& rank : c.neighbours.halo_of(0, c.neighbours.divided(4, {false}))) {
    EXPECT_NEAR(static_cast<double>(rank.particles), 8192.0, 0.1 * 8192.0);
    EXPECT_GE(rank.ghosts, 2u * 2u * 32u) << "two rows within the radius on each side";
    EXPECT_LE(rank.ghosts, 2u * 6u * 32u + 16u * 6u) << "and no more than the cells about them";
    EXPECT_EQ(rank.to.size(), 2u);
  }
}

TEST(ParticlesOfARank, AreThoseThatItKeepsInTheirNewOrder) {
  Uniform random(3);
  PhaseParticles p = phase(2, scattered(box(2, {5, 5, 0}, {false, false, false}), 9, random), 1.0, {}, 40);
  const auto own = p.add_own<std::array<std::uint16_t, 3>>("model.three");
  std::vector<Vec3> x;
  for (std::size_t k = 0; k < p.size(); ++k) {
    p.own(own)[k] = {static_cast<std::uint16_t>(k), 7, 8};
    x.push_back(position(p, k));
  }
  const std::vector<std::uint32_t> order{8, 2, 5, 0};
  p.keep(order.data(), order.size());
  ASSERT_EQ(p.size(), order.size());
  for (std::size_t k = 0; k < p.size(); ++k) {
    EXPECT_EQ(p.id()[k], 40 + order[k]);
    EXPECT_EQ(position(p, k), x[order[k]]);
    EXPECT_EQ(p.own(own)[k][0], order[k]);
  }
}

INSTANTIATE_TEST_SUITE_P(Boxes, RankHalos,
                         ::testing::Values(HaloCase{"Open2D", 2, {40, 17, 0}, {false, false, false}},
                                           HaloCase{"PeriodicX", 2, {36, 20, 0}, {true, false, false}},
                                           HaloCase{"PeriodicXY", 2, {40, 36, 0}, {true, true, false}},
                                           HaloCase{"Open3D", 3, {12, 8, 9}, {false, false, false}},
                                           HaloCase{"PeriodicXYZ", 3, {10, 9, 11}, {true, true, true}}),
                         [](const auto& one) { return one.param.name; });

}  // namespace
}  // namespace barchan
