// Pressure and velocity of the fluid continued into solids, so that a fluid particle near one finds neighbours all
// round.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "models/air/fluid.hpp"

namespace barchan {

/// What a solid (a wall, or grains in air) sees of one fluid.
struct ExtensionSource {
  const PairList* list;        // fluid particles about each particle of the solid
  const RecordArray* records;  // the fluid's motion records
  KernelKind kernel;
  double radius;       // m
  double density;      // kg/m3, of the fluid at rest
  double alone = 0.0;  // sum V W of the fluid about a grain that stands alone in it, where a form drag acts; 0: no drag
};

/// How a wall's surface bends, by particle: the second derivatives of its height over sqrt(1 + slope^2) (1/m) at the
/// place nearest to it: xx, in 3D xx xz zz. A fluid that follows the surface at the velocity u is accelerated away from
/// the wall by u.H.u.
struct SurfaceBend {
  std::int64_t first = 0;      // id of the wall's first particle
  std::vector<double> values;  // by id; empty: flat, or nobody knows
  static constexpr std::size_t components(int dimensions) { return dimensions == 2 ? 1 : 3; }
};

/// What a solid does to the fluid about it.
struct ExtensionRule {
  Slip slip = Slip::no_slip;
  bool accelerates = false;   // the fluid's pressure follows the acceleration of its particles: an elastic body
  bool own_velocity = false;  // its particles keep their own velocity: grains
};

inline constexpr double solid_share = 0.65, open_share = 0.9;

/// Writes velocity and pressure into the solid's motion records `own` (position and volume are there already):
///   p_w = [sum p_a W + rho (g - a_w) . sum (x_w - x_a) W] / sum W               (Adami et al. 2012, eq. 27)
///     a_w is that of an elastic body; grains count as unaccelerated: the blows of their contacts, thousands of g for
///     some microseconds, are no motion of a boundary that the fluid could follow
///   no-slip, depth known: v_w = v_wall - phi_w sum W phi_a (v_a - v_wall) / sum W phi_a^2, the line through the wall's
///     velocity at the surface that fits the fluid best (phi: distance to the surface); exact for a linear profile
///   no-slip, depth unknown: v_w = 2 v_wall - sum v_a W / sum W                   (Adami et al. 2012, eq. 23)
///   grains: v_w = v_wall, their own; a jump of twice the slip across one grain in flight would be no smooth field.
///     Where a form drag acts, a grain alone in the fluid has the fluid's mean velocity instead: one spacing cannot
///     resolve the flow about it, and what it takes from the fluid is the drag. Between `solid_share` and `open_share`
///     of the fluid that a lone grain has about it, v_w goes from the one to the other
///   free-slip: the normal part as no-slip, the tangential part the fluid's mean. Where the wall is curved, the
///   pressure
///     falls or rises with what turns the fluid: p_w = ... + rho u.H.u sum W (phi_a + phi_w) / sum W.
/// Without fluid near, the solid keeps its own velocity and the pressure is zero.
BARCHAN_PER_INSTRUCTION_SET(extend_into_solid,
                            void extend_into_solid(const PhaseParticles& solid, RecordArray& own,
                                                   std::span<const ExtensionSource> fluids, const Vec3& gravity,
                                                   const ExtensionRule& rule, const SurfaceBend& bend = {});)

}  // namespace barchan
