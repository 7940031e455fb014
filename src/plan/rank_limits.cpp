#include "plan/rank_limits.hpp"

#include "base/errors.hpp"

namespace barchan {

namespace {

[[noreturn]] void cannot_run(const std::string& where, const std::string& what) {
  throw SceneError(where + ": " + what +
                   " cannot run on several ranks yet; expected barchan without mpirun (it uses all cores of a "
                   "machine), or a scene that docs/ranks.md names");
}

}  // namespace

void check_for_ranks(const Scene& scene, const Plan& plan) {
  for (std::size_t k = 0; k < plan.phases.size(); ++k)
    if (plan.phases[k].flows && scene.phases[k].fluid().energy_budget)
      cannot_run(scene.file + ": phases." + plan.phases[k].name, "a fluid with an energy-budget");
}

}  // namespace barchan
