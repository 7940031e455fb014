// Where a level free surface meets a wall: the wall's particles above it stand beside air, not beside fluid.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "models/walls/walls.hpp"
#include "models/workspace.hpp"

namespace barchan {

/// Half of the height (in spacings) over which a wall's particle comes to count, about the height of the surface. A
/// wave between walls, 12 rows deep, loses 0.51, 0.29, 0.16 % a period with 0.5, 0.35, 0.2 (a third of the friction in
/// the row below the top one), and with 0.1 no less at a quarter of the amplitude.
constexpr double contact_width = 0.2;
/// The least variance (in spacings^2) of the height of the fluid about a wall's particle, from which a slope along the
/// wall is taken.
constexpr double least_spread = 0.15;

/// Takes the volume of a wall's particles away that stand above the contact line of a calm heavy fluid (calmed(),
/// fluid_phase.hpp). A fluid's particle in the top row beside a wall then finds above itself what its neighbours
/// farther away find, nothing, as if the fluid were mirrored. With the whole wall beside it, its B leaned to the wall,
/// half a spacing of water seemed to weigh less than it does, and the particle pumped: it moved a still tank at
/// 7e-4 sqrt(gH) and took 0.8 % of a wave between walls a period (25 rows).
///
/// A particle w of the wall knows its normal N. Over the fluid's particles a of the surface (wholeness below the
/// threshold) within the kernel radius R, with weights (1 - r/R)^2:
///   height = mean of (x_a - x_w).t_a/dx - 1/2,  t = n - M (M.n),  n: direction inwards, of length 1,  M: the level
///     part of N, of length 1. So a level surface goes on into a slanted wall as a level one, and any surface beside an
///     upright wall is mirrored. With N in place of M, which ends the wall across itself, the particle at the shore of
///     a tank with sides of 60 degrees pumped at 0.06 sqrt(gH).
///   level  = mean of n.g/|g|
/// It counts with 1 - S(level; 0.5, 0.9) S(height; -0.2, 0.2), S a smooth step: wholly where no surface is near,
/// below floors, and beside a surface that stands or folds.
///
/// The fluid about a particle of the wall near the surface ends above it, so that the means <> of the extension
/// (laws/extension.hpp) are those of a place below, and the top row rubbed on what it should slip along: 0.6 % of a
/// wave 12 rows deep a period. To the particle's pressure and its velocities along the wall
///   -S(level; 0.5, 0.9) <z> (<z q> - <z> <q>)/max(<z^2> - <z>^2, 0.15 dx^2),   z = (x_a - x_w).up
/// is added. q: velocity (m/s); p + rho (g - a_w).(x_w - x_a) (Pa). up: the direction along the wall against gravity.
class ContactLine {
 public:
  /// `wall`: a phase whose particles know normal and depth. `sources`, `rule`: by which fluids are extended into it;
  /// they must outlive this.
  ContactLine(Workspace& w, std::size_t wall, std::span<const ExtensionSource> sources, const ExtensionRule& rule);
  /// Changes volumes, pressures and velocities of the wall's records, for the step alone. `forced`: see
  /// extend_into_solid. All ranks must come here together.
  void end(const PhaseParticles& wall, std::span<const double> forced, RecordArray& records);

 private:
  struct Fluid {
    std::size_t phase;
    const ExtensionSource* source;
    double threshold;  // of the wholeness
  };
  template <int Dim>
  void end_in(const PhaseParticles& wall, std::span<const double> forced, RecordArray& records, const Fluid& fluid);
  template <int Dim>
  struct Rising;
  template <int Dim, class Surface>
  void raise(const PhaseParticles& wall, std::span<const double> forced, double* record, const Fluid& fluid,
             const Surface& surface, std::size_t k, double share);
  template <std::size_t Dim>
  std::array<double, Dim> pull(const PhaseParticles& wall, std::span<const double> forced, std::size_t k) const;

  Workspace& w_;
  const ExtensionRule& rule_;
  double spacing_;  // m, of the wall
  std::vector<Fluid> fluids_;
  std::vector<double> ghosts_;  // see SurfaceNeighbours
};

/// Adds the fields of fluids that ContactLine::end reads.
void add_contact_touches(const Scene& scene, const Layout& layout, std::size_t wall, Touches& touches);

}  // namespace barchan
