#include "models/coupling/border_stress.hpp"

#include "models/fluid/fluid_phase.hpp"

namespace barchan {

BorderFluid border_fluid(const Scene& scene, const Layout& layout, const PlanEntry& entry) {
  const PlanPhase& fluid = layout.phases[entry.fluid];
  return {entry.fluid,
          fluid.free_surface,
          fluid.spacing,
          border_fit_radius * fluid.spacing,
          pair_viscosity(scene, layout, entry.other, entry.fluid),
          scene.phases[entry.fluid].density,
          fluid.sound_speed};
}

}  // namespace barchan
