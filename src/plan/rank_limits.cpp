#include "plan/rank_limits.hpp"

#include <algorithm>

#include "base/errors.hpp"
#include "scene/located.hpp"

namespace barchan {

namespace {

[[noreturn]] void refuse(const std::string& where, const std::string& what) {
  throw SceneError(where + ": " + what +
                   " cannot run on several ranks yet; expected barchan without mpirun (it uses all cores of a "
                   "machine), or one laminar fluid that fills its space, with periodic sides or walls "
                   "(docs/ranks.md)");
}

void check_phase(const Scene& scene, const Plan& plan, std::size_t number) {
  const PlanPhase& p = plan.phases[number];
  const std::string where = scene.file + ": phases." + p.name;
  const auto has = [&](Field f) { return std::find(p.fields.begin(), p.fields.end(), f) != p.fields.end(); };
  const bool still = !p.moves && p.takes_momentum;  // a wall
  if (!p.flows && !still) refuse(where, "a phase of kind \"" + p.kind + "\"");
  if (p.travels) refuse(where, "a wall that moves by a [[motion]]");
  if (p.eddies) refuse(where, "a fluid with turbulence");
  if (p.free_surface) refuse(where, "a fluid with a free surface");
  if (!p.flow_ends.empty()) refuse(where, "a fluid with an [[inflow]] or [[outflow]]");
  if (has(Field::energy)) refuse(where, "a fluid with energy");
  if (p.flows && scene.phases[number].fluid().energy_budget) refuse(where, "a fluid with an energy-budget");
  if (std::none_of(plan.entries.begin(), plan.entries.end(), [&](const PlanEntry& e) { return e.has(number); }))
    refuse(where, "a phase without any entry in [interactions]");
}

void check_sections(const Scene& scene, const Plan& plan) {
  const auto none = [&](bool there, const char* key, const char* what) {
    if (there) refuse(located(scene, key), what);
  };
  none(!scene.motions.empty(), "motion", "a [[motion]]");
  none(!scene.force_meters.empty(), "force", "a [[force]]");
  none(!scene.markers.empty(), "marker", "a [[marker]]");
  none(!scene.influxes.empty(), "influx", "an [[influx]]");
  if (!plan.instruments.empty())
    refuse(scene.file, "the instrument \"" + plan.instruments.front().name + "\" (what a scene measures)");
  for (std::size_t k = 0; k < scene.forcings.size(); ++k) {
    const Forcing& f = scene.forcings[k];
    const std::string where = scene.file + ": forcing." + std::to_string(k);
    if (f.relaxes()) refuse(where, "a [[forcing]] with a rate");
    for (const Expression& e : f.acceleration)
      if (e.is_formula()) refuse(where + ".acceleration", "a formula of place and time");
  }
}

}  // namespace

void check_for_ranks(const Scene& scene, const Plan& plan) {
  for (std::size_t k = 0; k < plan.phases.size(); ++k) check_phase(scene, plan, k);
  if (std::count_if(plan.phases.begin(), plan.phases.end(), [](const PlanPhase& p) { return p.flows; }) > 1)
    refuse(scene.file + ": phases", "a scene with several fluids");
  for (const PlanEntry& e : plan.entries)
    if (!e.continues_fluid || e.law != (e.extends ? "boundary" : "fluid"))
      refuse(scene.file + ": interactions." + e.name, "an entry with the law \"" + e.law + "\"");
  check_sections(scene, plan);
}

}  // namespace barchan
