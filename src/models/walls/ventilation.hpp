// Where air comes between a wall and the fluid next to it: the wall does not pull there.
#pragma once

#include <span>
#include <vector>

#include "models/walls/walls.hpp"
#include "models/workspace.hpp"

namespace barchan {

/// The least sine of the angle at which a fluid leaves a wall that is ventilated at once. Results hardly depend on it:
/// with 0.05 and 0.2 the discharge under a gate (slots of 5 and 10 spacings) differs by less than 1 %.
constexpr double leaving_sine = 0.1;

/// A wall at rest extends pressures below zero too, so that it holds by suction a fluid that has no way to leave it:
/// a full pipe, the back of a body under water. Where the free surface meets the wall, air enters. There a particle w
/// of the wall loses its volume, and the fluid finds nothing in its place. Air enters where the extended pressure is
/// below zero, a particle of the fluid within the kernel radius is near the surface (it has a `surface_normal`; see
/// SurfaceFinder::reach), and
///   u.n > 0.1 |u|                       the fluid leaves the wall, as water that comes round an edge, or
///   u.n >= 0 and -p_s > rho u.u/2       the suction drives a cavity along the wall against the flow: its tip is a
///                                       point of stagnation (Benjamin 1968, J. Fluid Mech. 31, 209, eq. 2.5)
/// u: the fluid's mean velocity less the wall's; n: normal of the wall; p_s = p_w + rho g.n depth: the pressure at the
/// wall's surface. A line in which a surface and a wall meet so goes back to the edge of the wall, and no farther into
/// a pipe that flows full than its suction lets it.
class Ventilation {
 public:
  /// `wall`: a phase at rest. `sources`: the fluids that are extended into it; they must outlive this.
  Ventilation(Workspace& w, std::size_t wall, std::span<const ExtensionSource> sources);
  /// Changes volumes of the wall's records, for the step alone. All ranks must come here together.
  void let_go(const PhaseParticles& wall, RecordArray& records);

 private:
  struct Fluid {
    std::size_t phase;
    const ExtensionSource* source;
  };
  template <int Dim>
  void let_go_in(const PhaseParticles& wall, RecordArray& records, const Fluid& fluid);
  template <int Dim, class Surface>
  bool air_enters(const PhaseParticles& wall, const double* record, const Fluid& fluid, const Surface& surface,
                  std::size_t k) const;

  Workspace& w_;
  std::vector<Fluid> fluids_;   // with a free surface
  std::vector<double> ghosts_;  // see SurfaceNeighbours
};

/// Whether a wall at rest is next to a fluid with a free surface.
bool is_ventilated(const Layout& layout, std::size_t wall);
/// Adds the fields of fluids that Ventilation::let_go reads.
void add_ventilation_touches(const Layout& layout, std::size_t wall, Touches& touches);

}  // namespace barchan
