// Numbers below 2.2e-308 are flushed to zero: ahead of a wave front they fill whole arrays, and each costs a hundred
// times an ordinary one.
#pragma once

#if defined(__SSE2__)
#include <immintrin.h>
#endif

namespace barchan {

/// For the calling thread and those it creates from now on.
inline void flush_denormals() {
#if defined(__SSE2__)
  constexpr unsigned flush_to_zero = 0x8000, denormals_are_zero = 0x0040;
  _mm_setcsr(_mm_getcsr() | flush_to_zero | denormals_are_zero);
#endif
}

/// For comparisons bit for bit: the smallest numbers count.
inline void keep_denormals() {
#if defined(__SSE2__)
  constexpr unsigned flush_to_zero = 0x8000, denormals_are_zero = 0x0040;
  _mm_setcsr(_mm_getcsr() & ~(flush_to_zero | denormals_are_zero));
#endif
}

}  // namespace barchan
