#include "scene/couplings.hpp"

#include <algorithm>

namespace barchan {

const Interaction* entry_between(const Scene& scene, const Phase& a, const Phase& b) {
  for (const Interaction& pair : scene.interactions)
    if ((pair.a == a.name && pair.b == b.name) || (pair.a == b.name && pair.b == a.name)) return &pair;
  return nullptr;
}

bool meets(const Scene& scene, const Phase& phase, PhaseKind kind) {
  return std::any_of(scene.phases.begin(), scene.phases.end(), [&](const Phase& other) {
    return other.kind() == kind && other.name != phase.name && entry_between(scene, phase, other);
  });
}

bool touches_by(const Scene& scene, const Phase& phase, ContactLaw law) {
  return std::any_of(scene.interactions.begin(), scene.interactions.end(), [&](const Interaction& pair) {
    return pair.law == law && (pair.a == phase.name || pair.b == phase.name);
  });
}

bool has_eddies(const Scene& scene, const Phase& fluid) {
  if (fluid.kind() != PhaseKind::fluid) return false;
  return fluid.fluid().turbulence != Turbulence::none ||
         std::any_of(scene.phases.begin(), scene.phases.end(), [&](const Phase& wall) {
           return wall.kind() == PhaseKind::wall && (wall.wall().roughness || wall.wall().shear_stress) &&
                  entry_between(scene, fluid, wall);
         });
}

}  // namespace barchan
