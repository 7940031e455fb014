// What a step sees of a force that sets in while the step lasts.
//
// A step of the contacts (leapfrog) takes the force at x_n for the time from t_n - dt/2 to t_n + dt/2. Twelve steps a
// contact are few, so the force is that which makes the step exact: its mean over t_n - dt .. t_n + dt with the weight
// 1 - |s|/dt, because x_(n+1) - 2 x_n + x_(n-1) = dt^2 mean(F)/m. Where a length x passes 0 while it changes by a in a
// step, max(x, 0) has the mean ramp = max(x, 0) + a w^3/6, w = max(1 - |x|/a, 0); a force that is there from x = 0 acts
// for the share begin = w^2/2 before and 1 - w^2/2 after. So contacts have a force up to one step before and after they
// overlap.
#pragma once

#include "simd/vec.hpp"

namespace barchan::contact_onset {

/// What one step sees of a force that sets in where a length x (m) passes 0, while x changes by a (m) in a step.
template <class V>
struct Onset {
  V ratio, left;  // x/a; 1 - |x|/a, at least 0
  BARCHAN_SIMD_INLINE Onset(V x, V a) : ratio(x / a), left(simd::max(V(1.0) - simd::max(ratio, -ratio), V(0.0))) {}
};
/// Of a force in proportion to x: its mean in place of max(x, 0).
template <class V>
BARCHAN_SIMD_INLINE V ramp(V x, V a) {
  const V w = Onset<V>(x, a).left;
  return simd::fma(a * (w * w), w * V(1.0 / 6.0), simd::max(x, V(0.0)));
}
/// The same in the budget of energy: the work of the steps through x = 0 is then that of the spring, at any speed.
template <class V>
BARCHAN_SIMD_INLINE V ramp_of_work(V x, V a) {
  const V w = Onset<V>(x, a).left;
  return simd::fnma(V(0.25) * a, w * (V(1.0) - w), simd::max(x, V(0.0)));
}
/// Of a force that is there from x = 0: the share of the step.
template <class V>
BARCHAN_SIMD_INLINE V begin(V x, V a) {
  const V w = Onset<V>(x, a).left, half = V(0.5) * (w * w);
  return select(x > V(0.0), V(1.0) - half, half);
}
/// The way (m) of a step at a speed (m/s), above 0.
template <class V>
BARCHAN_SIMD_INLINE V way(V speed, V dt) {
  return simd::fma(simd::max(speed, -speed), dt, V(1e-30));
}

}  // namespace barchan::contact_onset
