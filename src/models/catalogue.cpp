#include "models/catalogue.hpp"

#include <algorithm>

#include "base/errors.hpp"
#include "models/bodies/body_contact_entry.hpp"
#include "models/bodies/elastic_phase.hpp"
#include "models/bodies/rigid_contact.hpp"
#include "models/bodies/rigid_phase.hpp"
#include "models/bodies/sets.hpp"
#include "models/bodies/total_phase.hpp"
#include "models/column/column_phase.hpp"
#include "models/coupling/drag_entry.hpp"
#include "models/coupling/rigid_in_fluid.hpp"
#include "models/coupling/sand_layer.hpp"
#include "models/coupling/solid_in_fluid.hpp"
#include "models/fluid/fluid_phase.hpp"
#include "models/fluid/open_sides.hpp"
#include "models/force_meter.hpp"
#include "models/grains/contact_entry.hpp"
#include "models/grains/grain_flux.hpp"
#include "models/grains/grain_phase.hpp"
#include "models/grains/saltation_layer.hpp"
#include "models/grains/spheres.hpp"
#include "models/walls/wall.hpp"
#include "scene/couplings.hpp"
#include "scene/located.hpp"

namespace barchan {

namespace {

/// How a kind of phase enters the program.
struct Kind {
  bool moves, flows;
  void (*describe)(const Scene&, const std::vector<ParticleBlock>&, std::size_t, Layout&, std::vector<std::string>&);
  std::unique_ptr<Model> (*make)(const Scene&, const Layout&, std::size_t);
};

template <class M>
std::unique_ptr<Model> make(const Scene& scene, const Layout& layout, std::size_t number) {
  return std::make_unique<M>(scene, layout, number);
}

Kind kind_of(const Phase& phase) {
  switch (phase.kind()) {
    case PhaseKind::fluid: return {true, true, describe_air, make<FluidPhase>};
    case PhaseKind::elastic:
      return {true, false, describe_elastic, is_total(phase) ? make<TotalPhase> : make<ElasticPhase>};
    case PhaseKind::rigid: return {true, false, describe_rigid, make<RigidPhase>};
    case PhaseKind::grains: return {true, false, describe_grains, make<GrainPhase>};
    case PhaseKind::wall: return {false, false, describe_wall, make<Wall>};
    case PhaseKind::column: return {false, false, describe_column, make<ColumnPhase>};
  }
  return {};
}

EntryKind kind_of_entry(const Phase& a, const Phase& b) {
  const auto is = [&](PhaseKind k, PhaseKind l) {
    return (a.kind() == k && b.kind() == l) || (a.kind() == l && b.kind() == k);
  };
  using enum PhaseKind;
  if (is(fluid, fluid)) return EntryKind::fluid;
  if (is(fluid, wall))
    return (a.kind() == wall ? a : b).wall().law == WallLaw::adami ? EntryKind::boundary : EntryKind::repulsive;
  if (is(column, grains)) return EntryKind::column;
  if (is(fluid, grains) || is(fluid, elastic) || is(fluid, rigid)) return EntryKind::coupling;
  if (is(elastic, elastic)) return EntryKind::elastic;
  const auto touches = [](const Phase& p) {
    return p.kind() == elastic || p.kind() == rigid || p.kind() == grains || p.kind() == wall;
  };
  if (touches(a) && touches(b)) return EntryKind::contact;
  throw SceneError("interactions: no law between \"" + a.name + "\", of kind " + a.kind_word() + ", and \"" + b.name +
                   "\", of kind " + b.kind_word() + "; expected no such entry");
}

}  // namespace

void describe_phases(const Scene& scene, const std::vector<ParticleBlock>& blocks, Layout& layout,
                     std::vector<std::string>& warnings) {
  for (std::size_t k = 0; k < layout.phases.size(); ++k) {
    const Kind kind = kind_of(scene.phases[k]);
    layout.phases[k].kind = scene.phases[k].kind_word();
    layout.phases[k].moves = kind.moves;
    layout.phases[k].flows = kind.flows;
  }
  for (std::size_t k = 0; k < layout.phases.size(); ++k)
    kind_of(scene.phases[k]).describe(scene, blocks, k, layout, warnings);
  bool leaves = scene.domain.open.empty() || scene.domain.open.front() == "none";
  for (std::size_t k = 0; k < layout.phases.size(); ++k) leaves = leaves || layout.leaves(k);
  if (!leaves)
    throw SceneError(located(scene, "domain.open") +
                     ": nothing leaves through it; expected a scene with a fluid that has a free surface");
  for (std::size_t k = 0; k < layout.phases.size(); ++k)
    if (scene.phases[k].kind() == PhaseKind::rigid && meets(scene, scene.phases[k], PhaseKind::fluid))
      for (const Field f :
           {Field::wall_normal, Field::wall_depth, Field::surface_velocity, Field::surface_acceleration})
        layout.phases[k].fields.push_back(f);
  for (std::size_t k = 0; k < layout.phases.size(); ++k)
    layout.phases[k].heats = !layout.phases[k].flows && rubs_on_energy(scene, scene.phases[k]);
  for (std::size_t k = 0; k < layout.phases.size(); ++k)
    if ((scene.phases[k].kind() == PhaseKind::grains && meets(scene, scene.phases[k], PhaseKind::column)) ||
        drags_by_law(scene, scene.phases[k]))
      layout.phases[k].fields.push_back(Field::drag_acceleration);
}

void classify(const Scene& scene, PlanEntry& e) {
  const Phase &a = scene.phases[e.a], &b = scene.phases[e.b];
  e.kind = e.of_bodies ? EntryKind::contact : kind_of_entry(a, b);
  if (e.kind == EntryKind::coupling && e.drag_law != DragLaw::none) e.kind = EntryKind::drag;
  e.fluid = a.kind() == PhaseKind::fluid ? e.a : e.b;
  e.other = e.partner(e.fluid);
  e.corrected = (e.kind == EntryKind::fluid || e.kind == EntryKind::boundary || e.kind == EntryKind::coupling) &&
                scene.phases[e.fluid].fluid().scheme == FluidScheme::consistent;
  e.corrected = e.corrected || (e.kind == EntryKind::elastic && e.a == e.b && is_total(a));
}

Models make_models(const Scene& scene, const Layout& layout) {
  Models models;
  models.push_back(std::make_unique<CommonWork>(layout));
  for (std::size_t k = 0; k < scene.force_meters.size(); ++k)  // they measure before driven sets go their way
    models.push_back(std::make_unique<ForceOn>(scene, layout, k));
  for (std::size_t k = 0; k < scene.motions.size(); ++k)                        // they lead before their bodies move
    if (find_phase(scene, scene.motions[k].phase)->kind() != PhaseKind::rigid)  // these hold themselves
      models.push_back(std::make_unique<DrivenSet>(scene, layout, k));
  for (std::size_t k = 0; k < layout.phases.size(); ++k)
    models.push_back(kind_of(scene.phases[k]).make(scene, layout, k));
  for (std::size_t k = 0; k < layout.phases.size(); ++k)
    if (layout.leaves(k)) models.push_back(std::make_unique<OpenSides>(scene, layout, k));
  for (std::size_t k = 0; k < layout.phases.size(); ++k) {
    if (std::none_of(layout.entries.begin(), layout.entries.end(),
                     [&](const PlanEntry& e) { return e.kind == EntryKind::coupling && e.other == k; }))
      continue;
    if (scene.phases[k].kind() == PhaseKind::rigid)  // its surface moves before the fluid is extended into it
      models.push_back(std::make_unique<RigidInFluid>(scene, layout, k));
    models.push_back(std::make_unique<SolidInFluid>(scene, layout, k));
  }
  if (std::any_of(layout.phases.begin(), layout.phases.end(), [](const PlanPhase& p) { return p.diameter > 0; }))
    models.push_back(std::make_unique<Spheres>(scene, layout));
  for (const auto& e : layout.entries) {
    if (e.kind == EntryKind::drag) models.push_back(std::make_unique<SandLayer>(scene, layout, e));
    if (e.drag > 0) models.push_back(make_drag_entry(scene, layout, e));
    if (e.of_surfaces) models.push_back(std::make_unique<RigidContact>(scene, layout, e));
    else if (e.of_bodies) models.push_back(std::make_unique<BodyContact>(scene, layout, e));
    else if ((e.kind == EntryKind::contact && !e.of_spheres()) || e.kind == EntryKind::repulsive)
      models.push_back(make_contact_entry(scene, layout, e));
  }
  add_grain_fluxes(scene, layout, models);
  for (const SaltationLayer& layer : scene.measuring.saltation)
    models.push_back(std::make_unique<SaltationHistory>(scene, layout, layer));
  for (std::size_t k = 0; k < scene.markers.size(); ++k)
    models.push_back(std::make_unique<MarkedSet>(scene, layout, k));
  return models;
}

Schedule make_schedule(const Models& models) {
  Schedule schedule(stage::names);
  for (const auto& model : models) model->schedule(schedule);
  return schedule;
}

}  // namespace barchan
