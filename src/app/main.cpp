#include <unistd.h>

#include <CLI/CLI.hpp>
#include <csignal>
#include <cstdlib>
#include <iostream>

#include "app/commands.hpp"
#include "base/denormals.hpp"
#include "base/errors.hpp"
#include "base/version.hpp"

namespace {

/// Threads that wait for work spin for a moment only, so that a busy machine is not wasted. OpenMP's library reads its
/// settings before main, so the program starts itself again with them, once, unless the user has set them.
void wait_politely(char** argv) {
  if (std::getenv("GOMP_SPINCOUNT") || std::getenv("OMP_WAIT_POLICY")) return;
  setenv("GOMP_SPINCOUNT", "20000", 1);
  execv("/proc/self/exe", argv);  // returns only if it failed; then the run goes on as it is
}

}  // namespace

int main(int argc, char** argv) {
  barchan::flush_denormals();
  wait_politely(argv);
  std::signal(SIGXFSZ, SIG_IGN);  // a file-size limit is an error to report, not a reason to die
  CLI::App app{"Barchan: wind-blown sand, multiphase flow and impact with smoothed particles"};
  app.set_version_flag("--version", [] {
    return "barchan " + barchan::version() + " (" + barchan::commit() + ")\ncompiler: " + barchan::compiler() +
           "\ninstruction set: " + barchan::instruction_set() + "\nVTK: " + barchan::vtk_version();
  });
  app.require_subcommand(1);
  app.footer(
      "Exit status: 0 done, 2 wrong scene or command, 3 the run broke down, 4 input/output failed,\n"
      "130 or 143 stopped by a signal. A file named TERMINATE in the output folder ends a run well.");

  int status = 0;
  std::vector<std::string> overrides;
  const auto add_set = [&](CLI::App* c) {
    c->add_option("--set", overrides, "override a key of the scene, e.g. --set time.end=0.01")->type_name("KEY=VALUE");
  };

  barchan::RunOptions run;
  auto* c_run = app.add_subcommand("run", "run a scene and write its ParaView series");
  c_run->add_option("scene", run.scene, "scene file (.toml)")->required();
  c_run->add_option("--out", run.out, "output folder (default out/NAME)")->type_name("DIR");
  c_run->add_option("--threads", run.threads, "number of threads (default: all)")->check(CLI::Range(1, 4096));
  c_run->add_option("--restart", run.restart, "go on from a checkpoint, or from the latest one")
      ->type_name("FILE|latest");
  c_run->add_flag("--quiet", run.quiet, "print errors only");
  add_set(c_run);
  c_run->callback([&] {
    run.overrides = overrides;
    status = barchan::run(run);
  });

  std::string scene, file_a, file_b;
  bool json = false;
  double tolerance = 0.0;
  auto* c_plan = app.add_subcommand("plan", "show what a scene would run and what it costs; run nothing");
  c_plan->add_option("scene", scene, "scene file (.toml)")->required();
  c_plan->add_flag("--json", json, "as JSON");
  add_set(c_plan);
  c_plan->callback([&] { status = barchan::plan(scene, overrides, json); });

  auto* c_generate = app.add_subcommand("generate", "write the initial particles only");
  c_generate->add_option("scene", scene, "scene file (.toml)")->required();
  c_generate->add_option("-o,--output", file_a, "file to write (.vtp or .vtu)")->required();
  add_set(c_generate);
  c_generate->callback([&] { status = barchan::generate(scene, file_a, overrides); });

  auto* c_compare = app.add_subcommand("compare", "compare two frames or two series, particle by particle");
  c_compare->add_option("a", file_a, ".vtp, .vtu or .pvd")->required();
  c_compare->add_option("b", file_b, ".vtp, .vtu or .pvd")->required();
  c_compare->add_option("--tolerance", tolerance, "relative difference that still counts as the same (default 0)")
      ->check(CLI::NonNegativeNumber);
  c_compare->add_flag("--json", json, "as JSON");
  c_compare->callback([&] { status = barchan::compare(file_a, file_b, tolerance, json); });

  app.add_subcommand("schema", "print the JSON schema of a scene file")->callback([&] { status = barchan::schema(); });

  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    const int code = app.exit(e);
    return code == 0 ? 0 : 2;
  } catch (const barchan::SceneError& e) {
    std::cerr << "barchan: " << e.what() << '\n';
    return 2;
  } catch (const barchan::BreakdownError& e) {
    std::cerr << "barchan: " << e.what() << '\n';
    return 3;
  } catch (const barchan::OutputError& e) {
    std::cerr << "barchan: " << e.what() << '\n';
    return 4;
  } catch (const std::bad_alloc&) {
    std::cerr << "barchan: out of memory; see `barchan plan` for what the scene needs\n";
    return 4;
  }
  return status;
}
