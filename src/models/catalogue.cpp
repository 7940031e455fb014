#include "models/catalogue.hpp"

#include <algorithm>
#include <utility>

#include "base/errors.hpp"
#include "models/bodies/body_contact_entry.hpp"
#include "models/bodies/elastic_phase.hpp"
#include "models/bodies/rigid_contact.hpp"
#include "models/bodies/rigid_phase.hpp"
#include "models/bodies/sets.hpp"
#include "models/bodies/total_phase.hpp"
#include "models/column/column_phase.hpp"
#include "models/coupling/border_load.hpp"
#include "models/coupling/drag_entry.hpp"
#include "models/coupling/elastic_in_fluid.hpp"
#include "models/coupling/rigid_in_fluid.hpp"
#include "models/coupling/sand_layer.hpp"
#include "models/coupling/solid_in_fluid.hpp"
#include "models/fluid/flow_zone.hpp"
#include "models/fluid/fluid_phase.hpp"
#include "models/fluid/kept_momentum.hpp"
#include "models/fluid/spacing_border.hpp"
#include "models/force_meter.hpp"
#include "models/grains/contact_entry.hpp"
#include "models/grains/grain_flux.hpp"
#include "models/grains/grain_phase.hpp"
#include "models/grains/grain_source.hpp"
#include "models/grains/hops.hpp"
#include "models/grains/saltation_layer.hpp"
#include "models/grains/spheres.hpp"
#include "models/open_sides.hpp"
#include "models/walls/driven_wall.hpp"
#include "models/walls/wall.hpp"
#include "scene/couplings.hpp"
#include "scene/located.hpp"

namespace barchan {

namespace {

/// How a kind of phase enters the program.
struct Kind {
  void (*declare)(const Scene&, std::size_t, Layout&);
  void (*describe)(const Scene&, const std::vector<ParticleBlock>&, std::size_t, Layout&, std::vector<std::string>&);
  std::unique_ptr<Model> (*make)(const Scene&, const Layout&, std::size_t);
};

template <class M>
std::unique_ptr<Model> make(const Scene& scene, const Layout& layout, std::size_t number) {
  return std::make_unique<M>(scene, layout, number);
}

Kind kind_of(const Phase& phase) {
  switch (phase.kind()) {
    case PhaseKind::fluid: return {declare_fluid, describe_fluid, make<FluidPhase>};
    case PhaseKind::elastic:
      return {declare_elastic, describe_elastic, is_total(phase) ? make<TotalPhase> : make<ElasticPhase>};
    case PhaseKind::rigid: return {declare_rigid, describe_rigid, make<RigidPhase>};
    case PhaseKind::grains: return {declare_grains, describe_grains, make<GrainPhase>};
    case PhaseKind::wall: return {declare_wall, describe_wall, make<Wall>};
    case PhaseKind::column: return {declare_column, describe_column, make<ColumnPhase>};
  }
  return {};
}

/// How an entry enters the program.
struct EntryKind {
  void (*describe)(const Scene&, const Interaction&, const Layout&, PlanEntry&);
  /// Null: the models of its phases do its work. May return null.
  std::unique_ptr<Model> (*make)(const Scene&, const Layout&, const PlanEntry&) = nullptr;
};

template <class M>
std::unique_ptr<Model> make_entry(const Scene& scene, const Layout& layout, const PlanEntry& entry) {
  return std::make_unique<M>(scene, layout, entry);
}

/// Throws SceneError when there is no law for the kinds of the two.
EntryKind kind_of_entry(const Interaction& pair, const Phase& a, const Phase& b) {
  const auto is = [&](PhaseKind k, PhaseKind l) {
    return (a.kind() == k && b.kind() == l) || (a.kind() == l && b.kind() == k);
  };
  using enum PhaseKind;
  if (touch_as_bodies(pair, a, b))
    return touch_by_surfaces(a, b) ? EntryKind{describe_rigid_contact, make_entry<RigidContact>}
                                   : EntryKind{describe_body_contact, make_entry<BodyContact>};
  if (is(fluid, fluid)) return {describe_fluids, make_spacing_border};
  if (is(fluid, wall))
    return (a.kind() == wall ? a : b).wall().law == WallLaw::adami ? EntryKind{describe_boundary}
                                                                   : EntryKind{describe_ghosts, make_ghosts};
  if (is(column, grains)) return {describe_grains_in_column};
  if (is(fluid, grains) && pair.drag_law != DragLaw::none) return {describe_sand_layer, make_sand_layer};
  if (is(fluid, grains) || is(fluid, elastic) || is(fluid, rigid)) return {describe_coupling, make_drag_entry};
  if (is(elastic, elastic)) return {is_total(a) ? describe_total_body : describe_elastic_pairs};
  const auto touches = [](const Phase& p) {
    return p.kind() == elastic || p.kind() == rigid || p.kind() == grains || p.kind() == wall;
  };
  if (touches(a) && touches(b))
    return of_spheres(pair) ? EntryKind{is(grains, rigid) ? describe_spheres_on_bodies : describe_sphere_contact}
                            : EntryKind{describe_kernel_contact, make_contact_entry};
  throw SceneError("interactions: no law between \"" + a.name + "\", of kind " + a.kind_word() + ", and \"" + b.name +
                   "\", of kind " + b.kind_word() + "; expected no such entry");
}

void add_of_entry(const Scene& scene, const Layout& layout, const PlanEntry& e, Models& models) {
  if (e.self_contact) {
    models.push_back(make_entry<BodyContact>(scene, layout, e));
    return;
  }
  const Phase &a = scene.phases[e.a], &b = scene.phases[e.b];
  const EntryKind kind = kind_of_entry(*entry_between(scene, a, b), a, b);
  if (!kind.make) return;
  models.push_back(kind.make(scene, layout, e));
  if (!models.back()) models.pop_back();  // this entry needs none: a coupling without drag
}

/// Fields of a phase for the fluid or the wind about it.
void describe_surroundings(const Scene& scene, std::size_t number, PlanPhase& p) {
  const Phase& phase = scene.phases[number];
  if ((phase.kind() == PhaseKind::rigid && meets(scene, phase, PhaseKind::fluid)) || ends_at_border(scene, phase))
    for (const Field f : {Field::wall_normal, Field::wall_depth, Field::surface_velocity, Field::surface_acceleration})
      p.fields.push_back(f);
  if (p.travels() && meets(scene, phase, PhaseKind::fluid))
    for (const Field f : {Field::surface_velocity, Field::surface_acceleration}) p.fields.push_back(f);
  p.heats = phase.kind() != PhaseKind::fluid && rubs_on_energy(scene, phase);
  if ((phase.kind() == PhaseKind::grains && meets(scene, phase, PhaseKind::column)) || drags_by_law(scene, phase))
    p.fields.push_back(Field::drag_acceleration);
}

}  // namespace

void declare_phases(const Scene& scene, Layout& layout) {
  double thickest = 0.0;
  for (std::size_t k = 0; k < layout.phases.size(); ++k) {
    layout.phases[k].kind = scene.phases[k].kind_word();
    kind_of(scene.phases[k]).declare(scene, k, layout);
    thickest = std::max(thickest, layout.phases[k].diameter);
  }
  if (layout.dimensions == 2 && thickest > 0.0) layout.slab = thickest;
}

void describe_phases(const Scene& scene, const std::vector<ParticleBlock>& blocks, Layout& layout,
                     std::vector<std::string>& warnings) {
  for (std::size_t k = 0; k < layout.phases.size(); ++k)
    kind_of(scene.phases[k]).describe(scene, blocks, k, layout, warnings);
  bool leaves = scene.domain.open.empty() || scene.domain.open.front() == "none";
  for (std::size_t k = 0; k < layout.phases.size(); ++k) leaves = leaves || layout.leaves(k);
  if (!leaves)
    throw SceneError(
        located(scene, "domain.open") +
        ": nothing leaves through it: a wall closes the side, or nothing that moves has a free surface or a "
        "diameter; expected a side without a wall, and a fluid with a free surface or grains with a diameter");
  for (std::size_t k = 0; k < layout.phases.size(); ++k) describe_surroundings(scene, k, layout.phases[k]);
}

void describe_entry(const Scene& scene, const Interaction& pair, const Layout& layout, PlanEntry& e) {
  const Phase &a = scene.phases[e.a], &b = scene.phases[e.b];
  e.fluid = a.kind() == PhaseKind::fluid || a.kind() == PhaseKind::column ? e.a : e.b;
  e.other = e.partner(e.fluid);
  kind_of_entry(pair, a, b).describe(scene, pair, layout, e);
}

std::optional<PlanEntry> contact_with_itself(const Scene& scene, const Interaction& pair, const Layout& layout,
                                             const PlanEntry& entry) {
  if (!touches_itself(pair, scene.phases[entry.a], scene.phases[entry.b])) return std::nullopt;
  return self_contact_of(scene, pair, layout, entry);
}

Models make_models(const Scene& scene, const Layout& layout) {
  Models models;
  models.push_back(std::make_unique<CommonWork>(layout));
  for (std::size_t k = 0; k < scene.force_meters.size(); ++k)  // they measure before driven sets go their way
    models.push_back(std::make_unique<ForceOn>(scene, layout, k));
  for (std::size_t k = 0; k < scene.motions.size(); ++k) {  // they lead before their bodies move
    const PhaseKind kind = find_phase(scene, scene.motions[k].phase)->kind();
    if (kind == PhaseKind::wall) models.push_back(std::make_unique<DrivenWall>(scene, layout, k));
    else if (kind != PhaseKind::rigid)  // these hold themselves
      models.push_back(std::make_unique<DrivenSet>(scene, layout, k));
  }
  for (std::size_t k = 0; k < layout.phases.size(); ++k)
    models.push_back(kind_of(scene.phases[k]).make(scene, layout, k));
  for (std::size_t k = 0; k < layout.phases.size(); ++k)
    if (layout.leaves(k)) models.push_back(std::make_unique<OpenSides>(scene, layout, k));
  for (std::size_t k = 0; k < layout.phases.size(); ++k)
    for (const FlowEnd& end : layout.phases[k].flow_ends)
      models.push_back(std::make_unique<FlowZone>(scene, layout, k, end));
  for (std::size_t k = 0; k < scene.influxes.size(); ++k)
    models.push_back(std::make_unique<GrainSource>(scene, layout, k));
  for (std::size_t k = 0; k < layout.phases.size(); ++k) {
    if (!layout.phases[k].moves() || !layout.is_extended(k)) continue;
    const bool rigid = scene.phases[k].kind() == PhaseKind::rigid, bent = ends_at_border(scene, scene.phases[k]);
    if (bent) models.push_back(std::make_unique<ElasticInFluid>(scene, layout, k));
    if (rigid)  // its surface moves before the fluid is extended into it
      models.push_back(std::make_unique<RigidInFluid>(scene, layout, k));
    models.push_back(std::make_unique<SolidInFluid>(scene, layout, k, rigid || bent));
    for (const PlanEntry& e : layout.entries)
      if (rigid && e.extends && e.other == k && e.corrected) models.push_back(make_entry<BorderLoad>(scene, layout, e));
  }
  if (std::any_of(layout.phases.begin(), layout.phases.end(), [](const PlanPhase& p) { return p.own_steps(); }))
    models.push_back(std::make_unique<Spheres>(scene, layout));
  for (const auto& e : layout.entries) add_of_entry(scene, layout, e, models);
  if (auto kept = kept_momentum(scene, layout)) models.push_back(std::move(kept));
  add_grain_fluxes(scene, layout, models);
  for (const SaltationLayer& layer : scene.measuring.saltation)
    models.push_back(std::make_unique<SaltationHistory>(scene, layout, layer));
  add_hop_statistics(scene, layout, models);
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
