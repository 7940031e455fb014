// Walls that stand behind the sides of the domain.
#pragma once

#include "engine/cell_grid.hpp"
#include "engine/hold_inside.hpp"

namespace barchan {

/// Whether a wall particle stands behind a side of the domain, so that the side itself is the wall's surface.
bool behind_a_side(const PhaseParticles& wall, std::size_t k, const Bounds& bounds, double spacing);

/// Closes the sides of the domain that the wall stands behind.
void close_sides(Sides& sides, const PhaseParticles& wall, const Bounds& bounds, double spacing);

}  // namespace barchan
