// What a laminar fluid of the consistent scheme does at a place of a border, from the fluid before it.
#pragma once

#include "models/coupling/border_neighbours.hpp"

namespace barchan {

/// A fluid that presses on a border.
struct BorderFluid {
  std::size_t phase;
  bool free_surface;          // beyond which nothing presses
  double spacing, radius;     // m; of the fit
  double viscosity, density;  // Pa s; kg/m3, at rest
  double sound_speed;         // m/s
};

/// As the entry of a solid with a fluid of the consistent scheme says.
BorderFluid border_fluid(const Scene& scene, const Layout& layout, const PlanEntry& entry);
/// Length of the pieces of a border, at most, in spacings of the fluid.
constexpr double piece_width(int dimensions) { return dimensions == 2 ? 0.5 : 0.7; }

/// How the border of a solid lies and moves at a piece.
struct BorderMotion {
  Vec3 normal;          // into the fluid
  Vec3 velocity, spin;  // m/s, 1/s: v + spin x r is the velocity of the surface about it
};

struct BorderStress {
  bool wet = false;       // some fluid is near
  double pressure = 0.0;  // Pa
  Vec3 friction{};        // Pa, along the border
  double share = 1.0;     // of the fluid there that is no spray (spray.hpp); pressure and friction have it already
  double parting = 0.0;   // m/s, with which the fluid goes off the border: zero but for the error of the scheme
};

/// Weighted least squares over the particles within the radius that stand before the border, (x - x_q).n > 0: behind a
/// thin plate is another fluid. Pressure: linear, less its hydrostatic part; friction mu du/dn: u is the velocity less
/// that of the surface (BorderSample). `gravity` in m/s2.
BorderStress border_stress(int dimensions, const Vec3& gravity, const BorderFluid& fluid,
                           const std::vector<BorderNeighbour>& about, const BorderMotion& border);

}  // namespace barchan
