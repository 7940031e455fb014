// A run that is saved between any two of its steps and loaded elsewhere goes on with the same bits. Of every scene:
// scenes_shortened.cpp.
#include <omp.h>

#include <array>
#include <cstring>

#include "base/errors.hpp"

#include "physics/drive.hpp"
#include "physics/flags.hpp"
#include "physics/small_scenes.hpp"

namespace barchan {
namespace {

/// The name of the first field that has other bits; "" if none has.
std::string first_difference(const Simulation& a, const Simulation& b) {
  if (a.time() != b.time() || a.steps() != b.steps() || a.last_step() != b.last_step()) return "time";
  if (a.history_row() != b.history_row()) return "history";
  for (std::size_t k = 0; k < a.phases().size(); ++k) {
    const auto &p = a.phases()[k], &q = b.phases()[k];
    if (p.id() != q.id()) return p.name() + ".id";
    for (const auto& about : field_table)
      for (int c = 0; p.has(about.id) && c < p.components(about.id); ++c)
        if (std::memcmp(p.column(about.id, c), q.column(about.id, c), p.size() * sizeof(double)) != 0)
          return p.name() + "." + std::string(about.name);
  }
  return "";
}

/// Saves `run` after each step up to `steps`; then loads each into `other`, which runs to the end as well. `threads`:
/// of the one and of the other; 0: as they are.
void expect_restarts(Simulation& run, Simulation& other, int steps, int stride, std::array<int, 2> threads = {0, 0}) {
  if (threads[0] > 0) omp_set_num_threads(threads[0]);
  std::vector<std::vector<char>> saved;
  for (int k = 0; k < steps; ++k) {
    Archive a;
    run.archive(a);
    saved.push_back(a.bytes());
    run.step(1e300);
  }
  if (threads[1] > 0) omp_set_num_threads(threads[1]);
  for (int k = 0; k < steps; k += stride) {
    Archive a(saved[static_cast<std::size_t>(k)]);
    ASSERT_NO_THROW(other.archive(a));
    ASSERT_NO_THROW(a.finish());
    for (int rest = k; rest < steps; ++rest) other.step(1e300);
    ASSERT_EQ(first_difference(run, other), "") << "saved after step " << k;
  }
}

TEST(Restart, BetweenAnyTwoOfManySteps) {
  // Far enough that lists are made anew many times between saving and the end.
  for (const auto& text :
       {small::held_dune, small::dam, small::squares, small::spheres, small::hertzian_spheres, small::drowned,
        small::drowned_ball, small::drowned_consistent, small::drowned_ball_consistent, small::paddle, small::drum,
        small::flag, small::jelly, small::spheres_on_block, small::spheres_on_block_3d}) {
    const auto run = small::simulation(text), other = small::simulation(text);
    expect_restarts(*run, *other, 60, 1);
  }
}

/// The books of a fluid's energy, with a free surface and in a fluid that is shut in.
TEST(Restart, OfTheBooksOfEnergy) {
  const int threads = omp_get_max_threads();
  for (const char* scheme : {"plain", "consistent"}) {
    const std::vector<std::string> overrides{std::string("phases.water.scheme=") + scheme, "spacing=5.715e-3",
                                             "phases.water.energy-budget=true"};
    testing::Drive run("verification/dam_break", overrides), other("verification/dam_break", overrides);
    run.to(0.2);
    expect_restarts(run.simulation(), other.simulation(), 60, 7, {1, 2});
    const std::vector<std::string> shut{std::string("phases.water.scheme=") + scheme,
                                        "phases.water.energy-budget=true"};
    testing::Drive whole("verification/poiseuille", shut), again("verification/poiseuille", shut);
    expect_restarts(whole.simulation(), again.simulation(), 30, 7, {2, 1});
  }
  omp_set_num_threads(threads);
}

/// Air with two equations of turbulence: over a hill; through borders of spacings and open ends.
TEST(Restart, OfTwoEquationsOfTurbulence) {
  const std::string two = "phases.air.turbulence=k-omega";
  const std::array<std::pair<std::string, std::vector<std::string>>, 2> scenes{
      {{"verification/rushil", {two, "spacing=0.0234"}},
       {"verification/joined_wind", {two, "phases.above.turbulence=k-omega", "phases.high.turbulence=k-omega"}}}};
  const int threads = omp_get_max_threads();
  for (const auto& [scene, overrides] : scenes) {
    testing::Drive run(scene, overrides), other(scene, overrides);
    expect_restarts(run.simulation(), other.simulation(), 20, 4, {1, 2});
  }
  omp_set_num_threads(threads);
}

TEST(Restart, RefusesTheStateOfAnotherScene) {
  const auto dune = small::simulation(small::dune), dam = small::simulation(small::dam);
  Archive saved;
  dune->archive(saved);
  Archive a(saved.bytes());
  EXPECT_THROW(dam->archive(a), SceneError);
  Archive cut(std::vector<char>(saved.bytes().begin(), saved.bytes().begin() + 1000));
  EXPECT_THROW(dune->archive(cut), SceneError);
}

}  // namespace
}  // namespace barchan
