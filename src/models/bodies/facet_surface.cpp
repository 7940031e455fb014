#include "models/bodies/facet_surface.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "start/outline.hpp"

namespace barchan {

FacetSurface::FacetSurface(const std::vector<Facet>& facets, int dimensions, double reach)
    : dimensions_(dimensions), reach_(reach) {
  for (const Facet& facet : facets) {
    const Vec3 a = facet[1] - facet[0], b = facet[2] - facet[0];
    const bool nothing = dimensions == 2 ? !(norm(a) > 0.0) : !(norm(cross(a, b)) > 0.0);
    if (!nothing) faces_.push_back({facet, {}, {}});
  }
  low_ = {1e300, 1e300, 1e300};
  high_ = {-1e300, -1e300, -1e300};
  for (const Face& face : faces_)
    for (const Vec3& corner : face.corners)
      for (std::size_t d = 0; d < 3; ++d) {
        low_[d] = std::min(low_[d], corner[d]);
        high_[d] = std::max(high_[d], corner[d]);
      }
  number_corners();
  turn_outwards();
  make_cells();
}

void FacetSurface::number_corners() {
  std::map<Vec3, std::uint32_t> numbers;
  for (Face& face : faces_)
    for (std::size_t k = 0; k < corners(); ++k)
      face.numbers[k] = numbers.emplace(face.corners[k], static_cast<std::uint32_t>(numbers.size())).first->second;
  about_.assign(numbers.size() + 1, 0);
  for (const Face& face : faces_)
    for (std::size_t k = 0; k < corners(); ++k) ++about_[face.numbers[k] + 1];
  for (std::size_t k = 1; k < about_.size(); ++k) about_[k] += about_[k - 1];
  of_about_.resize(about_.back());
  std::vector<std::uint32_t> next(about_.begin(), about_.end() - 1);
  for (std::size_t f = 0; f < faces_.size(); ++f)
    for (std::size_t k = 0; k < corners(); ++k) of_about_[next[faces_[f].numbers[k]]++] = static_cast<std::uint32_t>(f);
}

/// Normals of the facets, and at the corners their sums, weighted by the angles that the facets have there.
void FacetSurface::turn_outwards() {
  std::vector<Facet> all;
  for (const Face& face : faces_) all.push_back(face.corners);
  const Outline outline(all, dimensions_);
  corner_normals_.assign(about_.size() - 1, Vec3{});
  for (Face& face : faces_) {
    const Facet& at = face.corners;
    const Vec3 along = at[1] - at[0];
    const Vec3 across = dimensions_ == 2 ? Vec3{along[1], -along[0], 0.0} : cross(along, at[2] - at[0]);
    face.normal = 1.0 / norm(across) * across;
    const Vec3 middle = dimensions_ == 2 ? at[0] + 0.5 * along : 1.0 / 3.0 * (at[0] + at[1] + at[2]);
    if (outline.inside(middle + 1e-6 * norm(along) * face.normal)) face.normal = -1.0 * face.normal;
    for (std::size_t k = 0; k < corners(); ++k) {
      double angle = 1.0;
      if (dimensions_ == 3) {
        const Vec3 a = at[(k + 1) % 3] - at[k], b = at[(k + 2) % 3] - at[k];
        angle = std::atan2(norm(cross(a, b)), dot(a, b));
      }
      Vec3& sum = corner_normals_[face.numbers[k]];
      sum = sum + angle * face.normal;
    }
  }
}

FacetSurface::Foot FacetSurface::foot_on(const Face& face, const Vec3& x) const {
  return dimensions_ == 2 ? foot_on_segment(face, x) : foot_on_triangle(face, x);
}

FacetSurface::Foot FacetSurface::foot_on_segment(const Face& face, const Vec3& x) const {
  const Vec3 &from = face.corners[0], &to = face.corners[1], along = to - from;
  const double share = std::clamp(dot(x - from, along) / dot(along, along), 0.0, 1.0);
  const Vec3 at = from + share * along, r = x - at;
  return {r, r[0] * r[0] + r[1] * r[1], share == 0.0 ? first_corner : share == 1.0 ? first_corner + 1 : inner};
}

/// By the regions of the triangle's plane that its corners and edges are the nearest to (Ericson 2005, section 5.1.5).
FacetSurface::Foot FacetSurface::foot_on_triangle(const Face& face, const Vec3& x) const {
  const auto& [a, b, c] = face.corners;
  const auto made = [&](const Vec3& at, int feature) {
    const Vec3 out = x - at;
    return Foot{out, dot(out, out), feature};
  };
  const Vec3 ab = b - a, ac = c - a, from_a = x - a, from_b = x - b, from_c = x - c;
  const double a_ab = dot(ab, from_a), a_ac = dot(ac, from_a), b_ab = dot(ab, from_b), b_ac = dot(ac, from_b),
               c_ab = dot(ab, from_c), c_ac = dot(ac, from_c);
  if (a_ab <= 0.0 && a_ac <= 0.0) return made(a, first_corner);
  if (b_ab >= 0.0 && b_ac <= b_ab) return made(b, first_corner + 1);
  if (c_ac >= 0.0 && c_ab <= c_ac) return made(c, first_corner + 2);
  if (a_ab * b_ac - b_ab * a_ac <= 0.0 && a_ab >= 0.0 && b_ab <= 0.0)
    return made(a + a_ab / (a_ab - b_ab) * ab, first_edge);
  if (c_ab * a_ac - a_ab * c_ac <= 0.0 && a_ac >= 0.0 && c_ac <= 0.0)
    return made(a + a_ac / (a_ac - c_ac) * ac, first_edge + 2);
  const double along = b_ac - b_ab, back = c_ab - c_ac;
  if (b_ab * c_ac - c_ab * b_ac <= 0.0 && along >= 0.0 && back >= 0.0)
    return made(b + along / (along + back) * (c - b), first_edge + 1);
  const double height = dot(from_a, face.normal);
  return {height * face.normal, height * height, inner};
}

template <class F>
void FacetSurface::each_about(const Face& face, int feature, F&& f) const {
  const bool edge = feature >= first_edge;
  const auto k = static_cast<std::size_t>(feature - (edge ? first_edge : first_corner));
  const std::uint32_t corner = face.numbers[k], other = face.numbers[edge ? (k + 1) % 3 : k];
  for (std::uint32_t q = about_[corner]; q < about_[corner + 1]; ++q) {
    const Face& one = faces_[of_about_[q]];
    if (std::find(one.numbers.begin(), one.numbers.begin() + dimensions_, other) != one.numbers.begin() + dimensions_)
      f(one);
  }
}

Vec3 FacetSurface::normal_of(const Face& face, int feature) const {
  if (feature == inner) return face.normal;
  if (feature < first_edge) return corner_normals_[face.numbers[static_cast<std::size_t>(feature - first_corner)]];
  Vec3 sum{};
  each_about(face, feature, [&](const Face& one) { sum = sum + one.normal; });
  return sum;
}

Gap FacetSurface::gap_of(const Face& face, const Foot& foot, bool inside) const {
  const double side = inside ? -1.0 : 1.0, distance = std::sqrt(foot.distance2);
  if (foot.feature == inner) return {side * distance, face.normal};
  const Vec3 out = side * foot.out;
  if (const double size = norm(out); size > 0.0) return {side * distance, 1.0 / size * out};
  const Vec3 normal = normal_of(face, foot.feature);
  return {0.0, norm(normal) > 0.0 ? 1.0 / norm(normal) * normal : face.normal};
}

/// Whether no facet about the foot has a nearer place.
bool FacetSurface::is_least(const Face& face, const Foot& foot, const Vec3& x) const {
  if (foot.feature == inner) return true;
  bool least = true;
  each_about(face, foot.feature,
             [&](const Face& one) { least = least && !(foot_on(one, x).distance2 < foot.distance2 * (1.0 - 1e-9)); });
  return least;
}

/// Cells at least as wide as the reach; each has the facets that are within the reach of one of its places.
void FacetSurface::make_cells() {
  const auto dimensions = static_cast<std::size_t>(dimensions_);
  double longest = 0.0;
  for (std::size_t d = 0; d < dimensions; ++d) longest = std::max(longest, high_[d] - low_[d] + 2.0 * reach_);
  width_ = std::max(reach_, longest / (dimensions_ == 2 ? 512.0 : 96.0));
  std::size_t cells = 1;
  for (std::size_t d = 0; d < dimensions; ++d) {
    first_[d] = low_[d] - reach_;
    count_[d] = static_cast<std::size_t>((high_[d] - low_[d] + 2.0 * reach_) / width_) + 1;
    cells *= count_[d];
  }
  const double across = reach_ + 0.5 * width_ * std::sqrt(static_cast<double>(dimensions_));
  const auto middle = [&](std::size_t i, std::size_t j, std::size_t k) {
    const auto at = [&](std::size_t index, std::size_t d) {
      return d < dimensions ? first_[d] + (static_cast<double>(index) + 0.5) * width_ : 0.0;
    };
    return Vec3{at(i, 0), at(j, 1), at(k, 2)};
  };
  const auto each_cell_of = [&](const Face& face, auto&& f) {
    std::array<std::size_t, 3> from{}, to{};
    for (std::size_t d = 0; d < dimensions; ++d) {
      double low = 1e300, high = -1e300;
      for (const Vec3& corner : face.corners) {
        low = std::min(low, corner[d]);
        high = std::max(high, corner[d]);
      }
      const auto index = [&](double x) {
        return static_cast<std::size_t>(
            std::clamp(std::floor((x - first_[d]) / width_), 0.0, static_cast<double>(count_[d] - 1)));
      };
      from[d] = index(low - reach_);
      to[d] = index(high + reach_);
    }
    for (std::size_t k = from[2]; k <= to[2]; ++k)
      for (std::size_t j = from[1]; j <= to[1]; ++j)
        for (std::size_t i = from[0]; i <= to[0]; ++i)
          if (foot_on(face, middle(i, j, k)).distance2 <= across * across) f((k * count_[1] + j) * count_[0] + i);
  };
  begin_.assign(cells + 1, 0);
  for (const Face& face : faces_) each_cell_of(face, [&](std::size_t c) { ++begin_[c + 1]; });
  for (std::size_t c = 0; c < cells; ++c) begin_[c + 1] += begin_[c];
  near_.resize(begin_.back());
  std::vector<std::uint32_t> next(begin_.begin(), begin_.end() - 1);
  for (std::size_t f = 0; f < faces_.size(); ++f)
    each_cell_of(faces_[f], [&](std::size_t c) { near_[next[c]++] = static_cast<std::uint32_t>(f); });
  // Of cells without facets that follow each other one tells on which side they lie.
  std::vector<Facet> all;
  for (const Face& face : faces_) all.push_back(face.corners);
  const Outline outline(all, dimensions_);
  deep_.assign(cells, 0);
  for (std::size_t k = 0, c = 0; k < count_[2]; ++k)
    for (std::size_t j = 0; j < count_[1]; ++j)
      for (std::size_t i = 0; i < count_[0]; ++i, ++c) {
        if (begin_[c] != begin_[c + 1]) continue;
        const bool follows = i > 0 && begin_[c - 1] == begin_[c];
        deep_[c] = follows ? deep_[c - 1] : outline.inside(middle(i, j, k)) ? 1 : 0;
      }
}

FacetSurface::Near FacetSurface::near(const Vec3& x) const {
  std::size_t cell = 0;
  for (std::size_t d = static_cast<std::size_t>(dimensions_); d-- > 0;) {
    const double at = (x[d] - first_[d]) / width_;
    if (!(at >= 0.0) || !(at < static_cast<double>(count_[d]))) return {};
    cell = cell * count_[d] + static_cast<std::size_t>(at);
  }
  return {near_.data() + begin_[cell], near_.data() + begin_[cell + 1], deep_[cell] != 0};
}

FacetSurface::Nearest FacetSurface::nearest_of(const Near& cell, const Vec3& x) const {
  Nearest nearest;
  for (const std::uint32_t* f = cell.begin; f != cell.end; ++f)
    if (const Foot foot = foot_on(faces_[*f], x); foot.distance2 < nearest.foot.distance2)
      nearest = {&faces_[*f], foot};
  return nearest;
}

std::optional<Gap> FacetSurface::gap(const Vec3& x) const {
  const Near cell = near(x);
  if (cell.begin == cell.end) {
    if (!cell.deep) return std::nullopt;
    return Gap{-std::numeric_limits<double>::infinity(), {}};
  }
  const Nearest nearest = nearest_of(cell, x);
  if (nearest.face == nullptr) return std::nullopt;
  return gap_of(*nearest.face, nearest.foot, is_inside(nearest));
}

}  // namespace barchan
