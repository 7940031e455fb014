// What a fill may take as a region with a border: how deep a place lies in it. Internal to src/start.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "scene/scene.hpp"

namespace barchan {

/// A body of known border. Depths are exact near the border, and have the right sign everywhere.
struct Solid {
  std::function<double(const Vec3&)> depth;  // m, positive inside
  Vec3 lower{}, upper{};                     // m; without bounds along z where it goes through all of z
};

/// Nothing for a shape whose border is not known: bed, cube, points, formula, sides. `reach` (m): as far as the depth
/// must be exact.
std::optional<Solid> solid_of(const Scene& scene, const Shape& shape, double reach);

/// The depth in the deepest of the solid's images in the periodic domain that come near it.
std::function<double(const Vec3&)> depth_with_images(const Scene& scene, const Solid& solid, double reach);

/// The k-th fill's shape, inside the domain along axes through which it goes, less earlier fills if it leaves them out.
/// All of its fills must have a border (misfit_of_region is empty).
Solid region_of_fill(const Scene& scene, std::size_t k, double reach);

/// Why the k-th fill is no such region, or empty.
std::string misfit_of_region(const Scene& scene, std::size_t k);

/// The way out of the region at x: a unit vector, by differences over `step` (m); zero where no way is the shortest.
Vec3 way_out(const Solid& region, const Vec3& x, double step, int dimensions);

}  // namespace barchan
