// A fluid whose particles are made and removed by the thousand in every step: the same bits on one and two threads and
// from a checkpoint in between, no id twice, mass booked, no memory that grows, frames with numbers that vary.
#include <gtest/gtest.h>
#include <omp.h>

#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <set>

#include "models/workspace.hpp"
#include "output/compare.hpp"
#include "output/series.hpp"
#include "physics/small_scenes.hpp"

namespace barchan {
namespace {

const std::string vortices = R"toml(
spacing = 0.015625
[domain]
size = [1, 1]
periodic = ["x", "y"]
[phases.fluid]
kind = "fluid"
density = 1
viscosity = 0.01
sound-speed = 10
[interactions]
fluid-fluid = 2.1
[[fill]]
phase = "fluid"
shape = "the-rest"
perturb = 0.2
velocity = ["-cos(2*pi*x)*sin(2*pi*y)", "sin(2*pi*x)*cos(2*pi*y)"]
[time]
end = 1
largest-speed = 1
)toml";

/// Takes the first thousand particles out of memory in every step and makes others with the same values; in every
/// second step eight of them wait for the next one.
class Renewal : public Model {
 public:
  static constexpr std::size_t many = 1000, waits = 8;

  void begin(State& state, const std::vector<ParticleBlock>&) override { state.phases[0].number_may_change(); }
  void attach(Workspace& w) override { w_ = &w; }
  void schedule(Schedule& s) override {
    FieldSet all;
    for (const auto& about : field_table) all = all | FieldSet{about.id};
    s.add({stage::walls, "renewal", {{"fluid", all, all}}, [this] { renew(); }});
  }
  void archive(Archive& a) override { a.array("particles that wait", stock_); }
  std::size_t waiting() const { return w_ ? stock_.size() / values_a_particle() : 0; }
  std::int64_t made() const { return made_; }

 private:
  std::size_t values_a_particle() const {
    const PhaseParticles& p = w_->state.phases[0];
    std::size_t n = 0;
    for (const auto& about : field_table)
      if (p.has(about.id)) n += static_cast<std::size_t>(p.components(about.id));
    return n;
  }
  void renew() {
    PhaseParticles& p = w_->particles(0);
    const std::size_t first = p.size() - many;
    for (std::size_t k = first; k < p.size(); ++k)
      for (const auto& about : field_table)
        for (int c = 0; p.has(about.id) && c < p.components(about.id); ++c) stock_.push_back(p.column(about.id, c)[k]);
    ASSERT_EQ(p.remove_if([&](std::size_t k) { return k >= first; }), many);
    const std::size_t each = values_a_particle(), all = stock_.size() / each;
    const std::size_t count = w_->state.steps % 2 == 0 ? all - waits : all;
    const std::size_t place = p.create(count, w_->state.ids);
    made_ += static_cast<std::int64_t>(count);
    for (std::size_t q = 0; q < count; ++q) {
      const double* value = stock_.data() + q * each;
      for (const auto& about : field_table)
        for (int c = 0; p.has(about.id) && c < p.components(about.id); ++c) p.column(about.id, c)[place + q] = *value++;
    }
    stock_.erase(stock_.begin(), stock_.begin() + static_cast<std::ptrdiff_t>(count * each));
  }

  Workspace* w_ = nullptr;
  std::vector<double> stock_;
  std::int64_t made_ = 0;
};

/// A run with its renewal.
struct RenewedRun {
  RenewedRun() {
    const Scene scene = parse_scene(vortices, "test.toml");
    const auto blocks = make_particles(scene);
    Models more;
    more.push_back(std::make_unique<Renewal>());
    renewal = static_cast<Renewal*>(more.back().get());
    simulation = std::make_unique<Simulation>(scene, make_plan(scene, blocks), blocks, Simulation::Storage::as_filled,
                                              std::move(more));
  }
  const PhaseParticles& fluid() const { return simulation->phases()[0]; }
  void step(int count) {
    for (int k = 0; k < count; ++k) simulation->step(1e300);
  }
  Renewal* renewal = nullptr;
  std::unique_ptr<Simulation> simulation;
};

void expect_same(const RenewedRun& a, const RenewedRun& b) {
  const PhaseParticles &p = a.fluid(), &q = b.fluid();
  ASSERT_EQ(p.id(), q.id());
  for (const auto& about : field_table)
    for (int c = 0; p.has(about.id) && c < p.components(about.id); ++c)
      EXPECT_EQ(std::memcmp(p.column(about.id, c), q.column(about.id, c), p.size() * sizeof(double)), 0) << about.name;
  EXPECT_EQ(a.simulation->history_row(), b.simulation->history_row());
}

TEST(Makers, HaveTheSameBitsOnTwoThreadsAndFromACheckpoint) {
  const int threads = omp_get_max_threads();
  omp_set_num_threads(1);
  RenewedRun one;
  one.step(7);  // eight particles wait now or did a step ago
  Archive saved;
  one.simulation->archive(saved);
  one.step(8);
  omp_set_num_threads(2);
  RenewedRun two, other;
  two.step(15);
  expect_same(one, two);
  other.step(2);  // another number of particles than the checkpoint
  Archive loaded(saved.bytes());
  other.simulation->archive(loaded);
  loaded.finish();
  other.step(8);
  expect_same(one, other);
  omp_set_num_threads(threads);
}

TEST(Makers, GiveNoIdTwiceKeepTheMassAndGrowNoMemory) {
  RenewedRun run;
  std::set<std::int64_t> ids(run.fluid().id().begin(), run.fluid().id().end());
  const std::size_t start = ids.size();
  std::size_t seen = 0;
  const std::int64_t next = run.simulation->state().ids.next;  // some were made before the first step
  std::int64_t made = run.renewal->made();
  std::size_t bytes = 0;
  for (int k = 0; k < 20; ++k) {
    run.step(1);
    EXPECT_EQ(run.fluid().size() + run.renewal->waiting(), 4096u) << "mass";
    const std::set<std::int64_t> now(run.fluid().id().begin(), run.fluid().id().end());
    EXPECT_EQ(now.size(), run.fluid().size()) << "two particles have one id";
    std::size_t fresh = 0;
    for (const std::int64_t id : now) fresh += ids.insert(id).second ? 1 : 0;
    EXPECT_EQ(fresh, static_cast<std::size_t>(run.renewal->made() - made)) << "an id was used again";
    made = run.renewal->made();
    seen += fresh;
    if (k == 9) bytes = run.simulation->bytes();
  }
  EXPECT_EQ(ids.size(), start + seen);
  EXPECT_EQ(run.simulation->state().ids.next, next + static_cast<std::int64_t>(seen));
  EXPECT_LT(static_cast<double>(run.simulation->bytes()), 1.02 * static_cast<double>(bytes));
}

TEST(Makers, FramesHoldTheParticlesThatAreThere) {
  char name[] = "/tmp/barchan_makers_XXXXXX";
  const std::filesystem::path folder = mkdtemp(name);
  std::vector<std::size_t> counts;
  {
    RenewedRun run;
    SeriesWriter writer(folder, "run", FrameFormat::vtp, true);
    for (int k = 0; k < 4; ++k) {
      run.step(1);
      counts.push_back(run.fluid().size());
      writer.write(run.simulation->frame(k));
    }
    writer.finish();
  }
  EXPECT_NE(counts[0], counts[1]);
  const auto entries = read_pvd(folder / "run.pvd");
  ASSERT_EQ(entries.size(), counts.size());
  for (std::size_t k = 0; k < counts.size(); ++k) EXPECT_EQ(read_frame(folder / entries[k].file).id.size(), counts[k]);
  EXPECT_TRUE(compare_files(folder / "run.pvd", folder / "run.pvd", 0.0).at(3).same);
  std::filesystem::remove_all(folder);
}

TEST(Makers, AreRefusedWhereNobodySaidThatTheNumberMayChange) {
  PhaseParticles p("fluid", 2, 3, 1.0, 0);
  IdSource ids{3};
  EXPECT_THROW(p.create(1, ids), std::logic_error);
  EXPECT_THROW(p.remove_if([](std::size_t) { return true; }), std::logic_error);
  p.keep_places();
  EXPECT_THROW(p.number_may_change(), std::logic_error) << "ids with gaps have no places by id";
}

TEST(Columns, OfAModelMoveWithTheirParticles) {
  PhaseParticles p("fluid", 2, 5, 1.0, 10);
  p.add(Field::position);
  struct Three {
    float a, b, c;
  };
  const auto wide = p.add_own<Three>("model.three", Three{1, 2, 3});
  const auto narrow = p.add_own<std::uint8_t>("model.mark", std::uint8_t{7});
  EXPECT_THROW(p.add_own<double>("model.three"), std::logic_error);
  p.number_may_change();
  for (std::size_t k = 0; k < 5; ++k) {
    p.column(Field::position, 0)[k] = static_cast<double>(p.id()[k]);
    p.own(wide)[k].b = static_cast<float>(p.id()[k]);
    p.own(narrow)[k] = static_cast<std::uint8_t>(p.id()[k]);
  }
  const std::uint32_t order[] = {3, 1, 4, 0, 2};
  p.permute(order);
  IdSource ids{15};
  EXPECT_EQ(p.create(3, ids), 5u);
  EXPECT_EQ(p.own(wide)[6].c, 3.0f) << "the value of a new particle";
  EXPECT_EQ(p.own(narrow)[7], 7u);
  EXPECT_EQ(p.column(Field::position, 0)[5], 0.0);
  EXPECT_EQ(p.remove_if([&](std::size_t k) { return p.id()[k] == 14 || p.id()[k] == 16; }), 2u);
  EXPECT_EQ(p.id(), (std::vector<std::int64_t>{13, 11, 10, 12, 15, 17}));
  for (std::size_t k = 0; k < 4; ++k) {
    EXPECT_EQ(p.column(Field::position, 0)[k], static_cast<double>(p.id()[k]));
    EXPECT_EQ(p.own(wide)[k].b, static_cast<float>(p.id()[k]));
    EXPECT_EQ(p.own(narrow)[k], p.id()[k]);
  }
  Archive a;
  p.archive(a);
  p.own(wide)[0].b = -1.0f;
  p.remove_if([](std::size_t k) { return k > 2; });
  a.load_again();
  p.archive(a);
  EXPECT_EQ(p.size(), 6u);
  EXPECT_EQ(p.own(wide)[0].b, 13.0f) << "state comes back from an archive";
}

}  // namespace
}  // namespace barchan
