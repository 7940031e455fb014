// Contacts of grains among themselves and with walls and bodies.
#pragma once

#include "engine/pair_loop.hpp"
#include "laws/kernel_contact.hpp"
#include "scene/scene.hpp"
#include "state/particles.hpp"

namespace barchan {

BARCHAN_PER_INSTRUCTION_SET(contact_forces,
                            /// Adds to the acceleration of `a` the contact forces from the particles in `others`
                            /// (motion records with their true velocities).
                            void contact_forces(PhaseParticles& a, const RecordArray& own, const PairList& list,
                                                const RecordArray& others, KernelKind kernel, double radius,
                                                const KernelContact& law);)

}  // namespace barchan
