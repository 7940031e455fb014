// Internal energy of a fluid, only for scenes that ask for it.
#pragma once

#include <span>

#include "models/air/fluid.hpp"

namespace barchan {

BARCHAN_PER_INSTRUCTION_SET(
    fluid_energy,
    /// Writes energy_rate [W/kg]:
    ///   de_a/dt = (1/rho_a) sum V_b [ 1/2 (p_a + p_b) v_ab . grad W - mu F v_ab^2 ]
    /// eq. (13a) of Halik et al. 2015 with the factor 1/2 that it lacks (Monaghan 1992, eq. 3.8): what a pair's
    /// pressure and friction take from the kinetic energy of the plain scheme, they give here, half to each.
    void fluid_energy(PhaseParticles& fluid, const RecordArray& own, std::span<const FluidNeighbour> neighbours);)

}  // namespace barchan
