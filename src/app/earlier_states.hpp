// States that a run goes back to after a step that failed.
#pragma once

#include <array>

#include "measure/measurements.hpp"
#include "plan/memory_need.hpp"
#include "simulation/simulation.hpp"
#include "state/archive.hpp"

namespace barchan {

/// States of the past that a run can go back to, in memory: two, so that one is old enough.
class EarlierStates {
 public:
  static constexpr long every = steps_between_states;
  /// A particle that is wrong is found within 20 steps of it; states that are not this much older are not trusted.
  static constexpr long distance = 64;  // steps

  bool due(long step) const { return newest().step < 0 || step >= newest().step + every; }
  void keep(Simulation& simulation, Measurements* measurements);
  /// Loads the newest state that is old enough; false when there is none.
  bool go_back(Simulation& simulation, Measurements* measurements, long failed);

 private:
  struct State {
    long step = -1;
    Archive archive;
  };
  const State& newest() const { return states_[0].step >= states_[1].step ? states_[0] : states_[1]; }
  std::array<State, most_states> states_;
  long trusted_ = -1;  // step of the first that was kept, or that the run went back to: it was looked at closely
};

}  // namespace barchan
