// barchan run: integrate a scene and write its series.
#include <omp.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <iostream>
#include <optional>

#include "app/commands.hpp"
#include "app/progress.hpp"
#include "base/errors.hpp"
#include "base/instructions.hpp"
#include "base/version.hpp"
#include "measure/measurements.hpp"
#include "output/history.hpp"
#include "output/numbers.hpp"
#include "output/run_report.hpp"
#include "output/series.hpp"
#include "scene/reader.hpp"
#include "simulation/simulation.hpp"

namespace barchan {

namespace {

namespace fs = std::filesystem;

volatile std::sig_atomic_t caught_signal = 0;
void on_signal(int number) { caught_signal = number; }

double cpu_seconds() {
  timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

/// Where the first bad state of a run goes; not listed in the series.
fs::path bad_file(const fs::path& directory, const Scene& scene) {
  return directory / (scene.name + (scene.output.format == FrameFormat::vtp ? "_bad.vtp" : "_bad.vtu"));
}

/// Of all phases at rest, kg/m3.
std::vector<double> densities(const Scene& scene) {
  std::vector<double> all;
  for (const auto& p : scene.phases) all.push_back(p.density);
  return all;
}

/// All that a run writes, and where it stands.
class Run {
 public:
  Run(const Scene& scene, const Plan& plan, Simulation& simulation, const fs::path& directory, bool quiet)
      : scene_(scene),
        simulation_(simulation),
        directory_(directory),
        series_(directory, scene.name, scene.output.format, scene.output.compress),
        history_(directory / "history.csv", simulation_.history_columns()),
        progress_(scene.time.end, plan.particles(), quiet) {
    if (plan.instruments.empty()) return;
    measurements_.emplace(plan.instruments, plan.bounds, densities(scene));
    measurements_->open(directory);
  }

  int go() {
    int status = 0;
    try {
      status = loop();
      if (last_frame_step_ != simulation_.steps()) {
        simulation_.check();
        write_frame();
      }
    } catch (const BreakdownError& e) {
      const std::string message = e.what() + write_bad_state();
      reason_ = "breakdown: " + message;
      finish();
      progress_.end(reason_);
      throw BreakdownError(message);
    } catch (const OutputError& e) {
      reason_ = std::string("output failed: ") + e.what();
      progress_.end(reason_);
      throw;
    }
    finish();
    progress_.end(reason_);
    return status;
  }

 private:
  int loop() {
    const double end = scene_.time.end;
    const double frame_every = scene_.output.every > 0 ? scene_.output.every : end;
    const double row_every = scene_.output.history_every > 0 ? scene_.output.history_every : end / 100.0;
    long frames_due = 1, rows_due = 1;
    if (measurements_) measurements_->sample(simulation_.state());
    write_frame();
    write_row();
    const auto due = [&](double next) { return simulation_.time() * (1.0 + 1e-12) >= next; };
    while (simulation_.time() < end * (1.0 - 1e-12)) {
      const double next_frame = std::min(end, static_cast<double>(frames_due) * frame_every);
      const double next_row = std::min(end, static_cast<double>(rows_due) * row_every);
      simulation_.step(std::min(next_frame, next_row) - simulation_.time());
      if (due(next_row) || due(next_frame)) simulation_.check();  // no file gets a state that is wrong
      if (measurements_) measurements_->sample(simulation_.state());
      if (due(next_row)) {
        write_row();
        ++rows_due;
      }
      if (due(next_frame)) {
        write_frame();
        ++frames_due;
      }
      progress_.step(simulation_);
      if (simulation_.steps() % 16 == 0 || caught_signal != 0) {
        if (caught_signal != 0) return stop(caught_signal == SIGINT ? "SIGINT" : "SIGTERM", 128 + caught_signal);
        if (fs::exists(directory_ / "TERMINATE")) return stop("TERMINATE", 0);
      }
    }
    reason_ = "end";
    return 0;
  }

  int stop(const char* why, int status) {
    reason_ = why;
    std::cerr << "barchan: stopped by " << why << " at t = " << simulation_.time() << " s after " << simulation_.steps()
              << " steps; the last frame is written\n";
    return status;
  }

  /// A breakdown: the last good state joins the series, the first bad one stands beside it. What to say of them.
  std::string write_bad_state() {
    const long good = simulation_.good_step();
    if (good > last_frame_step_) {
      series_.write(simulation_.good_frame(frames_++));
      if (measurements_) measurements_->write(directory_, simulation_.good_time());
      last_frame_step_ = good;
      last_frame_time_ = simulation_.good_time();
    }
    series_.finish();
    barchan::write_frame(bad_file(directory_, scene_), simulation_.frame(frames_), scene_.output.format,
                         scene_.output.compress);
    return "; last good state: " + series_.last_file() + " (t = " + brief(last_frame_time_) + " s, step " +
           std::to_string(last_frame_step_) +
           "), first bad state: " + bad_file(directory_, scene_).filename().string() +
           " (t = " + brief(simulation_.time()) + " s, step " + std::to_string(simulation_.steps()) + ")";
  }

  void write_frame() {
    series_.write(simulation_.frame(frames_++));
    if (measurements_) measurements_->write(directory_, simulation_.time());
    last_frame_step_ = simulation_.steps();
    last_frame_time_ = simulation_.time();
  }
  void write_row() { history_.row(simulation_.history_row()); }

  /// The report, when the series is whole.
  void finish() {
    series_.finish();
    const Plan& plan = simulation_.plan();
    RunReport r;
    r.version = version();
    r.commit = commit();
    r.compiler = compiler();
    r.instruction_set = instruction_set();
    r.vtk = vtk_version();
    r.threads = omp_get_max_threads();
    r.scene_title = scene_.title;
    r.scene_file = scene_.file;
    r.scene_state = scene_.state;
    r.scene_spacing = scene_.spacing;
    double pairs = 0;
    for (const auto& p : plan.phases) {
      r.particles[p.name] = static_cast<long>(p.count);
      for (const Field f : p.fields) r.fields[p.name].emplace_back(info(f).name);
    }
    for (const auto& e : plan.entries) {
      r.pairs[e.name] = static_cast<long>(simulation_.pairs(e));
      pairs += static_cast<double>(simulation_.pairs(e));
    }
    r.steps = simulation_.steps();
    r.simulated_time = simulation_.time();
    double stepping = 0;
    for (std::size_t k = 0; k < simulation_.seconds().size(); ++k) {
      const auto& [name, seconds] = simulation_.seconds()[k];
      stepping += seconds;
      if (simulation_.executed()[k] == 0) continue;
      r.passes.push_back(name);
      r.seconds.emplace_back(name, seconds);
    }
    r.seconds.emplace_back("output (waiting)", series_.seconds_waiting());
    r.seconds.emplace_back("output (behind)", series_.seconds_writing());
    if (measurements_) {
      r.seconds.emplace_back("measuring", measurements_->seconds());
      for (std::size_t k = 0; k < plan.instruments.size(); ++k) {
        const Instrument& i = plan.instruments[k];
        r.measured.push_back(
            {kind_name(i.kind), i.name, i.files(), static_cast<long>(measurements_->accumulators().moments[k])});
      }
    }
    r.wall_seconds = progress_.seconds();
    r.cpu_seconds = cpu_seconds();
    const double steps = static_cast<double>(std::max(simulation_.steps(), 1L));
    r.particle_steps_per_second = plan.particles() * steps / std::max(stepping, 1e-9);
    r.pair_interactions_per_second = pairs * steps / std::max(stepping, 1e-9);
    for (const auto& [limit, count] : simulation_.limit_counts())
      if (count > 0) r.time_step_limits[limit] = count;
    const auto columns = simulation_.history_columns();
    const auto row = simulation_.history_row();
    for (std::size_t c = 2; c < row.size(); ++c) r.budgets[columns[c].substr(0, columns[c].find(" ["))] = row[c];
    r.budgets["neighbour_rebuilds"] = static_cast<double>(simulation_.neighbours().rebuilds());
    r.budgets["bytes_per_particle"] = static_cast<double>(simulation_.bytes()) / std::max(plan.particles(), 1.0);
    r.end_reason = reason_;
    r.warnings = simulation_.warnings().texts();
    for (const auto& w : r.warnings) std::cerr << "barchan: warning: " << w << '\n';
    write_run_report(directory_ / "run.json", r);
  }

  const Scene& scene_;
  Simulation& simulation_;
  fs::path directory_;
  SeriesWriter series_;
  History history_;
  Progress progress_;
  std::optional<Measurements> measurements_;  // empty: the scene measures nothing
  int frames_ = 0;
  long last_frame_step_ = -1;
  double last_frame_time_ = 0;
  std::string reason_;
};

/// There are no checkpoints yet. "latest" starts at the beginning where no run was; where frames lie it is refused,
/// because a new run would remove them.
void check_restart(const std::string& restart, const fs::path& series) {
  if (restart != "latest")
    throw SceneError("--restart " + restart +
                     ": checkpoints are not there yet; expected \"latest\", "
                     "which starts at the beginning in a folder without a run");
  if (fs::exists(series))
    throw SceneError("--restart latest: " + series.string() +
                     " is the series of an earlier run and there is no checkpoint to go on from; "
                     "a new run would remove its frames; expected another --out, or no --restart to start anew");
  std::cerr << "barchan: no checkpoint in the output folder; starting at the beginning\n";
}

}  // namespace

int run(const RunOptions& options) {
  if (!options.instructions.empty()) choose_instructions(options.instructions);
  const Scene scene = read_scene(options.scene, options.overrides);
  const auto blocks = generate(scene);
  const Plan plan = make_plan(scene, blocks);
  use_threads(options.threads, plan);
  const fs::path directory = options.out.empty() ? fs::path("out") / scene.name : fs::path(options.out);
  if (!options.restart.empty()) check_restart(options.restart, directory / (scene.name + ".pvd"));
  if (!options.quiet) std::cout << to_text(plan, scene) << std::flush;
  Simulation simulation(scene, plan, blocks);
  simulation.check_start();
  struct sigaction action {};
  action.sa_handler = on_signal;
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  std::error_code ignored;
  fs::remove(directory / "TERMINATE", ignored);  // what an earlier run left
  for (const char* suffix : {"_bad.vtp", "_bad.vtu"}) fs::remove(directory / (scene.name + suffix), ignored);
  return Run(scene, plan, simulation, directory, options.quiet).go();
}

}  // namespace barchan
