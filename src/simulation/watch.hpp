// The watch over a run: stops it within 20 steps of the first particle that is wrong.
//
// Every few steps (8 at most) one loop over positions, velocities and densities compares each particle with the bounds
// of its phase. The pair lists of grains and bodies are searched for particles in one place as soon as the fastest can
// have got there. Every second time a sample of each fluid is searched for particles in pairs. Only when a bound is
// exceeded is the particle looked for, so that all this costs less than a hundredth of a step. A state that passed
// everything is kept every 64 steps.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "base/warnings.hpp"
#include "engine/neighbours.hpp"
#include "models/workspace.hpp"
#include "plan/plan.hpp"
#include "scene/formula.hpp"
#include "simulation/kept_state.hpp"

namespace barchan {

/// Bounds of the watch that hold in all phases; each model gives its own besides (PhaseRules). docs/output.md gives
/// the reasons.
struct WatchBounds {
  static constexpr double outside = 0.5;              // spacings beyond a side of the domain
  static constexpr double coincidence = 0.2;          // spacings between two grains or two particles of bodies
  static constexpr double wall_depth = 0.6;           // spacings between a grain or a body and a particle of a wall
  static constexpr double pair_distance = 0.3;        // spacings: nearer fluid particles are a pair
  static constexpr double paired = 0.05;              // of a fluid's particles
  static constexpr double energy = 4.0;               // kinetic energy over what laws can have fed
  static constexpr double remarkable_density = 0.05;  // a density error that is worth a warning at the end
  static constexpr double remarkable_speed = 3.0;     // the same of a fluid particle, over what it can have been given
};

/// Where a run stands when the watch looks.
struct Moment {
  double time = 0.0, dt = 0.0;  // s
  long step = 0;
};

class Watch {
 public:
  /// What it looks at; all must outlive it.
  struct Sight {
    const Scene& scene;
    const Plan& plan;
    const std::vector<PhaseParticles>& particles;
    const Neighbours& neighbours;
    Workspace& work;
  };
  explicit Watch(const Sight& sight);

  /// Whether a look is due after this step.
  bool due(long step) const { return step >= next_; }
  /// The largest signal speed of all phases (m/s): what changes a speed by more in one step is not to wait for a look.
  double signal_speed() const;
  /// The look of a step: throws BreakdownError if a particle is wrong. Keeps a good state now and then. Allocates
  /// nothing.
  void look(const Moment& now);
  /// All looks, whatever is due; then keeps the state.
  void look_closely(const Moment& now);
  /// The same at a moment that a clock chose (a checkpoint, a signal, a restart): what archive() names and what later
  /// looks depend on stays as the last look left it, so that a run has the same bits without that moment.
  void look_aside(const Moment& now);
  /// For an acceleration that is not finite: throws BreakdownError with the particle of lowest id.
  void explain(const Moment& now);
  /// Throws BreakdownError with what a model found.
  [[noreturn]] void tell(const std::string& trouble, const Moment& now) const;
  /// "particle 12 of phase "air" at (...) m, t = ... s, step ...": the particle with the largest acceleration.
  std::string most_accelerated(const Moment& now) const;

  KeptState& good() { return good_; }
  const KeptState& good() const { return good_; }
  /// Adds what was remarkable in the whole run.
  void report(Warnings& warnings) const;
  std::size_t bytes() const;

  /// What it has seen so far; the good state is not among it: after a load none is kept until it has looked.
  void archive(Archive& a);

 private:
  static constexpr std::size_t block = 4096;  // particles; sums have an order that only their number decides
  static constexpr long longest_interval = 8, keep_interval = 64;  // steps

  /// The bounds of a phase that moves.
  struct Guard {
    std::size_t phase = 0;
    double signal_speed = 0.0;                   // m/s
    double way = 0.0;                            // m a step
    Vec3 low{}, high{};                          // m, where its particles may be
    std::array<std::array<int, 2>, 3> closed{};  // number of the wall behind each side, -1: none
    bool dense = false;                          // has a density
    double reference_density = 0.0, least_density = 0.0, most_density = 1e300;  // kg/m3
    int own_list = -1;  // of a fluid: direction of its entry with itself
  };
  /// Grains or bodies that may not come nearer than a distance.
  struct Apart {
    std::size_t a = 0, b = 0;
    int list = -1;
    bool stress = false;    // whose records
    double distance = 0.0;  // m
    double reach = 0.0;     // m, of the list
    double left = -1.0;     // m, what they may still approach each other before it is time to look
  };
  struct Part {
    double squares = 0.0, fastest = 0.0, lightest = 1e300, densest = -1e300, wrong = 0.0;
  };
  struct Force {
    std::size_t phase, number;  // number: of the [[forcing]]
    std::array<Formula, 3> acceleration;
  };
  /// The particle with the largest density error of the run so far, or with the largest speed.
  struct Extreme {
    double error = 0.0, value = 0.0, time = 0.0;  // error: of the density, or speed over what was given
    std::size_t phase = 0;
    std::int64_t id = 0;
    Vec3 place{};
    long step = 0;
  };

  /// What it knows of steps that the run has gone back from.
  void forget() {
    good_.forget();
    given_ = 0.0;
    for (Apart& pair : pairs_) pair.left = -1.0;
  }
  void make_guards();
  void make_pairs();
  double speed_bound(const Guard& g, double dt) const;
  static Part of_all_ranks(Part part);
  void take_places_of_ghosts(std::size_t phase) const;
  double look_at_phases(const Moment& now);  // returns the fastest grain or body, m/s
  void look_at_pairs(const Moment& now, double way);
  void look_at_pairing(const Moment& now, bool all) const;
  void look_at_energy(const Moment& now);
  double strongest_force(const Moment& now) const;
  bool too_near(Apart& pair) const;
  void look_for_pairing(const Guard& g, const Moment& now, bool all) const;
  double nearest(const Guard& g, std::size_t k) const;
  template <std::size_t Dim>
  double nearest_in(const Guard& g, std::size_t k) const;
  void note_density(const Guard& g, double error, const Moment& now);
  void note_speed(double given, const Moment& now);

  // the slow part: finds the particle and makes the message
  std::optional<std::string> wrong_with(const Guard& g, std::size_t k, double dt) const;
  std::optional<std::string> wrong_place(const Guard& g, std::size_t k) const;
  std::string who(std::size_t phase, std::size_t k, const Moment& now) const;
  std::optional<std::string> formula_to_blame(const Moment& now) const;
  std::string unpairing(const Guard& g) const;
  std::string step_key() const;
  [[noreturn]] void tell_worst(const Moment& now) const;
  [[noreturn]] void tell_pair(const Apart& pair, const Moment& now) const;

  Sight see_;
  std::vector<Guard> guards_;
  std::vector<Apart> pairs_;
  std::vector<Part> parts_;
  mutable std::array<std::vector<double>, 3> ghosts_;  // m, on several ranks: places of the ghosts of a phase
  std::vector<Force> forces_;
  KeptState good_;
  long next_ = 1, looks_ = 0;
  double mass_ = 0.0;               // kg of what moves, at the start
  double start_energy_ = 0.0;       // J: kinetic and elastic at the beginning, and what disorder may free
  double start_speed_ = 0.0;        // m/s, from it
  double start_fastest_ = 0.0;      // m/s
  std::vector<double> fastest_of_;  // m/s, by phase, at the last look
  double drag_ = 0.0;               // m/s2, of walls that pull with a given stress
  double forced_ = 0.0;             // m/s that forces can have given so far
  double given_ = 0.0;              // m/s that all together can have given; 0: not known
  double last_time_ = 0.0, last_fastest_ = 0.0, wall_speed_ = 0.0;  // s, m/s
  bool torques_ = false;  // what turns on an axle may get energy without bound
  double energy_ = 0.0;   // J, kinetic, at the last look
  Extreme extreme_, fastest_;
};

/// The fields that frames hold beside the position.
std::vector<Field> frame_fields(const Scene& scene);

}  // namespace barchan
