#include "plan/limits.hpp"

#include <algorithm>
#include <cmath>

namespace barchan {

std::vector<StepLimit> initial_limits(const Scene& scene, const Plan& plan) {
  std::vector<StepLimit> limits;
  const auto add = [&](std::string name, double value, std::string reason) {
    limits.push_back({std::move(name), value * scene.time.safety, std::move(reason)});
  };
  for (std::size_t k = 0; k < plan.phases.size(); ++k) {
    const PlanPhase& p = plan.phases[k];
    const Phase& s = scene.phases[k];
    if (p.count == 0) continue;
    const double h = p.smoothing_length;
    switch (p.kind) {
      case PhaseKind::fluid: {
        add("acoustic " + p.name, StepConstants::acoustic * h / (p.sound_speed + plan.largest_speed),
            "0.4 h/(c + u): sound crosses a spacing");
        const double nu = s.viscosity + s.artificial_viscosity * h * p.sound_speed / (2.0 * (plan.dimensions + 2));
        if (nu > 0) add("viscous " + p.name, StepConstants::viscous * h * h / nu, "0.125 h2/nu: momentum diffuses");
        break;
      }
      case PhaseKind::elastic: {
        double smallest = h;
        for (const auto& e : plan.entries)
          if (e.law == Law::elastic && (e.a == k || e.b == k)) smallest = std::min(smallest, 0.5 * e.radius);
        add("elastic " + p.name, StepConstants::elastic * smallest / p.sound_speed, "0.25 h/c_P: compression waves");
        break;
      }
      case PhaseKind::grains:
        add("contact " + p.name, StepConstants::contact * plan.spacing / p.sound_speed,
            "0.1 sqrt(m/K): a contact lasts about thirty steps");
        break;
      case PhaseKind::wall: break;
    }
  }
  return limits;
}

}  // namespace barchan
