// A run in its folder: steps, and what is written when.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "app/earlier_states.hpp"
#include "app/progress.hpp"
#include "app/steering.hpp"
#include "engine/team.hpp"
#include "measure/measurements.hpp"
#include "output/folder_lock.hpp"
#include "output/history.hpp"
#include "output/pieces.hpp"
#include "output/run_report.hpp"
#include "output/series.hpp"
#include "simulation/settle.hpp"
#include "simulation/simulation.hpp"

namespace barchan {

/// What a run has that lasts when it goes back to an earlier step.
struct RunContext {
  const Scene& scene;
  Simulation& simulation;
  std::filesystem::path directory;
  Progress progress;
  SettledBeds& beds;
  Team team;
  std::vector<RunReport::Placement> placements;       // of ranks
  std::string scene_sha256;                           // of the text of the scene's file
  double last_checkpoint = 0.0;                       // s of the run's wall time
  long checkpoint_step = -1, checkpoint_frames = -1;  // what it was written of
  std::vector<RunReport::Retreat> retreats{};
  /// What is asked of a run on several ranks after this step.
  struct Agreed {
    int signal = 0;
    bool checkpoint = false, terminate = false;
  } agreed{};
  const FolderLock* lock = nullptr;  // of the first rank
  Steering* steering = nullptr;      // null: nobody steers the run
};

std::filesystem::path checkpoint_file(const std::filesystem::path& directory, const Scene& scene);
/// What the name of the first bad state of a run begins with; it is not listed in the series.
std::string bad_stem(const Scene& scene);

class Run {
 public:
  /// The simulation stands at its beginning, or `continued`: at a state of a run in this folder.
  Run(RunContext& context, bool continued);

  Measurements* measurements() { return measurements_ ? &*measurements_ : nullptr; }
  /// Makes the files; begins those of a continued run where its state says. Throws OutputError, SceneError.
  void open();
  /// Steps to the end, or until it is asked to stop. Returns the exit status. Throws BreakdownError for a step that
  /// failed. `past`: where states to go back to are kept; null: none.
  int go(EarlierStates* past);
  /// The state as it is now, in place of the last checkpoint. Frames that it counts are on the disk.
  void write_checkpoint();
  /// After going back: frames that were handed over are listed, and the checkpoint is written anew where there is one,
  /// because those on the disk may be of steps that are given up.
  void files_of_retreat();
  /// Before open() of a run that goes on from an earlier state than that of its folder's newest checkpoint: this state
  /// is the newest from now on, because open() removes the frames that later ones count. Throws as open().
  void give_up_later_checkpoints();
  /// For a run that ends with a failed step: the last good state joins the series, the first bad one stands beside it.
  /// Returns what to tell.
  std::string break_down(const std::string& what);
  /// For a run that ends for another reason: run.json says so if anything can be written. On several ranks its numbers
  /// are those of the beginning, but for steps and time.
  void fail(const std::string& reason);
  /// Empty: the folder is still the one of the beginning.
  std::string fault_of_folder() const;

 private:
  OutputClock& clock() { return simulation_.outputs(); }
  int loop(EarlierStates* past);
  int stop(const std::string& why, int status);
  bool asked_to_stop(int& status);
  bool is_terminated() const;
  void agree();
  bool checkpoint_due() const;
  bool checkpoint_is_late() const;
  /// A checkpoint, unless the last one says the same.
  void bring_checkpoint_up_to_date();
  void write_frame();
  void write_row();
  /// Hands a frame over, or a piece of it.
  void hand_over(Frame&& frame);
  /// Lists the frame of which all pieces are on the disk.
  void list_pieces();
  /// Throws on every rank what went wrong on one or several of them ("" where nothing did). All ranks call it.
  [[noreturn]] static void throw_of_one(const std::string& error);
  /// Pieces make a checkpoint or a frame only where all ranks write into one folder. Throws SceneError, on every rank.
  void refuse_other_folders() const;
  /// Waits until all frames are on the disk and listed.
  void finish_series();
  /// The folder is still the one of the beginning. Throws OutputError: another one may belong to another run.
  void check_folder() const;
  /// No file of this run was removed. Throws OutputError, on every rank; the .pvd lists the frames that are there.
  void check_files();
  RunReport report(const std::string& reason) const;
  void finish(const std::string& reason);

  RunContext& context_;
  const Scene& scene_;
  Simulation& simulation_;
  const std::filesystem::path& directory_;
  bool continued_;
  PieceWriter pieces_;
  std::optional<Frame> unlisted_;       // without particles: what pieces_ writes, on all ranks
  std::optional<SeriesWriter> series_;  // these two: of the first rank; empty on the others
  std::optional<History> history_;
  std::optional<Measurements> measurements_;  // empty: the scene measures nothing
  RunReport beginning_;                       // what run.json says while the run goes on
  std::string reason_;
};

}  // namespace barchan
