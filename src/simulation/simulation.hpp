// A run in progress: particles, neighbours and the step.
#pragma once

#include <array>
#include <chrono>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "base/warnings.hpp"
#include "engine/integrate.hpp"
#include "engine/neighbours.hpp"
#include "models/air/eddies.hpp"
#include "models/air/fluid.hpp"
#include "models/air/relief.hpp"
#include "models/bodies/elastic.hpp"
#include "models/coupling/drag.hpp"
#include "models/grains/grains.hpp"
#include "models/walls/walls.hpp"
#include "output/frame.hpp"
#include "plan/plan.hpp"
#include "scene/formula.hpp"
#include "simulation/watch.hpp"

namespace barchan {

class Simulation {
 public:
  /// Makes the planned fields and carries the initial state over; evaluates the first rates.
  Simulation(const Scene& scene, const Plan& plan, const std::vector<ParticleBlock>& blocks);
  ~Simulation();
  Simulation(const Simulation&) = delete;
  Simulation& operator=(const Simulation&) = delete;

  /// Advances by one step of at most `largest` seconds. Throws BreakdownError when the state is no longer usable: the
  /// message names particle, phase, time, likely cause and remedy.
  void step(double largest);

  double time() const { return time_; }
  long steps() const { return steps_; }
  double last_step() const { return dt_; }
  const std::string& ruling_limit() const { return ruling_; }
  const std::map<std::string, long>& limit_counts() const { return limit_counts_; }

  const std::vector<PhaseParticles>& phases() const { return particles_; }
  std::vector<PhaseParticles>& phases() { return particles_; }
  const Plan& plan() const { return plan_; }
  const Scene& scene() const { return scene_; }
  const Neighbours& neighbours() const { return neighbours_; }

  /// Directed pairs of an entry in its current lists (those in the skin too).
  std::uint64_t pairs(const PlanEntry& entry) const;
  /// How often each pass was executed, in the order of the step; those that the scene does not need never are.
  const std::vector<long>& executed() const { return executed_; }
  /// Seconds of wall time by pass, in the order of the step.
  const std::vector<std::pair<std::string, double>>& seconds() const { return seconds_; }
  /// Seconds of processor time of the calling thread by pass; what a benchmark on a busy machine can trust.
  const std::vector<double>& processor_seconds() const { return processor_seconds_; }
  std::size_t bytes() const;

  /// A copy of the state for the writer.
  Frame frame(int index) const;
  /// Names and values of one row of history.csv.
  static std::vector<std::string> history_columns(const Plan& plan);
  std::vector<double> history_row() const;
  /// Throws BreakdownError if the present state is wrong (simulation/watch.hpp); the watch of step() looks now and then
  /// only.
  void check() { watch_->look_closely(moment()); }
  /// The same before the first step, when the scene is to blame: throws SceneError.
  void check_start();
  /// The last state that passed all checks: its step and time, and its frame. Needs a check() or check_start() before.
  long good_step() const { return watch_->good().step(); }
  double good_time() const { return watch_->good().time(); }
  Frame good_frame(int index);
  /// What is remarkable so far.
  Warnings warnings() const;

 private:
  struct Fluid;
  struct Extension;
  struct Contact;
  struct Body;
  struct Drag;

  // the verbs of a step, in order
  double stable_step();
  void choose_step(double largest);
  void kick_and_drift();
  void strain_bodies();
  void move_walls();
  void find_neighbours(bool force);
  void pack();
  void find_eddies();
  void extend_into_walls();
  void extend_into_grains();
  void rate_fluids();
  void find_free_surfaces();
  void rate_energies();
  void repel_from_walls();
  void stress_bodies();
  void touch();
  void react();
  void drag_grains();
  void hold_bulk_speeds();
  void kick(double time);

  void rates(bool first);
  Moment moment() const { return {time_, dt_, steps_}; }
  void make_state(const std::vector<ParticleBlock>& blocks);
  void wire();
  void wire_eddies(Fluid& fluid);
  Relief relief_under(std::size_t fluid) const;
  PressureLaw pressure_law(std::size_t phase) const;

  template <class F>
  void timed(std::size_t pass, F&& verb);

  Scene scene_;
  Plan plan_;
  std::vector<PhaseParticles> particles_;
  Neighbours neighbours_;
  std::vector<RecordArray> motion_, extended_, stress_;   // by phase; extended: a solid as the fluid sees it
  std::vector<std::unique_ptr<CompactRecords>> compact_;  // by phase, mixed precision: what fluid_rates reads

  std::vector<EddyRecords> eddies_;  // by phase
  std::vector<SurfaceBend> bends_;   // by phase, of fitted walls

  std::vector<Fluid> fluids_;
  std::vector<Extension> extensions_;
  std::vector<Contact> contacts_;
  std::vector<Body> bodies_;
  std::vector<Drag> drags_;
  std::vector<std::array<Formula, 3>> wall_velocity_;  // by phase
  struct Force {
    std::size_t phase;
    std::array<Formula, 3> acceleration;
  };
  std::vector<Force> forcings_;

  double time_ = 0, dt_ = 0;
  long steps_ = 0;
  double largest_acceleration_ = 0;
  std::string ruling_;
  std::map<std::string, long> limit_counts_;
  std::unique_ptr<Watch> watch_;
  std::vector<long> executed_;
  std::vector<std::pair<std::string, double>> seconds_;
  std::vector<double> processor_seconds_;
};

}  // namespace barchan
