// How cells are divided among ranks: equal sums of weights, and weights by the measured cost of steps.
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "engine/neighbours.hpp"
#include "engine/rank_load.hpp"
#include "unit/particle_sets.hpp"

namespace barchan {
namespace {

using namespace sets;

/// A square of unit spacing, 64 by 64, in cells.
Cast square() {
  const Bounds b = box(2, {64, 64, 0}, {false, false, false});
  Uniform random(5);
  std::vector<PhaseParticles> one;
  one.push_back(phase(2, lattice(b, 1.0, 0.1, random), 1.0));
  return Cast(b, std::move(one), {{0, 0, 2.1}});
}

/// By rank: the sum of the weights of its rows.
std::vector<std::int64_t> sums(const CellGrid& grid, const CellOwners& owners,
                               const std::vector<std::int64_t>& weights) {
  const std::vector<std::uint32_t> rows = grid.rows_of_strips();
  std::vector<std::int64_t> all(owners.ranks(), 0);
  std::size_t rank = 0;
  for (std::size_t r = 0; r < weights.size(); ++r) {
    while (rows[r] >= owners.first[rank + 1]) ++rank;
    all[rank] += weights[r];
  }
  return all;
}

TEST(DivisionByWeights, HasEqualSumsButForARow) {
  const Cast c = square();
  const CellGrid& grid = c.neighbours.grid(0);
  std::vector<std::int64_t> weights(grid.rows_of_strips().size() - 1);
  for (std::size_t r = 0; r < weights.size(); ++r) weights[r] = static_cast<std::int64_t>(10 + r % 7 + r);
  const double total = static_cast<double>(std::accumulate(weights.begin(), weights.end(), std::int64_t{0}));
  const double heaviest = static_cast<double>(*std::max_element(weights.begin(), weights.end()));
  for (const std::size_t ranks : {std::size_t{1}, std::size_t{2}, std::size_t{3}, std::size_t{7}}) {
    const std::vector<std::int64_t> of = sums(grid, grid.divided(weights, ranks), weights);
    for (const std::int64_t sum : of)
      EXPECT_NEAR(static_cast<double>(sum), total / static_cast<double>(ranks), heaviest) << ranks << " ranks";
  }
}

/// Particles in each row of strips.
std::vector<std::int64_t> particles_by_row(const CellGrid& grid) {
  const std::vector<std::uint32_t> rows = grid.rows_of_strips();
  std::vector<std::int64_t> by_row(rows.size() - 1, 0);
  std::uint32_t w = 0;  // place in the walk
  grid.each_block(grid.divided(1), [&](std::size_t, std::int32_t, std::uint32_t cell) {
    const auto row = std::upper_bound(rows.begin(), rows.end(), w++) - rows.begin() - 1;
    by_row[static_cast<std::size_t>(row)] += static_cast<std::int64_t>(grid.count(cell));
  });
  return by_row;
}

TEST(DivisionByWeights, OfEqualParticlesIsThatByTheirNumber) {
  const Cast c = square();
  const CellGrid& grid = c.neighbours.grid(0);
  std::vector<std::int64_t> weights = particles_by_row(grid);
  for (std::int64_t& weight : weights) weight *= 48;
  EXPECT_EQ(grid.divided(weights, 5).first, grid.divided(5).first);
}

TEST(DivisionByWeights, GivesARankOfDearParticlesFewer) {
  const Cast c = square();
  const CellGrid& grid = c.neighbours.grid(0);
  std::vector<std::int64_t> weights = particles_by_row(grid);
  std::int64_t before = 0;
  for (std::int64_t& weight : weights) {
    const std::int64_t particles = weight;
    if (before < 64 * 32) weight *= 3;  // the first half
    before += particles;
  }
  const auto particles = grid.particles_by_rank(grid.divided(weights, 2));
  // 3 x = 3 (1/2 - x) + 1/2: a third of all.
  EXPECT_NEAR(static_cast<double>(particles[0]), 64.0 * 64.0 / 3.0, 32.0);
}

TEST(RankCosts, AreSecondsAUnitOfWorkOverTheirMean) {
  RankCosts costs;
  EXPECT_EQ(costs.imbalance(), 1.0);
  costs.add({{3.0, 100.0}, {1.0, 100.0}}, 10);
  EXPECT_DOUBLE_EQ(costs.of(0), 1.5);
  EXPECT_DOUBLE_EQ(costs.of(1), 0.5);
  EXPECT_DOUBLE_EQ(costs.imbalance(), 1.5);
  // The work has been divided anew: the same costs, and all ranks take as long.
  RankCosts divided;
  divided.add({{3.0, 100.0}, {1.0, 100.0}}, 10);
  divided.add({{1.5, 50.0}, {1.5, 150.0}}, 10);
  EXPECT_NEAR(divided.imbalance(), 1.0, 1e-12);
}

TEST(RankCosts, AreSmoothedOverSeveralLooks) {
  RankCosts costs;
  for (int look = 0; look < 20; ++look) costs.add({{1.0, 100.0}, {1.0, 100.0}}, 8);
  costs.add({{2.0, 100.0}, {1.0, 100.0}}, 8);  // noise
  EXPECT_LT(costs.imbalance(), 1.09) << "one look of five that count";
  EXPECT_GT(costs.imbalance(), 1.0);
  for (int look = 0; look < 20; ++look) costs.add({{2.0, 100.0}, {1.0, 100.0}}, 8);
  EXPECT_NEAR(costs.imbalance(), 4.0 / 3.0, 0.02) << "what lasts counts";
}

TEST(RankCosts, LeaveNoRankWithoutParticles) {
  RankCosts costs;
  costs.add({{100.0, 1.0}, {1.0, 1000.0}, {1.0, 0.0}}, 8);
  EXPECT_EQ(costs.of(0), 4.0);
  EXPECT_EQ(costs.of(1), 0.25);
  EXPECT_EQ(costs.of(2), 1.0) << "has measured nothing";
}

}  // namespace
}  // namespace barchan
