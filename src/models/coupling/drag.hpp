// Form drag of grains in a fluid, and the barrier that keeps the fluid out of them, one side at a time.
#pragma once

#include "engine/pair_loop.hpp"
#include "laws/grain_barrier.hpp"
#include "scene/scene.hpp"
#include "state/particles.hpp"

namespace barchan {

struct DragEntry {
  KernelKind kernel;
  double radius;    // m
  double strength;  // K = 1/2 C_D rho_f A [kg/m]
  double density;   // kg/m3, of the fluid
  GrainBarrier barrier;
};

BARCHAN_PER_INSTRUCTION_SET(drag_forces,
                            /// Adds to the acceleration of `a` the drag and the barrier from `others` (motion records
                            /// with true velocities). `a_is_fluid` says whose volume weighs a pair.
                            void drag_forces(PhaseParticles& a, const RecordArray& own, const PairList& list,
                                             const RecordArray& others, const DragEntry& entry, bool a_is_fluid);)

}  // namespace barchan
