// [[forcing]] acts on every kind of phase that moves, and a bed of grains comes to rest with the defaults.
#include <gtest/gtest.h>
#include <omp.h>

#include <cmath>

#include "physics/small_scenes.hpp"

namespace barchan {
namespace {

struct OneThread {
  int before = omp_get_max_threads();
  OneThread() { omp_set_num_threads(1); }
  ~OneThread() { omp_set_num_threads(before); }
};

/// One particle far from everything, of the given kind.
std::string lonely(const std::string& kind, const std::string& force) {
  return R"(spacing = 0.1
[domain]
size = [4, 4]
[phases.a]
)" + kind +
         R"(
[interactions]
a-a = 2.1
[[fill]]
phase = "a"
shape = { points = [[2, 2], [3, 3]] }
[[forcing]]
phase = "a"
acceleration = )" +
         force + "\n[time]\nend = 0.1\nlargest-speed = 10\n[output]\n";
}

TEST(Forces, ActOnGrainsAndBodies) {
  const OneThread one;  // a handful of particles
  const std::string kinds[] = {"kind = \"grains\"\ndensity = 2650\n",
                               "kind = \"elastic\"\ndensity = 1000\nyoung = 1e6\n", "kind = \"fluid\"\ndensity = 1\n"};
  for (const std::string& kind : kinds) {
    const auto uniform = small::simulation(lonely(kind, "[3, -1]"));
    const auto varying = small::simulation(lonely(kind, "[\"60*t\", \"x\"]"));
    while (uniform->time() < 0.1 * (1 - 1e-12)) uniform->step(0.1 - uniform->time());
    while (varying->time() < 0.1 * (1 - 1e-12)) varying->step(0.1 - varying->time());
    const auto& p = uniform->phases()[0];
    const auto& q = varying->phases()[0];
    EXPECT_NEAR(p.column(Field::velocity, 0)[0], 0.3, 1e-12) << kind;
    EXPECT_NEAR(p.column(Field::velocity, 1)[1], -0.1, 1e-12) << kind;
    EXPECT_NEAR(q.column(Field::velocity, 0)[0], 0.3, 1e-3) << kind << "30 t^2, a kick of half a step late";
    EXPECT_NEAR(q.column(Field::velocity, 1)[1], 0.3, 1e-3) << kind << "x = 3 m";
  }
}

/// A heap that falls 5 mm: with the default restitution nothing moves faster than 2 cm/s after 0.4 s; with 1 they
/// still fly after 0.08 s, and some leave through the open top soon after.
TEST(Forces, BedComesToRestWithTheDefaults) {
  const OneThread one;
  std::string text = small::grains;
  text.erase(text.find("restitution = 0.6\n"), std::string("restitution = 0.6\n").size());
  const auto speed_after = [&](double end, const std::vector<std::string>& overrides) {
    auto all = overrides;
    all.insert(all.end(), {"domain.gravity=[0, -9.81]", "domain.size=[0.04, 0.3]", "phases.sand.contact-speed=5"});
    const auto run = small::simulation(text, all);
    while (run->time() < end) run->step(end - run->time() + 1e-6);
    const auto& p = run->phases()[0];
    double largest = 0;
    for (std::size_t k = 0; k < p.size(); ++k)
      largest = std::max(largest, std::hypot(p.column(Field::velocity, 0)[k], p.column(Field::velocity, 1)[k]));
    return largest;
  };
  const double rest = speed_after(0.4, {}), bouncing = speed_after(0.08, {"phases.sand.restitution=1"});
  RecordProperty("speed", std::to_string(rest) + " " + std::to_string(bouncing));
  EXPECT_LT(rest, 0.02);
  EXPECT_GT(bouncing, 0.2);
}

}  // namespace
}  // namespace barchan
