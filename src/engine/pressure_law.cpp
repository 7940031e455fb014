#include "engine/pressure_law.hpp"

#include <cmath>

namespace barchan {

double PressureLaw::operator()(double density) const {
  if (exponent == 1.0) return sound_speed * sound_speed * (density - reference_density) + background;
  const double stiffness = reference_density * sound_speed * sound_speed / exponent;
  return stiffness * (std::pow(density / reference_density, exponent) - 1.0) + background;
}

double PressureLaw::density(double pressure) const {
  const double over = (pressure - background) / (reference_density * sound_speed * sound_speed);
  if (exponent == 1.0) return reference_density * (1.0 + over);
  return reference_density * std::pow(1.0 + exponent * over, 1.0 / exponent);
}

}  // namespace barchan
