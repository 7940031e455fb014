// Stability limits of the time step.
#pragma once

#include <vector>

#include "plan/plan.hpp"

namespace barchan {

/// Courant numbers and the like, one place. Each was measured with the schemes of this code (docs/method.md).
struct StepConstants {
  static constexpr double theta = 1.25;     // of the centring diffusion theta c^2 dt; 1 is the bare leapfrog
  static constexpr double acoustic = 0.40;  // h/(c + u) (docs/method.md)
  static constexpr double viscous = 0.125;  // h^2/nu (Morris et al. 1997)
  static constexpr double force = 0.25;     // sqrt(h/|a|) (Monaghan 1992)
  static constexpr double elastic = 0.25;   // h/c_P, h the smallest of the body's entries
  static constexpr double contact = 0.10;   // sqrt(m/K), about a thirtieth of a contact's duration
};

/// The limits that hold from the beginning to the end: acoustic, viscous, elastic, contact. Times the scene's safety.
std::vector<StepLimit> initial_limits(const Scene& scene, const Plan& plan);

}  // namespace barchan
