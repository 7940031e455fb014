// One step of the contacts of spheres: forces, kick and drift of a chunk.
#pragma once

#include "base/instructions.hpp"
#include "models/grains/sphere_work.hpp"

namespace barchan {

BARCHAN_PER_INSTRUCTION_SET(
    step_spheres,
    /// Evaluates the contacts of a chunk at step.records and moves its spheres on: into step.next
    /// or, in the last step of a bundle, into the columns. Chunks may be done in any order.
    void step_spheres(const SphereStep& step, SphereChunk& chunk);)

BARCHAN_PER_INSTRUCTION_SET(energy_at_rest,
                            /// J, stored by the contacts of a chunk that no step evaluates: of two that sleep. Of pairs
                            /// that another chunk has too, half.
                            double energy_at_rest(const SphereStep& step, const SphereChunk& chunk);)

}  // namespace barchan
