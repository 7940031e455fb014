// Internal energy of a fluid, only for scenes that ask for it.
#pragma once

#include <span>

#include "models/air/fluid.hpp"

namespace barchan {

BARCHAN_PER_INSTRUCTION_SET(fluid_energy,
                            /// Writes energy_rate [W/kg] by laws/plain_energy.hpp.
                            void fluid_energy(PhaseParticles& fluid, const RecordArray& own,
                                              std::span<const FluidNeighbour> neighbours);)

}  // namespace barchan
