#include "start/outline.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace barchan {
namespace {

Vec3 on_segment(const Vec3& a, const Vec3& b, const Vec3& x) {
  const Vec3 ab = b - a;
  const double length2 = dot(ab, ab);
  return length2 > 0.0 ? a + std::clamp(dot(x - a, ab) / length2, 0.0, 1.0) * ab : a;
}

/// The place of a triangle nearest to x, by the regions of its plane (Ericson 2005, section 5.1.5).
Vec3 on_triangle(const Facet& f, const Vec3& x) {
  const Vec3 ab = f[1] - f[0], ac = f[2] - f[0], n = cross(ab, ac);
  const double n2 = dot(n, n);
  if (n2 > 0.0) {
    const double u = dot(cross(ab, x - f[0]), n) / n2, v = dot(cross(x - f[0], ac), n) / n2;  // of c and of b
    if (u >= 0.0 && v >= 0.0 && u + v <= 1.0) return f[0] + v * ab + u * ac;
  }
  Vec3 best = on_segment(f[0], f[1], x);
  for (const auto& [i, j] : {std::pair{1, 2}, std::pair{2, 0}}) {
    const Vec3 y = on_segment(f[static_cast<std::size_t>(i)], f[static_cast<std::size_t>(j)], x);
    if (norm(x - y) < norm(x - best)) best = y;
  }
  return best;
}

/// Where the line of height v cuts the edge a-b, or nothing: its other coordinate. The ends are taken in one order, so
/// that both facets of an edge find the same bits.
bool cut_of_edge(double ua, double va, double ub, double vb, double v, double& u) {
  if ((va > v) == (vb > v)) return false;
  if (va > vb) {
    std::swap(ua, ub);
    std::swap(va, vb);
  }
  u = (ub - ua) * (v - va) / (vb - va) + ua;
  return true;
}

}  // namespace

Outline::Outline(const std::vector<Facet>& facets, int dimensions, double reach)
    : dimensions_(dimensions), reach_(reach) {
  for (Facet f : facets) {
    if (dimensions == 2)
      for (Vec3& corner : f) corner[2] = 0.0;
    const bool nothing = f[0] == f[1] || (dimensions == 3 && (f[1] == f[2] || f[2] == f[0]));
    if (!nothing) facets_.push_back(f);
  }
  if (facets_.empty()) return;
  lower_ = upper_ = facets_[0][0];
  for (const Facet& f : facets_)
    for (const Vec3& corner : f)
      for (std::size_t d = 0; d < 3; ++d) {
        lower_[d] = std::min(lower_[d], corner[d]);
        upper_[d] = std::max(upper_[d], corner[d]);
      }
  sort_into_cells();
  measure();
}

std::size_t Outline::Hash::operator()(const Cell& cell) const {
  std::size_t hash = 0;
  for (const long index : cell) hash = (hash ^ static_cast<std::size_t>(index)) * 0x9e3779b97f4a7c15ull;
  return hash ^ (hash >> 29);
}

Outline::Cell Outline::cell_of(const Vec3& x) const {
  Cell cell{};
  for (std::size_t d = 0; d < static_cast<std::size_t>(dimensions_); ++d)
    cell[d] = static_cast<long>(std::floor((x[d] - lower_[d]) / width_));
  return cell;
}

std::array<long, 2> Outline::row_indices(double y, double z) const {
  const auto index = [&](double x, std::size_t d) {
    const double size = upper_[d] - lower_[d];
    return size > 0.0
               ? std::clamp(static_cast<long>((x - lower_[d]) / size * static_cast<double>(rows_)), 0l, rows_ - 1)
               : 0l;
  };
  return {index(y, 1), dimensions_ == 3 ? index(z, 2) : 0l};
}

std::size_t Outline::row_of(double y, double z) const {
  const auto [j, k] = row_indices(y, z);
  return static_cast<std::size_t>(k * rows_ + j);
}

void Outline::sort_into_cells() {
  const double count = static_cast<double>(facets_.size());
  rows_ = std::clamp(static_cast<long>(dimensions_ == 3 ? std::sqrt(count) : count), 1l, 2000l);
  rows_of_facets_.resize(static_cast<std::size_t>(dimensions_ == 3 ? rows_ * rows_ : rows_));
  for (std::size_t i = 0; i < facets_.size(); ++i) {
    Vec3 low = facets_[i][0], high = low;
    for (const Vec3& corner : facets_[i])
      for (std::size_t d = 0; d < 3; ++d) {
        low[d] = std::min(low[d], corner[d]);
        high[d] = std::max(high[d], corner[d]);
      }
    const auto first = row_indices(low[1], low[2]), last = row_indices(high[1], high[2]);
    for (long k = first[1]; k <= last[1]; ++k)
      for (long j = first[0]; j <= last[0]; ++j) rows_of_facets_[static_cast<std::size_t>(k * rows_ + j)].push_back(i);
    if (!(reach_ > 0.0)) continue;
    width_ = reach_;
    const Vec3 margin{reach_, reach_, dimensions_ == 3 ? reach_ : 0.0};
    const Cell from = cell_of(low - margin), to = cell_of(high + margin);
    for (Cell c = from; c[2] <= to[2]; ++c[2])
      for (c[1] = from[1]; c[1] <= to[1]; ++c[1])
        for (c[0] = from[0]; c[0] <= to[0]; ++c[0]) near_[c].push_back(i);
  }
}

/// Normal of a facet out of what it bounds, as long as the facet (m, m2); zero without area. The files do not promise
/// which way a facet faces: the side of its middle that is inside tells.
Vec3 Outline::outwards(const Facet& f) const {
  Vec3 area =
      dimensions_ == 3 ? 0.5 * cross(f[1] - f[0], f[2] - f[0]) : Vec3{f[1][1] - f[0][1], f[0][0] - f[1][0], 0.0};
  const double size = norm(area), step = 1e-7 * norm(upper_ - lower_);
  if (!(size > 0.0)) return {};
  const Vec3 middle = dimensions_ == 3 ? 1.0 / 3.0 * (f[0] + f[1] + f[2]) : 0.5 * (f[0] + f[1]);
  return inside(middle + step / size * area) ? -1.0 * area : area;
}

/// Content by Gauss's theorem.
void Outline::measure() {
  for (const Facet& f : facets_) {
    const Vec3 area = outwards(f), middle = dimensions_ == 3 ? 1.0 / 3.0 * (f[0] + f[1] + f[2]) : 0.5 * (f[0] + f[1]);
    border_ += norm(area);
    content_ += dot(middle - lower_, area) / dimensions_;
  }
}

/// Gauss's theorem for a polynomial f of degree k about a place: div(x f) = (d + k) f, and on a plane facet x.n is the
/// same everywhere. The integrals of f over a facet are exact: Simpson's rule of a segment, the middles of the edges of
/// a triangle.
Content Outline::moments() const {
  Content c;
  const Vec3 about = 0.5 * (lower_ + upper_);
  for (const Facet& f : facets_) {
    const Vec3 area = outwards(f);
    const Vec3 a = f[0] - about, b = f[1] - about, e = f[2] - about;
    const double flux = dot(a, area);
    if (dimensions_ == 2) {
      const Vec3 middle = 0.5 * (a + b);
      c.add(flux / 2.0, {}, {});
      for (const auto& [share, at] : {std::pair{1.0 / 6.0, a}, std::pair{4.0 / 6.0, middle}, std::pair{1.0 / 6.0, b}})
        c.add(0.0, flux * share / 3.0 * at, scaled(flux * share / 4.0, squares(at)));
    } else {
      c.add(flux / 3.0, {}, {});
      for (const Vec3& at : {0.5 * (a + b), 0.5 * (b + e), 0.5 * (e + a)})
        c.add(0.0, flux / 3.0 / 4.0 * at, scaled(flux / 3.0 / 5.0, squares(at)));
    }
  }
  c.refer_to_centre(about);
  return c;
}

bool Outline::cuts(const Facet& f, const Vec3& x) const {
  if (dimensions_ == 2) {
    double at = 0.0;
    return cut_of_edge(f[0][0], f[0][1], f[1][0], f[1][1], x[1], at) && x[0] < at;
  }
  // Seen along x: is (y, z) inside the triangle? The line of its z is cut by two edges or by none.
  std::array<double, 2> y{}, along{};  // of the cuts
  std::size_t cut = 0;
  for (std::size_t i = 0; i < 3 && cut < 2; ++i) {
    const Vec3 &a = f[i], &b = f[(i + 1) % 3];
    if (!cut_of_edge(a[1], a[2], b[1], b[2], x[2], y[cut])) continue;
    cut_of_edge(a[0], a[2], b[0], b[2], x[2], along[cut]);
    ++cut;
  }
  if (cut < 2 || (y[0] > x[1]) == (y[1] > x[1])) return false;
  return x[0] < along[0] + (along[1] - along[0]) * (x[1] - y[0]) / (y[1] - y[0]);
}

bool Outline::inside(const Vec3& x) const {
  for (std::size_t d = 0; d < static_cast<std::size_t>(dimensions_); ++d)
    if (facets_.empty() || x[d] < lower_[d] || x[d] > upper_[d]) return false;
  bool odd = false;
  for (const std::size_t i : rows_of_facets_[row_of(x[1], x[2])]) odd = odd != cuts(facets_[i], x);
  return odd;
}

double Outline::depth(const Vec3& x) const {
  double nearest = reach_;
  const Vec3 at{x[0], x[1], dimensions_ == 3 ? x[2] : 0.0};
  if (reach_ > 0.0)
    if (const auto cell = near_.find(cell_of(at)); cell != near_.end())
      for (const std::size_t i : cell->second) {
        const Facet& f = facets_[i];
        nearest = std::min(nearest, norm(at - (dimensions_ == 3 ? on_triangle(f, at) : on_segment(f[0], f[1], at))));
      }
  return inside(at) ? nearest : -nearest;
}

std::vector<Facet> facets_of(const Shape& shape) {
  std::vector<Facet> facets;
  const Placement* placement = nullptr;
  if (const auto* surface = std::get_if<SurfaceShape>(&shape)) {
    facets = surface->facets;
    placement = &surface->placement;
  } else if (const auto* polygon = std::get_if<PolygonShape>(&shape)) {
    const auto& corners = polygon->corners;
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const auto &a = corners[i], &b = corners[(i + 1) % corners.size()];
      facets.push_back({Vec3{a[0], a[1], 0.0}, Vec3{b[0], b[1], 0.0}, Vec3{b[0], b[1], 0.0}});
    }
    placement = &polygon->placement;
  }
  if (!placement) return facets;
  const double angle = placement->turn * std::numbers::pi / 180.0, c = std::cos(angle), s = std::sin(angle);
  const bool turned = placement->turn != 0.0;
  for (Facet& facet : facets)
    for (Vec3& x : facet) {
      x = placement->scale * x;
      if (turned) x = {c * x[0] - s * x[1], s * x[0] + c * x[1], x[2]};
      x = x + placement->move;
    }
  return facets;
}

}  // namespace barchan
