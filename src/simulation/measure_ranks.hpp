// What a run on several ranks would be, measured in one process: who would own which particles, and what would go from
// rank to rank.
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
  std::string why_start_is_whole;  // scene/shared_start.hpp
};

class RankMeasure {
 public:
  /// Divides the cells among so many ranks as a run does at its first sort: the simulation has made no step yet.
  RankMeasure(const Simulation& simulation, int ranks);

  /// Counts anew from the present step on: the first steps look for wrong particles more often than those of a run do.
  void begin();

  /// After some steps. `seconds`: of processor time of a step of one thread; 0: not known.
  RankPlan plan(double seconds, const MemoryOfOne& memory) const;

 private:
  /// Of a rank: work of its particles, its part of the arrays of all particles, bytes of its ghosts.
  struct Part {
    double work = 0, arrays = 0, ghosts = 0;
  };
  struct TimeShares {
    double whole = 0, contacts = 0;
  };
  void add_halo(RankPlan& plan, std::size_t phase, const std::vector<RankHalo>& halo, double steps) const;
  void add_displacements(RankPlan& plan, const std::vector<std::optional<CellOwners>>& owners) const;
  void add_moves(RankPlan& plan, std::size_t phase, double steps) const;
  void add_seconds(RankPlan& plan, const std::vector<Part>& parts, const TimeShares& time) const;
  void add_memory(RankPlan& plan, const std::vector<Part>& parts, const MemoryOfOne& memory) const;
  double memory_at_start(const MemoryOfOne& memory, double cells) const;
  double bytes_of_a_ghost(std::size_t phase) const;
  TimeShares shares_of_time(bool contacts_are_shared) const;
  double work_of(std::size_t phase) const;
  std::size_t number_of(std::size_t phase, std::size_t place) const;

  const Simulation& simulation_;
  std::size_t ranks_;
  std::vector<bool> whole_;                            // by phase
  std::vector<std::optional<CellOwners>> owners_;      // by phase, of the start
  std::vector<std::vector<std::int32_t>> rank_of_id_;  // by phase and number of the particle, at begin()
  // As the counters of the simulation stood at begin().
  long searches_ = 0, steps_ = 0;
  ranks::HandedOn handed_on_;
  std::vector<ImageUse> use_;        // by phase
  std::vector<double> seconds_;      // by stage
  std::vector<RankTraffic> before_;  // of the models, by rank
};

}  // namespace barchan
