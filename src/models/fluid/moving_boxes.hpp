// Boxes of walls that a [[motion]] carries, out of which a fluid with a surface is held.
#pragma once

#include <vector>

#include "models/walls/wall_motion.hpp"
#include "models/workspace.hpp"

namespace barchan {

/// A box of a wall where it stood at the start, and how it goes.
struct MovingBox {
  Vec3 low, high;  // m
  const WallMotion* motion;
};

/// The boxes of walls that move and that the fluid feels, if no particle is in them at the start. After the walls' own
/// models have attached.
std::vector<MovingBox> moving_boxes(const Workspace& w, std::size_t fluid, const PhaseParticles& particles);

/// Puts particles that are in the box where it is now back to its nearest face beyond which the domain goes on, and
/// takes from their velocity what leads into it: thin layers and single drops have no pressure that would hold them.
/// `time` (s): of the velocities.
void hold_outside(PhaseParticles& phase, const MovingBox& box, const Bounds& bounds, double time);

}  // namespace barchan
