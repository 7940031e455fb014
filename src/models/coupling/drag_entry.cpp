#include "models/coupling/drag_entry.hpp"

#include <numbers>

namespace barchan {

namespace {

DragEntry drag_law(const Scene& scene, const Layout& layout, const PlanEntry& e) {
  const double d = layout.phases[e.other].spacing,
               section = layout.dimensions == 2 ? d : 0.25 * std::numbers::pi * d * d;
  const double density = scene.phases[e.fluid].density, reach = GrainBarrier::reach * d;
  // What flows at a tenth of the sound speed is turned back before it reaches a grain's centre.
  const double speed = 0.1 * layout.phases[e.fluid].sound_speed;
  const GrainBarrier barrier{reach, speed / reach, 4.0 / (speed * speed)};
  return {e.kernel, e.radius, 0.5 * e.drag * density * section, density, barrier};
}

}  // namespace

DragModel::DragModel(const Scene& scene, const Layout& layout, const PlanEntry& entry)
    : entry_(entry), law_(drag_law(scene, layout, entry)) {}

void DragModel::schedule(Schedule& s) {
  using enum Field;
  for (const std::size_t phase : {entry_.a, entry_.b})
    s.add({stage::drag, entry_.name, {position, velocity, density}, {acceleration}, [this, phase] { pull(phase); }});
}

void DragModel::pull(std::size_t phase) {
  drag_forces(w_->particles(phase), w_->motion[phase], w_->list(entry_.direction(phase)),
              w_->motion[entry_.partner(phase)], law_, phase == entry_.fluid);
}

}  // namespace barchan
