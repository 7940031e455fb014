// Results do not depend on the number of threads: every bit of every field after a hundred steps of scenes that use all
// passes is the same with one, two and three threads, and the same when the run is repeated.
#include <gtest/gtest.h>
#include <omp.h>

#include <array>
#include <cstring>
#include <thread>

#include "physics/flags.hpp"
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

/// `changing`: every step has another number of threads, 1, 2, 3, 2, ...
State state_after(const std::string& text, int threads, int steps, bool changing = false) {
  const int before = omp_get_max_threads();
  omp_set_num_threads(threads);
  const auto run = small::simulation(text);
  for (int k = 0; k < steps; ++k) {
    if (changing) omp_set_num_threads(std::array{1, 2, 3, 2}[static_cast<std::size_t>(k % 4)]);
    run->step(1.0);
  }
  omp_set_num_threads(before);
  State s;
  s.time = run->time();
  s.rebuilds = run->searches();
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

class Threads : public ::testing::TestWithParam<small::Named> {};

TEST_P(Threads, DoNotChangeABit) {
  const std::string& text = *GetParam().text;
  const State once = state_after(text, 1, 100);
  EXPECT_GT(once.rebuilds, 1) << "the test is meant to see particles sorted anew";
  expect_same_bits(once, state_after(text, 1, 100));
  expect_same_bits(once, state_after(text, 2, 100));
  expect_same_bits(once, state_after(text, 3, 100));
  expect_same_bits(once, state_after(text, 1, 100, true));
  State other = state_after(text, 1, 99);
  EXPECT_NE(once.time, other.time);
  EXPECT_NE(once.values, other.values) << "and one step more does change them";
}

// Spheres on a free body are sorted anew but now and then: more steps.
TEST(ThreadsOfSpheres, DoNotChangeABitOnABody) {
  for (const std::string& text : {small::spheres_on_block, small::spheres_on_block_3d}) {
    const State once = state_after(text, 1, 1000);
    EXPECT_GT(once.rebuilds, 1) << "the test is meant to see particles sorted anew";
    expect_same_bits(once, state_after(text, 2, 1000));
    expect_same_bits(once, state_after(text, 3, 1000, true));
  }
}

// Nothing is shared between two simulations of one program. Two threads of the test seldom meet; the thread sanitizer
// (preset tsan) sees every number that both write.
TEST(Simulations, RunBesideEachOther) {
  const std::string &one = small::dune, &other = small::turbulent_dune;
  const State first = state_after(one, 1, 40), second = state_after(other, 1, 40);
  State beside_first, beside_second;
  std::thread thread([&] { beside_first = state_after(one, 1, 40); });
  beside_second = state_after(other, 1, 40);
  thread.join();
  expect_same_bits(first, beside_first);
  expect_same_bits(second, beside_second);
}

const std::string mixed_dune = "precision = \"mixed\"\n" + small::dune;
const std::string mixed_channel = "precision = \"mixed\"\n" + small::channel;

INSTANTIATE_TEST_SUITE_P(
    Scenes, Threads,
    ::testing::Values(small::Named{"Dune", &small::dune}, small::Named{"TurbulentDune", &small::turbulent_dune},
                      small::Named{"HeldDune", &small::held_dune}, small::Named{"Dam", &small::dam},
                      small::Named{"PlainDam", &small::plain_dam}, small::Named{"TwoFluids", &small::two_fluids},
                      small::Named{"Channel", &small::channel}, small::Named{"Squares", &small::squares},
                      small::Named{"Grains", &small::grains}, small::Named{"BlownGrains", &small::blown_grains},
                      small::Named{"Spheres", &small::spheres}, small::Named{"Drowned", &small::drowned},
                      small::Named{"DrownedConsistent", &small::drowned_consistent},
                      small::Named{"DrownedBallConsistent", &small::drowned_ball_consistent},
                      small::Named{"DrownedBall", &small::drowned_ball}, small::Named{"Paddle", &small::paddle},
                      small::Named{"Drum", &small::drum}, small::Named{"HertzianSpheres", &small::hertzian_spheres},
                      small::Named{"Flag", &small::flag}, small::Named{"Jelly", &small::jelly},
                      small::Named{"MixedDune", &mixed_dune}, small::Named{"MixedChannel", &mixed_channel}),
    [](const auto& s) { return std::string(s.param.name); });

}  // namespace
}  // namespace barchan
