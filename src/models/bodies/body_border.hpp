// The border of a rigid body that a fluid ends at: pieces of it, and how far a place is outside of it.
#pragma once

#include <optional>
#include <vector>

#include "models/bodies/contact_surface.hpp"
#include "state/rigid_body.hpp"

namespace barchan {

class BodyBorder {
 public:
  /// Along the body's own axes.
  struct Piece {
    Vec3 arm;        // m, its middle from the body's place
    Vec3 normal;     // out of the body
    double content;  // m (2D) or m2
  };

  /// `body` as it is at the start, with a shape that has a surface (has_surface); `width` (m): of its pieces, at most;
  /// `reach` (m): as far outside as distances are wanted.
  BodyBorder(const RigidBody& body, const Scene& scene, double spacing, double width, double reach);

  const std::vector<Piece>& pieces() const { return pieces_; }
  double reach() const { return reach_; }  ///< m, from the body's place to the farthest place of its border
  /// Of the place `arm` (m, in space, from the body's place) when the body's own axes are `now`. The normal is in
  /// space.
  std::optional<Gap> gap(const OwnAxes& now, const Vec3& arm) const;

 private:
  Vec3 first_place_;
  OwnAxes first_;
  std::vector<ContactSurface> surfaces_;
  std::vector<Piece> pieces_;
  double reach_ = 0.0;
};

}  // namespace barchan
