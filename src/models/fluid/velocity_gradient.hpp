// The velocity gradient of a fluid for frames: no step needs it.
#pragma once

#include <span>

#include "models/fluid/fluid_rates.hpp"

namespace barchan {

/// Writes the column velocity_gradient (1/s), and shear_rate where the fluid has it for frames alone: |S|, root of 2
/// S:S. Corrected sums, exact of a linear velocity: G = (sum V F v_ab r) (sum V F r r)^-1 (Bonet & Lok 1999, eq. 41),
/// over the fluid and what it is extended into, as in the pass before. Where the neighbours do not span space, of a
/// drop alone, it is zero. `own`: records of its particles.
void derive_velocity_gradient(PhaseParticles& fluid, const RecordArray& own, std::span<const FluidNeighbour> neighbours,
                              bool shear_rate);

}  // namespace barchan
