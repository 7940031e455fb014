// The stiffest vibration of a total Lagrangian body: what bounds its step.
//
// It sits in corners, where a particle has a quarter of its neighbours and M^-1 is largest. A block of the body's
// lattice with free sides and corners is shaken with the sums of the body itself; repeated application of a = -w^2 u
// leaves the vibration of the largest w (power iteration).
#pragma once

#include "models/bodies/total_lagrangian.hpp"

namespace barchan {

/// Its angular frequency (1/s).
double stiffest_vibration(KernelKind kernel, double radius, double spacing, int dimensions, TotalParameters parameters);

/// kappa_l (Pa) of laws/stray_length.hpp: with it waves of compression along the axes of the lattice keep their speed
/// to the fourth order.
double length_stiffness(KernelKind kernel, double radius, double spacing, int dimensions,
                        const TotalParameters& parameters);

}  // namespace barchan
