// Outlines of rigid bodies and walls, as contacts see them: distances to them, and the places of theirs that reach
// farthest.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "base/vec3.hpp"
#include "scene/scene.hpp"

namespace barchan {

/// How far a place is outside of a surface (m; negative inside), and the normal of the nearest place, outwards.
struct Gap {
  double distance;
  Vec3 normal;
};

/// A ball that belongs to a body: what touches a surface first. Corners have no radius.
struct TouchPoint {
  Vec3 at;                 // m
  double radius;           // m
  double deepest = 1e300;  // m, overlaps beyond it mean that the other lies on the inner side of a ring
};

/// Closed lines in x, y, by a grid of cells that know their nearest edges.
class PolygonOutline {
 public:
  /// Segments in any order, either way round.
  explicit PolygonOutline(const std::vector<Facet>& segments);
  /// Makes the cells; before gap(). `reach` (m): how far outside distances are wanted. `spacing` (m): that of the
  /// particles.
  void prepare(double reach, double spacing);
  /// Nothing farther outside than the reach. Farther inside than it: -infinity.
  std::optional<Gap> gap(const Vec3& x) const;
  std::vector<Vec3> corners() const;

 private:
  struct Edge {
    Vec3 from, to, normal;            // the normal points outwards
    std::array<Vec3, 2> end_normals;  // at its ends the mean with that of the next edge
  };
  struct Foot {
    double distance2;
    Vec3 at;
    double share;  // of the edge
  };
  static Foot foot_on(const Edge& edge, const Vec3& x);
  bool holds(const Vec3& x) const;
  void turn_outwards();
  void make_cell(const Vec3& middle, double reach, const std::vector<std::uint32_t>& edges);
  double nearest_among(const Vec3& x, const std::vector<std::uint32_t>& edges) const;

  std::vector<Edge> edges_;
  std::array<double, 2> low_{};
  double width_ = 1.0;
  std::array<std::size_t, 2> count_{};
  std::vector<std::uint32_t> begin_, near_;  // by cell
  std::vector<char> deep_;                   // cells that lie inside, beyond the reach
};

/// The outline of a body or a wall, or a part of it: a plane, a disc or sphere, a ring, a box in 3D, a polygon.
class ContactSurface {
 public:
  enum class Form { plane, round, ring, box, polygon };
  static ContactSurface plane(const Vec3& at, const Vec3& outwards);
  static ContactSurface round(const Vec3& centre, double radius);
  static ContactSurface ring(const Vec3& centre, double inner, double outer);
  static ContactSurface box(const Vec3& low, const Vec3& high);
  static ContactSurface polygon(PolygonOutline outline);

  /// Before gap(), as of a polygon.
  void prepare(double reach, double spacing);
  Form form() const { return form_; }
  /// Nothing: too far away to matter.
  std::optional<Gap> gap(const Vec3& x) const;
  /// Places that may touch another surface. Of a plane none: what touches it has some.
  const std::vector<TouchPoint>& probes() const { return probes_; }

 private:
  Form form_ = Form::plane;
  Vec3 at_{}, other_{};                // m: centre, or low and high corner; of a plane the normal
  double radius_ = 0.0, inner_ = 0.0;  // m
  std::vector<PolygonOutline> outline_;
  std::vector<TouchPoint> probes_;
};

/// The parts of a fill's shape, in space at the start; not yet prepared. Shapes that has_surface() says have none have
/// no parts, sides neither; in 3D lines are prisms along z, which are surfaces of walls only, for bodies of particles.
/// `spacing` (m): of the particles.
std::vector<ContactSurface> surfaces_of(const Shape& shape, const Scene& scene, double spacing);

}  // namespace barchan
