// A model: one kind of physics of a scene. It declares what it needs and adds its tasks to the schedule of a step.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "engine/schedule.hpp"
#include "models/layout.hpp"
#include "models/step_limits.hpp"
#include "scene/generate.hpp"
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
  energy,
  repel,
  elastic,
  weight,
  contacts,
  reaction,
  drag,
  motion,
  hold,
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

  /// Gives the particles of its phase, whose position and velocity are there, the rest of their initial state.
  virtual void begin(State&, const std::vector<ParticleBlock>&) {}
  /// Binds the records and lists that its tasks work on; once, when the state is there. Throws SceneError where only
  /// the particles show a mistake.
  virtual void attach(Workspace&) {}
  /// Adds its tasks. Needs no state: the plan prints what the step will execute.
  virtual void schedule(Schedule&) = 0;
  /// What bounds the step from the beginning to the end.
  virtual void limits(std::vector<StepLimit>&) const {}
  /// A bound that follows the motion; null: none.
  virtual const StepLimit* moving_limit() { return nullptr; }
  /// Its phase; -1: it belongs to an entry.
  virtual int phase() const { return -1; }
  /// Columns of history.csv of its own, and their values: of a moving phase behind those that all have, of an entry at
  /// the end. A row may follow the loading of a checkpoint at once, before records
  /// are filled: it reads the fields and what archive() saves.
  virtual void columns(std::vector<std::string>&) const {}
  virtual void row(std::vector<double>&) const {}
  /// Brings the fields up to date that only outputs read, and what a row tells of them. Called before every frame and
  /// row.
  virtual void derive() {}
  /// What has gone wrong in what only it sees, with the remedy; empty: nothing.
  virtual std::optional<std::string> trouble() const { return std::nullopt; }
  /// Directed pairs in its own lists of an entry, and how often it has searched them: for models that have such.
  virtual std::uint64_t pairs(const PlanEntry&) const { return 0; }
  virtual long searches() const { return 0; }
  /// Its numbers that a step starts from.
  virtual void archive(Archive&) {}
};

using Models = std::vector<std::unique_ptr<Model>>;

}  // namespace barchan
