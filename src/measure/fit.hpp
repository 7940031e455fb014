// Local least-squares fits through the particles about a point: what a probe reads, and the shear at a wall.
//
// Both minimise sum V_b W(r) (q_b - basis(r) . c)^2 (moving least squares, Lancaster & Salkauskas 1981), so that they
// are exact for fields that their basis spans, however the particles lie:
//   interpolate   1, x, y, z             linear fields; where too few particles lie about the point, the mean (Shepard)
//   wall_slope    n, 1, n^2, n x, n z    a velocity whose slope at the wall varies along it, and which is quadratic
//   away
//                                        from it; 1 takes up the slip that a wall of particles leaves, which is no
//                                        shear. Where particles are too few: n, 1; at the least n alone.
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
  std::array<const double*, 4> value{};  // velocity by component, then pressure
  std::size_t values;                    // dimensions + 1
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

/// dv/dn at x on a wall that moves with `wall_velocity` (m/s); n = inward * y - x_y points into the fluid. The pressure
/// is interpolated.
Reading wall_slope(const Vec3& x, double inward, const Vec3& wall_velocity, const FluidView& fluid,
                   const Lookup& lookup, const ReadyKernel& kernel, double radius);

}  // namespace barchan
