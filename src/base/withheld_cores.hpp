// Whether the system gives a team of threads the cores that it wants, or gives them to other programs.
#pragma once

#include <sys/resource.h>

namespace barchan {

/// Is told after every step how long it took, and asks the system for the processor time (0.5e-6 s) once in steps of
/// 2 ms together: a system gives a core away for some milliseconds at a time.
class WithheldCores {
 public:
  /// The mean of the steps (s) over the last three spans or more, where the team had too little processor time in each
  /// of them and lost cores that it was using; 0: it had enough. A thread that waits for long sleeps and takes no time
  /// either, but loses no core.
  double after_step(int threads, double seconds) {
    if (threads != threads_) {
      threads_ = threads;
      before_ = now();
      span_ = Steps{};
      withheld_ = Steps{};
      spans_ = 0;
      return 0.0;
    }
    span_.add(seconds, 1);
    if (span_.seconds < span) return 0.0;
    const Times times = now();
    const bool enough = times.lost == before_.lost ||
                        times.processor - before_.processor >= least * static_cast<double>(threads) * span_.seconds;
    before_ = times;
    spans_ = enough ? 0 : spans_ + 1;
    if (enough) withheld_ = Steps{};
    else withheld_.add(span_.seconds, span_.number);
    span_ = Steps{};
    return spans_ < several ? 0.0 : withheld_.seconds / static_cast<double>(withheld_.number);
  }

 private:
  static constexpr double span = 2e-3;   // s
  static constexpr double least = 0.75;  // of the wall time of all threads
  static constexpr int several = 3;      // spans
  struct Steps {
    double seconds = 0.0;
    long number = 0;
    void add(double more_seconds, long more) {
      seconds += more_seconds;
      number += more;
    }
  };
  struct Times {
    double processor = 0.0;  // s, of all threads of this process
    long lost = 0;           // how often the system took a core from one of them
  };
  static Times now() {
    rusage use{};
    getrusage(RUSAGE_SELF, &use);
    const auto seconds = [](const timeval& t) {
      return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
    };
    return {seconds(use.ru_utime) + seconds(use.ru_stime), use.ru_nivcsw};
  }

  int threads_ = 0;
  Times before_;
  Steps span_, withheld_;  // since the last question; of the spans in a row without enough
  int spans_ = 0;
};

}  // namespace barchan
