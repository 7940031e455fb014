// What threads share out against its serial twin, bit by bit: the sort by cell, the mean of many values, and the seeds
// of the distance to the ground.
#include <gtest/gtest.h>
#include <omp.h>

#include <algorithm>

#include "models/fluid/ground_distance.hpp"
#include "unit/particle_sets.hpp"

namespace barchan {
namespace {

class Threads : public ::testing::TestWithParam<int> {
 protected:
  void SetUp() override { omp_set_num_threads(GetParam()); }
  void TearDown() override { omp_set_num_threads(before_); }

 private:
  int before_ = omp_get_max_threads();
};
INSTANTIATE_TEST_SUITE_P(Numbers, Threads, ::testing::Values(1, 2, 3, 7));

/// By cell in the order of the blocks' runs; in a cell, particles keep the order that they had.
TEST_P(Threads, SortKeepsTheOrderWithinACell) {
  sets::Uniform random(5);
  const Bounds bounds = sets::box(2, {20, 12, 0}, {true, false, false});
  PhaseParticles p("p", 2, 3000, 1.0, 0);
  for (const Field f : {Field::position, Field::velocity}) p.add(f);
  Blocks blocks;
  blocks.count = {4, 3, 1};
  blocks.side = {5, 4, 1};
  CellGrid grid(bounds, 1.0, 1.2, blocks);
  for (int round = 0; round < 3; ++round) {
    for (std::size_t k = 0; k < p.size(); ++k) {
      p.column(Field::position, 0)[k] = random(-25, 45);  // some a period outside
      p.column(Field::position, 1)[k] = random(-1, 13);
      p.column(Field::velocity, 1)[k] = static_cast<double>(p.id()[k]);
    }
    std::vector<double> x(p.size()), wrapped(p.size());
    for (std::size_t k = 0; k < p.size(); ++k) {
      const auto id = static_cast<std::size_t>(p.id()[k]);
      x[id] = p.column(Field::position, 0)[k];
      wrapped[id] = x[id] - 20.0 * std::floor(x[id] / 20.0);
    }
    grid.sort(p);
    std::vector<bool> seen(p.size());
    std::vector<std::size_t> cells;
    for (std::size_t k = 0; k < p.size(); ++k) {
      const auto id = static_cast<std::size_t>(p.id()[k]);
      EXPECT_FALSE(seen[id]);
      seen[id] = true;
      ASSERT_EQ(p.column(Field::velocity, 1)[k], static_cast<double>(id)) << "columns move together";
      ASSERT_NEAR(p.column(Field::position, 0)[k], wrapped[id], 1e-12);
      const std::size_t cell = grid.cell_of({grid.search_position(0)[k], grid.search_position(1)[k], 0.0f});
      if (cells.empty() || cells.back() != cell) cells.push_back(cell);
      else ASSERT_LT(p.id()[k - 1], p.id()[k]) << "in cell " << cell;
    }
    std::sort(cells.begin(), cells.end());
    EXPECT_EQ(std::adjacent_find(cells.begin(), cells.end()), cells.end()) << "a cell's particles stand together";
  }
}

/// Danielsson's sweeps as the book has them: every cell is visited by every sweep, every place computed anew.
class PlainGround {
 public:
  PlainGround(const Bounds& bounds, double spacing, const std::vector<Vec3>& grains) : b_(bounds), spacing_(spacing) {
    for (std::size_t d = 0; d < dims(); ++d) {
      count_[d] = std::max(1, static_cast<int>(std::floor((b_.high[d] - b_.low[d]) / spacing + 1e-9)));
      side_[d] = (b_.high[d] - b_.low[d]) / count_[d];
    }
    std::size_t cells = 1;
    for (const int count : count_) cells *= static_cast<std::size_t>(count);
    nearest_.assign(cells, -1);
    std::vector<int> crowd(nearest_.size());
    for (const Vec3& g : grains) ++crowd[cell(place(g))];
    for (const Vec3& g : grains) {
      int company = 0;
      about(place(g), [&](std::size_t c) { company += crowd[c]; });
      if (company < 4) continue;
      auto& seed = nearest_[cell(place(g))];
      if (seed < 0) seed = static_cast<int>(seeds_.size());
      seeds_.push_back(g);
    }
    for (int round = 0; round < 8; ++round)
      for (const bool back : {false, true})
        for (int q = 0; q < static_cast<int>(nearest_.size()); ++q)
          visit(back ? static_cast<int>(nearest_.size()) - 1 - q : q);
  }
  double distance(const Vec3& x) const {
    double least = 1e300;
    about(place(x), [&](std::size_t c) { least = std::min(least, squared(x, nearest_[c])); });
    return std::max(std::sqrt(least) - 0.5 * spacing_, 0.0);
  }

 private:
  std::size_t dims() const { return static_cast<std::size_t>(b_.dimensions); }
  std::array<int, 3> place(const Vec3& x) const {
    std::array<int, 3> at{};
    for (std::size_t d = 0; d < dims(); ++d)
      at[d] = std::clamp(static_cast<int>(std::floor((x[d] - b_.low[d]) / side_[d])), 0, count_[d] - 1);
    return at;
  }
  std::size_t cell(const std::array<int, 3>& at) const {
    const auto whole = [](int number) { return static_cast<std::size_t>(number); };
    return (whole(at[2]) * whole(count_[1]) + whole(at[1])) * whole(count_[0]) + whole(at[0]);
  }
  template <class F>
  void about(const std::array<int, 3>& at, F&& f) const {
    for (int x = -1; x <= 1; ++x)
      for (int y = -1; y <= 1; ++y)
        for (int z = -1; z <= 1; ++z) {
          std::array<int, 3> b{at[0] + x, at[1] + y, at[2] + z};
          bool inside = true;
          for (std::size_t d = 0; d < 3; ++d) {
            if (count_[d] == 1 && b[d] != 0) inside = false;
            if (b_.periodic[d]) b[d] = (b[d] + count_[d]) % count_[d];
            inside = inside && b[d] >= 0 && b[d] < count_[d];
          }
          if (inside) f(cell(b));
        }
  }
  double squared(const Vec3& x, int seed) const {
    if (seed < 0) return 1e300;
    double sum = 0.0;
    for (std::size_t d = 0; d < dims(); ++d) {
      double r = x[d] - seeds_[static_cast<std::size_t>(seed)][d];
      const double period = b_.high[d] - b_.low[d];
      if (b_.periodic[d] && std::abs(r) > 0.5 * period) r -= period * std::round(r / period);
      sum += r * r;
    }
    return sum;
  }
  void visit(int number) {
    const std::array<int, 3> at{number % count_[0], number / count_[0] % count_[1], number / (count_[0] * count_[1])};
    Vec3 centre{};
    for (std::size_t d = 0; d < 3; ++d) centre[d] = b_.low[d] + (at[d] + 0.5) * side_[d];
    int mine = nearest_[static_cast<std::size_t>(number)];
    about(at, [&](std::size_t c) {
      if (squared(centre, nearest_[c]) < squared(centre, mine)) mine = nearest_[c];
    });
    nearest_[static_cast<std::size_t>(number)] = mine;
  }

  Bounds b_;
  double spacing_;
  std::array<int, 3> count_{1, 1, 1};
  std::array<double, 3> side_{1, 1, 1};
  std::vector<int> nearest_;
  std::vector<Vec3> seeds_;
};

/// On a lattice, where many seeds are equally near, the first that a sweep meets must win as in the twin.
TEST(GroundDistance, HasTheSeedsOfPlainSweeps) {
  sets::Uniform random(8);
  for (const int dimensions : {2, 3})
    for (const bool periodic : {false, true})
      for (const double disorder : {0.0, 0.3}) {
        const bool solid = dimensions == 3;
        const Bounds bounds = sets::box(dimensions, {12, 9, solid ? 7.0 : 0.0}, {periodic, false, solid && periodic});
        std::vector<Vec3> grains;
        for (int x = 0; x < 12; ++x)
          for (int y = 0; y < (x % 5 == 0 ? 4 : 2); ++y)
            for (int z = 0; z < (solid ? 7 : 1); ++z)
              if (x < 4 || x > 9)
                grains.push_back({x + 0.5 + disorder * random(-1, 1), y + 0.5 + disorder * random(-1, 1),
                                  solid ? z + 0.5 + disorder * random(-1, 1) : 0.0});
        PhaseParticles sand("sand", dimensions, grains.size(), 1.0, 0);
        sand.add(Field::position);
        GroundDistance ground(bounds, Sides{}, 1.0, true);
        const GroundDistance::Ground phases[] = {{&sand, 1.0}};
        for (int round = 0; round < 2; ++round) {  // the second finds the memory of the first
          for (Vec3& g : grains) g[1] += 0.01 * round;
          for (std::size_t k = 0; k < grains.size(); ++k)
            for (int d = 0; d < dimensions; ++d)
              sand.column(Field::position, d)[k] = grains[k][static_cast<std::size_t>(d)];
          ground.refresh(phases);
          const PlainGround twin(bounds, 1.0, grains);
          for (int k = 0; k < 3000; ++k) {
            const Vec3 x{random(-0.5, 12.5), random(-0.5, 9.5), solid ? random(0, 7) : 0.0};
            ASSERT_NEAR(ground.distance(x), twin.distance(x), 1e-12) << dimensions << "D, " << periodic << disorder;
          }
        }
      }
}

}  // namespace
}  // namespace barchan
