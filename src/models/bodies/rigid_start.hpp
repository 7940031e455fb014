// The rigid bodies of a phase at the start of a run, from the particles of its fills.
#pragma once

#include <vector>

#include "models/layout.hpp"
#include "start/generate.hpp"

namespace barchan {

/// One body a fill of the phase, with the mass, the centre and the inertia of its shape (start/shape_content.hpp) or
/// those that the fill says, and with the rigid motion of its particles. A body that a [[motion]] turns about a place
/// has that place, else its centre of mass.
/// Throws SceneError: points in one line, a body that stands across a periodic side, one that two motions hold, a
/// motion that holds none.
std::vector<RigidBody> rigid_bodies(const Scene& scene, const ParticleBlock& block, std::size_t phase,
                                    const Layout& layout);

}  // namespace barchan
