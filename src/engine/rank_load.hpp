// What steps cost each rank of a run, and when its cells must be divided anew. The cost of a rank is the processor time
// of the thread that calls the steps, without what it spends in calls of its communicator: so it means the same where
// ranks share cores, and where one writes files beside its steps. Clocks decide who owns what, and the bits of results
// do not depend on that.
#pragma once

#include <chrono>
#include <cstddef>
#include <optional>
#include <vector>

namespace barchan {

/// The cost of a unit of work on each rank, as measured lately. Work is a count (RankLoad): what a rank has of it is
/// known at once when its particles change, what it costs only after some steps.
class RankCosts {
 public:
  /// After so many steps a measurement counts half.
  static constexpr double half_life = 32.0;

  struct Measured {
    double busy = 0;  // s, in the steps since the last measurement
    double work = 0;  // of a step, now
  };
  /// `ranks`: what each measured in the same `steps`.
  void add(const std::vector<Measured>& ranks, long steps);
  /// The time that a step takes the slowest rank over the mean of all, for the work that they have now.
  double imbalance() const;
  /// Cost of a unit of work on a rank over the mean cost of all work; 1 where a rank has measured nothing. Held between
  /// 1/4 and 4, so that a wrong measurement leaves no rank without particles.
  double of(std::size_t rank) const;

 private:
  double mean_cost() const;
  std::vector<double> busy_, work_;  // by rank, s and work of the steps lately
  std::vector<double> now_;          // by rank, work of a step
};

/// The measurements of this rank; all ranks call these together.
class RankLoad {
 public:
  /// A rank that takes so many times the mean has cells to give away.
  static constexpr double most = 1.03;
  /// Steps between two looks, and at most so much of the run is spent in dividing.
  static constexpr long steps_a_look = 8;
  static constexpr double most_dividing = 0.01;

  struct Seconds {
    double busy = 0, waiting = 0;  // s
  };

  void begin_step();
  void end_step();
  /// Of this rank in all steps so far.
  Seconds seconds() const;

  /// Before a sort. `work`: of this rank in a step, as its lists are. Returns, if the cells must be divided anew, the
  /// cost of a unit of work on this rank over the mean.
  std::optional<double> look(double work);
  /// After that, when all particles are where they belong.
  void divided();
  long divisions() const { return divisions_; }
  /// Wall time of all divisions, s.
  double seconds_dividing() const { return dividing_; }

 private:
  using Clock = std::chrono::steady_clock;
  Seconds now() const;

  Seconds begun_, total_;
  bool in_step_ = false;
  long steps_ = 0, looked_at_step_ = 0, divisions_ = 0;
  double busy_before_ = 0.0;  // s, at the last look
  double dividing_ = 0.0;     // s
  Clock::time_point first_step_, look_;
  RankCosts costs_;
};

}  // namespace barchan
