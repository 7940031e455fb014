// The surface of an elastic body: which particles make it, and its outward normals as the body is deformed.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "base/vec3.hpp"
#include "engine/cell_grid.hpp"
#include "engine/records.hpp"
#include "laws/smooth_contact.hpp"
#include "state/particles.hpp"

namespace barchan {

/// Made once of the particles' first places, and never changed.
///
/// N = sum w X over the first neighbours points outwards, w = V (-dW/dr)/r. A particle belongs to the surface if no
/// neighbour stands within 60 degrees of N. The length of a normal is the 16th power of |mean of the unit normals about
/// it|: near 1 on a face and on a round surface, 0.15 at the edge of a block, so that the face decides how both touch.
/// The share is g = (sum S)^(-1/2) over the body's own surface (laws/smooth_contact.hpp).
class BodySurface {
 public:
  BodySurface() = default;
  /// `places` (m) by id; `radius` (m): of the wendland-c2 kernel.
  BodySurface(const std::vector<Vec3>& places, const Bounds& bounds, double spacing, double radius,
              const SmoothContactLaw& law);

  /// Records of the surface: n along cof(F) N, F the gradient of the motion by the particle's first neighbours. The
  /// phase keeps its places. Particles that are not of the surface have a share of zero.
  void pack(const PhaseParticles& body, RecordArray& records) const;
  /// A particle from whose neighbours no gradient follows; -1: there is none.
  std::int64_t alone() const { return alone_; }
  std::size_t size() const { return points_.size(); }

 private:
  struct Neighbour {
    std::uint32_t id;
    std::array<double, 3> reach;  // 1/m, w M^-1 X
  };
  struct Point {
    std::uint32_t id, begin, end;  // of neighbours_
    Vec3 normal;                   // N times its length
    double share;
  };
  template <class Kernel>
  void add_point(const std::vector<Vec3>& places, const std::vector<std::uint32_t>& near, std::size_t a, double radius,
                 const Kernel& kernel, std::vector<Vec3>& normals);
  template <int Dim>
  void pack_as(const PhaseParticles& body, RecordArray& records) const;
  Vec3 turned(const std::array<const double*, 3>& at, const std::uint32_t* places, const Point& p) const;

  int dimensions_ = 2;
  Vec3 period_{};  // m; 0: not periodic
  std::int64_t alone_ = -1;
  std::vector<Point> points_;
  std::vector<Neighbour> neighbours_;
};

}  // namespace barchan
