// The subcommands of `barchan`; each returns the exit status.
#pragma once

#include <string>
#include <vector>

#include "engine/division.hpp"
#include "plan/plan.hpp"

namespace barchan {

struct RunOptions {
  std::string scene;
  std::string out;                     // empty: out/NAME
  std::vector<std::string> overrides;  // KEY=VALUE
  int threads = 0;                     // 0: all
  std::string restart;                 // empty, "latest" or a checkpoint
  std::string instructions;            // empty: the best that the machine has
  int retreats = 10;                   // how often a run may go back after a failed step
  Division division = Division::time;  // of cells among ranks
  bool quiet = false;
  std::vector<int> steering;  // open files of requests and answers (app/steering.hpp); empty: nobody steers it
};

/// Sets the number of threads: `wanted`, or for 0 one for every two thousand particles, as far as the machine has them.
/// Below that, waiting for each other costs more than it brings. The result does not depend on it.
void use_threads(int wanted, double particles);

int run(const RunOptions& options);
/// `ranks` > 0: what a run on so many ranks would be as well.
int plan(const std::string& scene, const std::vector<std::string>& overrides, int threads, bool json, int ranks = 0);
int generate(const std::string& scene, const std::string& file, const std::vector<std::string>& overrides, int threads);
int compare(const std::string& a, const std::string& b, double tolerance, bool json);

/// Whether the first word of a command line is one that the Python package does: report, sweep.
bool is_python_command(const std::string& word);
/// Becomes `python3 -m barchan` with the words behind the program's name (`words[0]`). Throws OutputError if that is
/// not there.
int run_python(const std::vector<std::string>& words);

}  // namespace barchan
