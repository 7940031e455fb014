// Internal energy of a fluid, only for scenes that ask for it.
#pragma once

#include <span>

#include "models/fluid/fluid_rates.hpp"

namespace barchan {

/// One entry of a fluid with a solid: what the fluid sees of it, and how its bodies carry its particles.
struct SolidNeighbour {
  FluidNeighbour pair;
  const RecordArray* carried;
};

BARCHAN_PER_INSTRUCTION_SET(fluid_energy,
                            /// Writes energy_rate [W/kg] by laws/plain_energy.hpp. Accelerations are those of the step,
                            /// complete; `age` (s): how much older than they the velocities of the records are.
                            void fluid_energy(PhaseParticles& fluid, const RecordArray& own,
                                              std::span<const FluidNeighbour> fluids,
                                              std::span<const SolidNeighbour> solids, double age);)

}  // namespace barchan
