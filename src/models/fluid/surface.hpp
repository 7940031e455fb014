// The free surface of a fluid: its particles, their normals into the fluid, and the limit of the pressure there.
#pragma once

#include <cstdint>
#include <vector>

#include "engine/cell_grid.hpp"
#include "engine/pair_list.hpp"
#include "engine/pressure_law.hpp"
#include "models/fluid/fluid_rates.hpp"
#include "state/particles.hpp"

namespace barchan {

/// Finds the free surface. fluid_rates left the wholeness of every particle, and B = sum V F r (1/m, inwards) in
/// `surface_normal`. Of every particle nearer than `reach` kernel radii to a particle of the surface, `surface_normal`
/// becomes the sum of B over those particles of the surface; of all others zero. With a `spacing` (m; of a calm heavy
/// fluid) its length is made one over the distance of a particle of the surface to the row below it, and of the others
/// that are near one over the spacing.
///
/// Costs two walks over the rows of the particles at the surface; nothing elsewhere. No memory is taken once warm, and
/// every sum has the order of a particle's row, so that threads change nothing.
class SurfaceFinder {
 public:
  static constexpr double reach = 0.7;  // of the kernel radius

  /// `own`: the list of the fluid with itself. `radius`: its kernel radius (m). `threshold`: of the wholeness.
  void find(PhaseParticles& fluid, const CellGrid& grid, const PairList& own, double radius, double threshold,
            double spacing = 0.0);

 private:
  void take_members(const double* chi, std::size_t n, std::size_t ghosts, std::size_t dimensions, double threshold);
  void return_marks(const CellGrid& grid, std::size_t n);
  template <int Dim>
  void find_in(PhaseParticles& fluid, const CellGrid& grid, const PairList& own, double radius, double threshold,
               double spacing);
  std::vector<std::uint8_t> near_;      // by particle; on several ranks ghosts follow
  std::vector<std::uint32_t> members_;  // particles of the surface
  std::vector<double> inwards_;         // by particle and component
  std::vector<double> ghosts_;          // on several ranks: see SurfaceNeighbours
};

/// Sets what fluid_stress.hpp needs. `viscosity`: of a laminar fluid (Pa s), 0: the particles have their own; `row`: dx
/// |B| of the top row of a lattice.
void set_surface_stress(FluidParameters& q, double viscosity, double spacing, double row);

/// Particles of the surface feel no tension: where the pressure is below that of the void, it becomes that, and the
/// density the one at rest.
void release_surface(PhaseParticles& fluid, double threshold, const PressureLaw& law);

}  // namespace barchan
