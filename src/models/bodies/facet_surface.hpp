// A closed border of segments or triangles as balls touch it: each face, edge and corner once.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "models/bodies/contact_surface.hpp"

namespace barchan {

class FacetSurface {
 public:
  /// `dimensions`: 2 for segments in x, y, 3 for triangles, in any order and facing either way. `reach` (m): how far
  /// outside distances are wanted.
  FacetSurface(const std::vector<Facet>& facets, int dimensions, double reach);

  const Vec3& low() const { return low_; }
  const Vec3& high() const { return high_; }
  double reach() const { return reach_; }

  /// How far the place is from the surface; nothing farther outside than the reach. Farther inside: -infinity.
  std::optional<Gap> gap(const Vec3& x) const;

  /// Of the places of the surface whose distance to x is the least of all places about them, the nearest one that is
  /// nearer than best.distance and for which accept(gap) holds: it becomes `best`. From inside the solid: the nearest
  /// place of all.
  template <class Accept>
  void nearest(const Vec3& x, Accept&& accept, Gap& best) const;

 private:
  static constexpr int inner = 0, first_corner = 1, first_edge = 4;  // what of a facet a foot lies on
  struct Face {
    Facet corners;
    Vec3 normal;                           // outwards
    std::array<std::uint32_t, 3> numbers;  // of the corners
  };
  struct Foot {
    Vec3 out;          // m, from the foot to the place
    double distance2;  // m2
    int feature;
  };
  struct Nearest {
    const Face* face = nullptr;
    Foot foot{{}, 1e300, inner};
  };
  struct Near {
    const std::uint32_t *begin = nullptr, *end = nullptr;
    bool deep = false;  // no facet is near, and the place is inside
  };
  Foot foot_on(const Face& face, const Vec3& x) const;
  Foot foot_on_segment(const Face& face, const Vec3& x) const;
  Foot foot_on_triangle(const Face& face, const Vec3& x) const;
  std::size_t corners() const { return static_cast<std::size_t>(dimensions_); }
  void number_corners();
  void turn_outwards();
  void make_cells();
  Near near(const Vec3& x) const;
  Nearest nearest_of(const Near& near, const Vec3& x) const;
  /// The mean of the normals about the feature (Baerentzen & Aanaes 2005): it says on which side a place lies.
  Vec3 normal_of(const Face& face, int feature) const;
  bool is_inside(const Nearest& n) const { return dot(n.foot.out, normal_of(*n.face, n.foot.feature)) < 0.0; }
  Gap gap_of(const Face& face, const Foot& foot, bool inside) const;
  bool is_least(const Face& face, const Foot& foot, const Vec3& x) const;
  /// Calls f with each facet that has the corner or the edge.
  template <class F>
  void each_about(const Face& face, int feature, F&& f) const;

  int dimensions_;
  double reach_;
  std::vector<Face> faces_;
  std::vector<Vec3> corner_normals_;             // by corner: sums
  std::vector<std::uint32_t> about_, of_about_;  // by corner: facets that have it
  Vec3 low_{}, high_{}, first_{};                // m; first_: corner of the cells
  double width_ = 1.0;                           // m, of a cell
  std::array<std::size_t, 3> count_{1, 1, 1};
  std::vector<std::uint32_t> begin_, near_;  // by cell
  std::vector<char> deep_;                   // by cell
};

template <class Accept>
void FacetSurface::nearest(const Vec3& x, Accept&& accept, Gap& best) const {
  const Near cell = near(x);
  if (cell.begin == cell.end) {
    if (cell.deep) best = {-std::numeric_limits<double>::infinity(), {}};
    return;
  }
  const Nearest first = nearest_of(cell, x);
  if (first.face == nullptr) return;  // x is not a number
  if (is_inside(first)) {
    const Gap gap = gap_of(*first.face, first.foot, true);
    if (gap.distance < best.distance && accept(gap)) best = gap;
    return;
  }
  for (const std::uint32_t* f = cell.begin; f != cell.end; ++f) {
    const Face& face = faces_[*f];
    const Foot foot = foot_on(face, x);
    if (best.distance < 0.0 || !(foot.distance2 < best.distance * best.distance)) continue;
    if (foot.feature == inner && dot(foot.out, face.normal) < 0.0) continue;  // the solid lies between
    const Gap gap = gap_of(face, foot, false);
    if (gap.distance < best.distance && accept(gap) && is_least(face, foot, x)) best = gap;
  }
}

}  // namespace barchan
