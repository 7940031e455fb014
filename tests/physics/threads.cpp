// Results do not depend on the number of threads: every bit of every field after a hundred steps of scenes that use all
// passes is the same with one, two and three threads, and the same when the run is repeated.
#include <gtest/gtest.h>
#include <omp.h>

#include <cstring>

#include "physics/small_scenes.hpp"

namespace barchan {
namespace {

/// Ids and all fields of all phases, in the order in which they stand.
struct State {
  std::vector<std::int64_t> ids;
  std::vector<double> values;
  double time = 0.0;
  long rebuilds = 0;
};

State state_after(const std::string& text, int threads, int steps) {
  const int before = omp_get_max_threads();
  omp_set_num_threads(threads);
  const auto run = small::simulation(text);
  for (int k = 0; k < steps; ++k) run->step(1.0);
  omp_set_num_threads(before);
  State s;
  s.time = run->time();
  s.rebuilds = run->neighbours().rebuilds();
  for (const auto& p : run->phases()) {
    s.ids.insert(s.ids.end(), p.id().begin(), p.id().end());
    for (const auto& about : field_table)
      if (p.has(about.id))
        for (int c = 0; c < p.components(about.id); ++c)
          s.values.insert(s.values.end(), p.column(about.id, c), p.column(about.id, c) + p.size());
  }
  return s;
}

void expect_same_bits(const State& a, const State& b) {
  EXPECT_EQ(a.ids, b.ids);
  EXPECT_EQ(a.time, b.time);
  EXPECT_EQ(a.rebuilds, b.rebuilds);
  ASSERT_EQ(a.values.size(), b.values.size());
  EXPECT_EQ(std::memcmp(a.values.data(), b.values.data(), a.values.size() * sizeof(double)), 0);
}

class Threads : public testing::TestWithParam<std::pair<const char*, const std::string*>> {};

TEST_P(Threads, DoNotChangeABit) {
  const std::string& text = *GetParam().second;
  const State once = state_after(text, 1, 100);
  EXPECT_GT(once.rebuilds, 1) << "the test is meant to see particles sorted anew";
  expect_same_bits(once, state_after(text, 1, 100));
  expect_same_bits(once, state_after(text, 2, 100));
  expect_same_bits(once, state_after(text, 3, 100));
  State other = state_after(text, 1, 99);
  EXPECT_NE(once.time, other.time);
  EXPECT_NE(once.values, other.values) << "and one step more does change them";
}

const std::string mixed_dune = "precision = \"mixed\"\n" + small::dune;
const std::string mixed_channel = "precision = \"mixed\"\n" + small::channel;

INSTANTIATE_TEST_SUITE_P(Scenes, Threads,
                         testing::Values(std::pair{"Dune", &small::dune},
                                         std::pair{"TurbulentDune", &small::turbulent_dune},
                                         std::pair{"TwoFluids", &small::two_fluids},
                                         std::pair{"Channel", &small::channel}, std::pair{"Squares", &small::squares},
                                         std::pair{"Grains", &small::grains}, std::pair{"MixedDune", &mixed_dune},
                                         std::pair{"MixedChannel", &mixed_channel}),
                         [](const auto& s) { return std::string(s.param.first); });

}  // namespace
}  // namespace barchan
