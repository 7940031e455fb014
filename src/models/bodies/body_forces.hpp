// The sums of a contact of bodies.
#pragma once

#include "engine/pair_loop.hpp"
#include "laws/body_contact.hpp"
#include "state/particles.hpp"

namespace barchan {

BARCHAN_PER_INSTRUCTION_SET(body_contact_forces,
                            /// Adds to the acceleration of `a` what the particles of the other phase give; dt: s, of
                            /// the step. Records of motion.
                            void body_contact_forces(PhaseParticles& a, const RecordArray& own, const PairList& list,
                                                     const RecordArray& others, const BodyContactLaw& law, double dt);)

}  // namespace barchan
