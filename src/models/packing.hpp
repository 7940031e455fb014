// Fills the records of motion from the columns, once a step.
#pragma once

#include "base/instructions.hpp"
#include "engine/records.hpp"
#include "state/particles.hpp"

namespace barchan {

/// How the motion records of a phase are filled.
struct MotionPacking {
  bool pressure = false;      // with its pressure; else 0
  bool fixed_volume = false;  // its spacing's volume for all; else mass/density
};

/// Position, velocity, pressure and volume of every particle. `volume`: m^dimensions, of those whose volume is fixed.
BARCHAN_PER_INSTRUCTION_SET(pack_motion, void pack_motion(const PhaseParticles& particles, RecordArray& records,
                                                          const MotionPacking& how, double volume);)

/// The same in mixed precision, with the pressure.
BARCHAN_PER_INSTRUCTION_SET(pack_compact, void pack_compact(const PhaseParticles& particles, CompactRecords& records,
                                                            const MotionPacking& how, double volume);)

}  // namespace barchan
