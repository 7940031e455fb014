#include "models/bodies/body_border.hpp"

#include <algorithm>

#include "models/bodies/border_points.hpp"

namespace barchan {

BodyBorder::BodyBorder(const RigidBody& body, const Scene& scene, double spacing, double width, double reach)
    : first_place_(body.first_place), first_(body) {
  const Shape& shape = scene.fills[body.fill].shape;
  surfaces_ = surfaces_of(shape, scene, spacing);
  for (ContactSurface& surface : surfaces_) {
    surface.prepare(reach, spacing);
    for (const TouchPoint& probe : surface.probes())
      reach_ = std::max(reach_, norm(probe.at - first_place_) + probe.radius);
  }
  for (const BorderPoint& p : border_points(shape, scene.dimensions, spacing, width))
    pieces_.push_back({first_.to_own(p.at - first_place_), first_.to_own(p.normal), p.content});
}

std::optional<Gap> BodyBorder::gap(const OwnAxes& now, const Vec3& arm) const {
  const Vec3 at = first_place_ + first_.to_space(now.to_own(arm));
  std::optional<Gap> nearest;
  for (const ContactSurface& surface : surfaces_)
    if (const auto gap = surface.gap(at); gap && !(nearest && nearest->distance <= gap->distance)) nearest = gap;
  if (nearest) nearest->normal = now.to_space(first_.to_own(nearest->normal));
  return nearest;
}

}  // namespace barchan
