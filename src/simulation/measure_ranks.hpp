// What a run on several ranks would be, by the particles of one process: who would own which, with whose ghosts, and
// the memory that takes.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "plan/rank_plan.hpp"
#include "simulation/simulation.hpp"

namespace barchan {

/// Memory of the run of one process, bytes.
struct MemoryOfOne {
  double program = 0;  // without arrays
  double arrays = 0;   // of the simulation
  double blocks = 0;   // of the particles as they were made
  double frame = 0;
  double states = 0;               // to go back to
  std::string why_start_is_whole;  // start/shared_start.hpp
};

class RankMeasure {
 public:
  /// Divides the cells among so many ranks as a run does at its first sort: the simulation has made no step yet.
  RankMeasure(const Simulation& simulation, int ranks);

  /// After some steps.
  RankPlan plan(const MemoryOfOne& memory) const;

 private:
  /// Of a rank: its part of the arrays of all particles, bytes of its ghosts.
  struct Part {
    double arrays = 0, ghosts = 0;
  };
  void add_memory(RankPlan& plan, const std::vector<Part>& parts, const MemoryOfOne& memory) const;
  double memory_at_start(const MemoryOfOne& memory, double cells) const;
  double bytes_of_a_ghost(std::size_t phase) const;

  const Simulation& simulation_;
  std::size_t ranks_;
  std::vector<bool> whole_;                        // by phase
  std::vector<std::optional<CellOwners>> owners_;  // by phase, of the start
};

}  // namespace barchan
