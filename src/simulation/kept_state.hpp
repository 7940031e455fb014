// A copy of the state that frames are made of, for the time when the present state is no longer good.
#pragma once

#include <vector>

#include "state/particles.hpp"

namespace barchan {

class KeptState {
 public:
  /// Room for `fields` of all phases but walls, which do not move. Nothing is kept yet.
  KeptState(const std::vector<PhaseParticles>& particles, std::vector<Field> fields);

  /// Copies the state of this time. Allocates nothing.
  void keep(const std::vector<PhaseParticles>& particles, double time, long step);
  /// Nothing is kept any more.
  void forget() { step_ = -1; }
  /// Swaps what is kept with the state of the particles. A second call restores both.
  void exchange(std::vector<PhaseParticles>& particles);

  double time() const { return time_; }
  long step() const { return step_; }  ///< -1: nothing kept
  std::size_t bytes() const;

 private:
  struct Column {
    std::size_t phase;
    Field field;
    int component;
    AlignedVector<double> values;
  };
  std::vector<Field> fields_;
  std::vector<Column> columns_;
  std::vector<std::vector<std::int64_t>> ids_;  // by phase
  std::vector<bool> kept_;                      // whether the phase is one that moves
  double time_ = 0.0;
  long step_ = -1;
};

}  // namespace barchan
