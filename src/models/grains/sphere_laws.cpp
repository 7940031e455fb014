#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/errors.hpp"
#include "models/grains/spheres.hpp"
#include "scene/couplings.hpp"

namespace barchan {

namespace {

/// Steps in a contact (laws/sphere_contact.hpp); most codes take 10 to 50. Without loss: for the energy of a dense gas
/// within 1e-3 (tests/physics/spheres.cpp).
double steps_a_contact(double restitution, bool hertz) { return restitution < 1.0 ? 12.0 : hertz ? 24.0 : 48.0; }

/// Mass of a sphere of the phase (kg, not by depth): of the mean diameter, times a share of its radius cubed.
double mass_of(const Layout& layout, std::size_t phase, double share = 1.0) {
  return layout.phases[phase].mass * layout.slab * share * share * share;
}

}  // namespace

double sphere_stiffness(const Scene& scene, const Layout& layout, std::size_t phase, bool hertz) {
  const GrainsKeys& keys = scene.phases[phase].grains();
  if (!hertz && keys.stiffness) return *keys.stiffness;
  if (hertz && keys.young > 0.0) return SphereContact::hertzian(keys.young, keys.poisson, 1.0).stiffness;
  const double v = layout.largest_speed, d = layout.phases[phase].diameter, overlap = keys.largest_overlap * d;
  if (!(v > 0.0))
    throw SceneError(
        scene.file + ": time.largest-speed: missing: nothing in the scene moves or weighs, so that no stiffness of \"" +
        scene.phases[phase].name + "\" follows; expected it, or " + (hertz ? "young" : "stiffness") + " of the phase");
  const double reduced_mass = 0.5 * mass_of(layout, phase), reduced_radius = 0.25 * d;
  return hertz ? 1.25 * reduced_mass * v * v / (std::sqrt(reduced_radius) * std::pow(overlap, 2.5))
               : reduced_mass * v * v / (overlap * overlap);
}

bool spheres_turn(const Scene& scene, std::size_t phase) {
  const Phase& p = scene.phases[phase];
  return (p.grains().friction > 0.0 || p.grains().rolling_friction > 0.0) &&
         (touches_by(scene, p, ContactLaw::linear) || touches_by(scene, p, ContactLaw::hertz));
}

SphereLaws::SphereLaws(const Scene& scene, const Layout& layout) {
  const std::size_t n = layout.phases.size();
  table_.assign(n * n, SphereSearch::none);
  for (const auto& e : layout.entries) {
    if (!e.of_spheres()) continue;
    const bool hertz = e.contact == ContactLaw::hertz;
    std::vector<std::size_t> grains;
    for (const std::size_t k : {e.a, e.b})
      if (scene.phases[k].if_grains()) grains.push_back(k);
    // A wall is as hard and as rough as what touches it.
    double softness = 0.0, tangential = 0.0, restitution = 1.0, friction = 1e300, rolling = 1e300;
    for (const std::size_t k : grains) {
      const GrainsKeys& keys = scene.phases[k].grains();
      const auto share = 1.0 / static_cast<double>(grains.size());
      softness += share / sphere_stiffness(scene, layout, k, hertz);
      tangential +=
          share *
          (hertz ? SphereContact::hertzian(1.0, keys.poisson, 1.0) : SphereContact::linear(1.0, 1.0)).tangential;
      restitution = std::min(restitution, keys.restitution);
      friction = std::min(friction, keys.friction);
      rolling = std::min(rolling, keys.rolling_friction);
    }
    SphereContact law =
        hertz ? SphereContact::hertzian(1.0, 0.0, restitution) : SphereContact::linear(1.0, restitution);
    law.stiffness = 1.0 / softness;
    law.tangential = tangential;
    law.friction = friction;
    law.rolling = rolling;
    table_[e.a * n + e.b] = table_[e.b * n + e.a] = static_cast<std::uint32_t>(laws_.size());
    double inverse_mass = 0.0, curvature = 0.0;
    // Walls are the second of all pairs.
    const bool turned = !scene.phases[e.a].if_grains();
    for (const std::size_t k : {turned ? e.b : e.a, turned ? e.a : e.b}) {
      const PlanPhase& p = layout.phases[k];
      const bool moves = scene.phases[k].if_grains() != nullptr;
      inverse_densities_.push_back(moves ? std::pow(0.5 * p.diameter, 3) / mass_of(layout, k) : 0.0);
      const auto size = scene.phases[k].diameter();
      const double least = size ? 1.0 - size->spread : 1.0;
      inverse_mass += moves ? 1.0 / mass_of(layout, k, least) : 0.0;
      curvature += moves ? 2.0 / (p.diameter * least) : 0.0;
    }
    const double speed = std::max(layout.largest_speed, 1e-300);
    step_ =
        std::min(step_, law.duration(1.0 / inverse_mass, 1.0 / curvature, speed) / steps_a_contact(restitution, hertz));
    reach_ = std::max(reach_, e.radius);
    laws_.push_back(law);
  }
  for (const auto& p : layout.phases) reach_ = std::max(reach_, p.largest_diameter);
}

bool SphereLaws::rubs() const {
  return std::any_of(laws_.begin(), laws_.end(), [](const auto& l) { return l.friction > 0.0 || l.rolling > 0.0; });
}
bool SphereLaws::rolls() const {
  return std::any_of(laws_.begin(), laws_.end(), [](const auto& l) { return l.rolling > 0.0; });
}

}  // namespace barchan
