// How a run ends when it does not reach its end: stopped by a file or a signal, broken down, without room to write.
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <thread>

#include "output/series.hpp"

namespace barchan {
namespace {

namespace fs = std::filesystem;

/// Air at rest that would take hours.
constexpr const char* endless = R"(
dimensions = 2
spacing = 0.01
[domain]
size = [0.5, 0.5]
periodic = ["x", "y"]
[phases.air]
kind = "fluid"
density = 1.2
sound-speed = 10
[interactions]
air-air = 3.0
[[fill]]
phase = "air"
shape = "the-rest"
[time]
end = 1000
[output]
every = 0.01
)";

/// A grain with nothing under it.
constexpr const char* falling = R"(
dimensions = 2
spacing = 0.001
[domain]
size = [0.01, 0.01]
gravity = [0, -9.81]
[phases.sand]
kind = "grains"
density = 2650
[interactions]
sand-sand = 1.1
[[fill]]
phase = "sand"
shape = { points = [[0.005, 0.005], [0.005, 0.002]] }
[time]
end = 1
[output]
every = 0.005
history-every = 0.001
)";

class Behaviour : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!fs::exists(BARCHAN_PROGRAM)) GTEST_SKIP() << "no program at " BARCHAN_PROGRAM;
    char name[] = "/tmp/barchan_behaviour_XXXXXX";
    place_ = mkdtemp(name);
  }
  void TearDown() override {
    std::error_code ignored;
    if (!place_.empty()) fs::remove_all(place_, ignored);
  }

  fs::path out() const { return place_ / "out"; }

  /// Starts the program on the scene; output goes to `place_`/said.
  pid_t start(const char* scene, const fs::path& out) {
    const std::string file = (place_ / "scene.toml").string(), said = (place_ / "said").string(), to = out.string();
    std::ofstream(file) << scene;
    const pid_t child = fork();
    if (child == 0) {
      if (!std::freopen(said.c_str(), "w", stderr)) _exit(99);
      execl(BARCHAN_PROGRAM, BARCHAN_PROGRAM, "run", file.c_str(), "--quiet", "--out", to.c_str(), nullptr);
      _exit(99);
    }
    return child;
  }

  static int status_of(pid_t child) {
    int status = 0;
    waitpid(child, &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }

  /// Waits until the first frame is listed, so that the run is in its loop.
  void wait_for_first_frame() const {
    for (int k = 0; k < 2000 && !fs::exists(out() / "scene.pvd"); ++k)
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    ASSERT_TRUE(fs::exists(out() / "scene.pvd"));
  }

  std::string said() const {
    std::ostringstream text;
    text << std::ifstream(place_ / "said").rdbuf();
    return text.str();
  }

  /// All frames are whole, the last one is that of the last step (of the last good state after a breakdown), and
  /// run.json says why it ended.
  void expect_whole_series(const std::string& reason) const {
    const auto report = nlohmann::json::parse(std::ifstream(out() / "run.json"));
    EXPECT_EQ(report["end_reason"].get<std::string>().substr(0, reason.size()), reason);
    const auto entries = read_pvd(out() / "scene.pvd");
    ASSERT_FALSE(entries.empty());
    for (const auto& e : entries) EXPECT_EQ(read_frame(out() / e.file).time, e.time);
    if (reason.starts_with("breakdown")) EXPECT_LT(entries.back().time, report["simulated_time"].get<double>());
    else EXPECT_EQ(entries.back().time, report["simulated_time"].get<double>());
    for (const auto& e : fs::directory_iterator(out())) EXPECT_NE(e.path().extension(), ".tmp") << e.path();
  }

  fs::path place_;
};

TEST_F(Behaviour, FileNamedTerminateEndsARunWell) {
  const pid_t child = start(endless, out());
  wait_for_first_frame();
  std::ofstream(out() / "TERMINATE").flush();
  EXPECT_EQ(status_of(child), 0);
  EXPECT_NE(said().find("stopped by TERMINATE"), std::string::npos) << said();
  expect_whole_series("TERMINATE");
}

TEST_F(Behaviour, TerminateOfAnEarlierRunIsForgotten) {
  fs::create_directories(out());
  std::ofstream(out() / "TERMINATE").flush();
  const pid_t child = start(endless, out());
  wait_for_first_frame();
  EXPECT_FALSE(fs::exists(out() / "TERMINATE"));
  kill(child, SIGTERM);
  EXPECT_EQ(status_of(child), 143);
}

TEST_F(Behaviour, SignalsFinishTheStepAndWriteAFrame) {
  const struct {
    int signal, status;
    const char* name;
  } cases[] = {{SIGINT, 130, "SIGINT"}, {SIGTERM, 143, "SIGTERM"}};
  for (const auto& c : cases) {
    std::error_code ignored;
    fs::remove_all(out(), ignored);
    const pid_t child = start(endless, out());
    wait_for_first_frame();
    kill(child, c.signal);
    EXPECT_EQ(status_of(child), c.status);
    EXPECT_NE(said().find(std::string("stopped by ") + c.name), std::string::npos) << said();
    expect_whole_series(c.name);
  }
}

TEST_F(Behaviour, GrainWithoutAFloorBreaksDownByName) {
  EXPECT_EQ(status_of(start(falling, out())), 3);
  const std::string message = said();
  for (const char* part :
       {"particle 1 of phase \"sand\"", "t = 0.02", "escaped through the lower side of y", "add a wall"})
    EXPECT_NE(message.find(part), std::string::npos) << part << " in: " << message;
  expect_whole_series("breakdown: particle 1");
}

TEST_F(Behaviour, FolderUnderAFileIsAnOutputError) {
  const fs::path file = place_ / "file";
  std::ofstream(file) << "not a folder";
  EXPECT_EQ(status_of(start(endless, file / "out")), 4);
  EXPECT_NE(said().find(file.string()), std::string::npos) << said();
  EXPECT_TRUE(fs::is_regular_file(file));
}

TEST_F(Behaviour, FrameThatCannotBeWrittenLeavesTheEarlierOnesWhole) {
  fs::create_directories(out() / "scene_000002.vtp" / "in the way");
  EXPECT_EQ(status_of(start(endless, out())), 4);
  EXPECT_NE(said().find("scene_000002.vtp"), std::string::npos) << said();
  const auto entries = read_pvd(out() / "scene.pvd");
  ASSERT_EQ(entries.size(), 2u);
  for (const auto& e : entries) EXPECT_EQ(read_frame(out() / e.file).time, e.time);
}

// What somebody put into the folder under our names: a pipe that nobody reads, links to other files.
TEST_F(Behaviour, PipesAndLinksInTheFolderAreNotWrittenThrough) {
  fs::create_directories(out());
  const std::string pipe = (out() / "history.csv").string();
  ASSERT_EQ(mkfifo(pipe.c_str(), 0666), 0);
  EXPECT_EQ(status_of(start(falling, out())), 4);
  EXPECT_NE(said().find("history.csv': is not a file"), std::string::npos) << said();
  fs::remove(pipe);
  const fs::path other = place_ / "other";
  std::ofstream(other) << "mine";
  fs::create_symlink(other, out() / "barchan.lock");
  EXPECT_EQ(status_of(start(falling, out())), 4);
  EXPECT_NE(said().find("barchan.lock': is a link"), std::string::npos) << said();
  fs::remove(out() / "barchan.lock");
  for (const char* name :
       {"scene.checkpoint.part", "scene.pvd.part", "run.json.part", "run.json", "scene.pvd", "history.csv"}) {
    fs::remove(out() / name);
    fs::create_symlink(other, out() / name);
  }
  EXPECT_EQ(status_of(start(falling, out())), 3) << said();
  std::ostringstream content;
  content << std::ifstream(other).rdbuf();
  EXPECT_EQ(content.str(), "mine");
}

// Anyone may write a run.json: a new run removes what instruments write, nothing else.
TEST_F(Behaviour, PlantedReportRemovesNothing) {
  fs::create_directories(out());
  std::ofstream(out() / "thesis.tex") << "all";
  std::ofstream(out() / "probe_old.csv") << "1";
  std::ofstream(out() / "run.json")
      << R"({"measured": [{"files": ["thesis.tex", "probe_old.csv", "..", "probe_a.b.csv"]}]})";
  EXPECT_EQ(status_of(start(falling, out())), 3);
  EXPECT_TRUE(fs::exists(out() / "thesis.tex"));
  EXPECT_FALSE(fs::exists(out() / "probe_old.csv"));
}

}  // namespace
}  // namespace barchan
