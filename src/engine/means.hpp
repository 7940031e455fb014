// Means over the particles of a phase, the same on any number of threads.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

#include "state/particles.hpp"

namespace barchan {

/// Sum of f(k) over k < n in blocks, an order that only n decides.
template <class F>
double ordered_sum(std::size_t n, F&& f) {
  constexpr std::size_t block = 1024;
  double total = 0.0;
  for (std::size_t first = 0; first < n; first += block) {
    double part = 0.0;
    for (std::size_t k = first; k < std::min(first + block, n); ++k) part += f(k);
    total += part;
  }
  return total;
}

/// Sums in blocks whose order the number of values decides. Keeps its memory from step to step.
class BlockMean {
 public:
  /// Mean of n > 0 values.
  double operator()(const double* values, std::size_t n);

 private:
  std::vector<double> parts_;
};

/// Subtracts the mean from the density rates: mass and volume of an enclosed fluid are given, and the truncation error
/// of the divergence must not change them.
void keep_mean_density(PhaseParticles& fluid, BlockMean& mean);

/// Holds the mean velocity of a fluid along some axes, as a channel flow of constant mass flux is held: adds the
/// uniform acceleration that makes the mean velocity, half a step later, the wanted one.
struct BulkHold {
  std::array<bool, 3> axes{};            // along which
  std::array<double, 3> velocity{};      // m/s, wanted mean
  std::array<double, 3> acceleration{};  // m/s2, what the last step added
  bool any() const { return axes[0] || axes[1] || axes[2]; }
};

/// Adds a uniform acceleration (m/s2) along an axis.
void accelerate(PhaseParticles& fluid, int axis, double amount);

/// All forces on the fluid must be in its acceleration; its velocities are half a step (dt/2) behind.
void hold_bulk_velocity(PhaseParticles& fluid, BulkHold& hold, double dt, BlockMean& mean);

}  // namespace barchan
