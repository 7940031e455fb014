// Normals of walls that are filled inside the domain and have no described surface.
#pragma once

#include <span>

#include "engine/cell_grid.hpp"
#include "state/particles.hpp"

namespace barchan {

/// A wall whose particles stand for what is solid about another's, and the volume of one of its particles over that of
/// one of the other's.
struct WallPart {
  const PhaseParticles* particles;
  double volume;
};

/// Gives every particle of the wall that has neither depth nor normal the direction out of what is solid: the gradient
/// of the smoothed volume of `parts`, n = -sum V W'(r)/r r / |...|, within four of the wall's own spacings (m; cubic
/// spline). Zero where all is the same all round. The depth stays unknown, 0. Once, at the beginning.
void find_wall_normals(PhaseParticles& wall, std::span<const WallPart> parts, const Bounds& bounds, double spacing);

}  // namespace barchan
