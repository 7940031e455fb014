// The parts of kick-drift-kick, one loop over a phase each.
#pragma once

#include "state/particles.hpp"

namespace barchan {

/// The equation of state of a fluid, p(rho), as integrate.cpp evaluates it.
struct PressureLaw {
  double reference_density;  // kg/m3
  double sound_speed;        // m/s
  double exponent;           // Tait's gamma; 1 is the linear equation of state
  double background;         // Pa
  double operator()(double density) const;
  double density(double pressure) const;  ///< kg/m3, at which the pressure is this
};

/// v += half_kick a; x += drift (v + du), du the shift velocity where the phase has one. If `pressure` is given:
/// rho += drift drho/dt, p = pressure(rho).
void kick_and_drift(PhaseParticles& phase, double half_kick, double drift, const PressureLaw* pressure);

/// e += time de/dt.
void advance_energy(PhaseParticles& phase, double time);

/// x += drift v.
void drift(PhaseParticles& phase, double drift);

/// v += half_kick a; returns the largest component of |a|, or infinity if one is not finite.
double kick(PhaseParticles& phase, double half_kick);

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

/// Puts particles that came nearer to a closed side than the margin back to it and stops their motion outwards. The
/// consistent scheme has no pressure that a particle at the wall would feel; where the flow drives them on, as into the
/// corner between a moving lid and a wall, they would leave. Where that has thrown a density off, more room is kept.
void hold_inside(PhaseParticles& phase, const Sides& sides);

}  // namespace barchan
