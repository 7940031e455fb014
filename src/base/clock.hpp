// Processor time, which a busy machine does not lengthen.
#pragma once

#include <ctime>

namespace barchan {

/// Of the calling thread so far, s.
inline double thread_seconds() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

}  // namespace barchan
