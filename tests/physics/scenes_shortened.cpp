// Every scene of the repository, shortened: it runs through the library and through the program, and what it says is
// finite.
#include <sys/wait.h>

#include <algorithm>
#include <cctype>
#include <cmath>
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
using testing::Drive;

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
/// than its profile says.
bool is_meant(const Scene& scene, const std::string& warning) {
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

class EveryScene : public ::testing::TestWithParam<std::string> {};

TEST_P(EveryScene, TakesStepsInTheLibrary) {
  Drive drive(GetParam(), testing::with_fewer_particles(GetParam()));
  auto& simulation = drive.simulation();
  const bool coarser = !testing::with_fewer_particles(GetParam()).empty();
  for (const std::string& text : drive.plan().warnings)
    EXPECT_TRUE(is_meant(drive.scene(), text) || (coarser && comes_of_fewer_particles(text))) << text;
  ASSERT_NO_THROW(simulation.check_start());
  ASSERT_NO_THROW(for (int k = 0; k < 40; ++k) simulation.step(1e300));
  ASSERT_NO_THROW(simulation.check());
  for (const std::string& text : simulation.warnings().texts()) EXPECT_TRUE(is_meant(drive.scene(), text)) << text;
  const auto columns = drive.simulation().history_columns();
  const auto row = simulation.history_row();
  ASSERT_EQ(row.size(), columns.size());
  for (std::size_t c = 0; c < row.size(); ++c) EXPECT_TRUE(std::isfinite(row[c])) << columns[c];
  expect_finite(simulation.frame(0));
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
