#include "app/earlier_states.hpp"

namespace barchan {

void EarlierStates::keep(Simulation& simulation, Measurements* measurements) {
  State& state = states_[states_[0].step <= states_[1].step ? 0 : 1];
  state.archive.save([&](Archive& a) {
    simulation.archive(a);
    if (measurements) measurements->archive(a);
  });
  state.step = simulation.steps();
  if (trusted_ < 0) trusted_ = state.step;
}

bool EarlierStates::go_back(Simulation& simulation, Measurements* measurements, long failed) {
  State* best = nullptr;
  for (State& state : states_)
    if (state.step >= 0 && (state.step == trusted_ || state.step <= failed - distance) &&
        (!best || state.step > best->step))
      best = &state;
  if (!best) return false;
  for (State& state : states_)
    if (state.step > best->step) state.step = -1;
  best->archive.load_again();
  simulation.archive(best->archive);
  if (measurements) measurements->archive(best->archive);
  best->archive.finish();
  trusted_ = best->step;
  return true;
}

}  // namespace barchan
