// Diameters of spheres that a distribution gives.
#pragma once

#include "scene/scene.hpp"
#include "start/random.hpp"

namespace barchan {

/// d/mean of the next sphere; takes one number of the sequence.
inline double relative_diameter(const SphereSize& size, Random& random) {
  if (size.log_normal > 0.0 || !size.sieve.empty()) return size.quantile(random.uniform(0.0, 1.0));
  return random.uniform(1.0 - size.spread, 1.0 + size.spread);
}

}  // namespace barchan
