// Rows of particles that follow the ground. Internal to src/start.
#pragma once

#include <string>
#include <vector>

#include "scene/scene.hpp"
#include "start/ground.hpp"

namespace barchan {

/// The ground as a surface, with slopes.
class Terrain {
 public:
  Terrain(const Ground& ground, const Domain& domain, double spacing)
      : ground_(ground), bottom_(domain.origin[1]), step_(0.25 * spacing), solid_(domain.size[2] > 0.0) {}

  double height(double x, double z) const { return bottom_ + ground_.height(x, z); }  ///< m, as a coordinate
  /// Where the surface is nearest to x, a place near it.
  Vec3 foot(const Vec3& x) const;
  /// The two slopes dh/dx, dh/dz.
  std::array<double, 2> slopes(double x, double z) const;
  /// Second derivatives xx, xz, zz over sqrt(1 + slope^2), 1/m. Taken over a spacing to each side, and no larger than a
  /// quarter of a spacing bends: an edge is round to the particles.
  std::array<double, 3> bend(double x, double z) const;

 private:
  Ground ground_;
  double bottom_, step_;
  bool solid_;
};

/// Fitted rows: columns of the square lattice, each filled from the ground on. A wall's rows stand k + 1/2 spacings
/// below the surface; a fluid's column is divided into the whole number of rows that fits best between the ground and
/// the top of the domain, so that both have a row half a step away and every particle has its volume to 1/(2 rows).
std::vector<Vec3> fitted_wall(const Scene& scene, const BedShape& bed, double spacing);
std::vector<Vec3> fitted_fluid(const Scene& scene, const BedShape& bed, double spacing);

/// Why the ground is none for fitted rows of this spacing (m), or empty.
std::string misfit_of_ground(const Scene& scene, const BedShape& bed, double spacing);

/// Number of the fill whose fitted bed the fitted rows of a fluid stand on, or -1.
int fitted_bed(const Scene& scene, std::size_t fill);

}  // namespace barchan
