// How many threads the next step takes, chosen by measuring steps now and then: on a machine that others use, a team
// that waits for a thread without a core can be a hundred times slower than one thread.
#pragma once

#include <array>
#include <vector>

namespace barchan {

/// Chooses among 1, 2, 4, ... `most` threads. Knows no clock: it is told how long each step took. The results of a step
/// do not depend on its choice.
///
/// It begins with one thread and tries more, doubling, as long as a step becomes shorter by a tenth. Then it stays with
/// the best and looks at every step: where a team becomes slower than it was measured, and every twenty seconds, one
/// thread is measured again.
/// With fewer threads than there could be it tries more now and then, after half a second, and after twice that when
/// the trial failed, to twenty seconds. What teams have lost against one thread, less what they gained since, may be a
/// twentieth of the run and 30 ms at most: while it is more, no team is tried, and a step of a team that takes five
/// times as long as with one thread ends its trial at once, or a second one among nine: one alone may be a search.
/// Gains count because steps differ: one in six that takes longer, as those with an exchange of wind and grains do, is
/// no loss of the team.
///
/// A number that the user asked for (`Begin::all`) is used from the first step on, and on a machine that gives the team
/// its cores no step has another one. Where the machine withholds them, one thread is measured. The run goes on with
/// one thread where that is faster by a tenth, and tries the team again after half a second, and after twice that when
/// the trial failed, to twenty seconds.
class ThreadChooser {
 public:
  enum class Begin { one, all };
  /// `most` < 1 counts as 1.
  explicit ThreadChooser(int most, Begin begin = Begin::one);

  /// For the next step.
  int threads() const { return counts_[present_]; }
  int most() const { return counts_.back(); }
  /// The step took so long (s, wall time). `withheld`: where the machine gives cores that the team wants to others, the
  /// mean of its steps lately (s); else 0.
  void took(double seconds, double withheld = 0.0);

  /// What was used: steps and wall time by number of threads; how often the number changed.
  struct Use {
    int threads;
    long steps;
    double seconds;
  };
  const std::vector<Use>& uses() const { return uses_; }
  long switches() const { return switches_; }

 private:
  static constexpr std::size_t block = 9;                         // steps of a measurement
  static constexpr double better = 0.9;                           // of the time with fewer threads, to be worth more
  static constexpr double slower = 1.3;                           // of the measured time: something has changed
  static constexpr double follow = 0.2;                           // of the difference to the next block
  static constexpr double hopeless = 5.0;                         // of the time with one thread
  static constexpr double first_wait = 0.5, longest_wait = 20.0;  // s
  static constexpr double share = 0.05, allowance = 0.03;         // of the run, s: what teams may lose

  void go_to(std::size_t choice);
  void measured(double seconds);
  /// Back to one thread, whose steps are measured anew; `at_once`: then more are tried without a wait.
  void give_up(bool at_once);
  bool may_lose() const { return lost_ < share * total_ + allowance; }
  double usual() const;
  /// Compares one thread with the team that the user asked for; the length of a step of the team (s).
  void doubt(double team);
  void compared(double one);

  std::vector<int> counts_;      // 1, 2, 4, ..., most
  std::vector<double> seconds_;  // a step, as measured last, by choice; 0: not yet
  std::vector<Use> uses_;
  std::size_t present_ = 0, best_ = 0;
  bool asked_;              // for all of them
  bool trying_ = true;      // a measurement is going on
  bool comparing_ = false;  // it is of one thread, because a team that was asked for is in doubt
  std::array<double, block> window_{};
  std::size_t in_window_ = 0;
  int long_ = 0;  // steps of the block that took `hopeless` times as long as with one thread
  double total_ = 0.0, lost_ = 0.0, since_ = 0.0, wait_ = first_wait;  // s; since: the last trial
  long switches_ = 0;
};

}  // namespace barchan
