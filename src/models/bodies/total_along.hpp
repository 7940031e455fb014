// Of bodies with `wave-correction`: pairs keep the lengths that the gradient gives them (laws/stray_length.hpp).
#pragma once

#include "models/bodies/total_lagrangian.hpp"

namespace barchan {

/// After total_stress: writes H of all particles, and adds to Q what follows from it.
BARCHAN_PER_INSTRUCTION_SET(along_stress, void along_stress(const ReferenceBody<float>& reference,
                                                            TotalWork<float>& work, const TotalParameters& parameters);
                            void along_stress(const ReferenceBody<double>& reference, TotalWork<double>& work,
                                              const TotalParameters& parameters);)

/// Adds the acceleration by the lengths of pairs, after along_stress.
BARCHAN_PER_INSTRUCTION_SET(along_forces,
                            void along_forces(PhaseParticles& body, const ReferenceBody<float>& reference,
                                              const TotalWork<float>& work, const TotalParameters& parameters);
                            void along_forces(PhaseParticles& body, const ReferenceBody<double>& reference,
                                              const TotalWork<double>& work, const TotalParameters& parameters);)

/// Adds to the energy of the hourglass control what the lengths of pairs store; detail.gradient has H.
BARCHAN_PER_INSTRUCTION_SET(along_energy,
                            void along_energy(const ReferenceBody<float>& reference, const TotalWork<float>& work,
                                              const TotalParameters& parameters, TotalDetail& detail);
                            void along_energy(const ReferenceBody<double>& reference, const TotalWork<double>& work,
                                              const TotalParameters& parameters, TotalDetail& detail);)

}  // namespace barchan
