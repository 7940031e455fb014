// Local least-squares fits through the particles about a point: what a probe reads, and the shear at a wall.
//
// Both minimise sum V_b W(r) (q_b - basis(r) . c)^2 (moving least squares, Lancaster & Salkauskas 1981), so that they
// are exact for fields that their basis spans, however the particles lie:
//   interpolate   1, x, y, z             linear fields; where too few particles lie about the point, the mean (Shepard)
//   wall_slope    n, 1, n^2, n x, n z    a velocity whose slope at the wall varies along it, and which is quadratic
//   away
//                                        from it (x, z along the wall); 1 takes up the slip that a wall of particles
//                                        leaves, which is no shear. Where particles are too few: n, 1; at the least n
//                                        alone.
#pragma once

#include <array>

#include "kernels/kernel.hpp"
#include "measure/lookup.hpp"

namespace barchan {

/// The fluid as a fit reads it. Null columns are not read.
struct FluidView {
  explicit FluidView(const PhaseParticles& particles);
  double volume(std::size_t i) const { return mass / density[i]; }  ///< m^d

  double mass;
  int dimensions;
  const double* density;
  std::array<const double*, 4> value{};     // velocity by component, then pressure
  std::size_t values;                       // dimensions + 1
  const double* ground_distance = nullptr;  // m, of a turbulent fluid
};

/// What a fit finds at a point.
struct Reading {
  bool found = false;             // enough fluid is there; otherwise `value` means nothing
  std::array<double, 4> value{};  // velocity by component (m/s) or its slope (1/s), then pressure (Pa)
  double fraction = 0;            // sum V W: 1 within the fluid, 1/2 on a straight wall, 0 where none is
};

/// Less of the kernel than this covered by fluid, and there is nothing to read.
inline constexpr double least_fraction = 0.2;

/// Velocity and pressure at x (m).
Reading interpolate(const Vec3& x, const FluidView& fluid, const Lookup& lookup, const ReadyKernel& kernel,
                    double radius);

/// A piece of a wall's surface.
struct WallPoint {
  Vec3 x;         // m
  Vec3 normal;    // into the fluid, of length 1
  Vec3 velocity;  // m/s, of the wall
};

/// dv/dn at a wall less its part along the normal, in the domain's axes (1/s). The pressure is interpolated.
Reading wall_slope(const WallPoint& at, const FluidView& fluid, const Lookup& lookup, const ReadyKernel& kernel,
                   double radius);

/// The traction along the wall (Pa, in the domain's axes) of rough ground: the mean of
///   tau = rho (kappa/ln(d/z0))^2 |u| u                                              (laws/eddies.hpp)
/// over the particles within the kernel, with u their velocity along the wall against it and d their distance to the
/// ground. Weights are V W(|x_b - x|): summed over the wall's surface, a particle at the height h has the weight
/// integral W dS of a plane in the distance h, by which the fluid's own pass spreads the wall's stress over its
/// particles. So the integral of tau over the surface is the force of the pass. The pressure is interpolated.
struct RoughWall {
  double density, roughness, spacing;  // kg/m3, m, m of the fluid
};
Reading rough_stress(const WallPoint& at, const RoughWall& wall, const FluidView& fluid, const Lookup& lookup,
                     const ReadyKernel& kernel, double radius);

}  // namespace barchan
