// The ground that fitted rows follow, as heights on a fine grid: what holds a fluid above it.
#pragma once

#include <vector>

#include "engine/cell_grid.hpp"
#include "engine/hold_inside.hpp"

namespace barchan {

class Relief {
 public:
  Relief() = default;
  /// `heights` (m, as coordinates): at the nodes of counts[0] x counts[1] equal cells over the bounds along x and z, x
  /// fastest, both ends; counts[1] = 0 in two dimensions.
  Relief(const Bounds& bounds, const std::array<int, 2>& counts, std::vector<double> heights);

  bool exists() const { return !heights_.empty(); }
  double highest() const { return highest_; }
  /// Height and the slopes dh/dx, dh/dz under a place, linear between the nodes.
  std::array<double, 3> at(double x, double z) const;

 private:
  Bounds bounds_;
  std::array<int, 2> counts_{};
  std::array<double, 2> side_{1.0, 1.0};
  std::vector<double> heights_;
  double highest_ = 0.0;
};

/// hold_inside for curved ground: puts particles that came nearer to it than the margin (m) back to the margin, along
/// the normal, and stops their motion into it.
void hold_above(PhaseParticles& phase, const Relief& ground, double margin);

}  // namespace barchan
