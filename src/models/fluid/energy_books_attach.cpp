// What the books of a fluid's energy know of their fluid.
#include <algorithm>

#include "models/fluid/fluid_phase.hpp"

namespace barchan {

void FluidPhase::open_books() {
  const FluidParameters& q = parameters_;
  const double both = neighbours_.front().viscosity,  // as the sums have it: in the ratio of the scene's
      own = both / pair_viscosity(scene_, layout_, number_, number_) * phase_.density * keys_.viscosity;
  EnergyBooks::Fluid fluid{plan_.name, pressure_, scene_.domain.gravity, both > 0.0 ? own : 0.0, 0.0, {}};
  fluid.artificial = both - fluid.viscosity;
  bool falls = false;  // along a periodic axis, where a weight has no potential
  for (std::size_t d = 0; d < 3; ++d) {
    if (!layout_.bounds.periodic[d]) continue;
    falls = falls || fluid.weight[d] != 0.0;
    fluid.weight[d] = 0.0;
  }
  using enum EnergyBooks::Name;
  auto& may = fluid.may_take;
  may[viscosity] = keys_.viscosity > 0;
  may[artificial_viscosity] = keys_.artificial_viscosity > 0;
  may[surface_friction] = q.least_viscosity > 0 && keys_.scheme == FluidScheme::consistent;
  may[density_diffusion] = may[pressure_sums] = true;
  may[shifting] = keys_.shifting > 0;
  may[loose_fluid] = q.loosening > 0 || q.calming > 0;
  may[torn_surface] = plan_.free_surface;
  may[kept_density] = plan_.enclosed;
  may[held_at_walls] = keeps_inside_ || held_shapes_.any() || relief_.exists();
  may[forcing] = falls || std::any_of(scene_.forcings.begin(), scene_.forcings.end(),
                                      [&](const Forcing& f) { return f.phase == plan_.name; });
  may[open_sides] = layout_.leaves(number_);
  books_ = std::make_unique<EnergyBooks>(std::move(fluid), *particles_);
}

/// When all accelerations are whole.
void FluidPhase::schedule_books(Schedule& s) {
  using enum Field;
  const FieldSet read{position, velocity, density, acceleration, density_rate, shift_velocity};
  s.add({stage::energy, plan_.name, {{plan_.name, read, {}}}, [this] {
           books_->take(w_->kick_time, w_->state.steps == 0);
         }});
}

}  // namespace barchan
