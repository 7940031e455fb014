// Where the outline of a wall's fill is nearest to each of its particles.
#pragma once

#include <vector>

#include "models/layout.hpp"

namespace barchan {

/// The nearest place of a wall's surface: the normal there, out of the wall, and how deep a particle is behind it (m).
/// A depth of zero: unknown.
struct WallFace {
  Vec3 normal{};
  double depth = 0.0;
};

/// The faces of the particles of wall `number` at `places` (m), by place: those of the outline of the wall's fill (box,
/// disc, ring, polygon), if it is the wall's only one, as far as `reach` (m) behind it. What ends on a side of the
/// domain has no surface there.
std::vector<WallFace> outline_faces(const Scene& scene, const Layout& layout, std::size_t number,
                                    const std::vector<Vec3>& places, double reach);

}  // namespace barchan
