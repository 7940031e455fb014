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
#include "output/checkpoint.hpp"
#include "output/history.hpp"
#include "output/numbers.hpp"
#include "output/run_report.hpp"
#include "output/series.hpp"
#include "scene/reader.hpp"
#include "simulation/settle.hpp"
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

fs::path checkpoint_file(const fs::path& directory, const Scene& scene) {
  return directory / (scene.name + ".checkpoint");
}

/// The frames of an earlier run that are whole, at most so many.
std::vector<SeriesWriter::Entry> kept_frames(const fs::path& directory, const Scene& scene, long most) {
  if (most <= 0) return {};
  auto frames = read_pvd(directory / (scene.name + ".pvd"));
  if (frames.size() < static_cast<std::size_t>(most))
    throw SceneError("--restart: " + (directory / (scene.name + ".pvd")).string() + " lists " +
                     std::to_string(frames.size()) + " frames; the checkpoint was written after " +
                     std::to_string(most));
  frames.resize(static_cast<std::size_t>(most));
  return frames;
}

/// All that a run writes, and where it stands.
class Run {
 public:
  /// The simulation stands at its beginning, or `continued`: at a checkpoint of a run in this folder.
  Run(const Scene& scene, const Plan& plan, Simulation& simulation, const fs::path& directory, bool quiet,
      bool continued)
      : scene_(scene),
        simulation_(simulation),
        directory_(directory),
        continued_(continued),
        series_(directory, scene.name, scene.output.format, scene.output.compress,
                kept_frames(directory, scene, clock().frames)),
        history_(directory / "history.csv", simulation.history_columns(), continued, simulation.time()),
        progress_(scene.time.end, plan.particles(), quiet) {
    if (plan.instruments.empty()) return;
    measurements_.emplace(plan.instruments, plan.bounds, densities(scene));
    measurements_->open(directory, continued, simulation.time());
  }

  /// What has been measured before the checkpoint.
  void load_measurements(Archive& a) {
    if (measurements_) measurements_->archive(a);
  }

  int go() {
    int status = 0;
    try {
      status = loop();
      if (clock().last_frame_step != simulation_.steps()) {
        simulation_.check();
        write_frame();
      }
      if (reason_ == "end") write_checkpoint();
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
  OutputClock& clock() { return simulation_.outputs(); }

  int loop() {
    const double end = scene_.time.end;
    const double frame_every = scene_.output.every > 0 ? scene_.output.every : end;
    const double row_every = scene_.output.history_every > 0 ? scene_.output.history_every : end / 100.0;
    const auto due = [&](double next) { return simulation_.time() * (1.0 + 1e-12) >= next; };
    const auto next_number = [&](double every) {
      long k = std::max(1L, static_cast<long>(simulation_.time() / every));
      while (due(static_cast<double>(k) * every)) ++k;
      return k;
    };
    long frames_due = next_number(frame_every), rows_due = next_number(row_every);
    if (!continued_) {
      if (measurements_) measurements_->sample(simulation_.state());
      write_frame();
      write_row();
    }
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
      if (checkpoint_due()) write_checkpoint();
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
    write_checkpoint();
    std::cerr << "barchan: stopped by " << why << " at t = " << simulation_.time() << " s after " << simulation_.steps()
              << " steps; the last frame and a checkpoint are written, --restart latest goes on\n";
    return status;
  }

  bool checkpoint_due() const {
    return scene_.output.checkpoint_every > 0 &&
           progress_.seconds() - last_checkpoint_ >= scene_.output.checkpoint_every;
  }

  /// The state after this step, in place of the last one. Frames that it counts are on the disk.
  void write_checkpoint() {
    simulation_.check();
    series_.finish();
    Archive archive;
    simulation_.archive(archive);
    if (measurements_) measurements_->archive(archive);
    barchan::write_checkpoint(checkpoint_file(directory_, scene_),
                              {version() + " (" + commit() + ")", name_of(instructions()), scene_.identity,
                               simulation_.time(), simulation_.steps(), archive.bytes()});
    last_checkpoint_ = progress_.seconds();
  }

  /// A breakdown: the last good state joins the series, the first bad one stands beside it. What to say of them.
  std::string write_bad_state() {
    const long good = simulation_.good_step();
    if (good > clock().last_frame_step) {
      series_.write(simulation_.good_frame(static_cast<int>(clock().frames++)));
      if (measurements_) measurements_->write(directory_, simulation_.good_time());
      clock().last_frame_step = good;
      clock().last_frame_time = simulation_.good_time();
    }
    series_.finish();
    barchan::write_frame(bad_file(directory_, scene_), simulation_.frame(static_cast<int>(clock().frames)),
                         scene_.output.format, scene_.output.compress);
    return "; last good state: " + series_.last_file() + " (t = " + brief(clock().last_frame_time) + " s, step " +
           std::to_string(clock().last_frame_step) +
           "), first bad state: " + bad_file(directory_, scene_).filename().string() +
           " (t = " + brief(simulation_.time()) + " s, step " + std::to_string(simulation_.steps()) + ")";
  }

  void write_frame() {
    series_.write(simulation_.frame(static_cast<int>(clock().frames++)));
    if (measurements_) measurements_->write(directory_, simulation_.time());
    clock().last_frame_step = simulation_.steps();
    clock().last_frame_time = simulation_.time();
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
    r.budgets["neighbour_rebuilds"] = static_cast<double>(simulation_.searches());
    r.budgets["bytes_per_particle"] = static_cast<double>(simulation_.bytes()) / std::max(plan.particles(), 1.0);
    r.end_reason = reason_;
    r.warnings = simulation_.warnings().texts();
    for (const auto& w : r.warnings) std::cerr << "barchan: warning: " << w << '\n';
    write_run_report(directory_ / "run.json", r);
  }

  const Scene& scene_;
  Simulation& simulation_;
  fs::path directory_;
  bool continued_;
  SeriesWriter series_;
  History history_;
  Progress progress_;
  std::optional<Measurements> measurements_;  // empty: the scene measures nothing
  double last_checkpoint_ = 0.0;              // s of the run's wall time
  std::string reason_;
};

/// What --restart asks for; nothing: a start at the beginning. "latest" is the checkpoint of this folder, or the
/// beginning where no run was; frames without a checkpoint are refused, because a new run would remove them.
std::optional<Checkpoint> find_checkpoint(const std::string& restart, const fs::path& directory, const Scene& scene) {
  if (restart.empty()) return std::nullopt;
  const fs::path latest = checkpoint_file(directory, scene), series = directory / (scene.name + ".pvd");
  if (restart == "latest" && !fs::exists(latest)) {
    if (fs::exists(series))
      throw SceneError("--restart latest: " + series.string() +
                       " is the series of an earlier run and there is no checkpoint to go on from; "
                       "a new run would remove its frames; expected another --out, or no --restart to start anew");
    std::cerr << "barchan: no checkpoint in the output folder; starting at the beginning\n";
    return std::nullopt;
  }
  Checkpoint c = read_checkpoint(restart == "latest" ? latest : fs::path(restart));
  if (const std::string lines = difference(c.scene, scene.identity); !lines.empty())
    throw SceneError("--restart " + restart + ": the checkpoint is of another scene; only title, state, time.end and " +
                     "output.checkpoint-every may change; what differs:\n" + lines);
  if (c.time >= scene.time.end * (1.0 - 1e-12))
    throw SceneError("--restart " + restart + ": the checkpoint is at t = " + brief(c.time) +
                     " s, and the scene ends at " + brief(scene.time.end) + " s; expected a larger time.end");
  if (const std::string now = name_of(instructions()); c.instructions != now)
    std::cerr << "barchan: the checkpoint was made with " << c.instructions << "; with " << now
              << " the run goes on with other bits (see --instructions)\n";
  return c;
}

}  // namespace

int run(const RunOptions& options) {
  if (!options.instructions.empty()) choose_instructions(options.instructions);
  const Scene scene = read_scene(options.scene, options.overrides);
  const auto blocks = make_particles(scene);
  const Plan plan = make_plan(scene, blocks);
  use_threads(options.threads, plan);
  const fs::path directory = options.out.empty() ? fs::path("out") / scene.name : fs::path(options.out);
  const std::optional<Checkpoint> from = find_checkpoint(options.restart, directory, scene);
  if (!options.quiet) std::cout << to_text(plan, scene) << std::flush;
  Simulation simulation(scene, plan, blocks);
  simulation.check_start();
  std::optional<Archive> archive;
  if (from) {
    archive.emplace(from->state);
    simulation.archive(*archive);
  }
  struct sigaction action {};
  action.sa_handler = on_signal;
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  std::error_code ignored;
  fs::remove(directory / "TERMINATE", ignored);  // what an earlier run left
  for (const char* suffix : {"_bad.vtp", "_bad.vtu"}) fs::remove(directory / (scene.name + suffix), ignored);
  if (!from) fs::remove(checkpoint_file(directory, scene), ignored);
  Run run(scene, plan, simulation, directory, options.quiet, from.has_value());
  if (archive) {
    run.load_measurements(*archive);
    archive->finish();
    std::cerr << "barchan: going on at t = " << brief(simulation.time()) << " s after " << simulation.steps()
              << " steps\n";
  }
  return run.go();
}

}  // namespace barchan
