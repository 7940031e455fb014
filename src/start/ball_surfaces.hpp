// Shapes of walls and bodies as spheres meet them.
#pragma once

#include <functional>
#include <vector>

#include "scene/scene.hpp"

namespace barchan {

/// Whether spheres touch a fill of the wall by the surface of its shape: the wall has no `diameter`, and the shape says
/// where its surface lies. Else they touch its particles, as spheres. In 3D a shape that goes through all of z has no
/// ends, and is particles where a [[motion]] carries it.
bool touched_by_surface(const Scene& scene, const Phase& wall, const Shape& shape);
/// Whether the shape goes through all of z and a [[motion]] carries the wall, which has no `diameter`.
bool moves_as_rows(const Scene& scene, const Phase& wall, const Shape& shape);

/// Where spheres of a phase have no place: sides of the domain that hold them, walls that they touch by surfaces, and
/// rigid bodies, at the start.
class NoRoom {
 public:
  /// `radius` (m): of the largest sphere.
  NoRoom(const Scene& scene, const Phase& spheres, double radius);
  /// Whether a sphere at x would overlap one of them.
  bool at(const Vec3& x) const;

 private:
  double radius_;
  std::vector<std::function<double(const Vec3&)>> depths_;  // m, positive inside
};

}  // namespace barchan
