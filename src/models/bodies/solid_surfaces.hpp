// Solids as balls touch them: walls and rigid bodies by the surfaces of their shapes.
//
// A ball touches a union of solids where the distance to it is the least of all places about. Contacts whose normals
// agree are one: on the seam of two bodies or facets in one plane, on a crack, on the edge of a face that the ball
// stands on. With the deepest contact A (normal n, distance a of the ball's centre), another one (m, b) is the same
// where its foot does not stand out of the plane of A: a - b (n.m) <= agreement times the radius, for two of one depth
// an angle of 2.6 degrees between the normals. A foot inside another solid is none: an inner face of the union.
#pragma once

#include <span>
#include <variant>

#include "models/bodies/facet_surface.hpp"
#include "state/rigid_body.hpp"

namespace barchan {

/// The surface of one fill's shape, in space at the start.
class SolidSurface {
 public:
  /// Nothing for shapes that has_ball_surface() says have none. `spacing` (m): of the particles; `reach` (m): how far
  /// outside distances are wanted.
  static std::optional<SolidSurface> of(const Shape& shape, const Scene& scene, double spacing, double reach);

  const Vec3& low() const { return low_; }
  const Vec3& high() const { return high_; }
  std::optional<Gap> gap(const Vec3& x) const;
  /// Whether it may be nearer to x than a distance (m).
  bool may_be_near(const Vec3& x, double distance) const;
  /// Whether a foot on another surface may lie inside without being deeper than its own contacts.
  bool may_cover() const { return !convex_; }
  /// As FacetSurface::nearest().
  template <class Accept>
  void nearest(const Vec3& x, Accept&& accept, Gap& best) const {
    if (const auto* facets = std::get_if<FacetSurface>(&form_)) return facets->nearest(flat(x), accept, best);
    const auto found = gap(x);
    if (found && found->distance < best.distance && accept(*found)) best = *found;
  }

 private:
  SolidSurface(ContactSurface form, const Vec3& low, const Vec3& high)
      : form_(std::move(form)), low_(low), high_(high) {}
  explicit SolidSurface(FacetSurface form) : form_(std::move(form)) {}
  static SolidSurface round(const Vec3& centre, double inner, double outer, bool goes_through);
  static SolidSurface of_facets(const std::vector<Facet>& facets, int dimensions, bool goes_through, double reach);
  void go_through();
  Vec3 flat(const Vec3& x) const { return goes_through_ ? Vec3{x[0], x[1], 0.0} : x; }

  std::variant<ContactSurface, FacetSurface> form_;
  Vec3 low_{}, high_{};
  bool goes_through_ = false, convex_ = true;  // goes_through_: all of z
};

class SolidSurfaces {
 public:
  static constexpr double agreement = 1e-3;  // of the radius
  static constexpr std::size_t most = 4;     // contacts of a ball with solids
  struct Contact {
    Vec3 normal;            // out of the solid
    double distance;        // m, of the ball's centre; negative inside; -infinity: too deep to tell
    std::uint32_t surface;  // number
    Vec3 foot;              // m, the place of the contact from the ball's centre
  };

  void prepare(const std::array<double, 3>& period) { period_ = period; }
  /// A solid that goes where move() says, else stays as it is at the start. Returns its number.
  std::uint32_t add_solid();
  /// Returns the number of the surface.
  std::uint32_t add_surface(std::uint32_t solid, SolidSurface surface);
  /// The solid, which stood at `start`, is at `now`.
  void move(std::uint32_t solid, const RigidBody& start, const RigidBody& now);

  /// m, where a place of a solid is now that was at `start`.
  Vec3 now(std::uint32_t solid, const Vec3& start) const;
  /// m, from the place of a solid that moves to x, by the image next to it.
  Vec3 arm(std::uint32_t solid, const Vec3& x) const;
  std::size_t size() const { return surfaces_.size(); }
  std::uint32_t solid_of(std::size_t surface) const { return surfaces_[surface].solid; }
  const SolidSurface& surface(std::size_t number) const { return surfaces_[number].surface; }
  bool may_be_near(std::size_t surface, const Vec3& x, double distance) const;
  /// m, of a ball's centre: the least distance to the surfaces within `reach`; the reach where none is.
  double distance(const Vec3& x, double reach, std::span<const std::uint16_t> surfaces) const;
  /// Adds the contacts of a ball at x with those of the surfaces that are nearer than `reach` (m) to the `count` that
  /// are known, the deepest first. Returns how many there are.
  std::size_t touch(const Vec3& x, double radius, double reach, std::span<const std::uint16_t> surfaces,
                    std::span<Contact> found, std::size_t count) const;

 private:
  struct Solid {
    Vec3 first{}, place{};              // m, at the start and now
    std::optional<OwnAxes> start, now;  // empty: it stays as it is at the start
  };
  struct Surface {
    std::uint32_t solid;
    SolidSurface surface;
  };
  /// A place of now as it was at the start.
  Vec3 to_start(const Solid& solid, const Vec3& x) const;
  Vec3 to_now(const Solid& solid, const Vec3& direction) const;
  template <class F>
  void each_image(const Surface& of, const Vec3& x, double reach, F&& f) const;
  bool covered(const Vec3& foot, double radius, std::size_t except, std::span<const std::uint16_t> surfaces) const;

  std::array<double, 3> period_{};
  std::vector<Solid> solids_;
  std::vector<Surface> surfaces_;
};

}  // namespace barchan
