#include "models/coupling/drag_entry.hpp"

#include <numbers>

#include "models/pair_forces.hpp"

namespace barchan {

std::unique_ptr<Model> make_drag_entry(const Scene& scene, const Layout& layout, const PlanEntry& e) {
  if (!(e.given.drag > 0)) return nullptr;
  const double d = layout.phases[e.other].spacing,
               section = layout.dimensions == 2 ? d : 0.25 * std::numbers::pi * d * d;
  const double density = scene.phases[e.fluid].density, reach = GrainBarrier::reach * d;
  // What flows at a tenth of the sound speed is turned back before it reaches a grain's centre.
  const double speed = 0.1 * layout.phases[e.fluid].sound_speed;
  const GrainBarrier barrier{reach, speed / reach, 4.0 / (speed * speed)};
  const DragAndBarrier law{{}, 0.5 * e.given.drag * density * section, density, barrier};
  return std::make_unique<ForceEntry<DragAndBarrier>>(layout, e, law, stage::drag,
                                                      FieldSet{Field::position, Field::velocity, Field::density});
}

}  // namespace barchan
