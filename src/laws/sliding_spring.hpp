// A spring with a dashpot that gives way at a limit, for the forces of a contact that remember: friction and rolling.
//
//   F = -k xi - c v, at most `limit`; xi: the slip (m) since the spheres touched, dxi/dt = v. Where it slides, xi is
//   what F needs (Cundall and Strack 1979; Luding 2008, section 3.1).
//
// Where the stiffness changes from step to step, `old_stiffness` is that of the step before: what the slip before the
// step stored is told by it. The velocity is that of the force's own time (laws/normal_dashpot.hpp).
#pragma once

#include <array>

#include "simd/vec.hpp"

namespace barchan {

/// `slip` (m) is that before the step and becomes that after it; `old`: as it was remembered; `way` (m/s): half a step
/// ago; `in_touch`: the share of the step that counts for the slip; `velocity` (m/s): with half of what others add;
/// `inverse_mass` (1/kg): of the motion that resists. Returns the force (N); adds what is lost and what is stored (J).
template <class V, std::size_t N>
BARCHAN_SIMD_INLINE std::array<V, N> slide(std::array<V, N>& slip, const std::array<V, N>& old,
                                           const std::array<V, N>& way, const std::array<V, N>& velocity, V stiffness,
                                           V old_stiffness, V dashpot, V limit, V inverse_mass, V dt, V in_touch,
                                           V& lost, V& stored) {
  using simd::fma;
  using simd::fnma;
  std::array<V, N> force;
  const V slower = fma(dashpot * inverse_mass, V(0.5) * dt, V(1.0)), inverse = V(1.0) / (slower * stiffness);
  const V centred = inverse * stiffness;
  V f2(1e-200), was(0.0), now(0.0), work(0.0);
  for (std::size_t k = 0; k < N; ++k) {
    slip[k] = fma(way[k], dt * in_touch, slip[k]);
    force[k] = -fma(stiffness, slip[k], dashpot * velocity[k]) * centred;
    f2 = fma(force[k], force[k], f2);
  }
  const auto slides = f2 > limit * limit;
  if (to_bits(slides) != 0) {
    const V share = select(slides, limit / simd::sqrt(f2), V(1.0)), back = inverse * slower;
    for (std::size_t k = 0; k < N; ++k) {
      force[k] = force[k] * share;
      slip[k] = select(slides, -force[k] * back, slip[k]);
    }
  }
  for (std::size_t k = 0; k < N; ++k) {
    was = fma(old[k], old[k], was);
    now = fma(slip[k], slip[k], now);
    work = fma(force[k], fma(force[k] * inverse_mass, V(0.5) * dt, velocity[k]), work);
  }
  const V energy = V(0.5) * stiffness * now;
  stored += energy;
  lost += fnma(work, dt, V(0.5) * old_stiffness * was - energy);
  return force;
}

}  // namespace barchan
