// Two spheres at a contact: what the parts of a contact law see of them, and what the parts give back.
//
// Sign: r_ab = x_a - x_b; the normal n = r_ab/|r_ab| points at a; v_n = (v_a - v_b).n is positive when they part;
// forces and torques are on a. A composed law is in laws/sphere_contact.hpp, the laws of a scene in
// laws/sphere_catalogue.hpp.
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "simd/vec.hpp"

namespace barchan {

/// Of the sum of radii: beyond this overlap a law of contact means nothing.
inline constexpr double most_sphere_overlap = 0.3;

/// What a contact is evaluated from. V: a number or a vector of them; Spin: 1 in 2D (about z), 3 in 3D.
template <class V, std::size_t Dim>
struct TouchingSpheres {
  static constexpr std::size_t spin = Dim == 2 ? 1 : 3;
  std::array<V, Dim> normal;    // from b to a
  std::array<V, Dim> velocity;  // v_a - v_b, m/s
  std::array<V, spin> spin_a, spin_b;
  V overlap;           // m; below 0 a gap
  V lever_a, lever_b;  // m, from the centres to the contact
  V reduced_mass;      // kg
  V inverse_mass;      // 1/kg, of the reduced mass
  V reduced_radius;    // m
};

/// Force on a (N), torques on a and b (N m), the energy that the contact took in the step and what it stores (J).
template <class V, std::size_t Dim>
struct ContactForces {
  static constexpr std::size_t spin = TouchingSpheres<V, Dim>::spin;
  std::array<V, Dim> force;
  std::array<V, spin> torque_a, torque_b;
  V lost, stored;
};

/// A step of the contacts, and how it observes what else acts on them (laws/other_forces.hpp).
struct StepOfContacts {
  static constexpr double observing = 0.2;  // the gain of a step among others of its length

  double dt = 0.0;                            // s
  double gain = observing, next = observing;  // of this step, and of the next one
  double span = dt;                           // s, for which a contact's own force counts in what it remembers
  double rate = dt > 0.0 ? 1.0 / dt : 0.0;    // 1/s

  /// After one of another length (s), whose end is not the start of the run.
  static StepOfContacts after(double before, double dt) {
    return {dt, observing * dt / before, observing, dt, 1.0 / dt};
  }
  /// The forces at the start of the run, before a first step (s); in that step velocities are those of the start and
  /// half a kick.
  static StepOfContacts start(double first) { return {0.0, 0.0, 2.0, 0.5 * first, 1.0 / first}; }
  static StepOfContacts first(double dt) { return {dt, 2.0, observing, dt, 1.0 / dt}; }
};

/// The same in all lanes.
template <class V>
struct ContactStep {
  V whole, half, rate, gain, next_gain, span;
  explicit ContactStep(const StepOfContacts& s)
      : whole(s.dt), half(0.5 * s.dt), rate(s.rate), gain(s.gain), next_gain(s.next), span(s.span) {}
  explicit ContactStep(double dt) : ContactStep(StepOfContacts{dt}) {}
};

/// What a normal force is evaluated from.
template <class V>
struct NormalMotion {
  V overlap;          // m; below 0 a gap
  V approach;         // m/s, -v_n, with half of what others add in the step
  V mass;             // kg, reduced
  V inverse_mass;     // 1/kg, of the reduced mass
  V radius;           // m, reduced
  V others = V(0.0);  // N, by which all but the contact press the two together (laws/other_forces.hpp)
};

/// The normal force of a step and what it consists of.
template <class V>
struct NormalForce {
  V force, elastic;  // N, positive when it pushes; elastic: its part that is stored
  V load;            // N; friction and rolling resistance are at most a share of it
  V stored;          // J
  V depth;           // m, the overlap, of a contact that begins part of a step's way
  V inverse_depth;   // 1/m; only of springs whose stiffness depends on the depth
  V stiffness;       // N/m, at that depth
  V dashpot;         // N s/m
  V share;           // of the step in which they touch
};

/// Stiffness of the springs across the normal.
template <class V>
struct SlipStiffness {
  V now, before;  // N/m, of this step and of the one before
  V shrink;       // what the contact's area leaves of a slip, at most 1
};

/// Two equal spheres that meet head-on; lengths and masses are reduced ones.
struct SphereImpact {
  double mass;    // kg
  double radius;  // m
  double speed;   // m/s
};

/// A wall is as hard and as rough as what touches it, so that one or two phases of grains make a contact's constants.
/// 1/mean(1/k): springs in series, by the share of each.
inline double in_series(std::span<const double> stiffness) {
  double softness = 0.0;
  const double share = 1.0 / static_cast<double>(stiffness.size());
  for (const double k : stiffness) softness += share / k;
  return 1.0 / softness;
}
inline double mean_of(std::span<const double> values) {
  double sum = 0.0;
  const double share = 1.0 / static_cast<double>(values.size());
  for (const double value : values) sum += share * value;
  return sum;
}

}  // namespace barchan
