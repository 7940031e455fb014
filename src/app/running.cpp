#include "app/running.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <iostream>
#include <thread>

#include "app/make_report.hpp"
#include "app/signals.hpp"
#include "base/errors.hpp"
#include "base/instructions.hpp"
#include "base/ranks.hpp"
#include "base/version.hpp"
#include "output/checkpoint.hpp"
#include "output/numbers.hpp"
#include "output/placement.hpp"

namespace barchan {

namespace fs = std::filesystem;

namespace {

/// Of all phases at rest, kg/m3.
std::vector<double> densities(const Scene& scene) {
  std::vector<double> all;
  for (const auto& p : scene.phases) all.push_back(p.density);
  return all;
}

/// The frames of an earlier run that a state counts. Where neither a series nor a frame of it lies in the folder, none:
/// the series begins there. Frames that were removed while the run went on are missing from the series.
std::vector<SeriesWriter::Entry> kept_frames(const fs::path& directory, const Scene& scene, const OutputClock& clock) {
  if (clock.frames <= 0) return {};
  const fs::path series = directory / (scene.name + ".pvd");
  std::error_code unseen;
  if (!fs::exists(series, unseen) && !unseen && !has_frames(directory, scene.name)) {
    std::cerr << "barchan: " << directory.string() << " has no frame of \"" << scene.name
              << "\" yet; the series begins there with frame " << clock.frames << '\n';
    return {};
  }
  const auto refuse = [&](const std::string& what) { throw SceneError("--restart: " + series.string() + what); };
  auto frames = read_pvd(series);
  const std::size_t listed = frames.size();
  const auto number = [&](const SeriesWriter::Entry& frame) {
    return frame_number(scene.name, frame.file).value_or(-1);
  };
  std::erase_if(frames, [&](const auto& frame) { return number(frame) >= clock.frames; });
  if (frames.empty() || number(frames.back()) != clock.frames - 1)
    refuse(" lists " + std::to_string(listed) + " frames, without frame " + std::to_string(clock.frames - 1) +
           "; the checkpoint was written after " + std::to_string(clock.frames));
  if (frames.back().time != clock.last_frame_time)
    refuse(" is the series of another run: frame " + std::to_string(clock.frames - 1) + " is at " +
           brief(frames.back().time) + " s; expected " + brief(clock.last_frame_time) + " s");
  std::error_code ignored;
  const auto expect = [&](const fs::path& file) {
    if (!fs::is_regular_file(file, ignored))
      refuse(" lists " + file.lexically_relative(directory).string() +
             ", which is not there; expected all frames of the run");
  };
  for (const auto& frame : frames) {
    expect(directory / frame.file);
    if (is_list_of_pieces(frame.file))
      for (const fs::path& piece : pieces_of(directory / frame.file)) expect(piece);
  }
  return frames;
}

}  // namespace

fs::path checkpoint_file(const fs::path& directory, const Scene& scene) {
  return directory / (scene.name + ".checkpoint");
}

std::string bad_stem(const Scene& scene) { return scene.name + "_bad"; }

Run::Run(RunContext& context, bool continued)
    : context_(context),
      scene_(context.scene),
      simulation_(context.simulation),
      directory_(context.directory),
      continued_(continued),
      pieces_(context.directory, context.scene.output.format, context.scene.output.compress) {
  const Plan& plan = simulation_.plan();
  if (!plan.instruments.empty()) measurements_.emplace(plan.instruments, plan.bounds, densities(scene_));
}

void Run::open() {
  const std::vector<std::string> columns = simulation_.history_columns();
  if (ranks::is_first()) {
    series_.emplace(directory_, scene_.name, scene_.output.format, scene_.output.compress,
                    kept_frames(directory_, scene_, clock()));
    history_.emplace(directory_ / "history.csv", columns, continued_, simulation_.time());
    if (measurements_) measurements_->open(directory_, continued_, simulation_.time());
  }
  beginning_ = report("running");
  if (series_) write_run_report(directory_ / "run.json", beginning_);
  refuse_other_folders();
}

int Run::go(EarlierStates* past) {
  const int status = loop(past);
  if (clock().last_frame_step != simulation_.steps()) {
    simulation_.check_aside();
    write_frame();
  }
  if (reason_ == "end") bring_checkpoint_up_to_date();
  check_files();
  finish(reason_);
  return status;
}

int Run::loop(EarlierStates* past) {
  const double end = scene_.time.end;
  const double frame_every = scene_.output.every > 0 ? scene_.output.every : end;
  const double row_every = row_interval(scene_);
  const bool rows_cut = scene_.output.history_every > 0.0;
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
    if (context_.steering && !context_.steering->goes_on(simulation_, false)) {
      const int signal = stop_signal();
      return stop(signal != 0 ? signal_name(signal) : "the program that steers it", signal != 0 ? 128 + signal : 0);
    }
    if (past && past->due(simulation_.steps())) past->keep(simulation_, measurements());
    const double next_frame = std::min(end, static_cast<double>(frames_due) * frame_every);
    const double next_row = std::min(end, static_cast<double>(rows_due) * row_every);
    const double next = rows_cut ? std::min(next_frame, next_row) : next_frame;
    context_.team.step([&] { simulation_.step(next - simulation_.time()); });
    if (due(next_row) || due(next_frame)) simulation_.check();  // no file gets a state that is wrong
    if (measurements_) measurements_->sample(simulation_.state());
    if (due(next_row)) {
      write_row();
      rows_due = next_number(row_every);
    }
    if (due(next_frame)) {
      write_frame();
      ++frames_due;
    }
    agree();
    if (checkpoint_due()) write_checkpoint();
    context_.progress.step(simulation_);
    if (int status = 0; asked_to_stop(status)) return status;
  }
  if (context_.steering) context_.steering->goes_on(simulation_, true);
  reason_ = "end";
  return 0;
}

/// Looks for signals after every step, for the file TERMINATE after every sixteenth.
bool Run::asked_to_stop(int& status) {
  if (const int signal = ranks::active() ? context_.agreed.signal : stop_signal(); signal != 0) {
    status = stop(signal_name(signal), 128 + signal);
    return true;
  }
  if (ranks::active()) {
    if (context_.agreed.terminate) status = stop("TERMINATE", 0);
    return context_.agreed.terminate;
  }
  if (!is_terminated()) return false;
  status = stop("TERMINATE", 0);
  return true;
}

bool Run::is_terminated() const {
  std::error_code unseen;  // a folder that cannot be looked into is no reason to stop; writing to it will tell
  return simulation_.steps() % 16 == 0 && fs::exists(directory_ / "TERMINATE", unseen) && !unseen;
}

/// Every rank may have got a signal; the clock and the folder are those of the first one.
void Run::agree() {
  if (!ranks::active()) {
    if (unlisted_ && pieces_.is_done()) list_pieces();
    return;
  }
  const bool first = ranks::is_first(), asked = checkpoint_was_asked_for();
  std::string error;
  std::int64_t pieces = 0;  // 1: mine is not on the disk yet, 2: it never will be
  try {
    pieces = pieces_.is_done() ? 0 : 1;
  } catch (const OutputError& e) {
    error = e.what();
    pieces = 2;
  }
  std::array<std::int64_t, 4> asks{stop_signal(), asked || (first && checkpoint_is_late()) ? 1 : 0,
                                   first && is_terminated() ? 1 : 0, pieces};
  ranks::active()->reduce(asks.data(), asks.size(), Communicator::Take::largest);
  context_.agreed = {static_cast<int>(asks[0]), asks[1] != 0, asks[2] != 0};
  if (asks[3] == 2) throw_of_one(error);
  if (unlisted_ && asks[3] == 0) list_pieces();
}

int Run::stop(const std::string& why, int status) {
  reason_ = why;
  bring_checkpoint_up_to_date();
  std::cerr << "barchan: stopped by " << why << " at t = " << simulation_.time() << " s after " << simulation_.steps()
            << " steps; the last frame and a checkpoint are written, --restart latest goes on\n";
  return status;
}

bool Run::checkpoint_due() const {
  if (ranks::active()) return context_.agreed.checkpoint;
  return checkpoint_was_asked_for() || checkpoint_is_late();
}

bool Run::checkpoint_is_late() const {
  return scene_.output.checkpoint_every > 0 &&
         context_.progress.seconds() - context_.last_checkpoint >= scene_.output.checkpoint_every;
}

void Run::write_checkpoint() {
  simulation_.check_aside();
  check_folder();
  finish_series();
  if (history_) history_->sync();
  if (measurements_) measurements_->sync();
  simulation_.save_whole([&] {
    barchan::write_checkpoint(checkpoint_file(directory_, scene_),
                              {version() + " (" + commit() + ")",
                               name_of(instructions()),
                               scene_.identity,
                               simulation_.time(),
                               simulation_.steps(),
                               {}},
                              [&](Archive& a) {
                                context_.beds.archive(a, scene_);
                                simulation_.archive(a);
                                if (measurements_) measurements_->archive(a);
                              });
  });
  context_.last_checkpoint = context_.progress.seconds();
  context_.checkpoint_step = simulation_.steps();
  context_.checkpoint_frames = clock().frames;
}

void Run::bring_checkpoint_up_to_date() {
  if (context_.checkpoint_step != simulation_.steps() || context_.checkpoint_frames != clock().frames)
    write_checkpoint();
}

void Run::give_up_later_checkpoints() {
  if (ranks::is_first()) kept_frames(directory_, scene_, clock());  // refuses before anything is replaced
  files_of_retreat();
}

void Run::files_of_retreat() {
  finish_series();
  const fs::path file = checkpoint_file(directory_, scene_);
  if (!ranks::any(ranks::is_first() && fs::exists(file))) return;
  write_checkpoint();
  if (ranks::is_first()) remove_older_checkpoint(file);
}

/// The first warning of the scene's physics, which may be why a run breaks down; empty: there was none.
static std::string warned_of(const Plan& plan) {
  for (const std::string& warning : plan.warnings)
    for (const char* const section : {"phases.", "interactions", "domain", "fill.", "time."})
      if (warning.starts_with(section)) return "; the start warned of what may be the cause: " + warning;
  return "";
}

std::string Run::break_down(const std::string& what) {
  const long good = simulation_.good_step();
  if (good > clock().last_frame_step) {
    finish_series();
    hand_over(simulation_.good_frame(static_cast<int>(clock().frames++)));
    if (series_) {
      if (measurements_) measurements_->write(directory_, simulation_.good_time());
      simulation_.write_results(directory_.string(), simulation_.good_time());
    }
    clock().last_frame_step = good;
    clock().last_frame_time = simulation_.good_time();
  }
  finish_series();
  const OutputControl& output = scene_.output;
  const Frame frame = simulation_.frame(static_cast<int>(clock().frames));
  const std::string stem = bad_stem(scene_), bad = frame_name(stem, frame.in_pieces, output.format);
  if (frame.in_pieces) {
    std::string error;
    try {
      write_piece(directory_, stem, frame, output.format, output.compress);
    } catch (const OutputError& e) { error = e.what(); }
    if (ranks::any(!error.empty())) throw_of_one(error);
    if (series_) write_list_of_pieces(directory_, stem, frame, output.format);
  } else if (series_) {
    barchan::write_frame(directory_ / bad, frame, output.format, output.compress);
  }
  std::string message = what + "; last good state: " + (series_ ? series_->last_file() : "") +
                        " (t = " + brief(clock().last_frame_time) + " s, step " +
                        std::to_string(clock().last_frame_step) + "), first bad state: " + bad +
                        " (t = " + brief(simulation_.time()) + " s, step " + std::to_string(simulation_.steps()) + ")";
  finish("breakdown: " + message);
  return message + warned_of(simulation_.plan());
}

void Run::write_frame() {
  check_folder();
  finish_series();  // one frame at a time is in memory
  hand_over(simulation_.frame(static_cast<int>(clock().frames++)));
  if (series_) {
    if (measurements_) measurements_->write(directory_, simulation_.time());
    simulation_.write_results(directory_.string(), simulation_.time());
  }
  clock().last_frame_step = simulation_.steps();
  clock().last_frame_time = simulation_.time();
}

void Run::hand_over(Frame&& frame) {
  if (!frame.in_pieces) {
    if (series_) series_->write(std::move(frame));
    return;
  }
  unlisted_.emplace(frame.without_particles());
  pieces_.write(frame_stem(scene_.name, frame.index), std::move(frame));
}

void Run::list_pieces() {
  if (series_) series_->write(std::move(*unlisted_));
  unlisted_.reset();
}

void Run::throw_of_one(const std::string& error) {
  const std::vector<char> failed = ranks::each(static_cast<char>(error.empty() ? 0 : 1));
  const auto rank = std::find(failed.begin(), failed.end(), 1) - failed.begin();
  throw OutputError(ranks::text_of(static_cast<int>(rank), error));
}

void Run::refuse_other_folders() const {
  if (!ranks::active()) return;
  const fs::path file = directory_ / "run.json";  // the first rank has written it
  const std::string mine = run_of_report(beginning_.process, beginning_.host), first = ranks::text_of(0, mine);
  bool there = false;
  // A file system of a network may show a new file late.
  for (int k = 0; k < 300 && !(there = run_of_report(file) == first); ++k)
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  if (ranks::any(!there))
    throw SceneError("ranks write their checkpoints in pieces, into one folder; \"" + directory_.string() +
                     "\" is not the same for all of them; expected an --out that all machines see");
}

void Run::finish_series() {
  std::string error;
  try {
    pieces_.finish();
  } catch (const OutputError& e) { error = e.what(); }
  if (unlisted_) {  // no rank lists a frame before all have written their pieces
    if (ranks::any(!error.empty())) {
      unlisted_.reset();
      throw_of_one(error);
    }
    list_pieces();
  }
  if (series_) series_->finish();
}

void Run::write_row() {
  const std::vector<double> row = simulation_.history_row();
  if (history_) history_->row(row);
  simulation_.begin_row();
}

std::string Run::fault_of_folder() const {
  if (!context_.lock || context_.lock->is_there()) return "";
  return "the folder '" + directory_.string() +
         "' was removed or replaced while the run went on; nothing is written into another one";
}

void Run::check_folder() const {
  if (const std::string fault = fault_of_folder(); !fault.empty()) throw OutputError(fault);
}

void Run::check_files() {
  check_folder();
  finish_series();
  std::vector<std::string> removed;
  if (series_) removed = series_->removed();
  const std::size_t frames = removed.size();
  if (history_)
    if (std::string file = history_->removed(); !file.empty()) removed.push_back(file);
  if (measurements_ && series_)
    for (std::string& file : measurements_->removed()) removed.push_back(std::move(file));
  std::string error;
  constexpr std::size_t most = 5;  // names
  for (std::size_t k = 0; k < std::min(removed.size(), most); ++k) error += (k > 0 ? ", " : "") + removed[k];
  if (removed.size() > most) error += " and " + std::to_string(removed.size() - most) + " more";
  if (!error.empty())
    error = "files in '" + directory_.string() + "' were removed while the run went on: " + error +
            (frames > 0 ? "; " + scene_.name + ".pvd lists the frames that are there" : "");
  if (!ranks::any(!error.empty())) return;
  if (ranks::active()) throw_of_one(error);
  throw OutputError(error);
}

RunReport Run::report(const std::string& reason) const {
  RunReport r = make_report(simulation_, series_ ? &*series_ : nullptr, measurements_ ? &*measurements_ : nullptr,
                            context_.progress);
  if (const double seconds = pieces_.seconds_writing(); seconds > 0.0) {
    r.seconds.emplace_back("pieces of frames (waiting)", pieces_.seconds_waiting());
    r.seconds.emplace_back("pieces of frames (behind)", seconds);
  }
  r.end_reason = reason;
  r.scene_sha256 = context_.scene_sha256;
  r.threads = context_.team.most();
  r.thread_uses = context_.team.uses();
  r.thread_switches = context_.team.switches();
  r.ranks.placements = context_.placements;
  const std::vector<std::string> of_placements = warnings_of(context_.placements);
  r.warnings.insert(r.warnings.begin(), of_placements.begin(), of_placements.end());
  r.retreats = context_.retreats;
  r.retreat_count = simulation_.state().retreat.count;
  if (r.retreat_count > 0)
    r.warnings.push_back("the run went back to an earlier step " + std::to_string(r.retreat_count) +
                         (r.retreat_count == 1 ? " time" : " times") + " and took smaller ones" +
                         (r.retreats.empty() ? "" : "; the first failure: " + r.retreats.front().reason) +
                         "; docs/output.md says what the message means");
  return r;
}

/// The report, when the series is whole.
void Run::finish(const std::string& reason) {
  finish_series();
  const RunReport r = report(reason);
  if (!series_) return;
  const std::size_t told =
      simulation_.plan().warnings.size() + warnings_of(context_.placements).size();  // at the start
  for (std::size_t k = told; k < r.warnings.size(); ++k) std::cerr << "barchan: warning: " << r.warnings[k] << '\n';
  write_run_report(directory_ / "run.json", r);
  context_.progress.end(reason);
}

void Run::fail(const std::string& reason) {
  if (context_.lock && !context_.lock->is_there()) return context_.progress.end(reason);  // run.json is another run's
  if (ranks::active()) {  // the others may not be there to count with
    beginning_.end_reason = reason;
    beginning_.steps = simulation_.steps();
    beginning_.simulated_time = simulation_.time();
    if (series_) try_to_write(directory_ / "run.json", beginning_);
    return;
  }
  try {
    if (pieces_.failed()) unlisted_.reset();
    finish_series();                  // a frame that is whole is listed
  } catch (const std::exception&) {}  // NOLINT(bugprone-empty-catch): the reason of the end is another one
  if (series_) try_to_write(directory_ / "run.json", report(reason));
  context_.progress.end(reason);
}

}  // namespace barchan
