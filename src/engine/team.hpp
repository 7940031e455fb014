// The threads of a run: as many as the user said, or as many as pay at the moment.
#pragma once

#include <omp.h>

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <vector>

#include "base/thread_chooser.hpp"

namespace barchan {

class Team {
 public:
  /// `chosen`: from step to step, among 1 and `most`; else always `most`.
  Team(int most, bool chosen) : most_(most), chooser_(chosen ? most : 1), chosen_(chosen && most > 1) {}

  /// Calls `step` with the number of threads of the moment and remembers how long it took.
  template <class F>
  void step(F&& step) {
    if (chosen_) omp_set_num_threads(chooser_.threads());
    const auto begin = std::chrono::steady_clock::now();
    step();
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    if (chosen_) return chooser_.took(seconds);
    alone_.steps += 1;
    alone_.seconds += seconds;
  }

  int most() const { return most_; }
  /// What was used, by number of threads, and how often the number changed.
  std::vector<ThreadChooser::Use> uses() const {
    if (chosen_) return chooser_.uses();
    return {{most_, alone_.steps, alone_.seconds}};
  }
  long switches() const { return chosen_ ? chooser_.switches() : 0; }

 private:
  int most_;
  ThreadChooser chooser_;
  bool chosen_;
  ThreadChooser::Use alone_{};  // where nothing is chosen
};

/// A team for work before the steps of a run: as many threads as pay, of those that so many particles may be worth;
/// those from before at the end of the block.
class TeamInside {
 public:
  explicit TeamInside(std::size_t particles)
      : before_(omp_get_max_threads()),
        team_(std::min(before_, 1 + static_cast<int>(std::min<std::size_t>(particles / 2000, 4095))), true) {
    omp_set_num_threads(1);
  }
  ~TeamInside() { omp_set_num_threads(before_); }
  TeamInside(const TeamInside&) = delete;
  TeamInside& operator=(const TeamInside&) = delete;
  Team& team() { return team_; }

 private:
  int before_;
  Team team_;
};

}  // namespace barchan
