// Where the surface of a bed of grains is, as a mean along the ground.
#pragma once

#include <vector>

#include "state/particles.hpp"

namespace barchan {

/// Finds the height at which the mass of grains by height falls through half of its largest value, going down from
/// above: slices one diameter high, linear between their centres.
class BedHeight {
 public:
  /// bottom and top of the domain, mean diameter (m).
  BedHeight(double bottom, double top, double diameter);

  /// m; the bottom without grains. Allocates nothing.
  double operator()(const PhaseParticles& grains);

 private:
  double bottom_, slice_;
  std::vector<double> mass_;
};

}  // namespace barchan
