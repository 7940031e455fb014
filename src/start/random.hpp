// Random numbers that are the same with every compiler and standard library.
#pragma once

#include <cstdint>

namespace barchan {

/// splitmix64 (Steele, Lea and Flood 2014, figure 17): one 64-bit state, passes BigCrush.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}

  std::uint64_t next() {
    std::uint64_t z = (state_ += 0x9e3779b97f4a7c15ull);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
    return z ^ (z >> 31);
  }

  /// As if next() had been called so many times.
  void skip(std::uint64_t numbers) { state_ += numbers * 0x9e3779b97f4a7c15ull; }

  /// Uniform in [low, high), from the upper 53 bits.
  double uniform(double low, double high) { return low + (high - low) * (static_cast<double>(next() >> 11) * 0x1p-53); }

 private:
  std::uint64_t state_;
};

}  // namespace barchan
