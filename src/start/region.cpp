#include "start/region.hpp"

#include <algorithm>
#include <cmath>
#include <memory>

#include "scene/couplings.hpp"
#include "start/outline.hpp"

namespace barchan {
namespace {

constexpr double far = 1e300;

double depth_in_box(const Vec3& x, const Vec3& lower, const Vec3& upper, const std::array<bool, 3>& counts) {
  double inside = far, outside2 = 0.0;
  for (std::size_t d = 0; d < 3; ++d) {
    if (!counts[d]) continue;
    const double depth = std::min(x[d] - lower[d], upper[d] - x[d]);
    inside = std::min(inside, depth);
    if (depth < 0.0) outside2 += depth * depth;
  }
  return outside2 > 0.0 ? -std::sqrt(outside2) : inside;
}

class SolidOf {
 public:
  SolidOf(const Scene& scene, double reach) : scene_(scene), reach_(reach), solid_(scene.dimensions == 3) {}

  std::optional<Solid> operator()(const BoxShape& box) const {
    // A box that goes round a periodic axis has no border across it.
    std::array<bool, 3> counts{true, true, solid_};
    for (std::size_t d = 0; d < 3; ++d)
      if (scene_.domain.periodic[d] && box.max[d] - box.min[d] >= (1.0 - 1e-9) * scene_.domain.size[d])
        counts[d] = false;
    return Solid{[box, counts](const Vec3& x) { return depth_in_box(x, box.min, box.max, counts); }, box.min, box.max};
  }
  std::optional<Solid> operator()(const DiscShape& disc) const { return round(disc.centre, 0.0, disc.radius, false); }
  std::optional<Solid> operator()(const RingShape& ring) const {
    return round(ring.centre, ring.inner, ring.outer, false);
  }
  std::optional<Solid> operator()(const SphereShape& ball) const {
    return round(ball.centre, 0.0, ball.radius, solid_);
  }
  std::optional<Solid> operator()(const PolygonShape& polygon) const { return closed(polygon); }
  std::optional<Solid> operator()(const SurfaceShape& surface) const { return closed(surface); }
  template <class Other>
  std::optional<Solid> operator()(const Other&) const {
    return std::nullopt;
  }

 private:
  std::optional<Solid> round(const Vec3& centre, double inner, double outer, bool ball) const {
    const double z = ball || !solid_ ? outer : far;
    return Solid{[=](const Vec3& x) {
                   Vec3 r = x - centre;
                   if (!ball) r[2] = 0.0;
                   const double distance = norm(r);
                   return inner > 0.0 ? std::min(outer - distance, distance - inner) : outer - distance;
                 },
                 centre - Vec3{outer, outer, z}, centre + Vec3{outer, outer, z}};
  }
  std::optional<Solid> closed(const Shape& shape) const {
    const int dimensions = facet_dimensions(shape);
    const auto outline = std::make_shared<const Outline>(facets_of(shape), dimensions, reach_);
    Solid solid{[outline](const Vec3& x) { return outline->depth(x); }, outline->lower(), outline->upper()};
    if (dimensions == 2 && solid_) {
      solid.lower[2] = -far;
      solid.upper[2] = far;
    }
    return solid;
  }

  const Scene& scene_;
  double reach_;
  bool solid_;
};

bool leaves_out(const Fill& fill) {
  return std::holds_alternative<RemainderShape>(fill.shape) || fill.leave_out == LeaveOut::earlier_fills;
}

}  // namespace

std::optional<Solid> solid_of(const Scene& scene, const Shape& shape, double reach) {
  return std::visit(SolidOf(scene, reach), shape);
}

std::function<double(const Vec3&)> depth_with_images(const Scene& scene, const Solid& solid, double reach) {
  std::vector<Vec3> shifts{{0, 0, 0}};
  for (std::size_t d = 0; d < 3; ++d) {
    if (!scene.domain.periodic[d] || solid.upper[d] >= far) continue;
    const double size = scene.domain.size[d], low = scene.domain.origin[d];
    const std::size_t count = shifts.size();
    for (const double way : {-size, size}) {
      if (solid.upper[d] + way < low - reach || solid.lower[d] + way > low + size + reach) continue;
      for (std::size_t i = 0; i < count; ++i) {
        shifts.push_back(shifts[i]);
        shifts.back()[d] += way;
      }
    }
  }
  return [depth = solid.depth, shifts](const Vec3& x) {
    double deepest = -far;
    for (const Vec3& shift : shifts) deepest = std::max(deepest, depth(x - shift));
    return deepest;
  };
}

Solid region_of_fill(const Scene& scene, std::size_t k, double reach) {
  const Fill& fill = scene.fills[k];
  const Vec3 low = scene.domain.origin, high = low + scene.domain.size;
  const bool rest = std::holds_alternative<RemainderShape>(fill.shape);
  Solid own = rest ? Solid{[](const Vec3&) { return far; }, {-far, -far, -far}, {far, far, far}}
                   : *solid_of(scene, fill.shape, reach);
  own.depth = depth_with_images(scene, own, reach);
  std::array<bool, 3> ends{};  // the domain's sides are borders of the region
  for (std::size_t d = 0; d < 3; ++d) {
    const bool axis = d < static_cast<std::size_t>(scene.dimensions);
    const bool through = axis && (own.upper[d] >= far ||
                                  (scene.domain.periodic[d] && own.upper[d] - own.lower[d] >= scene.domain.size[d]));
    ends[d] = through && !scene.domain.periodic[d];
    if (through) {
      own.lower[d] = low[d];
      own.upper[d] = high[d];
    }
  }
  std::vector<std::function<double(const Vec3&)>> holes;
  if (leaves_out(fill))
    for (std::size_t j = 0; j < k; ++j)
      if (const auto solid = solid_of(scene, scene.fills[j].shape, reach))
        holes.push_back(depth_with_images(scene, *solid, reach));
  own.depth = [depth = own.depth, holes, ends, low, high](const Vec3& x) {
    double least = std::min(depth(x), depth_in_box(x, low, high, ends));
    for (const auto& hole : holes) least = std::min(least, -hole(x));
    return least;
  };
  return own;
}

std::string misfit_of_region(const Scene& scene, std::size_t k) {
  const Fill& fill = scene.fills[k];
  const bool rest = std::holds_alternative<RemainderShape>(fill.shape);
  if (!rest && !solid_of(scene, fill.shape, 0.0))
    return "relaxed places follow a border; expected a box, disc, sphere, ring, polygon or surface, or \"the-rest\"";
  if (leaves_out(fill))
    for (std::size_t j = 0; j < k; ++j)
      if (!std::holds_alternative<SidesShape>(scene.fills[j].shape) && !solid_of(scene, scene.fills[j].shape, 0.0))
        return "fill." + std::to_string(j) +
               " has no border that relaxed places could follow; expected earlier fills of box, disc, sphere, ring, "
               "polygon, surface or sides";
  return "";
}

Vec3 way_out(const Solid& region, const Vec3& x, double step, int dimensions) {
  Vec3 out{};
  for (std::size_t d = 0; d < static_cast<std::size_t>(dimensions); ++d) {
    Vec3 before = x, after = x;
    before[d] -= step;
    after[d] += step;
    out[d] = (region.depth(before) - region.depth(after)) / (2.0 * step);
  }
  const double length = norm(out);
  return length > 0.5 ? 1.0 / length * out : Vec3{};
}

}  // namespace barchan
