// Grains that are made and removed between steps: what stays goes on with the same bits, its contacts and its sleep
// too.
#include <gtest/gtest.h>
#include <omp.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>

#include "models/workspace.hpp"
#include "physics/small_scenes.hpp"

namespace barchan {
namespace {

/// A heap that slumps, with friction and rolling resistance, and grains that fly far over it.
std::string heap_and_flyers(const std::string& fill, const std::string& keys = "") {
  return R"toml(
dimensions = 2
spacing = 1e-3
[domain]
size = [0.08, 0.1]
periodic = ["x"]
gravity = [0, -9.81]
[phases.sand]
kind = "grains"
density = 2650
diameter = { mean = 1e-3, spread = 0.2 }
friction = 0.5
rolling-friction = 0.2
stiffness = 1000
)toml" + keys +
         R"toml(
[phases.floor]
kind = "wall"
diameter = 1e-3
[interactions]
sand-sand = { law = "linear" }
sand-floor = { law = "linear" }
[[fill]]
phase = "floor"
shape = { box = { min = [0, 0], max = [0.08, 1e-3] } }
[[fill]]
phase = "sand"
shape = { box = { min = [0.03, 1e-3], max = [0.055, 0.026] } }
)toml" + fill +
         R"toml(
[time]
end = 1
step = 2e-5
largest-speed = 2
)toml";
}

const std::string flyers = R"toml([[fill]]
phase = "sand"
shape = { box = { min = [0.01, 0.08], max = [0.03, 0.09] } }
velocity = [0.3, 0.4]
)toml";

/// Removes grains over 0.05 m and makes others there: in every step twenty go, and nineteen, twenty or twenty-one come.
class Flyers : public Model {
 public:
  void begin(State& state, const std::vector<ParticleBlock>&) override { state.phases[0].number_may_change(); }
  void attach(Workspace& w) override { w_ = &w; }
  void schedule(Schedule& s) override {
    FieldSet all;
    for (const auto& about : field_table) all = all | FieldSet{about.id};
    s.add({stage::walls, "flyers", {{"sand", all, all}}, [this] { renew(); }});
  }

 private:
  void renew() {
    PhaseParticles& p = w_->particles(0);
    const double* y = p.column(Field::position, 1);
    std::vector<std::int64_t> high;  // the oldest go
    for (std::size_t k = 0; k < p.size(); ++k)
      if (y[k] > 0.05) high.push_back(p.id()[k]);
    if (high.size() < 40) return;
    std::nth_element(high.begin(), high.begin() + 20, high.end());
    const std::int64_t from = high[20];
    p.remove_if([&](std::size_t k) { return p.column(Field::position, 1)[k] > 0.05 && p.id()[k] < from; });
    const std::size_t count = 19 + static_cast<std::size_t>(w_->state.steps % 3);
    const std::size_t first = p.create(count, w_->state.ids);
    for (std::size_t q = 0; q < count; ++q) {
      const std::size_t k = first + q;
      const std::int64_t place = p.id()[k] % 600, row = place / 40;  // nobody is there any more
      p.column(Field::position, 0)[k] = 0.002 * static_cast<double>(place % 40);
      p.column(Field::position, 1)[k] = 0.052 + 0.0016 * static_cast<double>(row);
      p.column(Field::velocity, 0)[k] = 0.1;
      p.column(Field::velocity, 1)[k] = 0.2;
      p.column(Field::radius)[k] = 4e-4 + 1e-5 * static_cast<double>(q);
    }
  }
  Workspace* w_ = nullptr;
};

struct Grains {
  Scene scene;
  std::unique_ptr<Simulation> simulation;
  Grains(const std::string& text, bool makes) : scene(parse_scene(text, "heap.toml")) {
    const auto blocks = make_particles(scene);
    Models more;
    if (makes) more.push_back(std::make_unique<Flyers>());
    simulation = std::make_unique<Simulation>(scene, make_plan(scene, blocks), blocks, Simulation::Storage::as_filled,
                                              std::move(more));
  }
  const PhaseParticles& sand() const { return simulation->phases()[0]; }
  void step(int count) {
    for (int k = 0; k < count; ++k) simulation->step(1e300);
  }
  /// Places, velocities and spins of the `count` grains with the lowest ids.
  std::map<std::int64_t, std::array<double, 5>> heap(std::size_t count) const {
    std::map<std::int64_t, std::array<double, 5>> grains;
    const PhaseParticles& p = sand();
    for (std::size_t k = 0; k < p.size(); ++k)
      if (p.id()[k] < p.first_id() + static_cast<std::int64_t>(count))
        grains[p.id()[k]] = {p.column(Field::position, 0)[k], p.column(Field::position, 1)[k],
                             p.column(Field::velocity, 0)[k], p.column(Field::velocity, 1)[k],
                             p.column(Field::angular_velocity)[k]};
    return grains;
  }
  double of_history(const std::string& column) const {
    const auto names = simulation->history_columns();
    const auto found =
        std::find_if(names.begin(), names.end(), [&](const std::string& each) { return each.starts_with(column); });
    EXPECT_NE(found, names.end()) << column;
    return simulation->history_row()[static_cast<std::size_t>(found - names.begin())];
  }
};

void expect_same(const Grains& a, const Grains& b) {
  const PhaseParticles &p = a.sand(), &q = b.sand();
  ASSERT_EQ(p.id(), q.id());
  for (const auto& about : field_table)
    for (int c = 0; p.has(about.id) && c < p.components(about.id); ++c)
      EXPECT_EQ(std::memcmp(p.column(about.id, c), q.column(about.id, c), p.size() * sizeof(double)), 0) << about.name;
  EXPECT_EQ(a.simulation->history_row(), b.simulation->history_row());
}

// The slips of the heap's contacts stay with their pairs although every sphere gets another number in every step.
TEST(SphereMakers, AHeapHasTheBitsThatItHasAlone) {
  Grains alone(heap_and_flyers(""), false), below(heap_and_flyers(flyers), true);
  const std::size_t heap = alone.sand().size();
  const auto next = below.simulation->state().ids.next;
  for (int k = 0; k < 8; ++k) {
    alone.step(50);
    below.step(50);
    ASSERT_EQ(alone.heap(heap), below.heap(heap)) << "step " << 50 * (k + 1);
  }
  EXPECT_GT(below.simulation->state().ids.next, next + 7000) << "grains were made in every step";
  EXPECT_GT(alone.of_history("contacts_lost_energy ["), 0.0) << "the heap slumped";
}

TEST(SphereMakers, HaveTheSameBitsOnTwoThreadsAndFromACheckpoint) {
  for (const std::string keys : {"", "sleep = true\n"}) {
    const int threads = omp_get_max_threads();
    const std::string text = heap_and_flyers(flyers, keys);
    omp_set_num_threads(1);
    Grains one(text, true);
    one.step(101);
    Archive saved;
    one.simulation->archive(saved);
    one.step(101);
    omp_set_num_threads(2);
    Grains two(text, true), other(text, true);
    two.step(202);
    expect_same(one, two);
    other.step(7);  // another number of grains than the checkpoint
    ASSERT_NE(other.sand().size(), 0u);
    Archive loaded(saved.bytes());
    other.simulation->archive(loaded);
    loaded.finish();
    other.step(101);
    expect_same(one, other);
    omp_set_num_threads(threads);
  }
}

/// Removes the grain with an id once.
class Thief : public Model {
 public:
  void begin(State& state, const std::vector<ParticleBlock>&) override { state.phases[0].number_may_change(); }
  void attach(Workspace& w) override { w_ = &w; }
  void schedule(Schedule& s) override {
    FieldSet all;
    for (const auto& about : field_table) all = all | FieldSet{about.id};
    s.add({stage::walls, "thief", {{"sand", all, all}}, [this] {
             PhaseParticles& p = w_->particles(0);
             if (taken >= 0) p.remove_if([&](std::size_t k) { return p.id()[k] == taken; });
             taken = -1;
           }});
  }
  std::int64_t taken = -1;

 private:
  Workspace* w_ = nullptr;
};

// A grain that sleeps on another one must not stay in the air when that one is gone.
TEST(SphereMakers, WhoLosesASleepingNeighbourWakes) {
  const Scene scene = parse_scene(R"toml(
dimensions = 2
spacing = 1e-3
[domain]
size = [0.02, 0.02]
periodic = ["x"]
gravity = [0, -9.81]
[phases.sand]
kind = "grains"
density = 2650
diameter = 1e-3
friction = 0.5
stiffness = 1000
sleep = true
[phases.floor]
kind = "wall"
[interactions]
sand-sand = { law = "linear" }
sand-floor = { law = "linear" }
[[fill]]
phase = "floor"
shape = { sides = ["bottom"], layers = 1 }
[[fill]]
phase = "sand"
shape = { points = [[0.005, 0.0005], [0.005, 0.0015], [0.015, 0.0005]] }
[time]
end = 1
largest-speed = 1
)toml",
                                  "tower.toml");
  const auto blocks = make_particles(scene);
  Models more;
  more.push_back(std::make_unique<Thief>());
  Thief& thief = static_cast<Thief&>(*more.back());
  Simulation run(scene, make_plan(scene, blocks), blocks, Simulation::Storage::as_filled, std::move(more));
  const auto asleep = [&] {
    const auto names = run.history_columns();
    return run.history_row()[static_cast<std::size_t>(std::find(names.begin(), names.end(), "asleep") - names.begin())];
  };
  while (run.time() < 0.15) run.step(1e300);
  ASSERT_EQ(asleep(), 3.0);
  const PhaseParticles& p = run.phases()[0];
  thief.taken = p.first_id();
  while (run.time() < 0.16) run.step(1e300);
  ASSERT_EQ(p.size(), 2u);
  const std::size_t upper = p.id()[0] == p.first_id() + 1 ? 0 : 1;
  EXPECT_LT(p.column(Field::position, 1)[upper], 0.0012) << "it fell";
  while (run.time() < 0.3) run.step(1e300);
  EXPECT_NEAR(p.column(Field::position, 1)[upper], 0.0005, 1e-5) << "on the floor";
  EXPECT_EQ(asleep(), 2.0);
}

}  // namespace
}  // namespace barchan
