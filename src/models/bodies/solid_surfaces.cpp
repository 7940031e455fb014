#include "models/bodies/solid_surfaces.hpp"

#include <algorithm>
#include <cmath>

#include "scene/couplings.hpp"
#include "start/outline.hpp"

namespace barchan {

namespace {

constexpr double endless = 1e30;

}  // namespace

void SolidSurface::go_through() {
  goes_through_ = true;
  low_[2] = -endless;
  high_[2] = endless;
}

SolidSurface SolidSurface::round(const Vec3& centre, double inner, double outer, bool goes_through) {
  Vec3 at = centre;
  if (goes_through) at[2] = 0.0;
  const Vec3 arm{outer, outer, outer};
  SolidSurface s(inner > 0.0 ? ContactSurface::ring(at, inner, outer) : ContactSurface::round(at, outer), at - arm,
                 at + arm);
  s.convex_ = !(inner > 0.0);
  if (goes_through) s.go_through();
  return s;
}

SolidSurface SolidSurface::of_facets(const std::vector<Facet>& facets, int dimensions, bool goes_through,
                                     double reach) {
  SolidSurface s{FacetSurface(facets, dimensions, reach)};
  const auto& form = std::get<FacetSurface>(s.form_);
  s.low_ = form.low();
  s.high_ = form.high();
  s.convex_ = false;
  if (goes_through) s.go_through();
  return s;
}

std::optional<SolidSurface> SolidSurface::of(const Shape& shape, const Scene& scene, double spacing, double reach) {
  const bool flat = scene.dimensions == 2;
  const auto box = [&](const Vec3& low, const Vec3& high) {
    Vec3 lowest = low, highest = high;
    if (flat) lowest[2] = -endless;
    if (flat) highest[2] = endless;
    return SolidSurface(ContactSurface::box(lowest, highest), lowest, highest);
  };
  if (const auto* b = std::get_if<BoxShape>(&shape)) return box(b->min, b->max);
  if (const auto* cube = std::get_if<CubeShape>(&shape)) {
    const double half = 0.5 * cube->count * spacing;
    return box(cube->centre - Vec3{half, half, half}, cube->centre + Vec3{half, half, half});
  }
  if (const auto* sphere = std::get_if<SphereShape>(&shape)) return round(sphere->centre, 0.0, sphere->radius, flat);
  if (const auto* disc = std::get_if<DiscShape>(&shape)) return round(disc->centre, 0.0, disc->radius, true);
  if (const auto* ring = std::get_if<RingShape>(&shape)) return round(ring->centre, ring->inner, ring->outer, true);
  if (const int dimensions = facet_dimensions(shape); dimensions > 0)
    return of_facets(facets_of(shape), dimensions, dimensions == 2, reach);
  return std::nullopt;
}

std::optional<Gap> SolidSurface::gap(const Vec3& x) const {
  if (const auto* facets = std::get_if<FacetSurface>(&form_)) return facets->gap(flat(x));
  return std::get<ContactSurface>(form_).gap(flat(x));
}

bool SolidSurface::may_be_near(const Vec3& x, double distance) const {
  for (std::size_t d = 0; d < 3; ++d)
    if (!(x[d] > low_[d] - distance && x[d] < high_[d] + distance)) return false;
  if (const auto* facets = std::get_if<FacetSurface>(&form_); facets && distance > facets->reach()) return true;
  const auto found = gap(x);
  return found && found->distance < distance;
}

std::uint32_t SolidSurfaces::add_solid() {
  solids_.emplace_back();
  return static_cast<std::uint32_t>(solids_.size() - 1);
}

std::uint32_t SolidSurfaces::add_surface(std::uint32_t solid, SolidSurface surface) {
  surfaces_.push_back({solid, std::move(surface)});
  return static_cast<std::uint32_t>(surfaces_.size() - 1);
}

void SolidSurfaces::move(std::uint32_t number, const RigidBody& start, const RigidBody& now) {
  Solid& solid = solids_[number];
  if (!solid.start) {
    solid.start.emplace(start);
    solid.first = start.first_place;
  }
  solid.now.emplace(now);
  solid.place = now.now.place;
}

Vec3 SolidSurfaces::to_start(const Solid& solid, const Vec3& x) const {
  return solid.now ? solid.first + solid.start->to_space(solid.now->to_own(x - solid.place)) : x;
}

Vec3 SolidSurfaces::to_now(const Solid& solid, const Vec3& direction) const {
  return solid.now ? solid.now->to_space(solid.start->to_own(direction)) : direction;
}

Vec3 SolidSurfaces::now(std::uint32_t number, const Vec3& start) const {
  const Solid& solid = solids_[number];
  return solid.now ? solid.place + to_now(solid, start - solid.first) : start;
}

Vec3 SolidSurfaces::arm(std::uint32_t number, const Vec3& x) const {
  Vec3 arm = x - solids_[number].place;
  for (std::size_t d = 0; d < 3; ++d)
    if (period_[d] > 0.0) arm[d] -= period_[d] * std::round(arm[d] / period_[d]);
  return arm;
}

/// Calls f with the place at the start of each image of x that may be nearer to the surface than `reach` (m).
template <class F>
void SolidSurfaces::each_image(const Surface& of, const Vec3& x, double reach, F&& f) const {
  const Solid& solid = solids_[of.solid];
  const Vec3 &low = of.surface.low(), &high = of.surface.high();
  Vec3 base = x;
  std::array<int, 3> first{}, last{};
  for (std::size_t d = 0; d < 3; ++d) {
    if (!(period_[d] > 0.0) || high[d] >= endless) continue;
    const double middle = solid.now ? solid.place[d] : 0.5 * (low[d] + high[d]);
    base[d] -= period_[d] * std::round((base[d] - middle) / period_[d]);
    first[d] = -1;
    last[d] = 1;
  }
  std::array<int, 3> turn{};
  for (turn[2] = first[2]; turn[2] <= last[2]; ++turn[2])
    for (turn[1] = first[1]; turn[1] <= last[1]; ++turn[1])
      for (turn[0] = first[0]; turn[0] <= last[0]; ++turn[0]) {
        Vec3 image = base;
        for (std::size_t d = 0; d < 3; ++d)
          if (turn[d] != 0) image[d] += turn[d] * period_[d];
        const Vec3 at = to_start(solid, image);
        bool near = true;
        for (std::size_t d = 0; d < 3; ++d) near = near && at[d] > low[d] - reach && at[d] < high[d] + reach;
        if (near) f(at);
      }
}

bool SolidSurfaces::may_be_near(std::size_t number, const Vec3& x, double distance) const {
  bool near = false;
  const Surface& of = surfaces_[number];
  each_image(of, x, distance, [&](const Vec3& at) { near = near || of.surface.may_be_near(at, distance); });
  return near;
}

double SolidSurfaces::distance(const Vec3& x, double reach, std::span<const std::uint16_t> surfaces) const {
  double least = reach;
  for (const std::uint16_t k : surfaces)
    each_image(surfaces_[k], x, reach, [&](const Vec3& at) {
      if (const auto gap = surfaces_[k].surface.gap(at)) least = std::min(least, gap->distance);
    });
  return least;
}

/// Whether a foot lies inside another surface.
bool SolidSurfaces::covered(const Vec3& foot, double radius, std::size_t except,
                            std::span<const std::uint16_t> surfaces) const {
  constexpr double inside = 1e-6;  // of the radius
  for (const std::uint16_t k : surfaces) {
    if (k == except || !surfaces_[k].surface.may_cover()) continue;
    bool covers = false;
    each_image(surfaces_[k], foot, 0.0, [&](const Vec3& at) {
      const auto gap = surfaces_[k].surface.gap(at);
      covers = covers || (gap && gap->distance < -inside * radius);
    });
    if (covers) return true;
  }
  return false;
}

std::size_t SolidSurfaces::touch(const Vec3& x, double radius, double reach, std::span<const std::uint16_t> surfaces,
                                 std::span<Contact> found, std::size_t count) const {
  const double same = agreement * radius;
  const std::size_t known = count;
  const bool alone = !(period_[0] > 0.0 || period_[1] > 0.0 || period_[2] > 0.0);  // without images
  const auto touched_by = [&](std::uint16_t k) {
    for (std::size_t q = known; q < count; ++q)
      if (found[q].surface == k) return true;
    return false;
  };
  for (; count < found.size(); ++count) {
    Contact best{{}, reach, 0, {}};
    bool any = false;
    for (const std::uint16_t k : surfaces) {
      const Surface& of = surfaces_[k];
      const Solid& solid = solids_[of.solid];
      if (alone && !of.surface.may_cover() && touched_by(k)) continue;  // a convex solid has one contact
      each_image(of, x, reach, [&](const Vec3& at) {
        Gap gap{best.distance, {}};
        of.surface.nearest(
            at,
            [&](const Gap& one) {
              const Vec3 normal = to_now(solid, one.normal);
              for (std::size_t q = 0; q < count; ++q)
                if (!(found[q].distance - one.distance * dot(found[q].normal, normal) > same)) return false;
              return !covered(x - one.distance * normal, radius, k, surfaces);
            },
            gap);
        if (!(gap.distance < best.distance)) return;
        any = true;
        const Vec3 normal = to_now(solid, gap.normal);
        best = {normal, gap.distance, k, -gap.distance * normal};
      });
    }
    if (!any) return count;
    found[count] = best;
    if (std::isinf(best.distance)) return count + 1;
  }
  return count;
}

}  // namespace barchan
