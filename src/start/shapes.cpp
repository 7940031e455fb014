#include "start/shapes.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

#include "base/errors.hpp"
#include "base/memory.hpp"
#include "scene/couplings.hpp"
#include "scene/formula.hpp"
#include "scene/keys.hpp"
#include "scene/located.hpp"
#include "scene/side_names.hpp"
#include "start/ball_surfaces.hpp"
#include "start/fitted.hpp"
#include "start/ground.hpp"
#include "start/lattice.hpp"
#include "start/outline.hpp"
#include "start/random.hpp"
#include "start/region.hpp"
#include "start/relaxed.hpp"

namespace barchan {
namespace {

/// The part of the domain in which the fill's lattice lives. Rows fill the nearest whole number of cells; other
/// packings keep half a spacing from sides that are not periodic.
ShapeRegion domain_region(const Scene& scene, Packing packing, double dx) {
  ShapeRegion region;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double low = scene.domain.origin[axis], size = scene.domain.size[axis];
    region.anchor[axis] = low + 0.5 * dx;
    region.lower[axis] = low;
    region.upper[axis] = packing == Packing::square ? low + cells_along(scene, axis, dx) * dx : low + size;
    if (packing != Packing::square && !scene.domain.periodic[axis]) {
      region.lower[axis] = low + 0.5 * dx;
      region.upper[axis] = low + size - (0.5 - 1e-6) * dx;
    }
  }
  region.inside = [](const Vec3&) { return true; };
  return region;
}

/// Bounds of a shape that may stick out of the domain, but not once around a periodic axis.
void bound(ShapeRegion& region, const Scene& scene, const Vec3& lower, const Vec3& upper, std::size_t axes) {
  for (std::size_t axis = 0; axis < axes; ++axis) {
    const bool periodic = scene.domain.periodic[axis];
    region.lower[axis] = periodic ? std::max(region.lower[axis], lower[axis]) : lower[axis];
    region.upper[axis] = periodic ? std::min(region.upper[axis], upper[axis]) : upper[axis];
  }
}

/// A round shape hangs on its centre, whatever the domain; `axes`: 2 for what goes through all of z.
void bound_round(ShapeRegion& region, const Vec3& centre, double radius, double spacing, std::size_t axes) {
  for (std::size_t axis = 0; axis < axes; ++axis) {
    region.anchor[axis] = centre[axis];
    region.lower[axis] = centre[axis] - radius - spacing;
    region.upper[axis] = centre[axis] + radius + spacing;
  }
}

class RegionOf {
 public:
  RegionOf(const Scene& scene, const Fill& fill)
      : scene_(scene), spacing_(spacing_of(scene, fill)), region_(domain_region(scene, fill.packing, spacing_)) {}
  ShapeRegion take() { return std::move(region_); }

  void operator()(const BoxShape& box) { bound(region_, scene_, box.min, box.max, scene_.dimensions == 3 ? 3 : 2); }
  void operator()(const DiscShape& disc) { round(disc.centre, -1.0, disc.radius, 2); }
  void operator()(const RingShape& ring) { round(ring.centre, ring.inner, ring.outer, 2); }
  void operator()(const SphereShape& sphere) { round(sphere.centre, -1.0, sphere.radius, 3); }
  void operator()(const PolygonShape& polygon) { closed(polygon); }
  void operator()(const SurfaceShape& surface) { closed(surface); }
  void operator()(const FormulaShape& shape) {
    region_.inside = [formula = std::make_shared<Formula>(shape.inside)](const Vec3& x) { return (*formula)(x) > 0.0; };
  }
  void operator()(const BedShape& bed) {
    const std::size_t up = up_axis(scene_.domain), across = across_axis(scene_.domain);
    const double bottom = scene_.domain.origin[up], slack = 1e-9 * spacing_;
    if (!bed.dune || bed.dune->form != DuneShape::Form::formula)
      region_.upper[up] = std::min(region_.upper[up], bottom + bed.depth + (bed.dune ? bed.dune->height : 0.0));
    region_.inside = [=, from = bed.from, ground = Ground(bed, scene_.domain)](const Vec3& x) {
      return x[up] - bottom < ground.height(x[0], x[across]) - slack && x[up] - bottom > from;
    };
  }
  void operator()(const RemainderShape&) {}
  void operator()(const CubeShape&) {}
  void operator()(const PointsShape&) {}
  void operator()(const FileShape&) {}
  void operator()(const SidesShape&) {}

 private:
  void closed(const Shape& shape) {
    const int dimensions = facet_dimensions(shape);
    const auto outline = std::make_shared<const Outline>(facets_of(shape), dimensions);
    bound(region_, scene_, outline->lower(), outline->upper(), static_cast<std::size_t>(dimensions));
    region_.inside = [outline](const Vec3& x) { return outline->inside(x); };
  }
  void round(const Vec3& centre, double inner, double outer, std::size_t axes) {
    if (scene_.dimensions == 2) axes = 2;
    const double slack = 1e-9 * spacing_;
    bound_round(region_, centre, outer, spacing_, axes);
    region_.inside = [=](const Vec3& x) {
      Vec3 r = x - centre;
      if (axes == 2) r[2] = 0.0;
      return norm(r) <= outer + slack && norm(r) >= inner - slack;
    };
  }
  const Scene& scene_;
  double spacing_;  // m
  ShapeRegion region_;
};

std::vector<Vec3> cube_places(const CubeShape& cube, int dimensions, double spacing) {
  std::vector<Vec3> places;
  const auto offset = [&](int i) { return (i - 0.5 * (cube.count - 1)) * spacing; };
  for (int j = 0; j < cube.count; ++j)
    for (int k = 0; k < (dimensions == 3 ? cube.count : 1); ++k)
      for (int i = 0; i < cube.count; ++i)
        places.push_back(cube.centre + Vec3{offset(i), offset(j), dimensions == 3 ? offset(k) : 0.0});
  return places;
}

/// Places of a lattice of the region. That of spheres is widened along periodic axes until whole rows fit.
std::vector<Vec3> stretched_lattice(const Scene& scene, const Fill& fill, const ShapeRegion& region, double dx,
                                    const ranks::Share& share) {
  const Phase* phase = find_phase(scene, fill.phase);
  if (!phase || !phase->diameter() || !hangs_on_origin(fill.shape))
    return lattice(fill.packing, scene.dimensions, dx, region.anchor, region.lower, region.upper, share);
  Vec3 stretch{1, 1, 1}, anchor = region.anchor, lower = region.lower, upper = region.upper;
  for (std::size_t axis = 0; axis < static_cast<std::size_t>(scene.dimensions); ++axis) {
    const double low = scene.domain.origin[axis], size = scene.domain.size[axis];
    const double period = period_of(fill.packing, scene.dimensions, axis, dx);
    if (scene.domain.periodic[axis] && size > period) {
      stretch[axis] = size / (std::floor(size / period * (1.0 + 1e-9)) * period);
      // Square cells were rounded to whole spacings; the stretched ones fill the domain.
      upper[axis] = std::min(upper[axis], low + size);
    }
    if (!scene.domain.periodic[axis]) {  // whole spheres inside
      lower[axis] = std::max(lower[axis], low + (0.5 - 1e-6) * dx);
      upper[axis] = std::min(upper[axis], low + size - (0.5 - 1e-6) * dx);
    }
    const auto shrunk = [&](double x) { return low + (x - low) / stretch[axis]; };
    lower[axis] = shrunk(lower[axis]);
    upper[axis] = shrunk(upper[axis]);
  }
  std::vector<Vec3> places = lattice(fill.packing, scene.dimensions, dx, anchor, lower, upper);
  for (Vec3& x : places)
    for (std::size_t axis = 0; axis < 3; ++axis)
      x[axis] = scene.domain.origin[axis] + (x[axis] - scene.domain.origin[axis]) * stretch[axis];
  return places;
}

/// Refuses what no memory holds. cells: places that a lattice of the spacing has in the fill's bounds.
void check_room(const Scene& scene, std::size_t k, double cells) {
  const Fill& fill = scene.fills[k];
  if (!(cells <= 1e9))
    throw SceneError(located(scene, "fill." + std::to_string(k)) + ": more than 10^9 particles of phase \"" +
                     fill.phase + "\"; expected a larger spacing or a smaller shape");
  // Of a shape that fills its bounds: the particle's place, velocity and id, and what a sort writes them into.
  const bool fills_bounds =
      std::holds_alternative<BoxShape>(fill.shape) || std::holds_alternative<RemainderShape>(fill.shape);
  const double least = fills_bounds ? 150.0 : sizeof(Vec3);  // bytes a cell
  const double bytes = cells * least * ranks::share_of_machine();
  if (const AvailableMemory there = available_memory(); bytes > there.bytes)
    throw SceneError(located(scene, "fill." + std::to_string(k)) + ": room for " +
                     std::to_string(static_cast<long>(cells)) + " particles of phase \"" + fill.phase + "\" takes " +
                     memory_text(bytes) + " at least, " + there.of + " leaves " + memory_text(there.bytes) +
                     "; expected a larger spacing or a smaller shape");
}

/// Refuses a shape that goes on beyond the domain, before its places are made. A wall may.
void refuse_outside(const Scene& scene, std::size_t k, const Vec3& lower, const Vec3& upper) {
  constexpr double slack = 2.0;  // spacings: round shapes have bounds one wider than they are
  const Fill& fill = scene.fills[k];
  const Phase* const phase = find_phase(scene, fill.phase);
  if (!phase || phase->if_wall()) return;
  for (std::size_t axis = 0; axis < static_cast<std::size_t>(scene.dimensions); ++axis) {
    const double low = scene.domain.origin[axis], high = low + scene.domain.size[axis],
                 dx = slack * spacing_of(scene, fill);
    if (scene.domain.periodic[axis] || (lower[axis] > low - dx && upper[axis] < high + dx)) continue;
    throw SceneError(located(scene, "fill." + std::to_string(k)) + ": the shape of phase \"" + fill.phase +
                     "\" goes from " + number_text(lower[axis]) + " to " + number_text(upper[axis]) + " m along " +
                     "xyz"[axis] + " and lies outside the domain, " + number_text(low) + " to " + number_text(high) +
                     " m; expected a shape inside it");
  }
}

/// Cells between two corners.
double cells_between(const Scene& scene, const Vec3& lower, const Vec3& upper, double dx) {
  double cells = 1.0;
  for (std::size_t axis = 0; axis < static_cast<std::size_t>(scene.dimensions); ++axis)
    cells *= std::max(0.0, upper[axis] - lower[axis]) / dx;
  return cells;
}

/// Random sequential addition. `none`: where spheres have no room, or null.
std::vector<Vec3> random_places(const Scene& scene, const ShapeRegion& region, double cells, unsigned seed, double dx,
                                const Occupied& occupied, const NoRoom* none) {
  const PeriodicSpace space(scene.domain);
  Random random(seed);
  Places taken(space, dx);
  std::vector<Vec3> places;
  const long trials = static_cast<long>(std::ceil(200.0 * cells));
  for (long trial = 0; trial < trials; ++trial) {
    Vec3 x{};
    for (std::size_t axis = 0; axis < static_cast<std::size_t>(scene.dimensions); ++axis)
      x[axis] = random.uniform(region.lower[axis], region.upper[axis]);
    if (!region.inside(x)) continue;
    x = space.wrapped(x);
    if (none && none->at(x)) continue;
    if (taken.owner_near(x, dx, 1.0) >= 0 || occupied.inside.owner_near(x, dx, 1.0) >= 0) continue;
    taken.add(x, dx, 0);
    places.push_back(x);
  }
  return places;
}

/// Depth in the earlier fills of solids whose border is known (m): the places between their rows are theirs, too. In 3D
/// the middle between eight of them is farther than rest_distance from all.
std::function<double(const Vec3&)> depth_in_solids(const Scene& scene, std::size_t k, double dx) {
  std::vector<std::function<double(const Vec3&)>> depths;
  for (std::size_t j = 0; j < k; ++j) {
    const Phase* const phase = find_phase(scene, scene.fills[j].phase);
    if (!phase || std::holds_alternative<FluidKeys>(phase->own) || phase->if_grains()) continue;
    if (const auto solid = solid_of(scene, scene.fills[j].shape, dx))
      depths.push_back(depth_with_images(scene, *solid, dx));
  }
  return [depths](const Vec3& x) {
    double deepest = -1e300;
    for (const auto& depth : depths) deepest = std::max(deepest, depth(x));
    return deepest;
  };
}

/// Of grains that are spheres: where walls and bodies leave no room for the largest.
std::optional<NoRoom> no_room_for_spheres(const Scene& scene, std::size_t k) {
  const Phase* const phase = find_phase(scene, scene.fills[k].phase);
  if (!phase || !phase->if_grains() || !phase->diameter()) return std::nullopt;
  return NoRoom(scene, *phase, 0.5 * phase->diameter()->largest());
}

/// Lattice places over the ground and outside of solids that keep their distance from what is there. Spheres keep it
/// whole: none overlaps another or a surface.
void keep_the_rest(std::vector<Vec3>& places, const Scene& scene, std::size_t k, double dx, const Occupied& occupied) {
  const bool over_ground = std::any_of(scene.fills.begin(), scene.fills.begin() + static_cast<std::ptrdiff_t>(k),
                                       [](const Fill& fill) { return std::holds_alternative<BedShape>(fill.shape); });
  const Ground ground(scene);
  const std::size_t up = up_axis(scene.domain), across = across_axis(scene.domain);
  const double slack = 1e-9 * dx;
  const auto depth = depth_in_solids(scene, k, dx);
  std::erase_if(places, [&](const Vec3& x) { return depth(x) > 0.25 * dx; });
  const auto none = no_room_for_spheres(scene, k);
  if (none) std::erase_if(places, [&](const Vec3& x) { return none->at(x); });
  leave_out(places, occupied.by_all, [&](const Vec3& x) {
    if (over_ground && x[up] - scene.domain.origin[up] < ground.height(x[0], x[across]) - slack) return true;
    return occupied.is_taken(x, dx, none ? 1.0 : rest_distance);
  });
}

}  // namespace

ShapeRegion region_of_shape(const Scene& scene, const Fill& fill) {
  RegionOf region_of(scene, fill);
  std::visit(region_of, fill.shape);
  return region_of.take();
}

void keep_inside(const Scene& scene, std::size_t k, SettledGrains& grains) {
  ShapeRegion region = region_of_shape(scene, scene.fills[k]);
  // A shape without sides of its own goes on to those of the domain, and keeps what lies there: the middles of small
  // grains are nearer to them than the last place of a row of the largest.
  const Shape& shape = scene.fills[k].shape;
  const bool goes_on = std::holds_alternative<BedShape>(shape) || std::holds_alternative<FormulaShape>(shape) ||
                       std::holds_alternative<RemainderShape>(shape);
  for (std::size_t d = 0; goes_on && d < static_cast<std::size_t>(scene.dimensions); ++d) {
    const double high = scene.domain.origin[d] + scene.domain.size[d];
    if (d != up_axis(scene.domain) && region.upper[d] > high - spacing_of(scene, scene.fills[k]))
      region.upper[d] = high;
  }
  std::vector<Vec3>& places = grains.position;
  constexpr std::size_t gone = static_cast<std::size_t>(-1);
  std::vector<std::size_t> number(places.size(), gone);
  std::size_t kept = 0;
  for (std::size_t i = 0; i < places.size(); ++i) {
    bool inside = region.inside(places[i]);
    for (std::size_t d = 0; d < static_cast<std::size_t>(scene.dimensions); ++d)
      inside = inside && places[i][d] >= region.lower[d] - scene.spacing && places[i][d] <= region.upper[d];
    if (!inside) continue;
    number[i] = kept;
    places[kept] = places[i];
    grains.radius[kept++] = grains.radius[i];
  }
  places.resize(kept);
  grains.radius.resize(kept);
  std::erase_if(grains.contacts, [&](const RestingContact& c) { return number[c.sphere] == gone; });
  for (RestingContact& c : grains.contacts) c.sphere = number[c.sphere];
}

double reach_of_overlaps(const Scene& scene, std::size_t k) {
  double widest = 0.0;
  for (const Fill& fill : scene.fills) widest = std::max(widest, spacing_of(scene, fill));
  return 1.01 * widest + scene.fills[k].perturb * spacing_of(scene, scene.fills[k]) * std::sqrt(3.0);
}

std::vector<Vec3> places_of(const Scene& scene, std::size_t k, Occupied& occupied,
                            const std::optional<ranks::Share>& share) {
  const Fill& fill = scene.fills[k];
  const double dx = spacing_of(scene, fill);
  std::vector<Vec3> places;
  if (fill.packing == Packing::fitted) {
    const int below = fitted_bed(scene, k);
    if (const auto* bed = std::get_if<BedShape>(&fill.shape)) {
      places = fitted_wall(scene, *bed, dx);
    } else if (below >= 0) {
      places = fitted_fluid(scene, std::get<BedShape>(scene.fills[static_cast<std::size_t>(below)].shape), dx);
      leave_out(places, occupied.by_all, [&](const Vec3& x) { return occupied.is_taken(x, dx, rest_distance, below); });
    }
  } else if (fill.packing == Packing::relaxed) {
    const Solid region = region_of_fill(scene, k, 0.0);
    refuse_outside(scene, k, region.lower, region.upper);
    check_room(scene, k, cells_between(scene, region.lower, region.upper, dx));
    places = relaxed_places(scene, k);
  } else if (const auto* points = std::get_if<PointsShape>(&fill.shape)) {
    places = points->at;
  } else if (const auto* cube = std::get_if<CubeShape>(&fill.shape)) {
    places = cube_places(*cube, scene.dimensions, dx);
  } else if (const auto* sides = std::get_if<SidesShape>(&fill.shape)) {
    places = rows_outside(scene, *sides, dx);
    std::erase_if(places, [&](const Vec3& x) { return occupied.outside.owner_near(x, dx, overlap_distance) >= 0; });
  } else {
    const ShapeRegion region = region_of_shape(scene, fill);
    refuse_outside(scene, k, region.lower, region.upper);
    const double cells = cells_between(scene, region.lower, region.upper, dx);
    check_room(scene, k, cells);
    if (fill.packing == Packing::random) {
      const auto none = no_room_for_spheres(scene, k);
      places = random_places(scene, region, cells, fill.seed, dx, occupied, none ? &*none : nullptr);
    } else {
      places = stretched_lattice(scene, fill, region, dx, share.value_or(ranks::Share{}));
      std::erase_if(places, [&](const Vec3& x) { return !region.inside(x); });
      if (share) occupied.ask_near(places, reach_of_overlaps(scene, k));
    }
    if (std::holds_alternative<RemainderShape>(fill.shape) || fill.leave_out == LeaveOut::earlier_fills)
      keep_the_rest(places, scene, k, dx, occupied);
  }
  const PeriodicSpace space(scene.domain);
  for (Vec3& x : places) x = space.wrapped(x);
  return places;
}

}  // namespace barchan
