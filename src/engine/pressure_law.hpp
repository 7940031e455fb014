// The equation of state of a weakly compressible fluid: Tait's, or the linear one (Monaghan 1994, J. Comput. Phys. 110,
// eq. 4.1).
#pragma once

namespace barchan {

/// p(rho) as the integrator evaluates it.
struct PressureLaw {
  double reference_density;  // kg/m3
  double sound_speed;        // m/s
  double exponent;           // Tait's gamma; 1 is the linear equation of state
  double background;         // Pa
  double operator()(double density) const;
  double density(double pressure) const;  ///< kg/m3, at which the pressure is this
};

}  // namespace barchan
