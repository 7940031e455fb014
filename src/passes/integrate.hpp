// The parts of kick-drift-kick, one loop over a phase each.
#pragma once

#include "particles/particles.hpp"

namespace barchan {

/// The equation of state of a fluid, p(rho), as integrate.cpp evaluates it.
struct PressureLaw {
  double reference_density;  // kg/m3
  double sound_speed;        // m/s
  double exponent;           // Tait's gamma; 1 is the linear equation of state
  double background;         // Pa
  double operator()(double density) const;
};

/// v += half_kick a; x += drift (v + du), du the shift velocity where the phase has one. If `pressure` is given:
/// rho += drift drho/dt, p = pressure(rho), and e += drift de/dt where the phase has an energy.
void kick_and_drift(PhaseParticles& phase, double half_kick, double drift, const PressureLaw* pressure);

/// x += drift v.
void drift(PhaseParticles& phase, double drift);

/// v += half_kick a; returns the largest component of |a|, or infinity if one is not finite.
double kick(PhaseParticles& phase, double half_kick);

}  // namespace barchan
