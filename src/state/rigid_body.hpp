// A body that moves as a whole: what it is, and where it is.
//
// Its own axes are the principal axes of its inertia about its place: the centre of mass or, of a body that is turned
// about a point, that point. At the start of a run they need not be those of space.
#pragma once

#include <array>
#include <cstddef>

#include "base/vec3.hpp"

namespace barchan {

/// What changes from step to step. Doubles only: it is saved as it lies in the memory.
struct RigidMotion {
  Vec3 place{}, velocity{};                // m, m/s; along periodic axes the place is not wrapped
  double angle = 0.0;                      // rad, in 2D, since the start
  std::array<double, 4> turn{1, 0, 0, 0};  // in 3D: the unit quaternion that turns its own axes into those of space
  Vec3 spin{};                             // kg m2/s, angular momentum about its place along its own axes; in 2D z
  Vec3 force{}, torque{};                  // N, N m: of the last step, all that kick it; the torque about its place
  Vec3 touch_force{}, touch_torque{};      // N, N m: of these, what others give that touch it
  double touch_work = 0.0;                 // J, the work of these on it since the start
};

struct RigidBody {
  enum class Hold { free, pinned, driven };
  std::size_t phase = 0, fill = 0;   // numbers
  std::size_t first = 0, count = 0;  // its particles: ids from the phase's first
  std::size_t motion = 0;            // number of the [[motion]] that holds it
  Hold hold = Hold::free;
  int dimensions = 2;
  double mass = 0.0;   // kg (2D: kg/m)
  Vec3 inertia{};      // kg m2, about its place along its own axes; in 2D about z only
  Vec3 centre{};       // m, the centre of mass from its place, along its own axes
  Vec3 first_place{};  // m
  double reach = 0.0;  // m, from its place to its farthest particle
  RigidMotion now;
};

/// The own axes of a body in space.
class OwnAxes {
 public:
  explicit OwnAxes(const RigidBody& body);
  Vec3 to_space(const Vec3& x) const { return x[0] * axes_[0] + x[1] * axes_[1] + x[2] * axes_[2]; }
  Vec3 to_own(const Vec3& x) const { return {dot(axes_[0], x), dot(axes_[1], x), dot(axes_[2], x)}; }

 private:
  std::array<Vec3, 3> axes_;
};

/// 1/s, along its own axes.
Vec3 own_angular_velocity(const RigidBody& body);
/// m and m/s, of its centre of mass.
Vec3 centre_of(const RigidBody& body);
Vec3 centre_velocity(const RigidBody& body);
/// kg m2/s, about its centre of mass, in space.
Vec3 turning_about_centre(const RigidBody& body);
/// J.
double kinetic_energy(const RigidBody& body);
/// Its own angular momentum (kg m2/s) for an angular velocity (1/s) along its own axes.
Vec3 spin_of(const RigidBody& body, const Vec3& rate);
/// Turns for a time (s) without any torque. 2D: exact. 3D: Hamilton's function of the free body, the sum of
/// L_i^2/(2 I_i), is split into rotations about its own axes (Dullweber, Leimkuhler & McLachlan 1997, J. Chem. Phys.
/// 107, 5840), composed to the fourth order (Suzuki 1990): the angular momentum in space stays as it is to rounding,
/// the energy within (w dt)^4.
void turn_freely(RigidBody& body, double time);
/// Turns with this angular velocity (1/s, in space) for a time (s).
void turn_by(RigidBody& body, const Vec3& rate, double time);

}  // namespace barchan
