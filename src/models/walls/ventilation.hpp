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
/// Between these distances (spacings) of the nearest particle of the fluid from the wall's surface a wall that let go
/// loses its volume. Particles that touch the wall are nearer than 0.71.
constexpr double gap_from = 0.8, gap_to = 1.1;

/// A wall at rest extends pressures below zero too, so that it holds by suction a fluid that has no way to leave it:
/// a full pipe, the back of a body under water. Where the free surface meets the wall, air enters. There a particle w
/// of the wall has no pressure, and the mean velocity of the fluid that leaves it (ExtendedState::let_go). Air enters
/// where p_w and p_s are below zero, a particle of the fluid within the kernel radius is near the surface (it has a
/// `surface_normal`; see SurfaceFinder::reach), and
///   u.n > 0.1 |u|                       the fluid leaves the wall, as water that comes round an edge, or
///   u.n >= 0 and -p_s > rho u.u/2       the suction drives a cavity along the wall against the flow: its tip is a
///                                       point of stagnation (Benjamin 1968, J. Fluid Mech. 31, 209)
/// u = <v_a> - v_w; n: normal of the wall; <>: the means of the extension; p_w: the extended pressure;
/// p_s = <p_a + rho g.n n.(x_s - x_a)>, x_s = x_w + depth n: the pressure at the wall's surface, with the weight
/// across it alone (p_w beside falling water is below zero, because the extension knows the whole weight).
///
/// The particle has no volume either, and the fluid finds nothing in its place, where the flow separates (the first
/// condition, and -p_s <= rho u.u/2) and, with a smooth step, where the fluid is farther from the surface than
/// particles that touch it.
class Ventilation {
 public:
  /// `wall`: a phase at rest. `sources`: the fluids that are extended into it; they must outlive this.
  Ventilation(Workspace& w, std::size_t wall, std::span<const ExtensionSource> sources);
  /// Changes pressures, velocities and volumes of the wall's records, for the step alone. All ranks must come here
  /// together.
  void let_go(const PhaseParticles& wall, RecordArray& records);

 private:
  struct Fluid {
    std::size_t phase;
    const ExtensionSource* source;
  };
  template <int Dim>
  void let_go_in(const PhaseParticles& wall, RecordArray& records, const Fluid& fluid);
  template <int Dim, class Surface>
  void let_go_at(const PhaseParticles& wall, double* record, const Fluid& fluid, const Surface& surface,
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
