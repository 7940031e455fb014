#include "simulation/settle_room.hpp"

#include <algorithm>
#include <array>
#include <optional>

#include "base/errors.hpp"
#include "output/numbers.hpp"
#include "scene/couplings.hpp"
#include "scene/located.hpp"
#include "scene/side_names.hpp"
#include "start/ground.hpp"
#include "start/shapes.hpp"

namespace barchan {

namespace {

// Places along x, in 3D a tenth of them along the third axis too, at which the heights of beds are asked.
constexpr int samples_across = 400;

template <class F>
void each_column(const Scene& scene, F&& f) {
  const int across = scene.dimensions == 3 ? samples_across / 10 : 1;
  const std::size_t third = across_axis(scene.domain);
  for (int k = 0; k < across; ++k)
    for (int i = 0; i <= samples_across; ++i)
      f(scene.domain.origin[0] + scene.domain.size[0] * i / samples_across,
        scene.domain.origin[third] + scene.domain.size[third] * (k + 0.5) / across);
}

/// The height of a bed over the bottom of the domain where it is highest (m).
double highest(const BedShape& bed, const Scene& scene) {
  if (!bed.dune || bed.dune->form != DuneShape::Form::formula) return bed.depth + (bed.dune ? bed.dune->height : 0.0);
  const Ground ground(bed, scene.domain);
  double most = bed.depth;
  each_column(scene, [&](double x, double z) { most = std::max(most, ground.height(x, z)); });
  return most;
}

}  // namespace

SettlingRoom settling_room(const Scene& scene, std::size_t k) {
  const Fill& fill = scene.fills[k];
  SettlingRoom c;
  c.low = scene.domain.origin;
  c.high = scene.domain.origin + scene.domain.size;
  const std::size_t up = up_axis(scene.domain);
  c.from = c.low[up];
  if (const auto* box = std::get_if<BoxShape>(&fill.shape)) {
    for (std::size_t d = 0; d < static_cast<std::size_t>(scene.dimensions); ++d) {
      if (d != up) c.low[d] = std::max(c.low[d], box->min[d]);
      c.high[d] = std::min(c.high[d], box->max[d]);
    }
    c.from = std::max(c.low[up], box->min[up]);
  } else if (const auto* bed = std::get_if<BedShape>(&fill.shape)) {
    c.high[up] = c.low[up] + highest(*bed, scene);
    c.from = c.low[up] + bed->from;
    if (c.high[up] > scene.domain.origin[up] + scene.domain.size[up])
      throw SceneError(located(scene, "fill." + std::to_string(k)) + ": the bed is up to " +
                       brief(c.high[up] - c.low[up]) + " m high, higher than the domain; expected a lower dune");
  }
  return c;
}

namespace {

/// Where the grains of a settled fill stand.
struct Extent {
  Extent(const Scene& scene, std::size_t k)
      : room(settling_room(scene, k)), up(up_axis(scene.domain)), third(3 - up), bottom(scene.domain.origin[up]) {
    if (const auto* bed = std::get_if<BedShape>(&scene.fills[k].shape)) ground.emplace(*bed, scene.domain);
  }
  /// {from, to} (m) in a column; to < from: nowhere.
  std::array<double, 2> in_column(double x, double z) const {
    const Vec3 &low = room.low, &high = room.high;
    const bool beside =
        x <= low[0] || x >= high[0] || (high[third] > low[third] && (z <= low[third] || z >= high[third]));
    if (beside) return {1.0, 0.0};
    return {room.from, ground ? bottom + ground->height(x, z) : high[up]};
  }
  SettlingRoom room;
  std::size_t up, third;
  std::optional<Ground> ground;
  double bottom;
};

}  // namespace

void refuse_beds_in_one_place(const Scene& scene) {
  const auto settles = [&](std::size_t k) {
    return scene.fills[k].packing == Packing::settled && !std::holds_alternative<FileShape>(scene.fills[k].shape);
  };
  for (std::size_t b = 0; b < scene.fills.size(); ++b)
    for (std::size_t a = 0; a < b; ++a) {
      if (!settles(a) || !settles(b)) continue;
      const double d = find_phase(scene, scene.fills[b].phase)->diameter()->mean;
      double deepest = 0.0, at = 0.0;
      const Extent one(scene, a), other(scene, b);
      each_column(scene, [&](double x, double z) {
        const auto p = one.in_column(x, z), q = other.in_column(x, z);
        const double both = std::min(p[1], q[1]) - std::max(p[0], q[0]);
        if (both > deepest) deepest = both, at = x;
      });
      if (deepest > d)
        throw SceneError(
            located(scene, "fill." + std::to_string(b)) + ": its grains settle where those of fill." +
            std::to_string(a) + " do, by " + brief(deepest) + " m at x = " + brief(at) +
            " m; expected beds side by side, one over the other (from), or one bed with a dune by formula");
    }
}

}  // namespace barchan
