#include "base/thread_chooser.hpp"

#include <algorithm>
#include <numeric>

namespace barchan {

ThreadChooser::ThreadChooser(int most, Begin begin) : asked_(begin == Begin::all) {
  for (int count = 1; count < most; count = asked_ ? most : 2 * count) counts_.push_back(count);
  counts_.push_back(std::max(most, 1));
  seconds_.assign(counts_.size(), 0.0);
  for (const int count : counts_) uses_.push_back({count, 0, 0.0});
  trying_ = counts_.size() > 1 && !asked_;
  if (!asked_) return;
  present_ = best_ = counts_.size() - 1;
  wait_ = 0.0;  // the first doubt is followed at once
}

void ThreadChooser::go_to(std::size_t choice) {
  if (choice != present_) ++switches_;
  present_ = choice;
  in_window_ = 0;
  long_ = 0;
}

/// The first step of a block wakes threads and fills caches, and a search may fall into it: the mean without the first
/// and the two longest of the others. Steps differ, so that a median of few would be that of one kind or another.
double ThreadChooser::usual() const {
  std::array<double, block> sorted = window_;
  std::sort(sorted.begin() + 1, sorted.end());
  return std::accumulate(sorted.begin() + 1, sorted.end() - 2, 0.0) / static_cast<double>(block - 3);
}

void ThreadChooser::give_up(bool at_once) {
  trying_ = true;
  best_ = 0;
  seconds_[0] = 0.0;
  if (!at_once) wait_ = std::min(2.0 * wait_, longest_wait);
  since_ = at_once ? wait_ : 0.0;
  go_to(0);
}

/// A block of the present number is complete: on to the next number, or to the best.
void ThreadChooser::measured(double seconds) {
  const bool gains = present_ == 0 || seconds < better * seconds_[best_];
  seconds_[present_] = seconds;
  if (gains) best_ = present_;
  const bool go_on =
      gains && present_ + 1 < counts_.size() && (present_ > 0 || since_ >= wait_ || total_ == since_) && may_lose();
  if (go_on) return go_to(present_ + 1);
  trying_ = false;
  if (present_ > 0) {
    wait_ = gains ? first_wait : std::min(2.0 * wait_, longest_wait);
    since_ = 0.0;
  }
  go_to(best_);
}

/// A trial of one thread may lose as much as one of a team may.
void ThreadChooser::doubt(double team) {
  seconds_.back() = team;
  trying_ = comparing_ = true;
  go_to(0);
}

/// The team comes back unless one thread is faster.
void ThreadChooser::compared(double one) {
  trying_ = comparing_ = false;
  seconds_[0] = one;
  best_ = one < better * seconds_.back() ? 0 : counts_.size() - 1;
  wait_ = best_ == 0 ? first_wait : std::clamp(2.0 * wait_, first_wait, longest_wait);
  since_ = 0.0;
  go_to(best_);
}

void ThreadChooser::took(double seconds, double withheld) {
  uses_[present_].steps += 1;
  uses_[present_].seconds += seconds;
  total_ += seconds;
  since_ += seconds;
  if (counts_.size() == 1) return;
  if (present_ > 0 && seconds_[0] > 0.0) {
    lost_ = std::max(lost_ + seconds - seconds_[0], 0.0);
    if (seconds > hopeless * seconds_[0] && (trying_ || ++long_ == 2)) return give_up(false);
  }
  if (comparing_) lost_ = std::max(lost_ + seconds - seconds_.back(), 0.0);
  window_[in_window_++] = seconds;
  const bool as_asked = asked_ && present_ > 0 && !trying_;
  if (as_asked && withheld > 0.0 && since_ >= wait_ && may_lose()) return doubt(withheld);
  if (in_window_ < block) return;
  const double now = usual();
  in_window_ = 0;
  long_ = 0;
  if (comparing_) return compared(now);
  if (trying_) return measured(now);
  if (as_asked) return;
  if (present_ > 0 && (now > slower * seconds_[present_] || since_ >= longest_wait)) return give_up(true);
  seconds_[present_] += follow * (now - seconds_[present_]);
  // With fewer threads than there could be: a trial of more.
  if (present_ + 1 < counts_.size() && since_ >= wait_ && may_lose()) {
    trying_ = true;
    go_to(present_ + 1);
  }
}

}  // namespace barchan
