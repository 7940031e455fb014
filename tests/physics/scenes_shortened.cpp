// Every scene of the repository, shortened: it runs through the library and through the program, what it says is
// finite, and its bits are the same however it is run.
#include <omp.h>
#include <sys/wait.h>

#include <algorithm>
#include <bit>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

#include "output/series.hpp"
#include "physics/drive.hpp"
#include "physics/every_scene.hpp"
#include "simulation/settle.hpp"

namespace barchan {
namespace {

namespace fs = std::filesystem;

/// What the scene will do, without the minutes in which its beds settle: they stand as they were filled.
Plan plan_of_filled(Scene scene) {
  for (auto& fill : scene.fills)
    if (fill.packing == Packing::settled) fill.packing = Packing::square;
  return make_plan(scene, make_particles(scene));
}

/// A time of `steps` steps, as an override.
std::string ending_after(const Plan& plan, double steps) {
  char text[64];
  std::snprintf(text, sizeof text, "time.end=%.9g", steps * plan.step());
  return text;
}
std::string ending_after(const std::string& scene, double steps) {
  return ending_after(plan_of_filled(read_scene(testing::scene_file(scene))), steps);
}

void expect_finite(const Frame& frame) {
  EXPECT_TRUE(std::all_of(frame.points.begin(), frame.points.end(), [](double x) { return std::isfinite(x); }));
  for (const auto& field : frame.fields)
    EXPECT_TRUE(std::all_of(field.values.begin(), field.values.end(), [](double x) { return std::isfinite(x); }))
        << field.name;
}

/// A folder of its own that goes with the test.
class Folder {
 public:
  Folder() {
    char name[] = "/tmp/barchan_scenes_XXXXXX";
    path_ = mkdtemp(name);
  }
  ~Folder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

/// Runs the program on a scene; its exit status.
int run_program(const std::string& scene, const fs::path& out, const std::vector<std::string>& overrides) {
  std::string command =
      "'" BARCHAN_PROGRAM "' run '" + testing::scene_file(scene) + "' --quiet --out '" + out.string() + "'";
  for (const auto& o : overrides) command += " --set '" + o + "'";
  const int status = std::system(command.c_str());
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

nlohmann::json report_of(const fs::path& out) { return nlohmann::json::parse(std::ifstream(out / "run.json")); }

/// A wind whose bulk speed is held is pulled as hard as it takes: plan says so beforehand, and the run when it is more
/// than its profile says. In a few steps the flux of grains along an open ground is not yet the same everywhere.
bool is_meant(const Scene& scene, const std::string& warning) {
  if (warning.find("still grows at the outflow") != warning.npos) return !scene.domain.periodic[0];
  return (warning.find("under hold = \"bulk-speed\" u* is a result") != warning.npos ||
          warning.find("a wind whose bulk speed is held is pulled as hard as the grains") != warning.npos) &&
         std::any_of(scene.forcings.begin(), scene.forcings.end(),
                     [](const Forcing& f) { return f.hold == Hold::bulk_speed; });
}

/// What is told because a test ends a run early.
bool comes_of_the_end(const std::string& warning) {
  return warning.find("time.end and measures") != warning.npos || warning.find("beyond time.end") != warning.npos;
}

/// Of rows that fit at the spacing of the scene.
bool comes_of_fewer_particles(const std::string& warning) {
  return warning.find("the mass of its") != warning.npos || warning.find(" m thick at ") != warning.npos;
}

/// The places of a phase's particles in the order of their ids.
std::vector<std::uint32_t> by_id(const PhaseParticles& p) {
  std::vector<std::uint32_t> order(p.size());
  for (std::size_t k = 0; k < order.size(); ++k) order[k] = static_cast<std::uint32_t>(k);
  std::sort(order.begin(), order.end(), [&](auto a, auto b) { return p.id()[a] < p.id()[b]; });
  return order;
}

std::uint64_t bits(double x) { return std::bit_cast<std::uint64_t>(x); }

/// Where two runs differ first, with the fields that only outputs read: a field of a phase and an id, or a column of
/// history.csv; "" if nowhere. `in_order`: they stand in the same order in memory too.
std::string first_difference(const Simulation& a, const Simulation& b, bool in_order) {
  if (a.time() != b.time() || a.steps() != b.steps() || a.last_step() != b.last_step()) return "time";
  for (const Simulation* s : {&a, &b}) s->frame(0);  // brings these fields up to date
  for (std::size_t k = 0; k < a.phases().size(); ++k) {
    const auto &p = a.phases()[k], &q = b.phases()[k];
    if (p.size() != q.size() || (in_order && p.id() != q.id())) return p.name() + ": particles";
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

class EveryScene : public ::testing::TestWithParam<std::string> {};

/// Forty steps; and of the first twenty the same bits on one thread, on two after a restart between any of them, and on
/// three from a shuffled storage: results follow from places and ids.
TEST_P(EveryScene, HasTheSameBitsHoweverItIsRun) {
  constexpr int steps = 20, stride = 5;
  const auto fewer = testing::with_fewer_particles(GetParam());
  const Scene scene = read_scene(testing::scene_file(GetParam()), fewer);
  const auto blocks = make_particles(scene);
  const Plan plan = make_plan(scene, blocks);
  for (const std::string& text : plan.warnings)
    EXPECT_TRUE(is_meant(scene, text) || (!fewer.empty() && comes_of_fewer_particles(text))) << text;
  const int threads = omp_get_max_threads();
  omp_set_num_threads(1);
  Simulation run(scene, plan, blocks);
  ASSERT_NO_THROW(run.check_start());
  std::vector<std::vector<char>> saved;
  for (int k = 0; k < steps; ++k) {
    if (k % stride == 0) {
      Archive a;
      run.archive(a);
      saved.push_back(a.bytes());
    }
    ASSERT_NO_THROW(run.step(1e300));
  }
  {
    omp_set_num_threads(2);
    Simulation other(scene, plan, blocks);
    for (std::size_t n = 0; n < saved.size(); ++n) {
      Archive a(saved[n]);
      ASSERT_NO_THROW(other.archive(a));
      ASSERT_NO_THROW(a.finish());
      for (int rest = static_cast<int>(n) * stride; rest < steps; ++rest) other.step(1e300);
      EXPECT_EQ(first_difference(run, other, true), "") << "saved after step " << static_cast<int>(n) * stride;
    }
  }
  {
    omp_set_num_threads(3);
    Simulation shuffled(scene, plan, blocks, Simulation::Storage::shuffled);
    for (int k = 0; k < steps; ++k) shuffled.step(1e300);
    EXPECT_EQ(first_difference(run, shuffled, false), "") << "shuffled";
  }
  omp_set_num_threads(threads);
  ASSERT_NO_THROW(for (int k = 0; k < steps; ++k) run.step(1e300));
  ASSERT_NO_THROW(run.check());
  for (const std::string& text : run.warnings().texts()) EXPECT_TRUE(is_meant(scene, text)) << text;
  const auto columns = run.history_columns();
  const auto row = run.history_row();
  ASSERT_EQ(row.size(), columns.size());
  for (std::size_t c = 0; c < row.size(); ++c) EXPECT_TRUE(std::isfinite(row[c])) << columns[c];
  expect_finite(run.frame(0));
}

TEST_P(EveryScene, RunsInTheProgram) {
  if (!fs::exists(BARCHAN_PROGRAM)) GTEST_SKIP() << "no program at " BARCHAN_PROGRAM;
  const Folder folder;
  const fs::path out = folder.path() / "out";
  const Scene scene = read_scene(testing::scene_file(GetParam()));
  const Plan plan = plan_of_filled(scene);
  const std::string end = ending_after(plan, 6);
  const double every = std::stod(end.substr(end.find('=') + 1)) / 2;
  char frames[64];
  std::snprintf(frames, sizeof frames, "output.every=%.17g", every);
  ASSERT_EQ(run_program(GetParam(), out, {end, frames, "output.history-every=0"}), 0);

  const std::string name = fs::path(GetParam()).filename().string();
  const auto entries = read_pvd(out / (name + ".pvd"));
  std::set<std::string> listed, there;
  for (const auto& e : entries) listed.insert(e.file);
  for (const auto& e : fs::directory_iterator(out)) {
    const std::string file = e.path().filename().string();
    const bool numbered =
        file.starts_with(name + "_") && std::isdigit(static_cast<unsigned char>(file[name.size() + 1]));
    if (numbered && (file.ends_with(".vtp") || file.ends_with(".vtu"))) there.insert(file);
  }
  EXPECT_EQ(listed, there);
  EXPECT_EQ(entries.size(), 3u);  // first, half-way, last
  for (const auto& e : entries) {
    const Frame frame = read_frame(out / e.file);
    EXPECT_EQ(frame.time, e.time);
    expect_finite(frame);
  }
  std::ifstream history(out / "history.csv");
  std::string line;
  for (int rows = 0; std::getline(history, line); ++rows) EXPECT_EQ(line.find("nan"), std::string::npos) << line;

  const auto report = report_of(out);
  EXPECT_EQ(report["end_reason"], "end");
  EXPECT_GE(report["steps"].get<long>(), 6);
  for (const std::string text : report["warnings"])
    EXPECT_TRUE(is_meant(scene, text) || comes_of_the_end(text)) << text;
  // What was executed is what the plan promised.
  EXPECT_EQ(report["passes"].get<std::vector<std::string>>(), plan.passes);
}

INSTANTIATE_TEST_SUITE_P(Scenes, EveryScene, ::testing::ValuesIn(testing::all_scenes()),
                         [](const auto& test) { return testing::test_name(test.param); });

/// What a scene does not have is neither run nor stored: run.json names the passes that ran and the fields that were
/// made.
TEST(RunJson, AirAloneHasNoContactsNoStressNoExtension) {
  const Folder folder;
  const std::string scene = "verification/taylor_green";
  ASSERT_EQ(run_program(scene, folder.path(), {ending_after(scene, 3)}), 0);
  const auto report = report_of(folder.path());
  const auto passes = report["passes"].get<std::set<std::string>>();
  EXPECT_TRUE(passes.contains("fluid rates"));
  for (const char* absent : {"contacts", "elastic forces", "elastic strain", "extension into walls",
                             "extension into solids", "reaction on solids", "wall motion", "wall repulsion"}) {
    EXPECT_FALSE(passes.contains(absent)) << absent;
    EXPECT_FALSE(report["seconds"].contains(absent)) << absent;
  }
  const auto fields = report["fields"]["fluid"].get<std::set<std::string>>();
  EXPECT_TRUE(fields.contains("pressure"));
  for (const char* absent : {"stress", "energy", "wall_normal", "velocity_gradient"})
    EXPECT_FALSE(fields.contains(absent)) << absent;
}

/// The other way round: bodies have no fluid's passes, and a bed has all that it needs.
TEST(RunJson, BodiesHaveNoFluidAndTheBedHasBoth) {
  const Folder folder;
  const std::string impact = "verification/two_particle_impact", bed = "paper/flat_bed";
  ASSERT_EQ(run_program(impact, folder.path() / "a", {ending_after(impact, 3)}), 0);
  auto passes = report_of(folder.path() / "a")["passes"].get<std::set<std::string>>();
  EXPECT_TRUE(passes.contains("elastic forces"));
  for (const char* absent : {"fluid rates", "contacts", "extension into walls"})
    EXPECT_FALSE(passes.contains(absent)) << absent;
  const auto fields = report_of(folder.path() / "a")["fields"]["a"].get<std::set<std::string>>();
  EXPECT_TRUE(fields.contains("stress"));
  EXPECT_FALSE(fields.contains("density_rate"));

  ASSERT_EQ(run_program(bed, folder.path() / "b", {ending_after(bed, 3)}), 0);
  passes = report_of(folder.path() / "b")["passes"].get<std::set<std::string>>();
  for (const char* present : {"fluid rates", "contacts", "extension into solids", "reaction on solids"})
    EXPECT_TRUE(passes.contains(present)) << present;
  EXPECT_FALSE(passes.contains("elastic forces"));
}

}  // namespace
}  // namespace barchan
