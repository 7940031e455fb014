// Strays of spheres against the naive twin: whoever may touch a stray before one of the two uses up its allowance is in
// the lists, once in the chunk of each, and who is out of reach is not.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "models/grains/sphere_strays.hpp"
#include "unit/sphere_sets.hpp"

namespace barchan::sphere_strays_test {
namespace {

using sets::SphereCast;
using sets::Uniform;

constexpr double stray_slack = 0.2, step = 0.01;  // m, s

template <int Dim>
struct Strayed {
  static constexpr std::size_t stride = SphereRecord<Dim>::size;
  SphereCast<Dim> cast;
  std::vector<SphereSearch::Side> sides;
  SphereSearch search;
  SphereStrays strays;
  SphereShares shares;            // of one process
  std::vector<double> allowance;  // m, by sphere, as it must be
  std::vector<bool> renewed;

  explicit Strayed(SphereCast<Dim> c, std::vector<SphereSearch::Side> s = {})
      : cast(std::move(c)), sides(std::move(s)) {
    search.prepare(cast.bounds, cast.reach, cast.number_of_kinds, cast.laws, sides, cast.numbers_of_a_pair);
    search.take_sizes(cast.sizes());
    strays.prepare(cast.set(), cast.reach, cast.chunks, cast.numbers_of_a_pair);
    strays.begin(cast.set(), stray_slack);
    shares.divide(cast.chunks, {});
    search.keep(0, cast.moving, cast.all, cast.chunks, cast.numbers.data());
    search.find(set(), stray_slack, cast.chunks);
    strays.take_cells(search.cells());
    allowance.assign(cast.all, 0.5 * stray_slack);
    renewed.assign(cast.all, false);
  }
  SphereSet set() const {
    SphereSet s = cast.set();
    s.places = strays.places();
    return s;
  }
  /// A sphere goes to x with a velocity along the first axis.
  void go(std::size_t k, const Vec3& x, double speed) {
    for (std::size_t d = 0; d < Dim; ++d) cast.records[k * stride + d] = x[d];
    cast.records[k * stride + SphereRecord<Dim>::velocity] = speed;
    strays.renew(set(), static_cast<std::uint32_t>(k), step, sides, cast.chunks, shares);
    renewed[k] = true;
    // Forty steps at its speed, half of the slack at least, the reach at most.
    allowance[k] = std::clamp(40.0 * step * std::abs(speed), 0.5 * stray_slack, cast.reach);
  }
  /// Of the places where the last search of each sphere found it.
  bool may_touch(std::size_t i, std::size_t j) const {
    const double gap = cast.distance(strays.places(), Dim, i, j) - cast.radius(i) - cast.radius(j);
    return gap < allowance[i] + allowance[j];
  }
  void compare(const std::string& what) const {
    std::size_t of_strays = 0;
    for (std::size_t c = 0; c < cast.chunks.size(); ++c) {
      const auto listed = cast.listed(cast.chunks[c]);
      const auto naive = cast.expected(c, [&](std::size_t i, std::size_t j) { return may_touch(i, j); });
      for (const auto& [pair, how] : naive) {
        const auto found = listed.find(pair);
        ASSERT_NE(found, listed.end()) << what << ": " << pair.first << " and " << pair.second << " may touch unseen";
        EXPECT_EQ(found->second, how) << what;
        of_strays += renewed[pair.first] || renewed[pair.second];
      }
      for (const auto& [pair, how] : listed) {
        if (!renewed[pair.first] && !renewed[pair.second]) continue;
        EXPECT_TRUE(naive.contains(pair))
            << what << ": " << pair.first << " and " << pair.second << " are out of reach";
      }
    }
    EXPECT_GT(of_strays, 10u) << what;
  }
};

template <int Dim>
void compare_strays(std::array<bool, 3> periodic, double perturb) {
  Uniform random(23);
  const Bounds bounds = sets::box(Dim, {9.0, 8.0, Dim == 3 ? 6.0 : 0.0}, periodic, {-2.0, 1.0, 0.5});
  const auto x = sets::lattice(bounds, 1.0, perturb, random);
  Strayed<Dim> strayed(SphereCast<Dim>(bounds, x, x.size() / 6, 0.35, 0.5, 2, 16, random));
  const std::size_t moving = strayed.cast.moving;
  // Some go anywhere, slow and fast, one of them twice; then some go a short way.
  for (std::size_t n = 0; n < 12; ++n) {
    const auto k = static_cast<std::size_t>(random(0.0, static_cast<double>(moving)));
    strayed.go(k, sets::scattered(bounds, 1, random)[0], n % 3 == 0 ? 0.0 : random(-4.0, 4.0));
    if (n == 5) strayed.go(k, sets::scattered(bounds, 1, random)[0], 1.0);
  }
  strayed.compare("gone anywhere");
  for (std::size_t n = 0; n < 12; ++n) {
    const auto k = static_cast<std::size_t>(random(0.0, static_cast<double>(moving)));
    Vec3 to = x[k];
    for (std::size_t d = 0; d < Dim; ++d)
      to[d] = strayed.cast.records[k * Strayed<Dim>::stride + d] + random(-0.3, 0.3);
    strayed.go(k, to, random(-0.5, 0.5));
  }
  strayed.compare("gone a short way");
}

TEST(SphereStrays, AreInTheListsOfTheNaiveTwinInAPlane) { compare_strays<2>({false, false, false}, 0.0); }
TEST(SphereStrays, AreInTheListsOfTheNaiveTwinInAPeriodicPlane) { compare_strays<2>({true, false, false}, 0.3); }
TEST(SphereStrays, AreInTheListsOfTheNaiveTwinInSpace) { compare_strays<3>({false, false, false}, 0.3); }
TEST(SphereStrays, AreInTheListsOfTheNaiveTwinInPeriodicSpace) { compare_strays<3>({true, true, false}, 0.0); }

/// Strays of 1:30 in sizes, whose cells are of several levels.
template <int Dim>
void compare_sizes(std::array<bool, 3> periodic) {
  Uniform random(37);
  const Bounds bounds = sets::box(Dim, {9.0, 8.0, Dim == 3 ? 6.0 : 0.0}, periodic, {-2.0, 1.0, 0.5});
  SphereCast<Dim> cast(bounds, sets::scattered(bounds, 1200, random), 100, 1.5, 1.5, 2, 64, random);
  cast.spread_sizes(0.1, random);
  for (std::size_t k = 0; k < cast.all; ++k)
    if (k % 40 != 0) cast.records[k * SphereCast<Dim>::R::size + SphereCast<Dim>::R::radius] *= 0.1;
  Strayed<Dim> strayed(std::move(cast));
  EXPECT_GE(strayed.search.levels(), 2u);
  for (std::size_t n = 0; n < 24; ++n) {
    const std::size_t k = n % 2 == 0 ? 40 * n : 40 * n + 7;  // a large one, a small one
    strayed.go(k, sets::scattered(bounds, 1, random)[0], n % 3 == 0 ? 0.0 : random(-2.0, 2.0));
  }
  strayed.compare("of all sizes");
}

TEST(SphereStrays, AreInTheListsWhateverTheirSizesInAPeriodicPlane) { compare_sizes<2>({true, false, false}); }
TEST(SphereStrays, AreInTheListsWhateverTheirSizesInSpace) { compare_sizes<3>({false, false, false}); }
TEST(SphereStrays, AreInTheListsWhateverTheirSizesInPeriodicSpace) { compare_sizes<3>({false, true, true}); }

TEST(SphereStrays, FindTheSidesThatTheyMayTouch) {
  Uniform random(29);
  const Bounds bounds = sets::box(2, {9.0, 9.0, 0.0}, {true, false, false});
  Strayed<2> strayed(SphereCast<2>(bounds, sets::lattice(bounds, 1.0, 0.0, random), 0, 0.4, 0.4, 1, 16, random),
                     {{1, 1, 0.0, 0}, {1, -1, 9.0, 0}});
  const auto at_sides = [&](std::size_t k) {
    std::vector<std::int16_t> signs;
    for (const auto& side : strayed.cast.chunks[strayed.cast.chunk_of(k)].sides)
      if (side.sphere == k) signs.push_back(side.sign);
    return signs;
  };
  const std::size_t k = 40;  // in the middle
  EXPECT_TRUE(at_sides(k).empty());
  strayed.go(k, {4.0, 0.4 + 0.09, 0.0}, 0.0);  // a gap below half of the slack
  EXPECT_EQ(at_sides(k), std::vector<std::int16_t>{1});
  strayed.go(k, {4.0, 0.4 + 0.09, 0.0}, 0.1);
  EXPECT_EQ(at_sides(k), std::vector<std::int16_t>{1}) << "once";
  strayed.go(41, {4.0, 9.0 - 0.4 - 0.3, 0.0}, 0.0);
  EXPECT_TRUE(at_sides(41).empty()) << "a gap of 0.3 m, an allowance of 0.1 m";
  strayed.go(41, {4.0, 9.0 - 0.4 - 0.3, 0.0}, 1.0);  // an allowance of 0.4 m
  EXPECT_EQ(at_sides(41), std::vector<std::int16_t>{-1});
}

/// A contact is a matter of two spheres, not of a search: who touches stays in the list, wherever a stray goes.
TEST(SphereStrays, LeaveNobodyWhomTheyTouch) {
  Uniform random(31);
  const Bounds bounds = sets::box(2, {9.0, 9.0, 0.0}, {false, false, false});
  Strayed<2> strayed(SphereCast<2>(bounds, sets::lattice(bounds, 1.0, 0.0, random), 0, 0.5, 0.5, 1, 200, random));
  SphereChunk& chunk = strayed.cast.chunks[0];
  const auto before = strayed.cast.listed(chunk);
  std::vector<std::pair<std::uint32_t, std::uint32_t>> of_stray;
  for (const auto& [pair, how] : before)
    if (pair.first == 40 || pair.second == 40) of_stray.push_back(pair);
  ASSERT_EQ(of_stray.size(), 4u);
  for (std::size_t at = 0; at < chunk.a.size(); ++at)
    if (std::pair{chunk.a[at], chunk.b[at]} == of_stray[1])
      chunk.touches[at / SphereChunk::batch] = static_cast<std::uint8_t>(1u << at % SphereChunk::batch);
  strayed.go(40, {4.5, 8.9, 0.0}, 0.0);
  const auto after = strayed.cast.listed(chunk);
  for (std::size_t n = 0; n < 4; ++n) EXPECT_EQ(after.contains(of_stray[n]), n == 1) << n;
}

TEST(SphereStrays, SearchesAllAgainWhenManyAreSlow) {
  Uniform random(37);
  const Bounds bounds = sets::box(2, {16.0, 16.0, 0.0}, {false, false, false});
  Strayed<2> strayed(SphereCast<2>(bounds, sets::lattice(bounds, 1.0, 0.0, random), 0, 0.4, 0.4, 1, 64, random));
  // 64 and a 64th of the 256 spheres.
  EXPECT_TRUE(strayed.strays.few(67));
  EXPECT_FALSE(strayed.strays.few(68));
  for (std::size_t k = 0; k < 10; ++k) strayed.go(k, {0.5 + static_cast<double>(k), 0.4, 0.0}, 0.0);
  for (std::size_t k = 10; k < 20; ++k) strayed.go(k, {4.5, 0.5, 0.0}, 5.0);  // their allowances are longer: they last
  EXPECT_TRUE(strayed.strays.few(57));
  EXPECT_FALSE(strayed.strays.few(58));
}

}  // namespace
}  // namespace barchan::sphere_strays_test
