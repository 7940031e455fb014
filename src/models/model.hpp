// A model: one kind of physics of a scene. It declares what it needs and adds its tasks to the schedule of a step.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/warnings.hpp"
#include "engine/schedule.hpp"
#include "models/history_row.hpp"
#include "models/layout.hpp"
#include "models/step_limits.hpp"
#include "start/generate.hpp"
#include "state/state.hpp"

namespace barchan {

/// The parts of a step, in order. The step limits and the watch come between steps.
namespace stage {
enum Stage : std::size_t {
  kick_and_drift,
  grain_contacts,
  strain_records,
  strain,
  walls,
  neighbours,
  pack,
  eddies,
  extend_walls,
  extend_solids,
  fluid,
  surface,
  repel,
  elastic,
  weight,
  rigid_loads,
  contacts,
  reaction,
  drag,
  rigid,
  motion,
  hold,
  energy,
  kick,
  watch,
  count
};
extern const std::array<const char*, count> names;
}  // namespace stage

class Workspace;

class Model {
 public:
  Model() = default;
  virtual ~Model() = default;
  Model(const Model&) = delete;
  Model& operator=(const Model&) = delete;

  /// Sets the initial state of its phase but for position and velocity, which are set before.
  virtual void begin(State&, const std::vector<ParticleBlock>&) {}
  /// Binds the records and lists that its tasks work on; once, when the state is there. Throws SceneError where only
  /// the particles show a mistake.
  virtual void attach(Workspace&) {}
  /// Adds its tasks. Needs no state: the plan prints what the step will execute.
  virtual void schedule(Schedule&) = 0;
  /// The bounds of the step that are the same in the whole run.
  virtual void limits(std::vector<StepLimit>&) const {}
  /// A bound of the step that changes with the motion; null: there is none.
  virtual const StepLimit* moving_limit() { return nullptr; }
  /// Its phase; -1: it belongs to an entry.
  virtual int phase() const { return -1; }
  /// Adds its columns of history.csv with their values: of a moving phase behind those that all have, of an entry at
  /// the end. The columns are the same in every row of a run. A row may follow the loading of a checkpoint at once,
  /// before records are filled: it reads the fields and what archive() saves.
  virtual void history(HistoryRow&) const {}
  /// A row of history.csv was written: means over the time between rows begin anew.
  virtual void begin_row() {}
  /// Brings the fields up to date that only outputs read, and what a row tells of them. Called before every frame and
  /// row.
  virtual void derive() {}
  /// A fault that only this model can find, with the remedy; empty: there is none.
  virtual std::optional<std::string> trouble() const { return std::nullopt; }
  /// Directed pairs in its own lists of an entry, and how often it has searched them: for models that have such.
  virtual std::uint64_t pairs(const PlanEntry&) const { return 0; }
  virtual long searches() const { return 0; }
  /// The contacts of the spheres of a phase, from which a bed that rests can begin again.
  virtual std::vector<RestingContact> resting_contacts(std::size_t) const { return {}; }
  /// A term of the budget of energy now (J), beside motion, weight and the compression of fluids: what a body holds
  /// as strain; less the work that a drive has done since the start.
  virtual double budget_energy() { return 0.0; }
  /// Replaces the files of its own results in a folder, each whole or not at all; called with every frame. `time` (s)
  /// is that of the frame. Throws OutputError.
  virtual void write(const std::string& /*folder*/, double /*time*/) const {}
  /// What a user should know of the run so far before its results are used.
  virtual void report(Warnings&) const {}
  /// Its numbers that a step starts from.
  virtual void archive(Archive&) {}
  /// Before the first rank saves what one process has: brings there what other ranks hold of it. All ranks call it.
  virtual void gather_to_save() {}
  /// After it, on the first rank.
  virtual void forget_gathered() {}
};

using Models = std::vector<std::unique_ptr<Model>>;

}  // namespace barchan
