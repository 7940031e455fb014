// What binds a fluid's two equations of turbulence (two_equations.hpp) to its entries.
#include <algorithm>
#include <cmath>

#include "base/errors.hpp"
#include "models/fluid/fluid_phase.hpp"
#include "scene/couplings.hpp"

namespace barchan {

namespace {

/// The turbulence records of the fluid whose motion records these are.
const RecordArray& turbulence_of(const Workspace& w, const RecordArray* motion, const std::string& key) {
  for (std::size_t other = 0; other < w.layout.phases.size(); ++other) {
    if (motion != &w.records(other, Record::motion)) continue;
    if (w.has(other, Record::turbulence)) return w.records(other, Record::turbulence);
    throw SceneError(key + ": \"k-omega\" of a fluid needs it in every fluid that it touches, and \"" +
                     w.layout.phases[other].name +
                     "\" has none; expected the same turbulence in both, or no such entry");
  }
  throw std::logic_error("motion records of no phase");
}

}  // namespace

void check_k_omega(const Scene& scene, std::size_t fluid, const Layout& layout) {
  const Phase& phase = scene.phases[fluid];
  const PlanPhase& plan = layout.phases[fluid];
  if (phase.fluid().turbulence != Turbulence::k_omega) return;
  const std::string key = scene.file + ": phases." + plan.name + ".turbulence: \"k-omega\" ";
  if (plan.free_surface)
    throw SceneError(key + "does not support a free surface, and \"" + plan.name +
                     "\" has one; expected no turbulence");
  if (!(plan.wind.friction_velocity(0.0) > 0.0))
    throw SceneError(key +
                     "begins as the logarithmic layer of a friction velocity, and the scene states none; expected "
                     "a log-profile as velocity of a fill, or a lid with shear-stress");
  for (std::size_t k = 0; k < scene.phases.size(); ++k) {
    const Phase& other = scene.phases[k];
    const Interaction* const pair = k == fluid ? nullptr : entry_between(scene, phase, other);
    if (!pair || pair->drag_law != DragLaw::none) continue;  // grains in the mean wind are no obstacles
    if (layout.phases[k].separate() || layout.phases[k].travels() ||
        layout.phases[k].moves() != layout.phases[k].flows())
      throw SceneError(key +
                       "supports moving grains with a law of drag by name only, and no bodies or walls that move; \"" +
                       other.name +
                       "\" is such a phase; expected \"mixing-length\", drag = \"duran\" of grains, or no entry of the "
                       "two");
  }
}

/// Its entries as its turbulence sees them.
void FluidPhase::bind_k_omega() {
  const std::string key = scene_.file + ": phases." + plan_.name + ".turbulence";
  k_omega_.viscosity = eddies_.viscosity;
  k_omega_.spacing = plan_.spacing;
  k_omega_.begins = plan_.wind.friction_velocity(0.0);
  for (const EddyNeighbour& e : eddy_neighbours_) {
    KOmegaNeighbour n;
    n.pair = e.pair;
    n.solid = e.friction != Friction::fluid;
    n.records = n.solid ? e.pair.records : &turbulence_of(*w_, e.pair.records, key);
    if (e.friction == Friction::driven) {
      n.side = -1.0;
      n.velocity = std::sqrt(norm(e.stress) / phase_.density);
    } else if (n.solid && e.friction != Friction::slip) {
      n.side = 1.0;
      k_omega_.roughness = std::max(k_omega_.roughness, e.roughness);
    }
    k_omega_neighbours_.push_back(n);
  }
}

}  // namespace barchan
