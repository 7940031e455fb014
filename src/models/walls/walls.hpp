// Pressure and velocity of the fluid continued into solids, so that a fluid particle near one finds neighbours all
// round.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "laws/extension.hpp"
#include "models/fluid/fluid_rates.hpp"

namespace barchan {

/// What a solid (a wall, or grains in air) sees of one fluid.
struct ExtensionSource {
  const PairList* list;        // fluid particles about each particle of the solid
  const RecordArray* records;  // the fluid's motion records
  KernelKind kernel;
  double radius;       // m
  double density;      // kg/m3, of the fluid at rest
  double alone = 0.0;  // sum V W of the fluid about a grain that stands alone in it, where a form drag acts; 0: no drag
  Compression compression = {};
};

/// How a wall's surface bends, by particle: the second derivatives of its height over sqrt(1 + slope^2) (1/m) at the
/// place nearest to it: xx, in 3D xx xz zz. A fluid that follows the surface at the velocity u is accelerated away from
/// the wall by u.H.u.
struct SurfaceBend {
  std::int64_t first = 0;      // id of the wall's first particle
  std::vector<double> values;  // by id; empty: flat, or not known
  static constexpr std::size_t components(int dimensions) { return dimensions == 2 ? 1 : 3; }
};

/// What a solid does to the fluid about it.
struct ExtensionRule {
  Slip slip = Slip::no_slip;
  bool accelerates = false;   // the fluid's pressure follows the acceleration of its particles: a body, a driven wall
  bool own_velocity = false;  // its particles keep their own velocity: grains
  bool lets_go = false;       // it does not pull: where the fluid has no pressure, it may leave
  bool one_sided = false;     // fluid behind its surface is another one: bodies that may be thin
  double least_phi = 0.0;     // m; see ExtendedState
  double rub = 1.0;           // share of no slip that is left along a surface whose normal is known (wall_rub)
};

/// Writes velocity and pressure into the solid's motion records `own` (position and volume are there already), by the
/// formulas of laws/extension.hpp. `forced`: what else accelerates the fluid there (m/s2), by particle and component;
/// empty: nothing.
BARCHAN_PER_INSTRUCTION_SET(extend_into_solid,
                            void extend_into_solid(const PhaseParticles& solid, RecordArray& own,
                                                   std::span<const ExtensionSource> fluids, const Vec3& gravity,
                                                   const ExtensionRule& rule, const SurfaceBend& bend = {},
                                                   std::span<const double> forced = {});)

}  // namespace barchan
