// The angular momentum of the particles of a phase about their common centre.
#pragma once

#include <string>

#include "base/vec3.hpp"
#include "models/history_row.hpp"
#include "models/layout.hpp"
#include "state/particles.hpp"
#include "state/rigid_body.hpp"

namespace barchan {

/// The turning of particles, in 2D per metre of depth.
struct Turning {
  Vec3 momentum{};       // kg m2/s, sum of m (x - X) x (v - V); X, V: of the common centre of mass
  double inertia = 0.0;  // kg m2, sum of m (x - X)^2
  double energy = 0.0;   // J, sum of m (v - V)^2/2: of the motion about the centre
};

/// Of `count` phases and of rigid bodies together. Places must not go through periodic sides, see has_centre().
Turning turning_of(const PhaseParticles* const* phases, std::size_t count, const std::vector<RigidBody>& bodies = {});

/// False where a side across which a turning goes is periodic: places of one body are then on both ends.
bool has_centre(const Layout& layout);

/// Adds NAME_angular_momentum (2D: about z; 3D: _x, _y, _z) of the phase where has_centre() says that there is one.
void add_angular_momentum(HistoryRow& row, const PhaseParticles& phase, const Layout& layout);

}  // namespace barchan
