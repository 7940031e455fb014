#include "models/bodies/contact_surface.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <set>

#include "scene/couplings.hpp"
#include "start/outline.hpp"

namespace barchan {

namespace {

/// A unit vector, or `otherwise` where it has no length.
Vec3 unit(const Vec3& v, const Vec3& otherwise) {
  const double size = norm(v);
  return size > 0.0 ? 1.0 / size * v : otherwise;
}

}  // namespace

PolygonOutline::PolygonOutline(const std::vector<Facet>& segments) {
  for (const Facet& segment : segments)
    if (segment[0] != segment[1]) edges_.push_back({segment[0], segment[1], {}, {}});
  turn_outwards();
}

/// Normals of the edges; at a corner the mean of both decides on which side a place is (Baerentzen & Aanaes 2005).
void PolygonOutline::turn_outwards() {
  std::map<Vec3, Vec3> at_corners;
  for (Edge& edge : edges_) {
    const Vec3 along = edge.to - edge.from, middle = edge.from + 0.5 * along;
    edge.normal = 1.0 / norm(along) * Vec3{along[1], -along[0], 0.0};
    if (holds(middle + 1e-6 * norm(along) * edge.normal)) edge.normal = -1.0 * edge.normal;
    for (const Vec3& end : {edge.from, edge.to}) {
      Vec3& sum = at_corners[end];
      sum = sum + edge.normal;
    }
  }
  for (Edge& edge : edges_) edge.end_normals = {at_corners[edge.from], at_corners[edge.to]};
}

std::vector<Vec3> PolygonOutline::corners() const {
  std::set<Vec3> all;
  for (const Edge& edge : edges_) {
    all.insert(edge.from);
    all.insert(edge.to);
  }
  return {all.begin(), all.end()};
}

PolygonOutline::Foot PolygonOutline::foot_on(const Edge& edge, const Vec3& x) {
  const Vec3 along = edge.to - edge.from;
  const double share = std::clamp(dot(x - edge.from, along) / dot(along, along), 0.0, 1.0);
  const Vec3 at = edge.from + share * along, r = x - at;
  return {r[0] * r[0] + r[1] * r[1], at, share};
}

bool PolygonOutline::holds(const Vec3& x) const {
  bool inside = false;
  for (const Edge& edge : edges_) {
    const Vec3 &a = edge.from, &b = edge.to;
    if ((a[1] > x[1]) != (b[1] > x[1]) && x[0] < (b[0] - a[0]) * (x[1] - a[1]) / (b[1] - a[1]) + a[0]) inside = !inside;
  }
  return inside;
}

double PolygonOutline::nearest_among(const Vec3& x, const std::vector<std::uint32_t>& edges) const {
  double nearest = 1e300;
  for (const std::uint32_t e : edges) nearest = std::min(nearest, foot_on(edges_[e], x).distance2);
  return std::sqrt(nearest);
}

/// A cell knows the edges that can be the nearest one of any place in it; `edges` holds those at least.
void PolygonOutline::make_cell(const Vec3& middle, double reach, const std::vector<std::uint32_t>& edges) {
  const double half = width_ * std::sqrt(0.5), nearest = nearest_among(middle, edges);
  begin_.push_back(static_cast<std::uint32_t>(near_.size()));
  const bool far = nearest > reach + half;
  deep_.push_back(far && holds(middle) ? 1 : 0);
  if (far) return;
  for (const std::uint32_t e : edges)
    if (std::sqrt(foot_on(edges_[e], middle).distance2) <= nearest + 2.0 * half) near_.push_back(e);
}

void PolygonOutline::prepare(double reach, double spacing) {
  std::array<double, 2> size{};
  for (std::size_t d = 0; d < 2; ++d) {
    double low = 1e300, high = -1e300;
    for (const Edge& edge : edges_) {
      low = std::min({low, edge.from[d], edge.to[d]});
      high = std::max({high, edge.from[d], edge.to[d]});
    }
    low_[d] = low - reach;
    size[d] = high - low + 2.0 * reach;
  }
  width_ = std::max(0.5 * spacing, std::max(size[0], size[1]) / 512.0);
  for (std::size_t d = 0; d < 2; ++d) count_[d] = static_cast<std::size_t>(size[d] / width_) + 1;
  // Of a row of cells first those of blocks of `side` cells, so that a cell looks at few edges.
  constexpr std::size_t side = 16;
  const auto middle = [&](double i, double j) { return Vec3{low_[0] + i * width_, low_[1] + j * width_, 0.0}; };
  std::vector<std::uint32_t> all(edges_.size());
  std::iota(all.begin(), all.end(), 0u);
  std::vector<std::vector<std::uint32_t>> blocks(count_[0] / side + 1);
  for (std::size_t j = 0; j < count_[1]; ++j) {
    for (std::size_t b = 0; b < blocks.size() && j % side == 0; ++b) {
      const Vec3 centre = middle((static_cast<double>(b) + 0.5) * side, static_cast<double>(j) + 0.5 * side);
      const double nearest = nearest_among(centre, all), across = width_ * side * std::sqrt(2.0);
      blocks[b].clear();
      for (const std::uint32_t e : all)
        if (std::sqrt(foot_on(edges_[e], centre).distance2) <= nearest + across) blocks[b].push_back(e);
    }
    for (std::size_t i = 0; i < count_[0]; ++i)
      make_cell(middle(static_cast<double>(i) + 0.5, static_cast<double>(j) + 0.5), reach, blocks[i / side]);
  }
  begin_.push_back(static_cast<std::uint32_t>(near_.size()));
}

std::optional<Gap> PolygonOutline::gap(const Vec3& x) const {
  std::array<std::size_t, 2> cell{};
  for (std::size_t d = 0; d < 2; ++d) {
    const double at = (x[d] - low_[d]) / width_;
    if (!(at >= 0.0) || !(at < static_cast<double>(count_[d]))) return std::nullopt;
    cell[d] = static_cast<std::size_t>(at);
  }
  const std::size_t k = cell[1] * count_[0] + cell[0];
  if (begin_[k] == begin_[k + 1]) {
    if (deep_[k] == 0) return std::nullopt;
    return Gap{-std::numeric_limits<double>::infinity(), {}};
  }
  Foot best{1e300, {}, 0.0};
  const Edge* edge = nullptr;
  for (std::uint32_t q = begin_[k]; q < begin_[k + 1]; ++q)
    if (const Foot foot = foot_on(edges_[near_[q]], x); foot.distance2 < best.distance2) {
      best = foot;
      edge = &edges_[near_[q]];
    }
  if (edge == nullptr) return std::nullopt;  // x is not a number
  const bool corner = best.share == 0.0 || best.share == 1.0;
  const Vec3& normal = corner ? edge->end_normals[best.share == 1.0 ? 1 : 0] : edge->normal;
  const Vec3 out{x[0] - best.at[0], x[1] - best.at[1], 0.0};
  const double side = dot(out, normal) < 0.0 ? -1.0 : 1.0;
  return Gap{side * std::sqrt(best.distance2), corner ? unit(side * out, unit(normal, edge->normal)) : normal};
}

ContactSurface ContactSurface::plane(const Vec3& at, const Vec3& outwards) {
  ContactSurface s;
  s.form_ = Form::plane;
  s.at_ = at;
  s.other_ = outwards;
  return s;
}

ContactSurface ContactSurface::round(const Vec3& centre, double radius) {
  ContactSurface s;
  s.form_ = Form::round;
  s.at_ = centre;
  s.radius_ = radius;
  s.probes_ = {{centre, radius}};
  return s;
}

ContactSurface ContactSurface::ring(const Vec3& centre, double inner, double outer) {
  ContactSurface s = round(centre, outer);
  s.form_ = Form::ring;
  s.inner_ = inner;
  s.probes_.front().deepest = 0.5 * (outer - inner);
  return s;
}

ContactSurface ContactSurface::box(const Vec3& low, const Vec3& high) {
  ContactSurface s;
  s.form_ = Form::box;
  s.at_ = low;
  s.other_ = high;
  for (int corner = 0; corner < 8; ++corner)
    s.probes_.push_back({{(corner & 1) != 0 ? high[0] : low[0], (corner & 2) != 0 ? high[1] : low[1],
                          (corner & 4) != 0 ? high[2] : low[2]},
                         0.0});
  return s;
}

ContactSurface ContactSurface::polygon(PolygonOutline outline) {
  ContactSurface s;
  s.form_ = Form::polygon;
  for (const Vec3& corner : outline.corners()) s.probes_.push_back({corner, 0.0});
  s.outline_.push_back(std::move(outline));
  return s;
}

void ContactSurface::prepare(double reach, double spacing) {
  for (PolygonOutline& outline : outline_) outline.prepare(reach, spacing);
}

namespace {

Gap gap_of_box(const Vec3& low, const Vec3& high, const Vec3& x) {
  Vec3 out{};
  double least = 1e300;
  std::size_t face = 0;
  for (std::size_t d = 0; d < 3; ++d) {
    out[d] = x[d] < low[d] ? x[d] - low[d] : x[d] > high[d] ? x[d] - high[d] : 0.0;
    const double depth = std::min(x[d] - low[d], high[d] - x[d]);
    if (depth >= least) continue;
    least = depth;
    face = d;
  }
  const double distance = norm(out);
  if (distance > 0.0) return {distance, 1.0 / distance * out};
  Vec3 normal{};
  normal[face] = x[face] - low[face] < high[face] - x[face] ? -1.0 : 1.0;
  return {-least, normal};
}

}  // namespace

std::optional<Gap> ContactSurface::gap(const Vec3& x) const {
  const Vec3 r = x - at_;
  switch (form_) {
    case Form::plane: return Gap{dot(r, other_), other_};
    case Form::round: return Gap{norm(r) - radius_, unit(r, {1, 0, 0})};
    case Form::ring: {
      const double distance = norm(r), outer = distance - radius_, inner = inner_ - distance;
      return outer > inner ? Gap{outer, unit(r, {1, 0, 0})} : Gap{inner, unit(-1.0 * r, {1, 0, 0})};
    }
    case Form::box: return gap_of_box(at_, other_, x);
    case Form::polygon: return outline_.front().gap({x[0], x[1], 0.0});  // in 3D a prism along z
  }
  return std::nullopt;
}

std::vector<ContactSurface> surfaces_of(const Shape& shape, const Scene& scene, double spacing) {
  const bool flat = scene.dimensions == 2;
  const auto rectangle = [&](const Vec3& low, const Vec3& high) {
    if (!flat) return ContactSurface::box(low, high);
    const PolygonShape corners{{{low[0], low[1]}, {high[0], low[1]}, {high[0], high[1]}, {low[0], high[1]}},
                               {1.0, 0.0, {}}};
    return ContactSurface::polygon(PolygonOutline(facets_of(corners)));
  };
  if (const auto* box = std::get_if<BoxShape>(&shape)) return {rectangle(box->min, box->max)};
  if (const auto* cube = std::get_if<CubeShape>(&shape)) {
    const double half = 0.5 * cube->count * spacing;
    const Vec3 corner{half, half, half};
    return {rectangle(cube->centre - corner, cube->centre + corner)};
  }
  if (const auto* sphere = std::get_if<SphereShape>(&shape))
    return {ContactSurface::round(sphere->centre, sphere->radius)};
  if (const auto* disc = std::get_if<DiscShape>(&shape)) return {ContactSurface::round(disc->centre, disc->radius)};
  if (const auto* ring = std::get_if<RingShape>(&shape)) {
    if (ring->inner > 0.0) return {ContactSurface::ring(ring->centre, ring->inner, ring->outer)};
    return {ContactSurface::round(ring->centre, ring->outer)};
  }
  if (facet_dimensions(shape) == 2) return {ContactSurface::polygon(PolygonOutline(facets_of(shape)))};
  return {};
}

}  // namespace barchan
