// The search against its naive twin, all pairs and all images: on lattices, perturbed lattices and random sets, in two
// and three dimensions, with every choice of periodic sides, in boxes so small that a particle sees several images of
// another, between two phases, on the bounds and outside them. Then the skin: lists stay complete while particles move.
#include "engine/neighbours.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <map>
#include <tuple>

#include "base/errors.hpp"
#include "unit/particle_sets.hpp"

namespace barchan {
namespace {

using namespace sets;

using Key = std::tuple<std::size_t, int, int, int>;  // particle and the periods it is moved by

/// Every pair within `radius` is in the list once, nothing is listed beyond `reach`, images are where they should be.
void expect_complete(const Cast& cast, std::size_t direction, double radius, double reach) {
  const auto [a, b, ignored] = cast.directions[direction];
  const PhaseParticles &from = cast.phases[a], &to = cast.phases[b];
  const auto& images = cast.neighbours.grid(b).image_list();
  const auto dims = static_cast<std::size_t>(from.dimensions());
  std::uint64_t entries = 0;
  for (std::size_t k = 0; k < from.size(); ++k) {
    const auto row = cast.list(direction).row(k);
    ASSERT_EQ(static_cast<std::size_t>(row.end - row.begin) % cast.list(direction).padding(), 0u);
    std::map<Key, int> listed;
    for (const auto* entry = row.begin; entry != row.end; ++entry) {
      ASSERT_EQ(*entry % PairList::stride, 0u);
      const std::uint32_t q = *entry / PairList::stride;
      if (q == cast.motion[b].dummy()) continue;
      ++entries;
      ASSERT_LT(q, to.size() + images.size());
      Key key{q, 0, 0, 0};
      if (q >= to.size()) {
        const Image& image = images[q - to.size()];
        key = {image.source, image.shift[0], image.shift[1], image.shift[2]};
      }
      ++listed[key];
      const double* place = cast.motion[b][q];
      double r2 = 0.0;
      for (std::size_t d = 0; d < dims; ++d) {
        const double period = cast.bounds.periodic[d] ? cast.bounds.high[d] - cast.bounds.low[d] : 0.0;
        const std::array<int, 3> shift{std::get<1>(key), std::get<2>(key), std::get<3>(key)};
        ASSERT_NEAR(place[d], position(to, std::get<0>(key))[d] + shift[d] * period, 1e-12);
        r2 += std::pow(position(from, k)[d] - place[d], 2);
      }
      ASSERT_LT(std::sqrt(r2), reach * 1.0001) << "listed beyond its reach";
    }
    std::size_t within = 0;
    for_all_pairs(cast.bounds, from, k, to, a == b, radius,
                  [&](std::size_t j, const Vec3& r, const std::array<int, 3>& s) {
                    ++within;
                    const auto found = listed.find({j, s[0], s[1], s[2]});
                    ASSERT_NE(found, listed.end()) << "particle " << k << " misses " << j << " at distance " << norm(r);
                  });
    for (const auto& [key, times] : listed) ASSERT_EQ(times, 1) << "listed more than once";
    ASSERT_GE(listed.size(), within);
  }
  EXPECT_EQ(cast.list(direction).entries(), entries);
  EXPECT_GT(entries, 0u);
}

struct SearchCase {
  std::string name;
  int dimensions;
  Vec3 size;
  std::array<bool, 3> periodic;
  Vec3 low{0, 0, 0};
};
void PrintTo(const SearchCase& c, std::ostream* out) { *out << c.name; }

std::vector<SearchCase> cases() {
  return {
      {"Open2D", 2, {14, 9, 0}, {false, false, false}},
      {"PeriodicX", 2, {14, 9, 0}, {true, false, false}, {-3.3, 100.0, 0}},
      {"PeriodicY", 2, {9, 14, 0}, {false, true, false}},
      {"PeriodicXY", 2, {12, 10, 0}, {true, true, false}, {5, -7, 0}},
      {"NarrowXY", 2, {4, 5, 0}, {true, true, false}},  // a period is less than two radii
      {"TinyXY", 2, {2, 2, 0}, {true, true, false}},    // and less than one: images of images
      {"Open3D", 3, {6, 5, 7}, {false, false, false}},
      {"PeriodicX3D", 3, {8, 6, 5}, {true, false, false}},
      {"PeriodicXZ", 3, {7, 5, 6}, {true, false, true}, {0, 1, -20}},
      {"PeriodicXYZ", 3, {6, 7, 8}, {true, true, true}},
      {"NarrowXYZ", 3, {3, 4, 3}, {true, true, true}},
      {"TinyXYZ", 3, {2, 2, 2}, {true, true, true}},
  };
}

class Search : public ::testing::TestWithParam<SearchCase> {
 protected:
  Bounds bounds() const { return box(GetParam().dimensions, GetParam().size, GetParam().periodic, GetParam().low); }
  int dimensions() const { return GetParam().dimensions; }
};

TEST_P(Search, OnePhaseFindsEveryPair) {
  Uniform random(1);
  for (const double perturb : {0.0, 0.2, 0.49})
    for (const double radius : {1.1, 2.5}) {
      std::vector<PhaseParticles> one;
      one.push_back(phase(dimensions(), lattice(bounds(), 1.0, perturb, random), 1.0));
      const Cast cast(bounds(), std::move(one), {{0, 0, radius}});
      expect_complete(cast, 0, radius * 1.1, radius * 1.1);
    }
}

TEST_P(Search, RandomSetsOfTwoPhasesWithRadiiOfTheirOwn) {
  Uniform random(2);
  const int n = dimensions() == 2 ? 90 : 130;
  std::vector<PhaseParticles> two;
  two.push_back(phase(dimensions(), scattered(bounds(), n, random), 1.0));
  two.push_back(phase(dimensions(), scattered(bounds(), n / 3, random), 1.0, {}, n));
  const Cast cast(bounds(), std::move(two), {{0, 0, 2.9}, {0, 1, 1.9}, {1, 0, 1.9}, {1, 1, 0.8}}, 0.2);
  for (std::size_t q = 0; q < 4; ++q) {
    const double reach = cast.directions[q].radius * 1.2;
    expect_complete(cast, q, reach, reach);
  }
  EXPECT_EQ(cast.list(1).entries(), cast.list(2).entries()) << "a sees b as often as b sees a";
}

TEST_P(Search, ParticlesOnTheBounds) {
  Uniform random(3);
  const Bounds b = bounds();
  auto x = lattice(b, 1.0, 0.1, random);
  for (std::size_t k = 0; k < x.size(); k += 3)
    for (std::size_t d = 0; d < static_cast<std::size_t>(b.dimensions); ++d) {
      const std::size_t choice = (k / 3 + d) % 4;
      if (choice == 0) x[k][d] = b.low[d];
      if (choice == 1) x[k][d] = b.high[d];
      if (choice == 2) x[k][d] = std::nextafter(b.low[d], -1e9);  // wraps onto the upper bound to rounding
    }
  std::vector<PhaseParticles> one;
  one.push_back(phase(dimensions(), x, 1.0));
  const Cast cast(b, std::move(one), {{0, 0, 1.7}});
  for (std::size_t k = 0; k < x.size(); ++k)
    for (std::size_t d = 0; d < static_cast<std::size_t>(b.dimensions); ++d)
      if (b.periodic[d]) {
        ASSERT_GE(position(cast.phases[0], k)[d], b.low[d]);
        ASSERT_LT(position(cast.phases[0], k)[d], b.high[d]);
      }
  expect_complete(cast, 0, 1.7 * 1.1, 1.7 * 1.1);
}

// Wall layers lie outside the domain, up to three spacings and more.
TEST_P(Search, ParticlesOutsideTheBounds) {
  Uniform random(4);
  const Bounds b = bounds();
  std::vector<Vec3> walls = scattered(b, 200, random);
  for (auto& x : walls)
    for (std::size_t d = 0; d < static_cast<std::size_t>(b.dimensions); ++d)
      if (!b.periodic[d]) x[d] = random(b.low[d] - 4.5, b.high[d] + 4.5);
  std::vector<PhaseParticles> two;
  two.push_back(phase(dimensions(), lattice(b, 1.0, 0.2, random), 1.0));
  two.push_back(phase(dimensions(), walls, 1.0, {}, 1000));
  const Cast cast(b, std::move(two), {{0, 0, 3.0}, {0, 1, 3.0}, {1, 0, 3.0}, {1, 1, 1.3}});
  for (std::size_t q = 0; q < 4; ++q)
    expect_complete(cast, q, cast.directions[q].radius * 1.1, cast.directions[q].radius * 1.1);
}

TEST_P(Search, PermutationKeepsIdsWithTheirFields) {
  Uniform random(5);
  const Bounds b = bounds();
  const auto x = scattered(b, 300, random);
  std::vector<PhaseParticles> one;
  one.push_back(phase(dimensions(), x, 1.0, {Field::velocity, Field::density}, 70));
  for (std::size_t k = 0; k < x.size(); ++k) {
    one[0].column(Field::density)[k] = static_cast<double>(k);
    for (int d = 0; d < dimensions(); ++d) one[0].column(Field::velocity, d)[k] = -10.0 * static_cast<double>(k) - d;
  }
  const Cast cast(b, std::move(one), {{0, 0, 0.4}});
  std::vector<int> seen(x.size(), 0);
  std::size_t moved = 0;
  for (std::size_t k = 0; k < x.size(); ++k) {
    const auto id = static_cast<std::size_t>(cast.phases[0].id()[k] - 70);
    ASSERT_LT(id, x.size());
    ++seen[id];
    moved += id != k;
    EXPECT_EQ(cast.phases[0].column(Field::density)[k], static_cast<double>(id));
    for (int d = 0; d < dimensions(); ++d) {
      EXPECT_EQ(cast.phases[0].column(Field::velocity, d)[k], -10.0 * static_cast<double>(id) - d);
      EXPECT_EQ(cast.phases[0].column(Field::position, d)[k], x[id][static_cast<std::size_t>(d)]);
    }
  }
  for (const int times : seen) EXPECT_EQ(times, 1);
  EXPECT_GT(moved, x.size() / 2) << "a random set must be sorted";
}

/// Moves every particle by at most `step` in a random direction.
void jiggle(PhaseParticles& p, double step, Uniform& random) {
  for (std::size_t k = 0; k < p.size(); ++k) {
    Vec3 u{};
    for (std::size_t d = 0; d < static_cast<std::size_t>(p.dimensions()); ++d) u[d] = random(-1, 1);
    const double scale = step / std::max(norm(u), 1e-3);
    for (int d = 0; d < p.dimensions(); ++d) p.column(Field::position, d)[k] += scale * u[static_cast<std::size_t>(d)];
  }
}

TEST_P(Search, ListsStayCompleteWhileParticlesMove) {
  Uniform random(6);
  const Bounds b = bounds();
  std::vector<PhaseParticles> two;
  two.push_back(phase(dimensions(), lattice(b, 1.0, 0.2, random), 1.0));
  two.push_back(phase(dimensions(), scattered(b, 30, random), 1.0, {}, 1000));
  Cast cast(b, std::move(two), {{0, 0, 2.0}, {0, 1, 1.5}, {1, 0, 1.5}}, 0.25);
  int rebuilt = 0;
  for (int step = 0; step < 12; ++step) {
    for (auto& p : cast.phases) jiggle(p, 0.04, random);
    rebuilt += cast.neighbours.update(cast.phases, false);
    cast.pack();
    for (std::size_t q = 0; q < 3; ++q) {
      const double radius = cast.directions[q].radius;
      expect_complete(cast, q, radius, radius * 1.25 * 1.25);  // what was listed may have moved away since
    }
  }
  EXPECT_GT(rebuilt, 0) << "the particles left the skin";
  EXPECT_LT(rebuilt, 12) << "not every step needs new lists";
}

INSTANTIATE_TEST_SUITE_P(Boxes, Search, ::testing::ValuesIn(cases()), [](const auto& c) { return c.param.name; });

// A list holds eight times an index in 32 bits (PairList::stride): the last that fits is 2^29 - 1.
TEST(PairLists, RefuseMoreRecordsThanTheirIndicesCount) {
  constexpr std::size_t limit = 536'870'911;
  EXPECT_EQ(PairList::dummy_index(limit, 0), limit);
  EXPECT_EQ(PairList::dummy_index(limit - 7, 7), limit);
  EXPECT_EQ(std::uint64_t{PairList::stride} * limit, std::uint64_t{PairList::stride * PairList::dummy_index(limit, 0)});
  const std::size_t most = std::numeric_limits<std::size_t>::max();
  for (const auto& [particles, images] : {std::pair{limit + 1, std::size_t{0}}, std::pair{limit, std::size_t{1}},
                                          std::pair{std::size_t{1} << 32, std::size_t{5}}, std::pair{most, most}}) {
    try {
      PairList::dummy_index(particles, images);
      ADD_FAILURE() << particles << " and " << images << " were accepted";
    } catch (const SceneError& error) {
      EXPECT_NE(std::string(error.what()).find("counts to 536870911"), std::string::npos) << error.what();
    }
  }
}

Cast two_hundred(double skin) {
  Uniform random(7);
  const Bounds b = box(2, {20, 10, 0}, {true, false, false});
  std::vector<PhaseParticles> one;
  one.push_back(phase(2, lattice(b, 1.0, 0.2, random), 1.0));
  return Cast(b, std::move(one), {{0, 0, 2.0}}, skin);
}

/// Where the particle nearest to a point stands.
std::size_t nearest(const PhaseParticles& p, const Vec3& to) {
  std::size_t best = 0;
  for (std::size_t k = 0; k < p.size(); ++k)
    if (norm(position(p, k) - to) < norm(position(p, best) - to)) best = k;
  return best;
}

TEST(Skin, RebuildsExactlyWhenAPairMayHaveComeWithinReach) {
  Cast cast = two_hundred(0.1);
  auto& p = cast.phases[0];
  EXPECT_EQ(cast.neighbours.rebuilds(), 1);
  EXPECT_FALSE(cast.neighbours.update(cast.phases, false)) << "nothing moved";
  p.column(Field::position, 0)[17] += 0.17;
  EXPECT_FALSE(cast.neighbours.update(cast.phases, false)) << "less than nine tenths of the skin of 0.2";
  p.column(Field::position, 0)[17] += 0.02;
  EXPECT_TRUE(cast.neighbours.update(cast.phases, false));
  EXPECT_EQ(cast.neighbours.rebuilds(), 2);
  // Two particles that approach each other, across the periodic side too, share the skin.
  for (const auto& [left, right] : {std::pair<Vec3, Vec3>{{9.5, 5, 0}, {11.5, 5, 0}}, {{19.5, 5, 0}, {1.5, 5, 0}}}) {
    p.column(Field::position, 0)[nearest(p, left)] += 0.1;
    EXPECT_FALSE(cast.neighbours.update(cast.phases, false));
    p.column(Field::position, 0)[nearest(p, right)] -= 0.1;
    EXPECT_TRUE(cast.neighbours.update(cast.phases, false));
  }
  EXPECT_TRUE(cast.neighbours.update(cast.phases, true)) << "forced";
}

/// The way is that along a straight line, not the larger of its components.
TEST(Skin, AWayAcrossTheAxesCountsAsAWhole) {
  Cast cast = two_hundred(0.1);
  auto& p = cast.phases[0];
  for (const int d : {0, 1}) p.column(Field::position, d)[17] += 0.12;
  EXPECT_FALSE(cast.neighbours.update(cast.phases, false)) << "0.170, less than nine tenths of the skin of 0.2";
  for (const int d : {0, 1}) p.column(Field::position, d)[17] += 0.02;
  EXPECT_TRUE(cast.neighbours.update(cast.phases, false)) << "0.198";
}

// In a long channel whose ends move against each other, neighbours hardly do.
TEST(Skin, OnlyMotionBetweenNeighboursCounts) {
  Uniform random(8);
  const Bounds b = box(2, {90, 8, 0}, {true, false, false});
  std::vector<PhaseParticles> two;
  two.push_back(phase(2, lattice(b, 1.0, 0.2, random), 1.0));
  two.push_back(phase(2, scattered(b, 60, random), 1.0, {}, 1000));
  Cast cast(b, std::move(two), {{0, 0, 2.0}, {0, 1, 1.5}, {1, 0, 1.5}}, 0.2);
  int quiet = 0;
  for (int step = 1; step <= 16; ++step) {
    for (auto& p : cast.phases)
      for (std::size_t k = 0; k < p.size(); ++k)
        p.column(Field::position, 0)[k] +=
            0.05 * std::sin(2.0 * 3.14159265358979 * p.column(Field::position, 0)[k] / 90.0);
    quiet += !cast.neighbours.update(cast.phases, false);
    cast.pack();
    for (std::size_t q = 0; q < 3; ++q)
      expect_complete(cast, q, cast.directions[q].radius, cast.directions[q].radius * 1.2 * 1.2);
  }
  EXPECT_GE(quiet, 10) << "the ends move by 0.1 a step against each other: a third of the skin";
  EXPECT_LT(quiet, 16) << "in the end the strain shows";
}

TEST(Skin, ACommonMotionNeedsNoNewLists) {
  Cast cast = two_hundred(0.1);
  for (std::size_t k = 0; k < cast.phases[0].size(); ++k) cast.phases[0].column(Field::position, 0)[k] += 0.9;
  EXPECT_FALSE(cast.neighbours.update(cast.phases, false));
  cast.pack();
  expect_complete(cast, 0, 2.0, 2.2);
}

// Two bodies that fly at each other through empty space: nothing near either of them moves against it.
TEST(Skin, BodiesThatCrossAGapMeet) {
  Uniform random(9);
  const Bounds b = box(2, {60, 8, 0}, {false, false, false});
  auto left = lattice(box(2, {6, 8, 0}, {false, false, false}), 1.0, 0.1, random), all = left;
  for (auto x : left) {
    x[0] += 54.0;
    all.push_back(x);
  }
  std::vector<PhaseParticles> one;
  one.push_back(phase(2, all, 1.0));
  Cast cast(b, std::move(one), {{0, 0, 2.0}}, 0.1);
  for (int step = 0; step < 50; ++step) {
    auto& p = cast.phases[0];
    for (std::size_t k = 0; k < p.size(); ++k)
      p.column(Field::position, 0)[k] += p.id()[k] < static_cast<std::int64_t>(left.size()) ? 0.5 : -0.5;
    cast.neighbours.update(cast.phases, false);
    cast.pack();
    expect_complete(cast, 0, 2.0, 60.0);
  }
  EXPECT_GT(cast.neighbours.rebuilds(), 2);
}

// Particles that hardly move get a thin skin, fast ones a wide one again, and no list misses anybody meanwhile.
TEST(Skin, FollowsTheMotion) {
  Cast cast = two_hundred(0.1);
  cast.neighbours.adapt_skin();
  Uniform random(10);
  const auto shake = [&](int steps, double most) {
    for (int step = 0; step < steps; ++step) {
      auto& p = cast.phases[0];
      for (int d = 0; d < 2; ++d)
        for (std::size_t k = 0; k < p.size(); ++k) p.column(Field::position, d)[k] += random(-most, most);
      cast.neighbours.update(cast.phases, false);
      cast.pack();
      if (step % 4 == 0) expect_complete(cast, 0, 2.0, 2.5);
    }
  };
  shake(140, 1e-6);
  EXPECT_LT(cast.neighbours.skin(), 0.04);
  EXPECT_LT(cast.neighbours.rebuilds(), 5);
  shake(60, 0.03);
  EXPECT_GT(cast.neighbours.skin(), 0.09);
}

TEST(Skin, APositionThatIsNotFiniteRebuilds) {
  Cast cast = two_hundred(0.1);
  cast.phases[0].column(Field::position, 0)[5] = std::numeric_limits<double>::infinity();
  EXPECT_TRUE(cast.neighbours.update(cast.phases, false));
  SUCCEED() << "and nothing is read out of bounds";
}

}  // namespace
}  // namespace barchan
