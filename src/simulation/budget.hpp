// What a run should have kept: momentum and energy, where the physics of its scene promises that.
//
// Momentum along an axis is kept when no wall stands in the scene, no force acts on a phase, and nothing weighs along
// that axis; the angular momentum of bodies about their common centre, when nothing else is in the scene. Energy may
// only fall (into heat) when no force acts and no wall moves: the sum of the kinetic energy, that of the weight, that
// which the compression of the fluids stores, and the strain of bodies less the work of what drives them. Mass has no
// budget: a particle carries its own. What is made or taken away is booked by who does it (State::departed).
#pragma once

#include <array>
#include <optional>

#include "base/warnings.hpp"
#include "models/bodies/angular_momentum.hpp"
#include "plan/plan.hpp"
#include "state/state.hpp"

namespace barchan {

class Budget {
 public:
  /// What may be lost or gained before a run says so.
  static constexpr double momentum_bound = 0.01;  // of mass times speed
  static constexpr double energy_bound = 0.05;    // of the energy of the motion
  /// Slower motion than this part of the sound speed is idle: its energy is not looked at.
  static constexpr double idle = 1e-5;
  /// The same where only bodies move, whose pairs have no noise.
  static constexpr double idle_bodies = 1e-9;
  /// Of the angular momentum of bodies, in the largest that their motion about the centre can have.
  static constexpr double turning_bound = 0.01;

  /// Of the state at the beginning.
  Budget(const Scene& scene, const Plan& plan, const State& state);

  /// The largest drift of a component that is promised to be kept, in mass times the speed (root of the mean square,
  /// of the beginning or now, the larger). Nothing: none is promised, or nothing moves.
  std::optional<double> momentum_drift(const State& state) const;
  /// Energy that was gained, in the largest of the kinetic energies and that held. `held`: J, the terms of the models
  /// (Model::budget_energy), 0 at the beginning. Nothing: as above, or the motion is idle.
  std::optional<double> energy_growth(const State& state, double held = 0.0) const;
  /// The drift of the angular momentum of all bodies, in sqrt(sum m r^2 sum m v^2) about their centre, of the beginning
  /// or now, the larger. Nothing: none is promised, or nothing moves about the centre.
  std::optional<double> turning_drift(const State& state) const;

  void report(const State& state, Warnings& warnings, double held = 0.0) const;
  void archive(Archive& a);

 private:
  struct Sums {
    std::array<double, 3> momentum{};                                 // kg m/s
    double mass = 0.0, kinetic = 0.0, potential = 0.0, stored = 0.0;  // kg, J, J, J
    Turning turning;                                                  // of bodies alone
    double mechanical() const { return kinetic + potential + stored; }
  };
  Sums sums(const State& state) const;

  /// Of a phase that moves. Compression stores m c^2 (rho/rho0 - 1)^2/2, exactly so in a fluid with the linear equation
  /// of state and to the second order with Tait's.
  struct Moving {
    std::size_t phase = 0;
    double sound_speed = 0.0, density = 0.0;  // m/s and kg/m3 of a fluid; 0: nothing is stored
    double weight_share = 1.0;                // of gravity
  };
  std::vector<Moving> moving_;
  Vec3 gravity_{};  // m/s2
  std::array<bool, 3> keeps_momentum_{};
  bool keeps_energy_ = false, keeps_turning_ = false;
  bool noiseless_ = false;    // nothing moves but phases whose pairs have no noise (PlanPhase::noiseless)
  double sound_speed_ = 0.0;  // m/s, the largest
  Sums start_;
};

}  // namespace barchan
