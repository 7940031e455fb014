// What the shape of a fill holds, whatever the spacing of its particles. Internal to src/start but for the plan.
#pragma once

#include <optional>
#include <vector>

#include "scene/scene.hpp"
#include "start/content.hpp"

namespace barchan {

/// How much work an integral over a shape may be. With the fine one mass and inertia of bodies of one to 40 spacings
/// were within 5e-4.
struct Sampling {
  double nodes, samples;
};
inline constexpr Sampling fine_sampling{3e5, 2e5}, rough_sampling{1e5, 5e4};

/// Of the k-th fill's shape; on periodic axes no more than once around. Exact of box, disc, sphere, ring, polygon,
/// surface and cube. Integrated on cells and points of a low-discrepancy sequence (Roberts 2018) where the cells are
/// cut by the border: of a formula, a bed, "the-rest", and of shapes that leave out earlier fills. `places` (m): those
/// of its particles, beyond a spacing of which nothing is looked for.
/// Nothing of points, a file and sides, or where the shape has no content.
std::optional<Content> content_of_fill(const Scene& scene, std::size_t k, const std::vector<Vec3>& places,
                                       const Sampling& sampling = fine_sampling);

/// Of the k-th fill as a rigid body: of its shape, or of its particles as points where the shape has none; with the
/// centre of mass that the fill says. On periodic axes the image that is nearest to the particles.
Content content_of_body(const Scene& scene, std::size_t k, const std::vector<Vec3>& places);

}  // namespace barchan
