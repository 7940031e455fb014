// A run in progress: the state, the models that act on it, and the schedule of a step.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/warnings.hpp"
#include "models/workspace.hpp"
#include "output/frame.hpp"
#include "plan/plan.hpp"
#include "simulation/budget.hpp"
#include "simulation/watch.hpp"

namespace barchan {

class Simulation {
 public:
  /// Makes the planned fields and carries the initial state over; evaluates the first rates. `storage`: how the
  /// particles stand in memory at the start; results must not depend on it, and a test compares.
  enum class Storage { as_filled, shuffled };
  /// `more`: models beside those of the scene, for programs that use the library; their tasks come behind the others of
  /// a stage.
  /// `blocks`: their memory goes back before lists are made.
  Simulation(const Scene& scene, const Plan& plan, std::vector<ParticleBlock> blocks,
             Storage storage = Storage::as_filled, Models more = {});
  ~Simulation();
  Simulation(const Simulation&) = delete;
  Simulation& operator=(const Simulation&) = delete;

  /// Advances by one step of at most `largest` seconds. Throws BreakdownError when the state is no longer usable: the
  /// message names particle, phase, time, likely cause and remedy.
  void step(double largest);

  /// On several ranks: how cells are divided among them from now on. The bits do not depend on it.
  void divide_by(Division division) { work_->neighbours.divide_by(division); }

  double time() const { return state_.time; }
  long steps() const { return state_.steps; }
  double last_step() const { return state_.dt; }
  const std::string& ruling_limit() const { return state_.ruling_limit; }
  const std::map<std::string, long>& limit_counts() const { return state_.limit_counts; }

  const std::vector<PhaseParticles>& phases() const { return state_.phases; }
  std::vector<PhaseParticles>& phases() { return state_.phases; }
  const State& state() const { return state_; }
  OutputClock& outputs() { return state_.outputs; }
  Retreat& retreat() { return state_.retreat; }
  const Plan& plan() const { return plan_; }
  const Scene& scene() const { return scene_; }
  const Neighbours& neighbours() const { return work_->neighbours; }
  const Schedule& schedule() const { return schedule_; }

  /// Directed pairs of an entry in its current lists (those in the skin too).
  std::uint64_t pairs(const PlanEntry& entry) const;
  /// How often lists were made anew, of all entries.
  long searches() const;
  /// How often each stage of the schedule was executed, in the order of the step; wall time of each (s).
  const std::vector<long>& executed() const { return schedule_.executed(); }
  const std::vector<std::pair<std::string, double>>& seconds() const { return schedule_.seconds(); }
  std::size_t bytes() const;
  /// Of the records of a phase.
  std::size_t bytes_of_an_image(std::size_t phase) const { return work_->bytes_of_an_image(phase); }

  /// A copy of the state for the writer.
  Frame frame(int index) const;
  /// Whether it is written in pieces, as the state is now.
  bool frames_are_in_pieces() const { return is_in_pieces(written_phases()); }
  /// The present contacts of the spheres of a phase; numbers count its particles by their ids.
  std::vector<RestingContact> resting_contacts(std::size_t phase) const;
  /// One row of history.csv: names and values.
  HistoryRow history() const;
  std::vector<std::string> history_columns() const { return history().names; }
  std::vector<double> history_row() const { return history().values; }
  /// Forces and torques of later rows are means from now on; before the first call, from the start on.
  void begin_row();
  /// Throws BreakdownError if the present state is wrong (simulation/watch.hpp); the watch of step() looks now and then
  /// only.
  void check() { watch_->look_closely(moment()); }
  /// The same at a moment that a clock chose: leaves no trace in the state.
  void check_aside() { watch_->look_aside(moment()); }
  /// The same before the first step, when the scene is to blame: throws SceneError.
  void check_start();
  /// The last state that passed all checks: its step and time, and its frame. Needs a check() or check_start() before.
  long good_step() const { return watch_->good().step(); }
  double good_time() const { return watch_->good().time(); }
  Frame good_frame(int index);
  /// Momentum and energy, which the run should conserve, against the beginning.
  const Budget& budget() const { return *budget_; }
  /// Replaces the files of results that models write beside frames and history (Model::write). Throws OutputError.
  void write_results(const std::string& folder, double time) const;
  /// The models' terms of the budget of energy, J.
  double held_energy() const;
  /// The warnings of the run so far.
  Warnings warnings() const;

  /// Saves everything that the next step starts from, or loads it into a simulation of the same scene: the run then
  /// goes on with the same bits. Throws SceneError when what is loaded does not fit.
  void archive(Archive& a);
  /// The same of all particles, as one process has it: on several ranks each saves its own as rows (Archive), and loads
  /// those of its cells. All ranks call it. `save` and `load` may name more items, and call `archive(a)`.
  void save_whole(const std::function<void()>& save);
  void load_whole(const std::function<void()>& load);

 private:
  double stable_step();
  void choose_step(double largest);
  Moment moment() const { return {state_.time, state_.dt, state_.steps}; }
  void make_state(const std::vector<ParticleBlock>& blocks);
  void shuffle();
  void check_columns() const;
  FrameField values_of(Field field, const std::vector<std::size_t>& written, std::size_t n) const;
  void gather_frame(Frame& f, const std::vector<std::size_t>& written) const;
  std::vector<std::size_t> written_phases() const;
  bool is_in_pieces(const std::vector<std::size_t>& written) const;
  bool is_shown(const PhaseParticles& p, std::size_t k) const;
  std::size_t shown_of(std::size_t phase) const;
  /// What all phases that move have in a row of history.csv.
  void add_phase(std::size_t number, HistoryRow& row) const;
  void rule(const std::string& name, double value, double& dt);

  Scene scene_;
  Plan plan_;
  bool flows_through_;  // particles stand beyond the domain (Layout::flows_through)
  State state_;
  Models models_;
  Schedule schedule_;
  std::unique_ptr<Workspace> work_;
  bool loads_whole_ = false;
  std::unique_ptr<Watch> watch_;
  std::optional<Budget> budget_;
};

}  // namespace barchan
