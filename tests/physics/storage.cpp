// Results follow from places and ids, not from how particles stand in memory: every scene, started from a shuffled
// storage, has the same bits after 20 steps on one, two and three threads.
#include <omp.h>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <filesystem>
#include <map>

#include "physics/drive.hpp"
#include "physics/every_scene.hpp"

namespace barchan {
namespace {

namespace fs = std::filesystem;

/// The places of a phase's particles in the order of their ids.
std::vector<std::uint32_t> by_id(const PhaseParticles& p) {
  std::vector<std::uint32_t> order(p.size());
  for (std::size_t k = 0; k < order.size(); ++k) order[k] = static_cast<std::uint32_t>(k);
  std::sort(order.begin(), order.end(), [&](auto a, auto b) { return p.id()[a] < p.id()[b]; });
  return order;
}

std::uint64_t bits(double x) { return std::bit_cast<std::uint64_t>(x); }

/// Where two runs differ first, with the fields that only outputs read: a field of a phase and an id, or a column of
/// history.csv; "" if nowhere.
std::string first_difference(const Simulation& a, const Simulation& b) {
  for (const Simulation* s : {&a, &b}) s->frame(0);  // brings these fields up to date
  for (std::size_t k = 0; k < a.phases().size(); ++k) {
    const auto &p = a.phases()[k], &q = b.phases()[k];
    if (p.size() != q.size()) return p.name() + ": number of particles";
    const auto i = by_id(p), j = by_id(q);
    for (const auto& about : field_table)
      for (int c = 0; p.has(about.id) && c < p.components(about.id); ++c) {
        const double *x = p.column(about.id, c), *y = q.column(about.id, c);
        for (std::size_t n = 0; n < i.size(); ++n)
          if (p.id()[i[n]] != q.id()[j[n]] || bits(x[i[n]]) != bits(y[j[n]]))
            return p.name() + "." + std::string(about.name) + " of particle " + std::to_string(p.id()[i[n]]);
      }
  }
  const auto names = a.history_columns();
  const auto r = a.history_row(), s = b.history_row();
  for (std::size_t c = 0; c < r.size(); ++c)
    if (bits(r[c]) != bits(s[c])) return "history.csv: " + names[c];
  return "";
}

class StorageOf : public ::testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Scenes, StorageOf, ::testing::ValuesIn(testing::all_scenes()),
                         [](const auto& p) { return testing::test_name(p.param); });

TEST_P(StorageOf, DoesNotMatter) {
  constexpr int steps = 20;
  const Scene scene = read_scene(testing::scene_file(GetParam()), testing::with_fewer_particles(GetParam()));
  const auto blocks = make_particles(scene);
  const Plan plan = make_plan(scene, blocks);
  const int threads = omp_get_max_threads();
  omp_set_num_threads(1);
  Simulation as_filled(scene, plan, blocks);
  for (int k = 0; k < steps; ++k) as_filled.step(1e300);
  for (const int t : {1, 2, 3}) {
    omp_set_num_threads(t);
    Simulation shuffled(scene, plan, blocks, Simulation::Storage::shuffled);
    for (int k = 0; k < steps; ++k) shuffled.step(1e300);
    EXPECT_EQ(first_difference(as_filled, shuffled), "") << t << " threads";
  }
  omp_set_num_threads(threads);
}

}  // namespace
}  // namespace barchan
