// Contact of two surfaces at one place: of rigid bodies with each other and with walls. Sign: n is the normal of b's
// surface there, which points at a; u = (v_a - v_b).n; forces are on a.
//
//   normal      F_n = phi K delta g,  delta > 0 the overlap,
//               g = (1 + q^2)/2 - (1 - q^2)/2 u/u_s within |u| <= u_s: 1 while they approach, q^2 while they part.
//               So q^2 of the work of the approach comes back, whatever the masses are, however many places touch and
//               wherever on the bodies: the energetic restitution of Stronge (1990, Proc. R. Soc. A 431, 169).
//               u_s = K delta dt/(2 m_n), half of what the force adds to u in a step: bodies at rest feel a dashpot.
//               While |u| < u_s more comes back, of a head-on contact e^2 = q^2 + c (1 - q), c = 0.23 (w dt)^2 with
//               w^2 = K/m_n (measured): q is the root of this. With w dt = 0.1, e from 0.05 to 1 is within 0.0021.
//   tangential  F_t = -min(c_t |v_t|, mu F_n) v_t/|v_t|: Coulomb, with a creep of F_t/c_t; c_t = 2 sqrt(m_t K).
//   phi         as of particles of bodies (laws/body_contact.hpp): the step in which a contact begins or ends.
// 1/m_n and 1/m_t say how much a force there, along the normal or along v_t, changes that velocity.
#pragma once

#include <algorithm>
#include <cmath>

#include "base/vec3.hpp"

namespace barchan {

struct SurfaceContactLaw {
  double stiffness = 0;    // N/m, K
  double restitution = 1;  // e
  double friction = 0;     // mu

  /// N, the push along the normal; overlap > 0. `inverse_mass`: 1/kg, 1/m_n.
  double push(double overlap, double speed, double inverse_mass, double dt) const {
    const double spring = stiffness * overlap, share = overlap / std::max(std::abs(speed) * dt, 1e-300);
    const double phi = share <= 1.0 ? 0.5 * (1.0 + share) : 1.0;
    const double more = 0.23 * stiffness * inverse_mass * dt * dt;
    const double root = std::sqrt(std::max(more * more - 4.0 * (more - restitution * restitution), 0.0));
    const double q = std::min(0.5 * (more + root), 1.0), kept = q * q;
    const double slow = std::max(0.5 * spring * dt * inverse_mass, 1e-300);
    return phi * spring * (0.5 * (1.0 + kept) - 0.5 * (1.0 - kept) * std::clamp(speed / slow, -1.0, 1.0));
  }

  /// N s/m, by which the velocity along the surface is multiplied; `push` in N, speed > 0 in m/s, 1/m_t in 1/kg.
  double grip(double push, double speed, double inverse_mass, double dt) const {
    if (!(inverse_mass > 0.0)) return 0.0;
    const double sticking = 2.0 * std::sqrt(stiffness / inverse_mass);
    return std::min(sticking / (1.0 + 0.5 * sticking * dt * inverse_mass), friction * push / speed);
  }
};

}  // namespace barchan
