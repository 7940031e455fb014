// Regular places for particles: square and close-packed lattices, and the rows outside the domain. Internal to
// src/scene.
#pragma once

#include <string>
#include <vector>

#include "base/ranks.hpp"
#include "scene/scene.hpp"

namespace barchan {

/// Places of a lattice inside a box of space.
///   square     spacing dx along each axis.
///   hexagonal  2D: rows along x, each second one shifted by dx/2, sqrt(3)/2 dx apart in y.
///              3D: close-packed layers (rows along x, sqrt(3)/2 dx apart in z) stacked along y, sqrt(2/3) dx apart,
///              each second one shifted into the hollows of the one below: hexagonal close packing.
/// The lattice has a particle on `anchor`, and all places with lower <= x < upper are returned, by rows: x runs
/// fastest, then z, then y. A place that round-off puts within 1e-9 dx of a bound counts as on it. `share`: of all
/// these places, in this order, the part that is returned.
std::vector<Vec3> lattice(Packing packing, int dimensions, double spacing, const Vec3& anchor, const Vec3& lower,
                          const Vec3& upper, const ranks::Share& share = {});

/// Length after which the packing repeats itself along an axis.
double period_of(Packing packing, int dimensions, std::size_t axis, double spacing);

/// The fill takes its places from the lattice that hangs on the domain's origin (first particle half a spacing inside).
bool hangs_on_origin(const Shape& shape);

/// Why the lattices of the scene's fills do not fit the periodic axis, with the nearest sizes that do; empty when they
/// do.
std::string misfit_of_period(const Scene& scene, std::size_t axis);

/// Cells of the square lattice along an axis of the domain: the nearest whole number of spacings (m).
int cells_along(const Scene& scene, std::size_t axis, double spacing);

/// Layers of places outside the domain behind the given sides: the first half a spacing outside, then a spacing apart,
/// continued around the corners of axes that are not periodic, each place once.
std::vector<Vec3> rows_outside(const Scene& scene, const SidesShape& sides, double spacing);

}  // namespace barchan
