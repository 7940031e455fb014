// Closed sides of the domain that no particle may pass.
#pragma once

#include <cmath>
#include <cstddef>

#include "state/particles.hpp"

namespace barchan {

/// Sides of the domain that a wall closes; an open side stands at infinity.
struct Sides {
  Vec3 low{-far, -far, -far}, high{far, far, far};  // m
  double margin = 0.0;                              // m
  double margin_of_off = 0.0;  // m, of particles whose density is off by more than `off`; 0: as of all
  double rest = 0.0;           // kg/m3, density at rest
  static constexpr double off = 0.02;
  static constexpr double far = 1e300;
  bool any() const {
    for (std::size_t d = 0; d < 3; ++d)
      if (low[d] > -far || high[d] < far) return true;
    return false;
  }
};

/// Spacings that a particle of a fluid keeps from a surface that moves, as from a closed side: `rho`, its density, and
/// `rest`, the fluid's at rest, in kg/m3.
constexpr double border_room = 0.02, border_room_of_off = 0.2;
inline double room_at_border(double rho, double rest) {
  return std::abs(rho - rest) > Sides::off * rest ? border_room_of_off : border_room;
}

/// Puts particles that came nearer to a closed side than the margin back to it and stops their motion outwards. The
/// consistent scheme has no pressure that a particle at the wall would feel; where the flow drives them on, as into the
/// corner between a moving lid and a wall, they would leave. Where that has thrown a density off, more room is kept.
void hold_inside(PhaseParticles& phase, const Sides& sides);

}  // namespace barchan
