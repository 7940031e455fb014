// Boxes of walls inside the domain, which a fluid with a free surface must not enter.
#pragma once

#include <vector>

#include "engine/cell_grid.hpp"
#include "models/layout.hpp"
#include "state/particles.hpp"

namespace barchan {

/// A box of a wall that a fluid feels (m).
struct HeldBox {
  Vec3 low, high;
};

/// The boxes of the walls that the fluid feels, less those in which fluid stands at the start.
std::vector<HeldBox> held_boxes(const Scene& scene, const Layout& layout, std::size_t fluid,
                                const PhaseParticles& particles);

/// hold_inside() of engine/integrate.hpp for boxes: a particle whose centre is in one is put back to the nearest face
/// beyond which there is room, and its motion inwards stops. Thin layers and single drops have no pressure that would
/// keep them out. Nothing is done to any other particle.
void hold_outside(PhaseParticles& phase, const std::vector<HeldBox>& boxes, const Bounds& bounds);

}  // namespace barchan
