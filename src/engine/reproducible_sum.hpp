// Sums whose bits do not depend on the order of the terms: not on the storage, not on the threads, not on the ranks.
//
// Every term is cut at two places that the largest term and the number of terms decide: x = high + low + rest, with
// high and low multiples of powers of two that are so large that their sums are exact. Exact sums have one value in
// any order. What is left out of a term is below 2^-58 of the largest one for up to 4 million terms. (Demmel & Nguyen
// 2015, IEEE Trans. Computers 64, 2060, with two bins and a first pass that finds the largest term.)
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "base/ranks.hpp"

namespace barchan {

/// Where the terms of a sum are cut.
class SumCuts {
 public:
  /// `largest`: of the absolute values of the terms (above 0 and finite), `terms`: how many there are.
  SumCuts(double largest, std::size_t terms) {
    int exponent = 0;
    std::frexp(largest, &exponent);  // largest < 2^exponent
    int bits = 50;                   // of a cut term; terms * 2^bits stays below 2^53
    for (std::size_t n = terms; n > 2; n /= 2) --bits;
    high_ = std::ldexp(1.5, 52 + exponent - bits);
    low_ = std::ldexp(1.5, 52 + exponent - 2 * bits);
  }
  /// Adds the two parts of a term.
  void add(double x, double& high, double& low) const {
    const double first = (x + high_) - high_;
    high += first;
    low += ((x - first) + low_) - low_;
  }

 private:
  double high_, low_;  // 1.5 times 2^52 times the quantum of a part: adding it rounds to the quantum
};

/// The bits of |x| as a whole number. They have the order of the numbers; those of infinity and NaN are above all.
inline std::int64_t bits_of_size(double x) { return std::bit_cast<std::int64_t>(x) & 0x7fff'ffff'ffff'ffff; }

/// The largest of |values|; infinite or NaN where one of them is.
inline double largest_of(const double* values, std::size_t n) {
  std::int64_t most = 0;
#pragma omp simd reduction(max : most)
  for (std::size_t k = 0; k < n; ++k) most = std::max(most, bits_of_size(values[k]));
  const auto largest = std::bit_cast<double>(most);
  return std::isfinite(largest) ? largest : std::numeric_limits<double>::quiet_NaN();
}

/// Below this no term counts: its parts could not be told from zero.
inline constexpr double least_term = 1e-250;

/// The parts of all ranks: these sums are exact too.
inline void add_of_ranks(double& high, double& low, Communicator* all) {
  if (!all) return;
  std::array<double, 2> parts{high, low};
  all->reduce(parts.data(), parts.size(), Communicator::Take::sum);
  high = parts[0];
  low = parts[1];
}

/// Sum of f(k) over k < n, of the ranks of a communicator (null: of this process), the same for any order of the f(k).
/// f is called twice for each k and must give the same. NaN when a value is not finite. Allocates nothing.
template <class F>
double reproducible_sum(std::size_t n, F&& f, Communicator* ranks_of_it = ranks::active()) {
  constexpr std::size_t block = 256;
  std::array<double, block> values;
  const auto fill = [&](std::size_t first) {
    const std::size_t count = std::min(block, n - first);
    for (std::size_t q = 0; q < count; ++q) values[q] = f(first + q);
    return count;
  };
  double largest = 0.0;
  for (std::size_t first = 0; first < n; first += block) {
    const double most = largest_of(values.data(), fill(first));
    if (!(most <= largest)) largest = most;
    if (std::isnan(largest)) break;
  }
  largest = std::bit_cast<double>(ranks::reduced(bits_of_size(largest), Communicator::Take::largest, ranks_of_it));
  const auto all =
      static_cast<std::size_t>(ranks::reduced(static_cast<std::int64_t>(n), Communicator::Take::sum, ranks_of_it));
  if (std::isnan(largest)) return largest;
  if (largest < least_term) return 0.0;
  const SumCuts cuts(largest, all);
  double high = 0.0, low = 0.0;
  for (std::size_t first = 0; first < n; first += block) {
    const std::size_t count = fill(first);
#pragma omp simd reduction(+ : high, low)
    for (std::size_t q = 0; q < count; ++q) cuts.add(values[q], high, low);
  }
  add_of_ranks(high, low, ranks_of_it);
  return high + low;
}

/// Sum and mean of n values of each rank, by all threads; the same for any order of the values and any number of
/// threads.
double reproducible_total(const double* values, std::size_t n);
double reproducible_mean(const double* values, std::size_t n);

}  // namespace barchan
