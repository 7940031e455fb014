#include "start/ball_surfaces.hpp"

#include <algorithm>

#include "scene/couplings.hpp"
#include "scene/side_names.hpp"
#include "start/outline.hpp"
#include "start/region.hpp"

namespace barchan {

namespace {

/// m, positive behind the side.
std::function<double(const Vec3&)> depth_behind(const Domain& domain, const std::string& side) {
  const auto [axis, upper] = side_at(domain, side);
  const double place = domain.origin[axis] + (upper ? domain.size[axis] : 0.0);
  return [axis = axis, upper = upper, place](const Vec3& x) { return upper ? x[axis] - place : place - x[axis]; };
}

/// Depths of shapes of facets are exact as far as the cells that hold the facets: these are not much smaller than the
/// shape.
double reach_of(const Shape& shape, double radius) {
  constexpr double cells = 64.0;
  Vec3 low{1e300, 1e300, 1e300}, high{-1e300, -1e300, -1e300};
  for (const Facet& facet : facets_of(shape))
    for (const Vec3& corner : facet)
      for (std::size_t d = 0; d < 3; ++d) {
        low[d] = std::min(low[d], corner[d]);
        high[d] = std::max(high[d], corner[d]);
      }
  return std::max({radius, (high[0] - low[0]) / cells, (high[1] - low[1]) / cells, (high[2] - low[2]) / cells});
}

}  // namespace

NoRoom::NoRoom(const Scene& scene, const Phase& spheres, double radius) : radius_(radius) {
  for (const Fill& fill : scene.fills) {
    const Phase* const phase = find_phase(scene, fill.phase);
    const Interaction* const pair = phase ? entry_between(scene, spheres, *phase) : nullptr;
    if (!pair || !of_spheres(*pair)) continue;
    if (const auto* sides = std::get_if<SidesShape>(&fill.shape)) {
      for (const std::string& side : sides->sides) depths_.push_back(depth_behind(scene.domain, side));
      continue;
    }
    if (phase->kind() != PhaseKind::rigid && !touched_by_surface(scene, *phase, fill.shape)) continue;
    Shape shape = fill.shape;
    if (const auto* cube = std::get_if<CubeShape>(&fill.shape)) {
      const double half = 0.5 * cube->count * phase->spacing;
      shape = BoxShape{cube->centre - Vec3{half, half, half}, cube->centre + Vec3{half, half, half}};
    }
    const double reach = reach_of(shape, radius);
    if (const auto solid = solid_of(scene, shape, reach)) depths_.push_back(depth_with_images(scene, *solid, reach));
  }
}

bool NoRoom::at(const Vec3& x) const {
  constexpr double rounding = 1e-9;
  for (const auto& depth : depths_)
    if (depth(x) > -radius_ * (1.0 - rounding)) return true;
  return false;
}

static bool is_prism(const Shape& shape) {
  return std::holds_alternative<DiscShape>(shape) || std::holds_alternative<RingShape>(shape) ||
         facet_dimensions(shape) == 2;
}

bool moves_as_rows(const Scene& scene, const Phase& wall, const Shape& shape) {
  return wall.if_wall() && !wall.diameter() && scene.dimensions == 3 && is_prism(shape) && motion_of(scene, wall);
}

bool touched_by_surface(const Scene& scene, const Phase& wall, const Shape& shape) {
  if (!wall.if_wall() || wall.diameter()) return false;
  if (is_prism(shape)) return !moves_as_rows(scene, wall, shape);
  return std::holds_alternative<BoxShape>(shape) || std::holds_alternative<CubeShape>(shape) ||
         std::holds_alternative<SphereShape>(shape) || facet_dimensions(shape) == 3;
}

}  // namespace barchan
