// What everything but a contact does to the speed at the contact: weight, other contacts, a body's motion.
//
// Velocities are half a step behind the places, and a dashpot acts with the speed at the time of the places,
//   u_n = u_(n-1/2) + (b + f)/2,   f: what the contact's own force adds in a step (m/s), b: what all else adds
// Without b a contact at rest under a weight has the speed f/2 that is not there: its dashpot carries c f/2 of the
// weight, and its energy is lost for ever. A contact cannot tell b before all forces are summed; it observes it, as a
// disturbance observer does (Ohnishi 1987; Luenberger 1964), from how u changed beyond f:
//
//   b_n = dt Z + gain u_(n-1/2),   Z <- (b_n - gain (u_(n-1/2) + b_n + f_n))/dt
//
// so that b follows its true value with the gain of a low-pass. At rest b = -f exactly, for any gain. Alone b = 0, and
// an impact is what it is without b. Z is an acceleration: where the step changes, b follows at once.
//
// The gain is 1/5 (StepOfContacts::observing). Others' dashpots act on b a step late, and a gain of 1 would halve the
// step that many strong dashpots on one sphere allow. With g = c dt/m* and L the largest ratio of the accelerations of
// a contact by all contacts and by itself (a chain 2, layers of discs 3, packed spheres 4), steps are stable for about
// L g < 9/5 + g, without b for L g < 2 + g (models/grains/sphere_laws.cpp).
#pragma once

#include "laws/touching_spheres.hpp"
#include "simd/vec.hpp"

namespace barchan::other_forces {

/// b (m/s) of one direction; `memory`: Z (m/s2), 0 where a contact begins, which knows nothing of others; `speed`: u.
template <class V>
BARCHAN_SIMD_INLINE V in_step(V memory, V speed, const ContactStep<V>& dt) {
  using simd::select;
  return select(memory == V(0.0), V(0.0), simd::fma(dt.whole, memory, dt.gain * speed));
}
/// Z after the step; `own`: the acceleration by the contact itself (m/s2).
template <class V>
BARCHAN_SIMD_INLINE V remember(V others, V speed, V own, const ContactStep<V>& dt) {
  return dt.rate * simd::fnma(dt.next_gain, simd::fma(own, dt.span, speed + others), others);
}

}  // namespace barchan::other_forces
