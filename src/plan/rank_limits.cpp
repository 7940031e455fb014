#include "plan/rank_limits.hpp"

#include <algorithm>

#include "base/errors.hpp"
#include "scene/located.hpp"

namespace barchan {

namespace {

[[noreturn]] void cannot_run(const std::string& where, const std::string& what) {
  throw SceneError(where + ": " + what +
                   " cannot run on several ranks yet; expected barchan without mpirun (it uses all cores of a "
                   "machine), or a scene of fluids and walls alone (docs/ranks.md)");
}

void check_phase(const Scene& scene, const Plan& plan, std::size_t number) {
  const PlanPhase& p = plan.phases[number];
  const std::string where = scene.file + ": phases." + p.name;
  const bool wall = !p.moves && p.takes_momentum;
  if (!p.flows && !wall) cannot_run(where, "a phase of kind \"" + p.kind + "\"");
  if (p.flows && scene.phases[number].fluid().energy_budget) cannot_run(where, "a fluid with an energy-budget");
  if (std::none_of(plan.entries.begin(), plan.entries.end(), [&](const PlanEntry& e) { return e.has(number); }))
    cannot_run(where, "a phase without any entry in [interactions]");
}

}  // namespace

void check_for_ranks(const Scene& scene, const Plan& plan) {
  for (std::size_t k = 0; k < plan.phases.size(); ++k) check_phase(scene, plan, k);
  for (const PlanEntry& e : plan.entries)
    if (!e.continues_fluid || e.law != (e.extends ? "boundary" : "fluid"))
      cannot_run(scene.file + ": interactions." + e.name, "an entry with the law \"" + e.law + "\"");
  if (!scene.influxes.empty()) cannot_run(located(scene, "influx"), "an [[influx]]");
}

}  // namespace barchan
