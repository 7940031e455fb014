#include "plan/rank_limits.hpp"

#include "base/errors.hpp"

namespace barchan {

namespace {

[[noreturn]] void cannot_run(const std::string& where, const std::string& what) {
  throw SceneError(where + ": " + what +
                   " cannot run on several ranks yet; expected barchan without mpirun (it uses all cores of a "
                   "machine), or a scene that docs/ranks.md names");
}

/// A fluid of the consistent scheme loads a body by integrals over its border, which look at the fluid of one process.
void check_entry(const Scene& scene, const Plan& plan, const PlanEntry& e) {
  const PlanPhase& other = plan.phases[e.other];
  if (e.extends && e.corrected && other.moves && !other.separate)
    cannot_run(scene.file + ": interactions." + e.name, "a body in a fluid of the consistent scheme");
}

}  // namespace

void check_for_ranks(const Scene& scene, const Plan& plan) {
  for (std::size_t k = 0; k < plan.phases.size(); ++k)
    if (plan.phases[k].flows && scene.phases[k].fluid().energy_budget)
      cannot_run(scene.file + ": phases." + plan.phases[k].name, "a fluid with an energy-budget");
  for (const PlanEntry& e : plan.entries) check_entry(scene, plan, e);
}

}  // namespace barchan
