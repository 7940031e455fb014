// The search of spheres against its naive twin, which looks at all pairs: which pairs a chunk has, by which law, how
// much of their energy is its own, which sides its spheres are near, and whose memory of a contact goes with them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <tuple>

#include "models/grains/sphere_search.hpp"
#include "unit/sphere_sets.hpp"

namespace barchan::sphere_search_test {
namespace {

using sets::SphereCast;
using sets::Uniform;

constexpr double slack = 0.13;  // m; the spheres have diameters of about 1 m

template <int Dim>
void search(SphereCast<Dim>& cast, const std::vector<SphereSearch::Side>& sides = {}) {
  SphereSearch of;
  of.prepare(cast.bounds, cast.reach, cast.number_of_kinds, cast.laws, sides, cast.numbers_of_a_pair);
  of.keep(0, cast.set().moving, cast.set().all, cast.chunks, cast.numbers.data());
  of.find(cast.set(), slack, cast.chunks);
}

/// Compares the lists of all chunks with the naive ones and returns the number of pairs.
template <int Dim>
std::size_t compare(const SphereCast<Dim>& cast, const std::string& what) {
  std::size_t pairs = 0;
  for (std::size_t c = 0; c < cast.chunks.size(); ++c) {
    const auto naive = cast.expected(
        c, [&](std::size_t i, std::size_t j) { return cast.distance(i, j) < cast.radius(i) + cast.radius(j) + slack; });
    EXPECT_EQ(cast.listed(cast.chunks[c]), naive) << what << ", chunk " << c;
    pairs += naive.size();
  }
  return pairs;
}

template <int Dim>
void compare_sets(std::array<bool, 3> periodic) {
  // Cells are as wide as the largest sum of radii and the slack, so that 3.7 m has three of them: fewer than any
  // domain with neighbours on two sides.
  for (const double wide : {3.7, 9.0})
    for (const double perturb : {0.0, 0.3})
      for (const std::size_t kinds : {1u, 3u}) {
        Uniform random(17);
        const Bounds bounds = sets::box(Dim, {wide, 7.0, Dim == 3 ? 5.0 : 0.0}, periodic, {-1.0, 2.0, -3.0});
        auto x = sets::lattice(bounds, 1.0, perturb, random);
        for (Vec3& at : x)  // some have left a periodic domain
          if (periodic[0] && random(0, 1) < 0.2) at[0] += wide;
        SphereCast<Dim> cast(bounds, x, x.size() / 5, 0.4, 0.55, kinds, 16, random);
        search(cast);
        const std::string what = "width " + std::to_string(wide) + ", perturbed by " + std::to_string(perturb) + ", " +
                                 std::to_string(kinds) + " kinds";
        EXPECT_GT(compare(cast, what), x.size() / 2) << what << ": a search with few pairs shows little";
      }
}

TEST(SphereSearch, FindsThePairsOfTheNaiveTwinInAPlane) { compare_sets<2>({false, false, false}); }
TEST(SphereSearch, FindsThePairsOfTheNaiveTwinInAPeriodicPlane) { compare_sets<2>({true, false, false}); }
TEST(SphereSearch, FindsThePairsOfTheNaiveTwinInSpace) { compare_sets<3>({false, false, false}); }
TEST(SphereSearch, FindsThePairsOfTheNaiveTwinInPeriodicSpace) { compare_sets<3>({true, false, true}); }

/// Sizes of 1:40: the levels of cells find what one grid of cells as wide as the largest sphere would.
template <int Dim>
void compare_levels(std::array<bool, 3> periodic, double slack_here) {
  Uniform random(41);
  const Bounds bounds = sets::box(Dim, {9.0, 7.0, Dim == 3 ? 6.0 : 0.0}, periodic, {-1.0, 2.0, -3.0});
  auto x = sets::scattered(bounds, Dim == 2 ? 3000 : 4000, random);
  for (Vec3& at : x)  // some have left a periodic domain
    if (periodic[0] && random(0, 1) < 0.2) at[0] -= 9.0;
  SphereCast<Dim> cast(bounds, x, 300, 1.0, 1.0, 2, 64, random);  // the reach is 2 m
  cast.spread_sizes(0.05, random);
  for (std::size_t k = 0; k < cast.all; ++k)  // most are small, as in a packing
    if (k % 50 != 0) cast.records[k * SphereCast<Dim>::R::size + SphereCast<Dim>::R::radius] *= 0.1;
  SphereSearch of;
  of.prepare(cast.bounds, cast.reach, cast.number_of_kinds, cast.laws, {}, cast.numbers_of_a_pair);
  of.take_sizes(cast.sizes());
  EXPECT_GE(of.levels(), 2u);
  EXPECT_LT(of.scale(), 0.3 * cast.reach);
  of.keep(0, cast.moving, cast.all, cast.chunks, cast.numbers.data());
  of.find(cast.set(), slack_here, cast.chunks);
  std::size_t pairs = 0;
  for (std::size_t c = 0; c < cast.chunks.size(); ++c) {
    const auto naive = cast.expected(c, [&](std::size_t i, std::size_t j) {
      return cast.distance(i, j) < cast.radius(i) + cast.radius(j) + slack_here;
    });
    EXPECT_EQ(cast.listed(cast.chunks[c]), naive) << "chunk " << c;
    pairs += naive.size();
  }
  EXPECT_GT(pairs, cast.all / 4) << "a search with few pairs shows little";
}

TEST(SphereSearch, FindsSpheresOfAllSizesInAPlane) { compare_levels<2>({false, false, false}, 0.03); }
TEST(SphereSearch, FindsSpheresOfAllSizesInAPeriodicPlane) { compare_levels<2>({true, true, false}, 0.01); }
TEST(SphereSearch, FindsSpheresOfAllSizesInSpace) { compare_levels<3>({false, false, false}, 0.1); }
TEST(SphereSearch, FindsSpheresOfAllSizesInPeriodicSpace) { compare_levels<3>({true, false, true}, 0.05); }

/// Sizes that differ by less than a factor of two are one level, and searched as if nothing were known of them.
TEST(SphereSearch, HasOneLevelForNarrowSizes) {
  SphereSizes narrow(1.0), walls(1.0), wide(1.0);
  for (int k = 0; k < 1000; ++k) {
    narrow.add(0.5 - 0.0002 * k, true);
    walls.add(k < 500 ? 0.49 : 0.2, k < 500);
    wide.add(k == 0 ? 0.5 : 0.01, true);
  }
  SphereSearch of;
  of.prepare(sets::box(3, {9.0, 7.0, 6.0}, {true, false, false}), 1.0, 1, {0}, {}, 3);
  for (const SphereSizes& sizes : {narrow, walls}) {
    of.take_sizes(sizes);
    EXPECT_EQ(of.levels(), 1u);
    EXPECT_EQ(of.scale(), 1.0);
  }
  of.take_sizes(wide);
  EXPECT_EQ(of.levels(), 2u);
  EXPECT_NEAR(of.scale(), 0.02, 1e-4) << "one large sphere among many small ones widens no list";
}

/// On periodic axes that are narrower than two spheres each pair has all images that may touch, once each.
template <int Dim>
void compare_images(double wide, double deep) {
  Uniform random(43);
  const Bounds bounds = sets::box(Dim, {wide, 7.0, deep}, {true, false, Dim == 3}, {-1.0, 2.0, -3.0});
  auto x = sets::scattered(bounds, 60, random);
  for (Vec3& at : x)  // places that nobody put back into the domain
    if (random(0, 1) < 0.3) at[0] += 3.0 * wide;
  SphereCast<Dim> cast(bounds, x, 10, 0.35, 0.55, 2, 16, random);
  SphereSearch of;
  of.prepare(cast.bounds, cast.reach, cast.number_of_kinds, cast.laws, {}, cast.numbers_of_a_pair);
  ASSERT_TRUE(of.images());
  of.take_sizes(cast.sizes());
  SphereSet set = cast.set();
  set.images = true;
  of.keep(0, cast.moving, cast.all, cast.chunks, cast.numbers.data(), cast.places.data());
  of.find(set, slack, cast.chunks);
  using Key = std::tuple<std::uint32_t, std::uint32_t, int, int>;
  constexpr std::size_t stride = SphereCast<Dim>::R::size;
  std::size_t twice = 0;
  for (std::size_t c = 0; c < cast.chunks.size(); ++c) {
    std::map<Key, int> listed, naive;
    const SphereChunk& chunk = cast.chunks[c];
    for (const auto& group : chunk.groups)
      for (std::size_t at = group.first * SphereChunk::batch; at < group.end * SphereChunk::batch; ++at)
        if (chunk.a[at] < cast.all)
          ++listed[{chunk.a[at], chunk.b[at], pair_image::periods(group.image, 0),
                    pair_image::periods(group.image, 2)}];
    for (const auto& [pair, how] : cast.expected(c, [](std::size_t, std::size_t) { return true; })) {
      const auto [a, b] = pair;
      int images = 0;
      for (int n = -9; n <= 9; ++n)
        for (int m = -9; m <= 9; ++m) {
          const double dx = cast.records[a * stride] - cast.records[b * stride] - n * wide,
                       dy = cast.records[a * stride + 1] - cast.records[b * stride + 1],
                       dz = Dim == 3 ? cast.records[a * stride + 2] - cast.records[b * stride + 2] - m * deep : 0.0;
          if ((Dim == 2 && m != 0) || !(std::hypot(dx, dy, dz) < cast.radius(a) + cast.radius(b) + slack)) continue;
          naive[{a, b, n, m}] = 1;
          ++images;
        }
      twice += images > 1 ? 1u : 0u;
    }
    EXPECT_EQ(listed, naive) << "chunk " << c;
  }
  EXPECT_GT(twice, 20u);
}

TEST(SphereSearch, FindsAllImagesOnANarrowPeriodicAxis) { compare_images<2>(1.3, 0.0); }
TEST(SphereSearch, FindsAllImagesOnNarrowPeriodicAxes) { compare_images<3>(1.7, 1.2); }

TEST(SphereSearch, FindsTheSidesThatASphereMayTouch) {
  Uniform random(3);
  const Bounds bounds = sets::box(2, {24.0, 14.0, 0.0}, {false, false, false});
  SphereCast<2> cast(bounds, sets::lattice(bounds, 1.0, 0.4, random), 0, 0.3, 0.6, 2, 8, random);
  search(cast, {{1, 1, 0.0, 0}, {0, -1, 24.0, 1}});  // the bottom of kind 0; the right side of kind 1
  std::size_t found = 0;
  for (std::size_t k = 0; k < cast.all; ++k) {
    const double x = cast.records[k * 8], y = cast.records[k * 8 + 1];
    const bool bottom = y < cast.radius(k) + slack;                              // each kind touches kind 0
    const bool right = cast.kinds[k] == 0 && 24.0 - x < cast.radius(k) + slack;  // kind 1 does not touch kind 1
    const auto& sides = cast.chunks[cast.chunk_of(k)].sides;
    const auto has = [&](std::uint16_t axis) {
      return std::count_if(sides.begin(), sides.end(), [&](const auto& s) { return s.sphere == k && s.axis == axis; });
    };
    EXPECT_EQ(has(1), bottom ? 1 : 0) << "sphere " << k << " at " << x << " " << y;
    EXPECT_EQ(has(0), right ? 1 : 0) << "sphere " << k << " at " << x << " " << y;
    found += bottom + right;
  }
  EXPECT_GT(found, 12u);
}

/// The memory of a contact follows the two numbers, wherever the spheres stand in memory at the next search.
TEST(SphereSearch, KeepsTheMemoryOfThoseThatTouch) {
  Uniform random(11);
  const Bounds bounds = sets::box(3, {6.0, 5.0, 4.0}, {true, false, false});
  SphereCast<3> cast(bounds, sets::lattice(bounds, 1.0, 0.2, random), 10, 0.45, 0.55, 1, 32, random);
  SphereSearch of;
  of.prepare(bounds, cast.reach, 1, cast.laws, {}, 3);
  of.keep(0, cast.set().moving, cast.set().all, cast.chunks, cast.numbers.data());
  of.find(cast.set(), slack, cast.chunks);
  constexpr std::size_t batch = SphereChunk::batch;
  // Numbers of a pair that say who the two are; pairs with an odd sum of numbers touch.
  const auto each_pair = [&](auto&& call) {
    for (SphereChunk& chunk : cast.chunks)
      for (std::size_t at = 0; at < chunk.a.size(); ++at)
        if (chunk.a[at] < cast.all) {
          const std::uint32_t a = cast.numbers[chunk.a[at]], b = cast.numbers[chunk.b[at]];
          call(chunk, at, a, b, 1.0 + a + 1000.0 * b);
        }
  };
  each_pair([&](SphereChunk& chunk, std::size_t at, std::uint32_t a, std::uint32_t b, double tag) {
    if ((a + b) % 2 == 0) return;
    chunk.touches[at / batch] = static_cast<std::uint8_t>(chunk.touches[at / batch] | 1u << at % batch);
    for (std::size_t m = 0; m < 3; ++m)
      chunk.memory[(at / batch * 3 + m) * batch + at % batch] = tag * static_cast<double>(m + 1);
  });
  // The moving spheres change their places in memory.
  const std::vector<std::uint32_t> before = cast.numbers;
  for (std::size_t k = cast.moving; k > 1; --k) {
    const auto other = static_cast<std::size_t>(random(0.0, static_cast<double>(k)));
    std::swap(cast.numbers[k - 1], cast.numbers[other]);
    std::swap_ranges(&cast.records[(k - 1) * 12], &cast.records[k * 12], &cast.records[other * 12]);
  }
  cast.take_places();
  of.keep(0, cast.set().moving, cast.set().all, cast.chunks, before.data());
  of.find(cast.set(), slack, cast.chunks);
  std::size_t touching = 0, parted = 0;
  each_pair([&](SphereChunk& chunk, std::size_t at, std::uint32_t a, std::uint32_t b, double tag) {
    const bool touches = (chunk.touches[at / batch] >> at % batch & 1u) != 0;
    EXPECT_EQ(touches, (a + b) % 2 != 0) << a << " " << b;
    ++(touches ? touching : parted);
    for (std::size_t m = 0; m < 3; ++m)
      EXPECT_EQ(chunk.memory[(at / batch * 3 + m) * batch + at % batch],
                touches ? tag * static_cast<double>(m + 1) : 0.0);
  });
  EXPECT_GT(touching, 50u);
  EXPECT_GT(parted, 50u);
}

/// order() is a permutation, and neighbours in it are near in space.
TEST(SphereSearch, OrdersSpheresSoThatNeighboursAreNear) {
  Uniform random(2);
  const Bounds bounds = sets::box(2, {40.0, 40.0, 0.0}, {true, false, false});
  const auto x = sets::scattered(bounds, 900, random);
  std::vector<double> columns[2];
  for (const Vec3& at : x)
    for (std::size_t d = 0; d < 2; ++d) columns[d].push_back(at[d]);
  SphereSearch of;
  of.prepare(bounds, 1.0, 1, {0}, {}, 1);
  std::vector<std::uint32_t> order;
  std::vector<std::int64_t> id(x.size());
  std::iota(id.rbegin(), id.rend(), 0);
  of.order({columns[0].data(), columns[1].data(), nullptr}, id, order);
  ASSERT_EQ(order.size(), x.size());
  double apart = 0.0, as_given = 0.0;
  for (std::size_t k = 1; k < x.size(); ++k) {
    apart += norm(x[order[k]] - x[order[k - 1]]);
    as_given += norm(x[k] - x[k - 1]);
  }
  EXPECT_LT(apart, 0.4 * as_given);
  std::sort(order.begin(), order.end());
  for (std::uint32_t k = 0; k < order.size(); ++k) ASSERT_EQ(order[k], k);
}

}  // namespace
}  // namespace barchan::sphere_search_test
