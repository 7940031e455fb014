// The parts of kick-drift-kick, one loop over a phase each.
#pragma once

#include "base/instructions.hpp"
#include "engine/pressure_law.hpp"
#include "state/particles.hpp"

namespace barchan {

/// v += half_kick a; x += drift (v + du), du the shift velocity where the phase has one. If `pressure` is given:
/// rho += drift drho/dt, p = pressure(rho).
BARCHAN_PER_INSTRUCTION_SET(kick_and_drift, void kick_and_drift(PhaseParticles& phase, double half_kick, double drift,
                                                                const PressureLaw* pressure);)

/// e += time de/dt.
BARCHAN_PER_INSTRUCTION_SET(advance_energy, void advance_energy(PhaseParticles& phase, double time);)

/// x += drift v.
BARCHAN_PER_INSTRUCTION_SET(drift, void drift(PhaseParticles& phase, double drift);)

/// v += half_kick a; returns the largest component of |a|, or infinity if one is not finite.
BARCHAN_PER_INSTRUCTION_SET(kick, double kick(PhaseParticles& phase, double half_kick);)

}  // namespace barchan
