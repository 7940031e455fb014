// What the program answers to a wrong command, and that a plan takes threads and passes warnings on.
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "unit/scene_texts.hpp"

namespace barchan {
namespace {

namespace fs = std::filesystem;
using testing::square_text;

class Commands : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!fs::exists(BARCHAN_PROGRAM)) GTEST_SKIP() << "no program at " BARCHAN_PROGRAM;
    place_ = fs::path(::testing::TempDir()) / ("barchan_commands_" + std::to_string(getpid()));
    fs::create_directories(place_);
  }
  void TearDown() override { fs::remove_all(place_); }

  /// Runs the program in the folder of the test; returns its status, and in `said_` and `errors_` what it said.
  int run(const std::string& arguments) {
    const std::string command = "cd '" + place_.string() + "' && '" BARCHAN_PROGRAM "' " + arguments + " > said 2> err";
    const int status = std::system(command.c_str());
    const auto text = [&](const char* name) {
      std::ostringstream stream;
      stream << std::ifstream(place_ / name).rdbuf();
      return stream.str();
    };
    said_ = text("said");
    errors_ = text("err");
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }
  void write(const std::string& name, const std::string& text) { std::ofstream(place_ / name) << text; }
  void expect_commands() const {
    for (const char* command : {"  run ", "  plan ", "  generate ", "  compare ", "  schema "})
      EXPECT_NE(errors_.find(command), std::string::npos) << command << " in: " << errors_;
  }

  fs::path place_;
  std::string said_, errors_;
};

TEST_F(Commands, NoCommandShowsThem) {
  EXPECT_EQ(run(""), 2);
  EXPECT_EQ(errors_.substr(0, errors_.find('\n')), "barchan: no command");
  expect_commands();
}

TEST_F(Commands, MisspeltCommand) {
  EXPECT_EQ(run("rnu s.toml"), 2);
  EXPECT_EQ(errors_.substr(0, errors_.find('\n')), "barchan: \"rnu\" is not a command; did you mean \"run\"?");
  expect_commands();
  EXPECT_EQ(run("banana"), 2);
  EXPECT_EQ(errors_.substr(0, errors_.find('\n')), "barchan: \"banana\" is not a command");
}

TEST_F(Commands, SceneWithoutACommand) {
  EXPECT_EQ(run("scenes/x.toml"), 2);
  EXPECT_EQ(errors_.substr(0, errors_.find('\n')),
            "barchan: \"scenes/x.toml\" is a scene, not a command; did you mean \"barchan run scenes/x.toml\"?");
  expect_commands();
}

TEST_F(Commands, MisspeltOption) {
  write("s.toml", square_text);
  EXPECT_EQ(run("run s.toml --thread 1"), 2);
  EXPECT_EQ(errors_.substr(0, errors_.find('\n')), "barchan: unknown option --thread; did you mean --threads?");
  EXPECT_EQ(run("plan s.toml --jsn"), 2);
  EXPECT_EQ(errors_.substr(0, errors_.find('\n')), "barchan: unknown option --jsn; did you mean --json?");
}

TEST_F(Commands, ReportNamesTheOverrides) {
  write("s.toml", square_text);
  ASSERT_EQ(run("run s.toml --quiet --out o --set time.end=1e-3 --set phases.air.density=2"), 0) << errors_;
  const auto report = nlohmann::json::parse(std::ifstream(place_ / "o" / "run.json"));
  EXPECT_EQ(report["scene"]["set"], (nlohmann::json{"time.end=1e-3", "phases.air.density=2"}));
}

TEST_F(Commands, NameThatIsTooLongIsRefusedBeforeTheRun) {
  const std::string name = std::string(200, 'n') + ".toml";
  write(name, square_text);
  for (const char* command : {"plan ", "run "}) {
    EXPECT_EQ(run(command + name), 2);
    EXPECT_NE(errors_.find("the name of the scene has 200 letters"), std::string::npos) << errors_;
  }
}

TEST_F(Commands, HelpAndVersionAreNoMistakes) {
  EXPECT_EQ(run("--help"), 0);
  EXPECT_NE(said_.find("5 a mistake in Barchan itself"), std::string::npos);
  EXPECT_EQ(run("--version"), 0);
  EXPECT_EQ(run("plan --help"), 0);
  EXPECT_EQ(run("--nonsense"), 2);
}

TEST_F(Commands, PlanTakesThreadsAndPassesWarningsOn) {
  write("s.toml", square_text);
  EXPECT_EQ(run("plan s.toml --json --threads 2"), 0) << errors_;
  const auto plan = nlohmann::json::parse(said_);
  EXPECT_EQ(plan["estimate"]["threads"], 2);
  EXPECT_GT(plan["estimate"]["seconds"].get<double>(), 0.0);
  EXPECT_GT(plan["estimate"]["processor_seconds"].get<double>(), 0.0);
  EXPECT_TRUE(plan["warnings"].empty());
  EXPECT_EQ(plan["interactions"]["air-air"]["corrected"], true);
  EXPECT_EQ(plan["phases"]["air"]["enclosed"], false);
  const std::string pairing = " --set phases.air.scheme=plain --set interactions.kernel=cubic-spline";
  EXPECT_EQ(run("plan s.toml --json" + pairing), 0);
  EXPECT_EQ(nlohmann::json::parse(said_)["warnings"].size(), 1u);
  EXPECT_EQ(run("run s.toml --set time.end=0.01" + pairing), 0) << errors_;
  EXPECT_NE(said_.find("warning: interactions.air-air: under the cubic spline particles pair"), std::string::npos);
  EXPECT_EQ(run("plan s.toml --threads 0"), 2);
}

/// The title that a scene has from a file name which is no UTF-8 cannot be written as JSON: an exception that is not
/// ours.
TEST_F(Commands, ExceptionOfALibraryHasAStatus) {
  write("\xff.toml", square_text);
  EXPECT_EQ(run("plan --json '\xff.toml'"), 5);
  EXPECT_NE(errors_.find("a mistake in Barchan itself"), std::string::npos) << errors_;
}

}  // namespace
}  // namespace barchan
