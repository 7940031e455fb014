// Stability limits of the time step.
#pragma once

#include <string>

namespace barchan {

/// Courant numbers and the like, one place. Each was measured with the schemes of this code (docs/method.md).
struct StepConstants {
  static constexpr double theta = 1.25;         // of the centring diffusion theta c^2 dt; 1 is the bare leapfrog
  static constexpr double acoustic = 0.40;      // h/(c + u) (docs/method.md)
  static constexpr double viscous = 0.125;      // h^2/nu (Morris et al. 1997)
  static constexpr double force = 0.25;         // sqrt(h/|a|) (Monaghan 1992)
  static constexpr double elastic = 0.25;       // h/c_P, h the smallest of the body's entries
  static constexpr double total = 0.8;          // of the bound of the leapfrog on the stiffest vibration
  static constexpr double contact = 0.10;       // sqrt(m/K), about a thirtieth of a contact's duration
  static constexpr double restitution = 0.10;   // sqrt(m*/K) of two particles of bodies (laws/body_contact.hpp)
  static constexpr double body_contact = 0.35;  // the same between bodies of many particles
};

/// A bound on the time step. `value` is at the start; limits that follow the motion are renewed every step.
struct StepLimit {
  std::string name;  // "acoustic air", "viscous air", "force", "elastic a", "contact sand"
  double value = 0;  // s
  std::string reason;
};

}  // namespace barchan
