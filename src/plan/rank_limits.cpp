#include "plan/rank_limits.hpp"

#include <algorithm>

#include "base/errors.hpp"
#include "scene/located.hpp"

namespace barchan {

namespace {

[[noreturn]] void cannot_run(const std::string& where, const std::string& what) {
  throw SceneError(where + ": " + what +
                   " cannot run on several ranks yet; expected barchan without mpirun (it uses all cores of a "
                   "machine), or a scene of fluids, walls, grains and columns of air (docs/ranks.md)");
}

void check_phase(const Scene& scene, const Plan& plan, std::size_t number) {
  const PlanPhase& p = plan.phases[number];
  const std::string where = scene.file + ": phases." + p.name;
  const PhaseKind kind = scene.phases[number].kind();
  if (kind == PhaseKind::elastic || kind == PhaseKind::rigid) cannot_run(where, "a phase of kind \"" + p.kind + "\"");
  if (p.flows && scene.phases[number].fluid().energy_budget) cannot_run(where, "a fluid with an energy-budget");
}

}  // namespace

void check_for_ranks(const Scene& scene, const Plan& plan) {
  for (std::size_t k = 0; k < plan.phases.size(); ++k) check_phase(scene, plan, k);
}

}  // namespace barchan
