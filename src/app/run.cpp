// barchan run: integrate a scene and write its series.
#include <omp.h>

#include <algorithm>
#include <filesystem>
#include <iostream>
#include <optional>
#include <sstream>
#include <streambuf>
#include <utility>
#include <vector>

#include "app/commands.hpp"
#include "app/guard.hpp"
#include "app/launch.hpp"
#include "app/make_report.hpp"
#include "app/mpi_ranks.hpp"
#include "app/running.hpp"
#include "app/signals.hpp"
#include "base/errors.hpp"
#include "base/instructions.hpp"
#include "base/ranks.hpp"
#include "base/sha256.hpp"
#include "checks/reader.hpp"
#include "output/checkpoint.hpp"
#include "output/folder_lock.hpp"
#include "output/numbers.hpp"
#include "output/pieces.hpp"
#include "output/placement.hpp"
#include "output/whole_file.hpp"
#include "plan/memory_need.hpp"
#include "scene/identity.hpp"
#include "simulation/settle.hpp"

namespace barchan {

namespace {

namespace fs = std::filesystem;

/// Whether there is a checkpoint, or the one before it. Throws SceneError where only some of the ranks see one.
bool all_see(const fs::path& checkpoint) {
  const char mine = fs::exists(checkpoint) || fs::exists(older_checkpoint(checkpoint)) ? 1 : 0;
  Communicator* const all = ranks::available();
  if (!all) return mine == 1;
  std::vector<char> see(static_cast<std::size_t>(all->size()));
  all->all_gather(&mine, 1, see.data());
  const auto with = std::find(see.begin(), see.end(), 1), without = std::find(see.begin(), see.end(), 0);
  if (with != see.end() && without != see.end())
    throw SceneError("--restart latest: rank " + std::to_string(with - see.begin()) + " sees the checkpoint " +
                     checkpoint.string() + ", rank " + std::to_string(without - see.begin()) +
                     " does not; expected an --out that all machines share");
  return mine == 1;
}

/// What a run goes on from.
struct From {
  std::optional<Archive> state;    // nothing: a start at the beginning
  bool newest_is_damaged = false;  // then it is the state of the one before
  bool newest_is_another = false;  // than that of the folder
  bool has_ended = false;          // the run of the folder is at its end: there is nothing to do
};

/// A run replaces history.csv, run.json and tables of the folder: those of another scene would be lost.
void refuse_folder_of_another(const fs::path& directory, const Scene& scene) {
  std::error_code none;
  std::vector<std::string> others;
  for (const auto& file : fs::directory_iterator(directory, none))
    if (file.path().extension() == ".pvd" && file.path().stem() != scene.name)
      others.push_back(file.path().filename().string());
  if (others.empty()) return;
  std::sort(others.begin(), others.end());
  throw SceneError("--out " + directory.string() + ": the folder holds the run of another scene, " + others.front() +
                   ", whose history.csv and run.json this run would replace; expected another folder");
}

/// The state that --restart asks for. "latest" is the checkpoint of this folder, or the beginning where no run was;
/// frames without a checkpoint are refused, because a new run would remove them.
From find_checkpoint(const std::string& restart, const fs::path& directory, const Scene& scene) {
  refuse_folder_of_another(directory, scene);
  if (restart.empty()) return {};
  const fs::path latest = checkpoint_file(directory, scene), series = directory / (scene.name + ".pvd");
  if (restart == "latest" && !all_see(latest)) {
    if (fs::exists(series))
      throw SceneError("--restart latest: " + series.string() +
                       " is the series of an earlier run and there is no checkpoint to go on from; "
                       "a new run would remove its frames; expected another --out, or no --restart to start anew");
    std::cerr << "barchan: no checkpoint in the output folder; starting at the beginning\n";
    return {};
  }
  std::string damage;
  Checkpoint c;
  if (restart == "latest") std::tie(c, damage) = read_newest_checkpoint(latest);
  else c = read_checkpoint(fs::path(restart));
  if (const std::string lines = difference(c.scene, scene.identity); !lines.empty())
    throw SceneError("--restart " + restart + ": the checkpoint is of another scene; only title, state, time.end and " +
                     "[output] but its format may change; what differs:\n" + lines);
  const bool has_ended = c.time >= scene.time.end * (1.0 - 1e-12);
  if (has_ended && restart == "latest") {  // a job of a chain that is one too many
    std::cerr << "barchan: the run of " << directory.string() << " has ended, at t = " << brief(c.time)
              << " s; a later time.end continues it\n";
    return {{}, false, false, true};
  }
  if (has_ended)
    throw SceneError("--restart " + restart + ": the checkpoint is at t = " + brief(c.time) +
                     " s, and the scene ends at " + brief(scene.time.end) + " s; expected a larger time.end");
  if (!damage.empty())
    std::cerr << "barchan: " << damage << "; going on from the one before it, at t = " << brief(c.time) << " s\n";
  if (const std::string now = name_of(instructions()); c.instructions != now)
    std::cerr << "barchan: the checkpoint was made with " << c.instructions << "; with " << now
              << " the run goes on with other bits (see --instructions)\n";
  std::error_code unseen;
  const bool another = restart != "latest" && fs::exists(latest, unseen) && !fs::equivalent(restart, latest, unseen);
  return {Archive(std::move(c.state)), !damage.empty(), another};
}

/// Removes what an earlier run left and this one will not replace.
void clear(const fs::path& directory, const Scene& scene, const Plan& plan, const From& from) {
  std::error_code ignored;
  fs::remove(directory / "TERMINATE", ignored);
  remove_frame(directory, bad_stem(scene));
  const fs::path newest = checkpoint_file(directory, scene);
  // In the place of the damaged one: the next checkpoint would take the name of the one before from the whole one.
  if (from.newest_is_damaged) fs::rename(older_checkpoint(newest), newest);
  if (from.state) return;
  remove_checkpoints(newest);
  std::vector<std::string> ours;
  for (const auto& i : plan.instruments)
    for (const auto& file : i.files()) ours.push_back(file);
  for (const auto& file : measured_files(directory / "run.json"))
    if (std::find(ours.begin(), ours.end(), file) == ours.end()) fs::remove(directory / file, ignored);
  fs::remove(directory / "run.json", ignored);
}

/// The lock of the output folder; of processes that were started together, a second one is told why it has none.
void hold(std::optional<FolderLock>& lock, const fs::path& directory, const Launch& launch) {
  try {
    lock.emplace(directory);
  } catch (const SceneError& e) {
    if (!launch.together() || ranks::available()) throw;
    throw SceneError(e.what() + std::string("; ") + launch.told() +
                     ": each is a run and needs an --out of its own, or start one process only");
  }
}

/// After a failed step: goes back and lets the next steps be smaller. False when that has been tried often enough.
class Retreater {
 public:
  Retreater(RunContext& context, int most) : context_(context), most_(context.scene.time.fixed_step ? 0 : most) {}

  EarlierStates* past() { return most_ > 0 ? &past_ : nullptr; }

  bool go_back(Run& run, const std::string& why) {
    Simulation& s = context_.simulation;
    const long failed = s.steps();
    const double when = s.time();
    const bool again = when <= s.retreat().until;
    const double share = again ? 0.5 * s.retreat().share : 0.5;
    const long count = s.retreat().count + 1;
    if (count > most_ || share < smallest_share || !past_.go_back(s, run.measurements(), failed)) return false;
    // At smaller steps until it is as long after the failure as the state that it went back to was before.
    s.retreat() = {count, share, when + (when - s.time())};
    context_.retreats.push_back({when, s.time(), failed, share, why});
    context_.progress.back(s);
    std::cerr << "barchan: step " << failed << " failed: " << why << "\nbarchan: going back to t = " << brief(s.time())
              << " s, step " << s.steps() << ", and on with " << brief(share)
              << " of the step until t = " << brief(s.retreat().until) << " s\n";
    run.files_of_retreat();
    return true;
  }

 private:
  static constexpr double smallest_share = 0.125;
  RunContext& context_;
  int most_;
  EarlierStates past_;
};

/// The files go back to where the simulation went back to.
void begin_again(std::optional<Run>& run, RunContext& context) {
  Archive measured;
  if (run->measurements()) run->measurements()->archive(measured);
  run.emplace(context, true);
  measured.load_again();
  if (run->measurements()) run->measurements()->archive(measured);
  run->open();
}

int run_to_the_end(RunContext& context, From from, int retreats) {
  Simulation& simulation = context.simulation;
  Retreater retreater(context, retreats);
  std::optional<Run> run(std::in_place, context, from.state.has_value());
  if (std::optional<Archive>& state = from.state) {
    state->load_again();
    context.beds.archive(*state, context.scene);
    simulation.load_whole([&] { simulation.archive(*state); });
    if (run->measurements()) run->measurements()->archive(*state);
    state->finish();
    simulation.check_aside();
    state.reset();  // its memory is needed from now on
    std::cerr << "barchan: going on at t = " << brief(simulation.time()) << " s after " << simulation.steps()
              << " steps\n";
  }
  try {
    if (ranks::any(ranks::is_first() && from.newest_is_another)) run->give_up_later_checkpoints();
    run->open();
    while (true) {
      std::string why;
      try {
        return run->go(retreater.past());
      } catch (const LastingBreakdown& e) {
        throw BreakdownError(run->break_down(e.what()));
      } catch (const BreakdownError& e) { why = e.what(); }
      bool goes_on = false;
      try {
        goes_on = retreater.go_back(*run, why);
      } catch (const BreakdownError& e) { why = e.what(); }  // the state that it went back to is wrong too
      if (!goes_on) throw BreakdownError(run->break_down(why));
      begin_again(run, context);
    }
  } catch (const BreakdownError&) { throw; } catch (const OutputError& e) {
    const std::string folder = run->fault_of_folder(), why = folder.empty() ? e.what() : folder;
    run->fail("output failed: " + why);
    throw OutputError(why);
  } catch (const std::exception& e) {
    run->fail(std::string("failed: ") + e.what());
    throw;
  }
}

/// Nothing that the other ranks say is seen: all of them say the same.
class Silence {
 public:
  Silence() {
    if (ranks::is_first()) return;
    out_ = std::cout.rdbuf(&nothing_);
    err_ = std::cerr.rdbuf(&nothing_);
  }
  ~Silence() {
    if (out_) std::cout.rdbuf(out_);
    if (err_) std::cerr.rdbuf(err_);
  }
  Silence(const Silence&) = delete;
  Silence& operator=(const Silence&) = delete;

 private:
  struct Nothing : std::streambuf {
    int overflow(int c) override { return c == EOF ? 0 : c; }
  } nothing_;
  std::streambuf *out_ = nullptr, *err_ = nullptr;
};

/// All that decides what a run computes, for ranks to compare.
std::string command_of(const RunOptions& options) {
  std::string text = options.scene + "\n" + options.restart + "\n" + options.instructions + "\n" +
                     std::to_string(options.retreats) + "\n" + name_of(options.division);
  for (const std::string& one : options.overrides) text += "\n" + one;
  return text;
}

/// Ranks compute what they all hold by themselves: with other instructions it would have other bits.
void refuse_other_instructions() {
  if (!ranks::available()) return;
  const std::string own = name_of(instructions()), of_first = ranks::text_of_rank(0, own),
                    other = ranks::first_text(own == of_first ? "" : own);
  if (!other.empty())
    throw SceneError("the ranks have different instruction sets, " + of_first + " and " + other +
                     ": their results would have different bits; expected one for all: --instructions avx2, or "
                     "machines that are alike");
}

int run_scene(const RunOptions& options, const Launch& launch) {
  const bool first = ranks::is_first(), quiet = options.quiet || !first;
  if (!options.instructions.empty()) choose_instructions(options.instructions);
  refuse_other_instructions();
  const Scene scene = read_scene(options.scene, options.overrides);
  std::string checksum = sha256(read_text(options.scene));
  if (options.threads > 0) use_threads(options.threads, 0);
  const fs::path directory = options.out.empty() ? fs::path("out") / scene.name : fs::path(options.out);
  std::optional<FolderLock> lock;
  std::error_code unseen;
  if (first && fs::is_directory(directory, unseen)) hold(lock, directory, launch);
  From from = find_checkpoint(options.restart, directory, scene);
  if (from.has_ended) return 0;
  SettledBeds beds;
  if (from.state) beds.archive(*from.state, scene);
  auto blocks = make_particles(scene, quiet ? nullptr : &std::cout, &beds);
  const Plan plan = make_plan(scene, blocks);
  check_memory(scene, memory_need(scene, plan, options.retreats > 0 && !scene.time.fixed_step));
  const int share = threads_of_a_rank();
  use_threads(options.threads > 0 ? options.threads : share, plan.particles());
  std::vector<RunReport::Placement> placements = placements_of_ranks(omp_get_max_threads());
  for (const std::string& warning : warnings_of(placements)) std::cerr << "barchan: warning: " << warning << "\n";
  if (!quiet) std::cout << to_text(plan, scene) << to_text(placements) << std::flush;
  else
    for (const std::string& warning : plan.warnings) std::cerr << "barchan: warning: " << warning << "\n";
  Simulation simulation(scene, plan, std::move(blocks));
  simulation.divide_by(options.division);
  simulation.check_start();
  listen_to_signals();
  if (first && !lock) {
    make_directory(directory);
    hold(lock, directory, launch);
  }
  if (first && !lock->left_by().empty())
    std::cerr << "barchan: the run of " << lock->left_by() << " ended without a word in this folder\n";
  if (first) clear(directory, scene, plan, from);
  RunContext context{scene,
                     simulation,
                     directory,
                     Progress(scene.time.end, plan.particles(), quiet),
                     beds,
                     Team(omp_get_max_threads(), options.threads == 0),
                     std::move(placements),
                     std::move(checksum)};
  context.lock = lock ? &*lock : nullptr;
  std::optional<Steering> steering;
  if (options.steering.empty()) return run_to_the_end(context, std::move(from), options.retreats);
  if (ranks::available()) throw SceneError("--steering: one process only; expected no mpirun");
  context.steering = &steering.emplace(options.steering[0], options.steering[1]);
  return run_to_the_end(context, std::move(from), 0);  // who steers would see the time go back
}

}  // namespace

int run(const RunOptions& options) {
  outlive_readers();
  handle_questions();
  const Launch launch = how_launched();
  std::ostringstream words;
  int status = 0;
  try {
    join_ranks(launch, command_of(options), options.out);
    const Silence silence;
    return leave_ranks(run_scene(options, launch));
  } catch (...) {
    // Of independent runs each tells its own error at once: to leave takes as long as the others run.
    if (!ranks::available()) return leave_ranks(guarded(std::cerr, []() -> int { throw; }));
    status = guarded(words, []() -> int { throw; });
  }
  if (all_failed()) {
    if (ranks::is_first()) std::cerr << words.str();
    return leave_ranks(status);
  }
  std::cerr << words.str() << std::flush;
  abort_ranks(status);
  return status;
}

}  // namespace barchan
