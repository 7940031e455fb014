// The threads of a run: as many as the user said, as long as the machine gives them cores, or as many as pay at the
// moment.
#pragma once

#include <omp.h>

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <vector>

#include "base/thread_chooser.hpp"
#include "base/withheld_cores.hpp"

namespace barchan {

class Team {
 public:
  /// `chosen`: from step to step, among 1 and `most`; else `most`, and one where the machine withholds their cores.
  Team(int most, bool chosen)
      : most_(most), asked_(!chosen), chooser_(most, chosen ? ThreadChooser::Begin::one : ThreadChooser::Begin::all) {}

  /// Calls `step` with the number of threads of the moment and remembers how long it took.
  template <class F>
  void step(F&& step) {
    const bool several = chooser_.most() > 1;
    if (several) omp_set_num_threads(chooser_.threads());
    const auto begin = std::chrono::steady_clock::now();
    step();
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    chooser_.took(seconds, several && asked_ ? withheld_.after_step(chooser_.threads(), seconds) : 0.0);
  }

  int most() const { return most_; }
  /// What was used, by number of threads, and how often the number changed.
  std::vector<ThreadChooser::Use> uses() const {
    std::vector<ThreadChooser::Use> uses = chooser_.uses();
    if (asked_) std::erase_if(uses, [&](const auto& use) { return use.threads != most_ && use.steps == 0; });
    return uses;
  }
  long switches() const { return chooser_.switches(); }

 private:
  int most_;
  bool asked_;
  ThreadChooser chooser_;
  WithheldCores withheld_;
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
