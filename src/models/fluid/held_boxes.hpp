// Shapes of walls inside the domain, which a fluid with a free surface must not enter.
#pragma once

#include <vector>

#include "engine/cell_grid.hpp"
#include "models/bodies/contact_surface.hpp"
#include "models/layout.hpp"
#include "state/particles.hpp"

namespace barchan {

/// A box of a wall that a fluid touches (m).
struct HeldBox {
  Vec3 low, high;
};

struct HeldShapes {
  std::vector<HeldBox> boxes;
  std::vector<ContactSurface> surfaces;  // 2D: discs, rings, polygons
  bool any() const { return !boxes.empty() || !surfaces.empty(); }
};

/// The shapes of the walls at rest that the fluid touches, less those in which fluid stands at the start.
HeldShapes held_shapes(const Scene& scene, const Layout& layout, std::size_t fluid, const PhaseParticles& particles);

/// hold_inside() of engine/integrate.hpp for shapes: a particle whose centre is in one is put back to the nearest place
/// of its surface (of a box: to the nearest face beyond which there is room), and its motion inwards stops. Thin
/// layers, single drops and water in a wedge have no pressure that would keep them out. Nothing is done to any other
/// particle.
void hold_outside(PhaseParticles& phase, const HeldShapes& shapes, const Bounds& bounds);

}  // namespace barchan
