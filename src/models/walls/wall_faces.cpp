#include "models/walls/wall_faces.hpp"

#include <algorithm>

#include "models/bodies/contact_surface.hpp"

namespace barchan {

namespace {

/// Whether a place is on a side of the domain: what ends there does not end where a fluid is.
bool on_a_side(const Bounds& bounds, const Vec3& x, double spacing) {
  const double margin = 0.5 * spacing;
  for (std::size_t d = 0; d < static_cast<std::size_t>(bounds.dimensions); ++d)
    if (x[d] < bounds.low[d] + margin || x[d] > bounds.high[d] - margin) return true;
  return false;
}

/// Of a particle that is nearest to a face on a side of the domain, `below` under it: the face that meets it and is
/// within a spacing or as near; depth zero if there is none. The particles in the edge between the two lie as deep
/// under both, and round-off must not decide.
WallFace face_next_to(const ContactSurface& surface, const Bounds& bounds, const Vec3& x, const Vec3& side,
                      double below, double spacing) {
  const auto gap = surface.gap(x - spacing * side);
  if (!gap || !(gap->distance < 0.0)) return {};
  const Vec3 foot = x - spacing * side - gap->distance * gap->normal;
  const double depth = dot(foot - x, gap->normal), most = std::max(spacing, below) * (1.0 + 1e-9);
  if (!(depth > 0.0 && depth <= most) || on_a_side(bounds, foot, spacing)) return {};
  return {gap->normal, depth};
}

}  // namespace

std::vector<WallFace> outline_faces(const Scene& scene, const Layout& layout, std::size_t number,
                                    const std::vector<Vec3>& places, double reach) {
  std::vector<WallFace> faces(places.size());
  const double spacing = layout.phases[number].spacing;
  const auto own = [&](const Fill& fill) { return fill.phase == layout.phases[number].name; };
  if (std::count_if(scene.fills.begin(), scene.fills.end(), own) != 1) return faces;
  const auto fill = std::find_if(scene.fills.begin(), scene.fills.end(), own);
  std::vector<ContactSurface> surfaces = surfaces_of(fill->shape, scene, spacing);
  for (ContactSurface& surface : surfaces) surface.prepare(reach + spacing, spacing);
  for (std::size_t k = 0; k < places.size(); ++k)
    for (const ContactSurface& surface : surfaces) {
      WallFace& face = faces[k];
      const auto gap = surface.gap(places[k]);
      if (!gap || !(gap->distance < 0.0) || -gap->distance > reach) continue;
      if (face.depth > 0.0 && -gap->distance > face.depth) continue;
      if (!on_a_side(layout.bounds, places[k] - gap->distance * gap->normal, spacing))
        face = {gap->normal, -gap->distance};
      else if (const WallFace next =
                   face_next_to(surface, layout.bounds, places[k], gap->normal, -gap->distance, spacing);
               next.depth > 0.0)
        face = next;
    }
  return faces;
}

}  // namespace barchan
