// What a run should have kept: momentum and energy, where the physics of its scene promises that.
//
// Momentum along an axis is kept when no wall stands in the scene, no force acts on a phase, and nothing weighs along
// that axis. Energy may only fall (into heat) when no force acts and no wall moves: kinetic energy and that of the
// weight together. Mass has no budget: a particle carries its own, and none is made or taken away.
#pragma once

#include <array>
#include <optional>

#include "base/warnings.hpp"
#include "plan/plan.hpp"
#include "state/state.hpp"

namespace barchan {

class Budget {
 public:
  /// What may be lost or gained before a run says so.
  static constexpr double momentum_bound = 0.01;  // of mass times speed
  static constexpr double energy_bound = 0.05;    // of the energy of the motion
  /// Slower motion than this part of the sound speed is not told from the energy that compression stores.
  static constexpr double idle = 0.02;

  /// Of the state at the beginning.
  Budget(const Scene& scene, const Plan& plan, const State& state);

  /// The largest drift of a component that is promised to be kept, in mass times the speed (root of the mean square,
  /// of the beginning or now, the larger). Nothing: none is promised, or nothing moves.
  std::optional<double> momentum_drift(const State& state) const;
  /// Energy that was gained, in the larger of the kinetic energies. Nothing: as above, or the motion is idle.
  std::optional<double> energy_growth(const State& state) const;

  void report(const State& state, Warnings& warnings) const;
  void archive(Archive& a);

 private:
  struct Sums {
    std::array<double, 3> momentum{};                   // kg m/s
    double mass = 0.0, kinetic = 0.0, potential = 0.0;  // kg, J, J
  };
  Sums sums(const State& state) const;

  std::vector<std::size_t> moving_;  // phases
  Vec3 gravity_{};                   // m/s2
  std::array<bool, 3> keeps_momentum_{};
  bool keeps_energy_ = false;
  double sound_speed_ = 0.0;  // m/s, the largest
  Sums start_;
};

}  // namespace barchan
