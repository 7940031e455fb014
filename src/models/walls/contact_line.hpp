// Where a level free surface meets a wall: the wall's particles above it stand beside air, not beside fluid.
#pragma once

#include <vector>

#include "models/workspace.hpp"

namespace barchan {

/// Half of the height (in spacings) over which a wall's particle comes to count, about the height of the surface.
constexpr double contact_width = 0.35;

/// Takes the volume of a wall's particles away that stand above the contact line of a calm heavy fluid (calmed(),
/// fluid_phase.hpp). A fluid's particle in the top row beside a wall then finds above itself what its neighbours
/// farther away find, nothing, as if the fluid were mirrored. With the whole wall beside it, its B leaned to the wall,
/// half a spacing of water seemed to weigh less than it does, and the particle pumped: it moved a still tank at
/// 7e-4 sqrt(gH) and took 0.8 % of a wave between walls a period (25 rows).
///
/// A particle w of the wall knows its normal N. Over the fluid's particles a of the surface (wholeness below the
/// threshold) within the kernel radius R, with weights (1 - r/R)^2:
///   height = mean of (x_a - x_w).t_a/dx - 1/2,  t = n - N (N.n),  n: direction inwards, of length 1
///   level  = mean of n.g/|g|
/// It counts with 1 - S(level; 0.5, 0.9) S(height; -0.35, 0.35), S a smooth step: wholly where no surface is near,
/// below floors, and beside a surface that stands or folds.
class ContactLine {
 public:
  /// `wall`: a phase whose particles know normal and depth.
  ContactLine(Workspace& w, std::size_t wall);
  /// Changes the volumes of the wall's records, for the step alone. All ranks must come here together.
  void cut(const PhaseParticles& wall, RecordArray& records);

 private:
  struct Fluid {
    std::size_t phase;
    const PairList* list;  // fluid about the wall's particles
    double radius;         // m
    double threshold;      // of the wholeness
  };
  template <int Dim>
  void cut_in(const PhaseParticles& wall, RecordArray& records, const Fluid& fluid);

  Workspace& w_;
  double spacing_;  // m, of the wall
  std::vector<Fluid> fluids_;
  std::vector<double> ghosts_;  // see SurfaceNeighbours
};

/// Adds the fields of fluids that ContactLine::cut reads.
void add_contact_touches(const Scene& scene, const Layout& layout, std::size_t wall, Touches& touches);

}  // namespace barchan
