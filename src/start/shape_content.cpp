#include "start/shape_content.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "scene/couplings.hpp"
#include "start/outline.hpp"
#include "start/shapes.hpp"

namespace barchan {
namespace {

using std::numbers::pi;

Content of_box(const Vec3& lower, const Vec3& upper, int dimensions) {
  Content c;
  c.content = 1.0;
  for (std::size_t d = 0; d < static_cast<std::size_t>(dimensions); ++d) {
    const double length = std::max(0.0, upper[d] - lower[d]);
    c.content *= length;
    c.centre[d] = 0.5 * (lower[d] + upper[d]);
    c.second[d] = length * length / 12.0;
  }
  c.second = scaled(c.content, c.second);
  return c;
}

class ExactContent {
 public:
  ExactContent(const Scene& scene, const Fill& fill)
      : scene_(scene), spacing_(spacing_of(scene, fill)), solid_(scene.dimensions == 3) {}

  std::optional<Content> operator()(const BoxShape& box) const {
    Vec3 lower = box.min, upper = box.max;
    for (std::size_t d = 0; d < 3; ++d) {
      if (!scene_.domain.periodic[d]) continue;
      lower[d] = std::max(lower[d], scene_.domain.origin[d]);
      upper[d] = std::min(upper[d], scene_.domain.origin[d] + scene_.domain.size[d]);
    }
    return of_box(lower, upper, scene_.dimensions);
  }
  std::optional<Content> operator()(const CubeShape& cube) const {
    const double half = 0.5 * cube.count * spacing_;
    const Vec3 corner{half, half, half};
    return of_box(cube.centre - corner, cube.centre + corner, scene_.dimensions);
  }
  std::optional<Content> operator()(const DiscShape& disc) const { return ring(disc.centre, 0.0, disc.radius); }
  std::optional<Content> operator()(const RingShape& r) const { return ring(r.centre, r.inner, r.outer); }
  std::optional<Content> operator()(const SphereShape& ball) const {
    if (!solid_) return ring(ball.centre, 0.0, ball.radius);
    Content c;
    c.content = 4.0 / 3.0 * pi * std::pow(ball.radius, 3);
    c.centre = ball.centre;
    c.second[0] = c.second[1] = c.second[2] = c.content * ball.radius * ball.radius / 5.0;
    return c;
  }
  std::optional<Content> operator()(const PolygonShape& polygon) const { return closed(polygon); }
  std::optional<Content> operator()(const SurfaceShape& surface) const { return closed(surface); }
  template <class Other>
  std::optional<Content> operator()(const Other&) const {
    return std::nullopt;
  }

 private:
  std::optional<Content> ring(const Vec3& centre, double inner, double outer) const {
    Content c;
    c.content = pi * (outer * outer - inner * inner);
    c.centre = {centre[0], centre[1], 0.0};
    c.second[0] = c.second[1] = 0.25 * pi * (std::pow(outer, 4) - std::pow(inner, 4));
    return through_z(c);
  }
  std::optional<Content> closed(const Shape& shape) const {
    const int dimensions = facet_dimensions(shape);
    const Content c = Outline(facets_of(shape), dimensions).moments();
    return dimensions == 2 ? through_z(c) : c;
  }
  /// What has no end along z goes through the domain in 3D.
  Content through_z(Content c) const {
    if (!solid_) return c;
    const double length = scene_.domain.size[2];
    c = {c.content * length, c.centre, scaled(length, c.second)};
    c.centre[2] = scene_.domain.origin[2] + 0.5 * length;
    c.second[2] = c.content * length * length / 12.0;
    return c;
  }

  const Scene& scene_;
  double spacing_;  // m
  bool solid_;
};

bool places_by_itself(const Shape& shape) {
  return std::holds_alternative<PointsShape>(shape) || std::holds_alternative<FileShape>(shape) ||
         std::holds_alternative<SidesShape>(shape);
}

bool is_cut(const Fill& fill) { return fill.leave_out == LeaveOut::earlier_fills; }

/// Whether a place is in the shape, and in no earlier one that the fill leaves out.
class InShape {
 public:
  InShape(const Scene& scene, std::size_t k, const ShapeRegion& own) : own_(own) {
    const Fill& fill = scene.fills[k];
    if (!is_cut(fill) && !std::holds_alternative<RemainderShape>(fill.shape)) return;
    for (std::size_t j = 0; j < k; ++j)
      if (!places_by_itself(scene.fills[j].shape)) add_hole(scene, scene.fills[j]);
  }
  bool operator()(const Vec3& x) const {
    return own_.inside(x) && std::none_of(holes_.begin(), holes_.end(), [&](const ShapeRegion& hole) {
             for (std::size_t d = 0; d < 3; ++d)
               if (x[d] < hole.lower[d] || x[d] > hole.upper[d]) return false;
             return hole.inside(x);
           });
  }

 private:
  /// With the images of a shape that goes across a periodic side.
  void add_hole(const Scene& scene, const Fill& fill) {
    ShapeRegion hole = region_of_shape(scene, fill);
    if (const auto* cube = std::get_if<CubeShape>(&fill.shape)) {
      const double half = 0.5 * cube->count * spacing_of(scene, fill);
      hole.lower = cube->centre - Vec3{half, half, half};
      hole.upper = cube->centre + Vec3{half, half, half};
    }
    if (scene.dimensions == 2) {
      hole.lower[2] = -1e300;
      hole.upper[2] = 1e300;
    }
    holes_.push_back(hole);
    for (std::size_t d = 0; d < 3; ++d) {
      const std::size_t count = holes_.size();
      const double low = scene.domain.origin[d], size = scene.domain.size[d];
      for (std::size_t i = 0; scene.domain.periodic[d] && i < count; ++i)
        for (const double way : {-size, size}) {
          ShapeRegion image = holes_[i];
          image.lower[d] += way;
          image.upper[d] += way;
          if (image.upper[d] <= low || image.lower[d] >= low + size) continue;
          image.inside = [inside = holes_[i].inside, way, d](Vec3 x) {
            x[d] -= way;
            return inside(x);
          };
          holes_.push_back(image);
        }
    }
  }

  const ShapeRegion& own_;
  std::vector<ShapeRegion> holes_;
};

/// Cells over the bounds of a shape.
class ShapeCells {
 public:
  ShapeCells(const ShapeRegion& region, int dimensions, double pitch, double most)
      : dimensions_(static_cast<std::size_t>(dimensions)), lower_(region.lower) {
    for (double nodes = most + 1.0; nodes > most; pitch *= 1.3) {
      nodes = 1.0;
      for (std::size_t d = 0; d < dimensions_; ++d) {
        const double length = region.upper[d] - region.lower[d];
        count_[d] = static_cast<std::size_t>(std::clamp(std::ceil(length / pitch), 1.0, most));
        width_[d] = length / static_cast<double>(count_[d]);
        nodes *= static_cast<double>(count_[d] + 1);
      }
    }
  }

  template <class Inside>
  Content integrate(const Inside& inside, const std::vector<Vec3>& places, double samples) {
    classify(inside);
    for (const Vec3& x : places) mark(x);
    widen();
    const auto cut = static_cast<double>(std::count(kinds_.begin(), kinds_.end(), Kind::cut));
    const auto each = static_cast<std::size_t>(std::clamp(samples / std::max(cut, 1.0), 16.0, 1e5));
    const Vec3 about = lower_;
    Content sum;
    double size = 1.0;
    SecondMoments own{};
    for (std::size_t d = 0; d < dimensions_; ++d) size *= width_[d];
    for (std::size_t d = 0; d < dimensions_; ++d) own[d] = width_[d] * width_[d] / 12.0;
    std::size_t number = 0;  // of the sequence, which goes on from cell to cell
    for_each_cell([&](std::size_t cell, const Vec3& low) {
      if (kinds_[cell] == Kind::empty) return;
      const Vec3 from = low - about;
      if (kinds_[cell] == Kind::full) {
        const Vec3 middle = from + 0.5 * width_;
        SecondMoments squared = squares(middle);
        for (std::size_t d = 0; d < 6; ++d) squared[d] += own[d];
        return sum.add(size, size * middle, scaled(size, squared));
      }
      const double share = size / static_cast<double>(each);
      for (std::size_t q = 0; q < each; ++q) {
        const Vec3 x = from + in_cell(number++);
        if (inside(about + x)) sum.add(share, share * x, scaled(share, squares(x)));
      }
    });
    sum.refer_to_centre(about);
    return sum;
  }

 private:
  enum class Kind : char { empty, full, cut };

  template <class F>
  void for_each_cell(F&& f) const {
    std::size_t cell = 0;
    for (std::size_t k = 0; k < count_[2]; ++k)
      for (std::size_t j = 0; j < count_[1]; ++j)
        for (std::size_t i = 0; i < count_[0]; ++i, ++cell) f(cell, node(i, j, k));
  }
  Vec3 node(std::size_t i, std::size_t j, std::size_t k) const {
    return lower_ + Vec3{static_cast<double>(i) * width_[0], static_cast<double>(j) * width_[1],
                         static_cast<double>(k) * width_[2]};
  }
  std::size_t cell_of(std::size_t i, std::size_t j, std::size_t k) const { return (k * count_[1] + j) * count_[0] + i; }

  /// A cell is full or empty where all of its corners are.
  template <class Inside>
  void classify(const Inside& inside) {
    const std::size_t nx = count_[0] + 1, ny = count_[1] + 1, nz = dimensions_ == 3 ? count_[2] + 1 : 1;
    std::vector<char> in(nx * ny * nz);
    for (std::size_t k = 0; k < nz; ++k)
      for (std::size_t j = 0; j < ny; ++j)
        for (std::size_t i = 0; i < nx; ++i) in[(k * ny + j) * nx + i] = inside(node(i, j, k)) ? 1 : 0;
    kinds_.resize(count_[0] * count_[1] * count_[2]);
    const int corners = dimensions_ == 3 ? 8 : 4;
    for (std::size_t k = 0; k < count_[2]; ++k)
      for (std::size_t j = 0; j < count_[1]; ++j)
        for (std::size_t i = 0; i < count_[0]; ++i) {
          int held = 0;
          for (std::size_t c = 0; c < static_cast<std::size_t>(corners); ++c)
            held += in[((k + (c >> 2)) * ny + j + ((c >> 1) & 1)) * nx + i + (c & 1)];
          kinds_[cell_of(i, j, k)] = held == 0 ? Kind::empty : held == corners ? Kind::full : Kind::cut;
        }
  }

  /// The cell of a particle holds some of the shape, however thin that is.
  void mark(const Vec3& x) {
    std::array<std::size_t, 3> at{};
    for (std::size_t d = 0; d < dimensions_; ++d) {
      const double index = std::floor((x[d] - lower_[d]) / width_[d]);
      if (!(index >= 0.0 && index < static_cast<double>(count_[d]))) return;
      at[d] = static_cast<std::size_t>(index);
    }
    Kind& kind = kinds_[cell_of(at[0], at[1], at[2])];
    if (kind == Kind::empty) kind = Kind::cut;
  }

  /// The border may reach into the neighbours of a cut cell between their corners.
  void widen() {
    const std::vector<Kind> before = kinds_;
    const std::array<std::size_t, 3> stride{1, count_[0], count_[0] * count_[1]};
    std::size_t cell = 0;
    for (std::size_t k = 0; k < count_[2]; ++k)
      for (std::size_t j = 0; j < count_[1]; ++j)
        for (std::size_t i = 0; i < count_[0]; ++i, ++cell) {
          const std::array<std::size_t, 3> at{i, j, k};
          for (std::size_t d = 0; d < dimensions_; ++d)
            if ((at[d] > 0 && before[cell - stride[d]] == Kind::cut) ||
                (at[d] + 1 < count_[d] && before[cell + stride[d]] == Kind::cut))
              kinds_[cell] = Kind::cut;
        }
  }

  /// The place in a cell of a number of Roberts's sequence: multiples of the powers of 1/g, g^(d+1) = g + 1.
  Vec3 in_cell(std::size_t number) const {
    const double g = dimensions_ == 3 ? 1.2207440846057596 : 1.3247179572447460;
    Vec3 x{};
    double step = 1.0;
    for (std::size_t d = 0; d < dimensions_; ++d) {
      step /= g;
      const double turns = 0.5 + step * static_cast<double>(number);
      x[d] = (turns - std::floor(turns)) * width_[d];
    }
    return x;
  }

  std::size_t dimensions_;
  Vec3 lower_, width_{};  // m
  std::array<std::size_t, 3> count_{1, 1, 1};
  std::vector<Kind> kinds_;
};

/// The bounds of a shape within the domain; of one that only the places bound, those.
void tighten(ShapeRegion& region, const Scene& scene, const Fill& fill, const std::vector<Vec3>& places) {
  const double dx = spacing_of(scene, fill);
  const bool bounded = std::holds_alternative<BoxShape>(fill.shape) || facet_dimensions(fill.shape) != 0 ||
                       std::holds_alternative<DiscShape>(fill.shape) || std::holds_alternative<RingShape>(fill.shape) ||
                       std::holds_alternative<SphereShape>(fill.shape);
  for (std::size_t d = 0; d < static_cast<std::size_t>(scene.dimensions); ++d) {
    const double low = scene.domain.origin[d], high = low + scene.domain.size[d];
    if (bounded && (d < 2 || std::holds_alternative<BoxShape>(fill.shape) || facet_dimensions(fill.shape) == 3 ||
                    std::holds_alternative<SphereShape>(fill.shape)))
      continue;
    region.lower[d] = low;  // some packings keep half a spacing from the sides
    region.upper[d] = high;
    if (bounded || places.empty()) continue;
    double least = 1e300, most = -1e300;
    for (const Vec3& x : places) {
      least = std::min(least, x[d]);
      most = std::max(most, x[d]);
    }
    region.lower[d] = std::max(region.lower[d], least - 1.5 * dx);
    region.upper[d] = std::min(region.upper[d], most + 1.5 * dx);
  }
}

}  // namespace

std::optional<Content> content_of_fill(const Scene& scene, std::size_t k, const std::vector<Vec3>& places,
                                       const Sampling& sampling) {
  const Fill& fill = scene.fills[k];
  if (places_by_itself(fill.shape)) return std::nullopt;
  std::optional<Content> found;
  if (!is_cut(fill)) found = std::visit(ExactContent(scene, fill), fill.shape);
  if (!found) {
    ShapeRegion region = region_of_shape(scene, fill);
    tighten(region, scene, fill, places);
    ShapeCells cells(region, scene.dimensions, 0.5 * spacing_of(scene, fill), sampling.nodes);
    found = cells.integrate(InShape(scene, k, region), places, sampling.samples);
  }
  return found->content > 0.0 ? found : std::nullopt;
}

Content content_of_body(const Scene& scene, std::size_t k, const std::vector<Vec3>& places) {
  Vec3 middle{};
  for (const Vec3& x : places) middle = middle + x;
  middle = 1.0 / static_cast<double>(places.size()) * middle;
  const Fill& fill = scene.fills[k];
  Content body;
  if (const auto found = content_of_fill(scene, k, places)) {
    body = *found;
    for (std::size_t d = 0; d < 3; ++d)
      if (scene.domain.periodic[d])
        body.centre[d] -= scene.domain.size[d] * std::round((body.centre[d] - middle[d]) / scene.domain.size[d]);
  } else {
    const double each = std::pow(spacing_of(scene, fill), scene.dimensions);
    for (const Vec3& x : places) body.add(each, each * (x - middle), scaled(each, squares(x - middle)));
    body.refer_to_centre(middle);
  }
  if (fill.centre) body.centre = *fill.centre;
  return body;
}

}  // namespace barchan
