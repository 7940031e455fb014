#include "models/bodies/border_points.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "scene/couplings.hpp"
#include "start/outline.hpp"

namespace barchan {

namespace {

using Points = std::vector<BorderPoint>;
using std::numbers::pi;

/// `outwards`: 1, or -1 of a hole.
void add_circle(const Vec3& centre, double radius, double outwards, double width, Points& points) {
  const auto n = std::max<std::size_t>(8, static_cast<std::size_t>(std::ceil(2.0 * pi * radius / width)));
  for (std::size_t k = 0; k < n; ++k) {
    const double angle = 2.0 * pi * (static_cast<double>(k) + 0.5) / static_cast<double>(n);
    const Vec3 out{std::cos(angle), std::sin(angle), 0.0};
    points.push_back({centre + radius * out, outwards * out, 2.0 * pi * radius / static_cast<double>(n)});
  }
}

void add_segment(const Vec3& from, const Vec3& to, const Vec3& normal, double width, Points& points) {
  const double length = norm(to - from);
  const auto n = std::max<std::size_t>(1, static_cast<std::size_t>(std::ceil(length / width)));
  for (std::size_t k = 0; k < n; ++k)
    points.push_back({from + (static_cast<double>(k) + 0.5) / static_cast<double>(n) * (to - from), normal,
                      length / static_cast<double>(n)});
}

/// A triangle, cut into n^2 like it; the pieces' middles and areas.
template <class F>
void cut_triangle(const Vec3& a, const Vec3& b, const Vec3& c, std::size_t n, F&& f) {
  const Vec3 u = 1.0 / static_cast<double>(n) * (b - a), v = 1.0 / static_cast<double>(n) * (c - a);
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; i + j < n; ++j) {
      const Vec3 p = a + static_cast<double>(i) * u + static_cast<double>(j) * v;
      f(p, p + u, p + v);
      if (i + j + 1 < n) f(p + u, p + u + v, p + v);
    }
}

double area_of(const Vec3& a, const Vec3& b, const Vec3& c) { return 0.5 * norm(cross(b - a, c - a)); }

/// Eight faces of an octahedron, cut and blown up: symmetric, so that the sums of n and of n n are exact.
void add_ball(const Vec3& centre, double radius, double width, Points& points) {
  const auto n = std::max<std::size_t>(2, static_cast<std::size_t>(std::ceil(0.5 * pi * radius / (1.3 * width))));
  const std::size_t first = points.size();
  double whole = 0.0;
  for (int face = 0; face < 8; ++face) {
    const double sx = (face & 1) != 0 ? -1.0 : 1.0, sy = (face & 2) != 0 ? -1.0 : 1.0,
                 sz = (face & 4) != 0 ? -1.0 : 1.0;
    cut_triangle({sx, 0, 0}, {0, sy, 0}, {0, 0, sz}, n, [&](const Vec3& a, const Vec3& b, const Vec3& c) {
      const Vec3 p = 1.0 / norm(a) * a, q = 1.0 / norm(b) * b, r = 1.0 / norm(c) * c, sum = p + q + r;
      const Vec3 out = 1.0 / norm(sum) * sum;
      const double area = area_of(p, q, r);
      whole += area;
      points.push_back({centre + radius * out, out, area});
    });
  }
  for (std::size_t k = first; k < points.size(); ++k) points[k].content *= 4.0 * pi * radius * radius / whole;
}

void add_box(const Vec3& low, const Vec3& high, int dimensions, double width, Points& points) {
  if (dimensions == 2) {
    const Vec3 a{low[0], low[1], 0}, b{high[0], low[1], 0}, c{high[0], high[1], 0}, d{low[0], high[1], 0};
    add_segment(a, b, {0, -1, 0}, width, points);
    add_segment(b, c, {1, 0, 0}, width, points);
    add_segment(c, d, {0, 1, 0}, width, points);
    return add_segment(d, a, {-1, 0, 0}, width, points);
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::size_t e = (axis + 1) % 3, f = (axis + 2) % 3;
    const double along = high[e] - low[e], across = high[f] - low[f];
    const auto n = static_cast<std::size_t>(std::ceil(along / width)),
               m = static_cast<std::size_t>(std::ceil(across / width));
    for (const bool upper : {false, true})
      for (std::size_t i = 0; i < n; ++i)
        for (std::size_t j = 0; j < m; ++j) {
          BorderPoint p{{}, {}, along * across / static_cast<double>(n * m)};
          p.at[axis] = upper ? high[axis] : low[axis];
          p.at[e] = low[e] + along * (static_cast<double>(i) + 0.5) / static_cast<double>(n);
          p.at[f] = low[f] + across * (static_cast<double>(j) + 0.5) / static_cast<double>(m);
          p.normal[axis] = upper ? 1.0 : -1.0;
          points.push_back(p);
        }
  }
}

void add_facets(const std::vector<Facet>& facets, int dimensions, double width, Points& points) {
  const Outline outline(facets, dimensions);
  for (const Facet& f : outline.facets()) {
    const Vec3 across =
        dimensions == 2 ? Vec3{f[1][1] - f[0][1], f[0][0] - f[1][0], 0.0} : cross(f[1] - f[0], f[2] - f[0]);
    Vec3 normal = 1.0 / norm(across) * across;
    const Vec3 middle = dimensions == 2 ? 0.5 * (f[0] + f[1]) : 1.0 / 3.0 * (f[0] + f[1] + f[2]);
    const double size = dimensions == 2 ? norm(f[1] - f[0]) : std::sqrt(area_of(f[0], f[1], f[2]));
    if (outline.inside(middle + 1e-6 * size * normal)) normal = -1.0 * normal;
    if (dimensions == 2) {
      add_segment(f[0], f[1], normal, width, points);
      continue;
    }
    const double longest = std::max({norm(f[1] - f[0]), norm(f[2] - f[1]), norm(f[0] - f[2])});
    const auto n = std::max<std::size_t>(1, static_cast<std::size_t>(std::ceil(longest / (1.4 * width))));
    cut_triangle(f[0], f[1], f[2], n, [&](const Vec3& a, const Vec3& b, const Vec3& c) {
      points.push_back({1.0 / 3.0 * (a + b + c), normal, area_of(a, b, c)});
    });
  }
}

}  // namespace

std::vector<BorderPoint> border_points(const Shape& shape, int dimensions, double spacing, double width) {
  Points points;
  if (const auto* box = std::get_if<BoxShape>(&shape)) {
    add_box(box->min, box->max, dimensions, width, points);
  } else if (const auto* cube = std::get_if<CubeShape>(&shape)) {
    const double half = 0.5 * cube->count * spacing;
    const Vec3 corner{half, half, half};
    add_box(cube->centre - corner, cube->centre + corner, dimensions, width, points);
  } else if (const auto* disc = std::get_if<DiscShape>(&shape); disc && dimensions == 2) {
    add_circle(disc->centre, disc->radius, 1.0, width, points);
  } else if (const auto* ring = std::get_if<RingShape>(&shape); ring && dimensions == 2) {
    add_circle(ring->centre, ring->outer, 1.0, width, points);
    if (ring->inner > 0.0) add_circle(ring->centre, ring->inner, -1.0, width, points);
  } else if (const auto* sphere = std::get_if<SphereShape>(&shape); sphere && dimensions == 3) {
    add_ball(sphere->centre, sphere->radius, width, points);
  } else if (facet_dimensions(shape) == dimensions) {
    add_facets(facets_of(shape), dimensions, width, points);
  }
  return points;
}

}  // namespace barchan
