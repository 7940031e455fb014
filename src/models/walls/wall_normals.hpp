// Normals of walls that are filled inside the domain and have no described surface.
#pragma once

#include <span>

#include "engine/cell_grid.hpp"
#include "state/particles.hpp"

namespace barchan {

/// Gives every wall particle that has neither depth nor normal the direction out of the wall: the gradient of the
/// walls' own smoothed volume, n = -sum W'(r)/r r / |...|, over the particles of all walls within four spacings (cubic
/// spline). Zero where the wall is the same all round. The depth stays unknown, 0. Once, at the beginning.
void find_wall_normals(std::span<PhaseParticles* const> walls, const Bounds& bounds, double spacing);

}  // namespace barchan
