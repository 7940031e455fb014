#include <omp.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cerrno>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <iostream>
#include <string>
#include <vector>

#include "app/commands.hpp"
#include "app/guard.hpp"
#include "app/habits.hpp"
#include "app/mistakes.hpp"
#include "app/shipped.hpp"
#include "app/terminal.hpp"
#include "base/denormals.hpp"
#include "base/errors.hpp"
#include "base/memory.hpp"
#include "base/version.hpp"
#include "output/numbers.hpp"

namespace {

/// Whether the command has a team of threads: one that computes, with more than one thread.
bool needs_team(const std::vector<std::string>& words) {
  if (omp_get_max_threads() == 1 || words.size() < 2) return false;
  if (words[1] != "run" && words[1] != "plan" && words[1] != "generate") return false;
  for (std::size_t k = 2; k < words.size(); ++k)
    if (words[k] == "--threads=1" || (words[k - 1] == "--threads" && words[k] == "1")) return false;
  return true;
}

/// Threads that wait for work spin for a moment only, so that a busy machine is not wasted. OpenMP's library reads its
/// settings before main, so the program starts itself again with them, once, unless the user has set them. That costs
/// 0.04 s of loading (VTK's libraries), as much as a hundred steps of a small scene: not where one thread works alone.
void wait_politely(int argc, char** argv) {
  if (std::getenv("GOMP_SPINCOUNT") || std::getenv("OMP_WAIT_POLICY") || !needs_team({argv, argv + argc})) return;
  setenv("GOMP_SPINCOUNT", "20000", 1);
  execv("/proc/self/exe", argv);  // returns only if it failed; then the run goes on as it is
}

/// The status of a command whose answer is what it prints: it has failed when that could not be written.
int all_was_said(int status) {
  errno = 0;
  if (std::cout.flush() && std::fflush(stdout) == 0) return status;
  throw barchan::OutputError("cannot write to standard output" +
                             (errno ? ": " + std::string(std::strerror(errno)) : std::string()));
}

std::string version_text(bool verbose) {
  std::string text = "barchan " + barchan::version() + " (" + barchan::commit() +
                     ")\ncompiler: " + barchan::compiler() + "\ninstruction set: " + barchan::instruction_set();
  if (!verbose) return text + "\nVTK: " + barchan::vtk_version();
  for (const auto& [name, version] : barchan::packages()) text += "\n" + name + ": " + version;
  return text;
}

int dispatch(int argc, char** argv) {
  CLI::App app{"Barchan: wind-blown sand, multiphase flow and impact with smoothed particles"};
  std::vector<std::string> words(argv, argv + argc);  // --version answers before the options behind it are read
  bool verbose = std::find(words.begin(), words.end(), "--verbose") != words.end();
  app.set_version_flag(
      "--version", [&] { return version_text(verbose); }, "version, compiler and instruction set");
  app.add_flag("--verbose", verbose, "with --version: the versions of all packages too");
  app.require_subcommand(1);
  app.footer(
      "Exit status: 0 done, 1 compare: different, 2 wrong scene or command, 3 the run broke down,\n"
      "4 input/output failed, no threads or out of memory, 5 a mistake in Barchan itself, 128 + n stopped by signal "
      "n.\n"
      "A file named TERMINATE in the output folder ends a run well.");

  int status = 0;
  std::vector<std::string> overrides;
  const auto add_set = [&](CLI::App* c) {
    c->add_option("--set", overrides, "override a key of the scene, e.g. --set time.end=0.01")
        ->type_name("KEY=VALUE")
        ->allow_extra_args(false);  // one value each: what follows is the scene
  };

  barchan::RunOptions run;
  auto* c_run = app.add_subcommand("run", "run a scene and write its ParaView series");
  const char* const of_scene = "scene file (.toml), or the name of a scene that comes along (barchan list)";
  c_run->add_option("scene", run.scene, of_scene)->type_name("SCENE")->required();
  c_run->add_option("--out", run.out, "output folder (default out/NAME)")->type_name("DIR");
  c_run
      ->add_option("--threads", run.threads,
                   "number of threads, one while others hold the cores (default: as many as pay)")
      ->type_name("N")
      ->check(CLI::Range(1, 4096));
  c_run->add_option("--restart", run.restart, "go on from a checkpoint, or from the latest one")
      ->type_name("FILE|latest");
  c_run->add_option("--instructions", run.instructions, "avx2 or avx512 (default: the best that the machine has)")
      ->type_name("avx2|avx512");
  c_run->add_option("--retreats", run.retreats, "how often to go back after a failed step and take smaller ones (10)")
      ->type_name("N")
      ->check(CLI::Range(0, 1000));
  std::string division = name_of(run.division);
  c_run
      ->add_option("--division", division,
                   "ranks (mpirun -n N) share cells by the time of their steps, or by particles (default time)")
      ->type_name("time|particles")
      ->check([](const std::string& text) {
        return text == "time" || text == "particles" ? "" : text + " not in {time,particles}";
      });
  c_run->add_option("--steering", run.steering, "open files of requests and answers, for the Python package")
      ->delimiter(',')
      ->expected(2)
      ->group("");
  c_run->add_flag("--quiet", run.quiet, "print warnings and errors only");
  bool dry = false;
  c_run->add_flag("--dry", dry, "run nothing: the same as barchan plan");
  add_set(c_run);
  c_run->callback([&] {
    run.overrides = overrides;
    run.division = division == "time" ? barchan::Division::time : barchan::Division::particles;
    run.scene = barchan::scene_file(run.scene);
    status = dry ? barchan::plan(run.scene, overrides, run.threads, false) : barchan::run(run);
  });

  std::string scene, file_a, file_b;
  bool json = false;
  double tolerance = 0.0;
  auto* c_plan = app.add_subcommand("plan", "show what a scene would run and what it costs; run nothing");
  c_plan->add_option("scene", scene, of_scene)->type_name("SCENE")->required();
  int threads = 0;
  c_plan->add_option("--threads", threads, "number of threads that the estimate is for (default: those that run takes)")
      ->type_name("N")
      ->check(CLI::Range(1, 4096));
  int ranks = 0;
  c_plan->add_option("--ranks", ranks, "particles, ghosts and memory of a run on N ranks (mpirun -n N)")
      ->type_name("N")
      ->check(CLI::Range(1, 4096));
  c_plan->add_flag("--json", json, "as JSON");
  add_set(c_plan);
  c_plan->callback([&] { status = barchan::plan(barchan::scene_file(scene), overrides, threads, json, ranks); });

  auto* c_generate = app.add_subcommand("generate", "write the initial particles only");
  c_generate->add_option("scene", scene, of_scene)->type_name("SCENE")->required();
  c_generate->add_option("-o,--output", file_a, "file to write (.vtp or .vtu)")->type_name("FILE")->required();
  c_generate->add_option("--threads", threads, "number of threads (default: as many as pay)")
      ->type_name("N")
      ->check(CLI::Range(1, 4096));
  add_set(c_generate);
  c_generate->callback([&] { status = barchan::generate(barchan::scene_file(scene), file_a, overrides, threads); });

  auto* c_compare =
      app.add_subcommand("compare", "compare two frames, series or folders of runs, particle by particle");
  c_compare->add_option("a", file_a, ".vtp, .vtu, .pvtp, .pvtu, .pvd or the folder of a run")
      ->type_name("FILE")
      ->required();
  c_compare->add_option("b", file_b, ".vtp, .vtu, .pvtp, .pvtu, .pvd or the folder of a run")
      ->type_name("FILE")
      ->required();
  c_compare->add_option("--tolerance", tolerance, "relative difference that still counts as the same (default 0)")
      ->type_name("NUMBER")
      ->check([](const std::string& text) {
        const auto number = barchan::parse_number(text);
        return number && *number >= 0 && std::isfinite(*number) ? ""
                                                                : "expected a number >= 0, found " + text.substr(0, 40);
      });
  c_compare->add_flag("--json", json, "as JSON");
  c_compare->callback([&] { status = barchan::compare(file_a, file_b, tolerance, json); });

  barchan::add_habits(app, status);

  barchan::add_python_commands(app);
  if (argc > 1 && barchan::is_python_command(argv[1])) {
    if (words[1] == "sweep" && argc > 2 && !words[2].starts_with('-')) words[2] = barchan::scene_file(words[2]);
    return barchan::run_python(words);
  }

  if (const std::string what = barchan::not_a_command(app, argc > 1 ? argv[1] : ""); !what.empty()) {
    std::cerr << "barchan: " << what << "`barchan COMMAND --help` says more.\n";
    return 2;
  }
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    if (e.get_exit_code() == 0) return app.exit(e), all_was_said(0);  // --help, --version
    std::cerr << "barchan: " << barchan::wrong_command(app, e, words);
    return 2;
  }
  return c_run->parsed() ? status : all_was_said(status);
}

}  // namespace

int main(int argc, char** argv) {
  barchan::flush_denormals();
  wait_politely(argc, argv);
  barchan::return_freed_arrays();
  std::signal(SIGXFSZ, SIG_IGN);  // a file-size limit is an error to report, not a reason to die
  const barchan::Terminal terminal;
  return barchan::guarded(std::cerr, [&] { return dispatch(argc, argv); });
}
