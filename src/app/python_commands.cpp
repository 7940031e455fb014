// barchan report and sweep, which the package in python/barchan does.
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <string>
#include <system_error>
#include <vector>

#include "app/commands.hpp"
#include "app/habits.hpp"
#include "base/errors.hpp"

namespace barchan {
namespace {

namespace fs = std::filesystem;

/// The folder that holds the package `barchan`: share/barchan/python of an installation, python/ of the source tree.
fs::path package_folder(const fs::path& program) {
  const fs::path above = program.parent_path().parent_path();
  const std::vector<fs::path> places = {above / "share/barchan/python", above / "python"};
  std::error_code ignored;
  for (const fs::path& place : places)
    if (fs::is_regular_file(place / "barchan/__main__.py", ignored)) return place;
  throw OutputError("the Python package of Barchan is not next to the program: neither in " + places[0].string() +
                    " nor in " + places[1].string());
}

}  // namespace

bool is_python_command(const std::string& word) { return word == "report" || word == "sweep"; }

void add_python_commands(CLI::App& app) {
  const auto option = [](CLI::App* command, const char* names, const char* takes, const char* meaning) {
    return command->add_option(names)->type_name(takes)->description(meaning);
  };
  auto* report = app.add_subcommand("report", "one HTML page of a run, from its folder (python3)");
  option(report, "folder", "DIR", "folder of a run, as out/dune")->required();
  option(report, "-o,--output", "FILE", "the page (default DIR/report.html)");
  report->add_flag("--render")->description("render pictures of the scene's states first (ParaView)");
  report->add_flag("--film")->description("put films into the page; with --render make them");
  option(report, "--scene", "FILE", "the file of the scene, where it is not the one that run.json names");
  option(report, "--speed", "U", "with --length: coefficients of force, for a stream of this speed (m/s)");
  option(report, "--length", "L", "width of the body across the stream (m)");
  report->add_flag("--no-plan")->description("do not ask barchan plan for the matrix");
  auto* sweep = app.add_subcommand("sweep", "run a scene with many values of its keys (python3)");
  option(sweep, "scene", "SCENE", "scene file (.toml), or the name of a scene that comes along")->required();
  option(sweep, "--vary", "KEY=VALUES", "FROM:TO:NUMBER, FROM:TO:NUMBER:log or VALUE,VALUE,...; again for another key");
  option(sweep, "--set", "KEY=VALUE", "override a key of the scene in all runs");
  option(sweep, "-j,--jobs", "N", "runs at a time (default: processors over --threads)");
  option(sweep, "--threads", "N", "threads of each run (default 1)");
  option(sweep, "--out", "DIR", "folder of the sweep (default out/NAME_sweep)");
  option(sweep, "--measure", "COLUMN[:WAY]",
         "a column of history.csv; WAY is last, first, mean, max or min of its rows");
  option(sweep, "--from", "TIME", "s; measures take the rows of the history from this time on");
}

int run_python(const std::vector<std::string>& words) {
  std::error_code failed;
  const fs::path program = fs::read_symlink("/proc/self/exe", failed);
  if (failed) throw OutputError("/proc/self/exe: " + failed.message());
  const char* named = std::getenv("BARCHAN_PYTHON");
  const std::string python = named && *named ? named : "/usr/bin/python3";
  const char* before = std::getenv("PYTHONPATH");
  const std::string folders = package_folder(program).string() + (before && *before ? ":" + std::string(before) : "");
  setenv("PYTHONPATH", folders.c_str(), 1);
  setenv("BARCHAN_PROGRAM", program.c_str(), 1);
  std::vector<std::string> line = {python, "-P", "-m", "barchan"};  // -P: no module of the folder it stands in
  line.insert(line.end(), words.begin() + 1, words.end());
  std::vector<char*> arguments;
  for (std::string& word : line) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  execv(python.c_str(), arguments.data());  // returns only if it failed
  throw OutputError("barchan " + words[1] + " needs " + python + ": " + std::strerror(errno) +
                    "; apt install python3, or name another in BARCHAN_PYTHON");
}

}  // namespace barchan
