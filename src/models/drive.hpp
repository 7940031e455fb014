// All that drives a fluid along the periodic axis x, as a force on an area of ground: what history.csv tells of it, and
// what is remembered of a hold.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "base/warnings.hpp"
#include "models/forces.hpp"
#include "models/model.hpp"

namespace barchan {

/// The mean of a number over windows of time that follow each other, weighted by the steps. A plain struct: it is
/// archived as it is.
struct WindowMean {
  long window = -1;              // the present one, where windows have a length
  double sum = 0.0, time = 0.0;  // value times s, s
  double last = 0.0;             // value times s, of the window before
  double last_time = 0.0;        // s, that it had; 0: there was none

  /// Takes the value of a step of `dt` s.
  void add(double dt, double value) {
    sum += value * dt;
    time += dt;
  }
  /// Takes the value of a step that ends at `now` (s) in windows of `length` (s) from t = 0.
  void add(double length, double now, double dt, double value);
  /// Begins the next window.
  void begin();
  /// Of the present window; of the one before where the present one has no step; `otherwise` where neither has one.
  double mean(double otherwise) const {
    return time > 0.0 ? sum / time : last_time > 0.0 ? last / last_time : otherwise;
  }
  bool any() const { return time > 0.0 || last_time > 0.0; }
  /// Of the present window, or of the one before where the present one has had less than half of `length`.
  double recent(double length) const { return time < 0.5 * length && last_time > 0.0 ? last / last_time : sum / time; }
};

/// The part of a run over which warnings mean (s).
double warning_interval(const Scene& scene);

class Drive {
 public:
  /// Whether something that a scene states drives this fluid along x, and x is periodic: a [[forcing]], a wall's
  /// shear-stress, or gravity.
  static bool exists(const Scene& scene, const Phase& fluid);

  Drive(const Scene& scene, const Phase& fluid);

  /// Whether a [[forcing]] holds the force.
  bool holds_force() const { return held_.has_value(); }
  /// The acceleration (m/s2) that a fluid of this mass (kg; in 2D of a metre of depth) gets for what walls do not give
  /// of rho u*|u*|, at a time (s).
  double missing(double time, double mass) const;
  /// Remembers what the hold gave in a step (m/s2).
  void remember(const State& state, double held);
  /// A row of history.csv was written.
  void begin_row();
  /// NAME_pull [Pa] and NAME_equivalent_friction_velocity [m/s], with the mean of the hold since the row before.
  /// `given`: the sum over the particles of what [[forcing]] entries without a hold give along x (m/s2); `held`: what
  /// the hold gave in the last step (m/s2), for the row of the start.
  void history(HistoryRow& row, const PhaseParticles& p, double given, double held) const;
  /// The force on the ground (Pa).
  double pull(double mass, double given, double held) const;
  /// A hold that pulls with more than 1.5 times what the profile of the start or the walls say.
  void report(double mass, Warnings& warnings) const;
  void archive(Archive& a);

 private:
  std::string name_;
  double density_, area_, gravity_, walls_;  // kg/m3; m2 of ground (2D: of a metre of depth); m/s2 and Pa along x
  double said_ = 0.0;                        // Pa, rho u*^2 of the profile of the start, or of the walls
  bool holds_speed_ = false;
  std::optional<Formula> held_;   // m/s, u* of a force that is held
  double tenth_;                  // s, a window
  WindowMean in_row_, in_tenth_;  // m/s2, of the hold
};

/// What wind a scene states over grains, m/s at a time (s): the friction velocity of a held force, of the profile of
/// the start, of that of an inflow or of the walls' stress, the first that is there. 0: none.
std::function<double(double time)> stated_friction_velocity(const Scene& scene, const Phase& fluid);

/// The largest |u*| (m/s) of a force that is held, at 65 times of the run.
double largest_friction_velocity(const Scene& scene, const Expression& friction_velocity);

/// Columns NAME_pull [Pa] and NAME_equivalent_friction_velocity [m/s].
void add_pull(HistoryRow& row, const std::string& name, double pull, double density);

}  // namespace barchan
