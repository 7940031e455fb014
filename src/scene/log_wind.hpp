// The logarithmic wind, the one place that has its formula.
#pragma once

#include <cmath>

#include "scene/scene.hpp"

namespace barchan {

/// eq. (18) of Halik et al. 2015 in SI units: u = (u*/kappa) ln(y/y0) at a height over the ground (m); 0 below y0.
inline double log_wind(const LogProfile& log, double height) {
  return height > log.roughness ? log.friction_velocity / log.kappa * std::log(height / log.roughness) : 0.0;
}

/// The mean of log_wind() from the ground up to a height (m): (u*/kappa) (ln(y/y0) - 1 + y0/y).
inline double mean_log_wind(const LogProfile& log, double height) {
  if (!(height > log.roughness)) return 0.0;
  return log.friction_velocity / log.kappa * (std::log(height / log.roughness) - 1.0 + log.roughness / height);
}

}  // namespace barchan
