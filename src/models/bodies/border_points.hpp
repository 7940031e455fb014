// Places on the border of a body, over which what a fluid does to it is summed.
#pragma once

#include <vector>

#include "base/vec3.hpp"
#include "scene/scene.hpp"

namespace barchan {

/// A piece of a border: its middle (m, in space at the start), the normal out of the body, its length (m) or area (m2).
struct BorderPoint {
  Vec3 at, normal;
  double content;
};

/// The border of a fill's shape in pieces no wider than `width` (m): box, cube, disc, ring, polygon and lines of a file
/// in 2D, box, cube, sphere and triangles of a file in 3D. The pieces of a round body sum up to its whole border, and
/// their normals to zero. Empty: the shape has no border that is known. `spacing` (m): of the particles.
std::vector<BorderPoint> border_points(const Shape& shape, int dimensions, double spacing, double width);

}  // namespace barchan
