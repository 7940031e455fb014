// The sums of a contact of bodies.
#pragma once

#include <algorithm>

#include "engine/pair_loop.hpp"
#include "laws/smooth_contact.hpp"
#include "models/bodies/self_contact.hpp"
#include "state/particles.hpp"

namespace barchan {

/// Both of the following add what they give to the field contact_force too, where the phase has it.
inline void clear_contact_forces(PhaseParticles& p) {
  if (!p.has(Field::contact_force)) return;
  for (int d = 0; d < p.dimensions(); ++d) std::fill_n(p.column(Field::contact_force, d), p.size(), 0.0);
}

BARCHAN_PER_INSTRUCTION_SET(body_contact_forces,
                            /// Adds to the acceleration of `a` what the particles of the other phase give; dt: s, of
                            /// the step. Records of motion.
                            void body_contact_forces(PhaseParticles& a, const RecordArray& own, const PairList& list,
                                                     const RecordArray& others, const BodyContactLaw& law, double dt);
                            /// The same by surfaces: records of these.
                            void body_contact_forces(PhaseParticles& a, const RecordArray& own, const PairList& list,
                                                     const RecordArray& others, const SmoothContactLaw& law, double dt);
                            /// What parts of a body give each other.
                            void body_contact_forces(PhaseParticles& a, const RecordArray& own, const FarPairs& list,
                                                     const BodyContactLaw& law, double dt);)

/// A side of the domain: a plane.
struct BodySide {
  std::size_t axis;
  double sign, place;  // +1 where the inside lies above it; m
};

BARCHAN_PER_INSTRUCTION_SET(body_side_forces,
                            /// The same of a plane: as of a particle of the wall that faces each particle. `half`: m,
                            /// from the plane to where that particle stands.
                            void body_side_forces(PhaseParticles& a, const BodySide& side, double half,
                                                  const BodyContactLaw& law, double dt);)

}  // namespace barchan
