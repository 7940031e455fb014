// The logarithmic wind, the one place that has its formula.
#pragma once

#include <cmath>

#include "scene/scene.hpp"

namespace barchan {

/// eq. (18) of Halik et al. 2015 in SI units: u = (u*/kappa) ln(y/y0) at a height over the ground (m); 0 below y0.
inline double log_wind(const LogProfile& log, double height) {
  return height > log.roughness ? log.friction_velocity / log.kappa * std::log(height / log.roughness) : 0.0;
}

}  // namespace barchan
