// Warns of a scene outside the ranges in which the runs of the stability atlas held (docs/stability.md).
#include <algorithm>
#include <string_view>

#include "output/numbers.hpp"
#include "plan/plan.hpp"

namespace barchan {
namespace {

/// Of all small scenes of a kind of physics: between these values no run was unstable.
struct StableRange {
  std::string_view kind, quantity;
  double low, high;
};
constexpr StableRange stable_ranges[] = {
#include "plan/stable_ranges.inc"
};

const StableRange* range_of(std::string_view kind, std::string_view quantity) {
  const auto* found = std::find_if(std::begin(stable_ranges), std::end(stable_ranges),
                                   [&](const StableRange& r) { return r.kind == kind && r.quantity == quantity; });
  return found == std::end(stable_ranges) ? nullptr : found;
}

std::string range_text(const StableRange& r) {
  constexpr double without_bound = 1e9;
  return r.high >= without_bound ? "at least " + brief(r.low) : brief(r.low) + " to " + brief(r.high);
}

class Comparison {
 public:
  Comparison(const Scene& scene, Plan& plan) : scene_(scene), plan_(plan) {}

  void phase(std::size_t k) {
    const PlanPhase& p = plan_.phases[k];
    const std::string& kind = p.physics;
    if (plan_.fixed_step == 0) {
      if (scene_.time.safety != 1.0) compare(kind, "safety", scene_.time.safety, "time.safety", "");
    } else if (const double limit = limit_at_safety_one(p.name); limit > 0) {
      compare(kind, "safety", plan_.fixed_step / limit, "time.step", " of the stability limit");
    }
    const std::string of = "phases." + p.name;
    if (p.sound_speed > 0 && plan_.largest_speed > 0)
      compare(kind, "sound", p.sound_speed / plan_.largest_speed, of + ".sound-speed", " of the largest speed");
    if (p.sound_speed > 0)
      compare(kind, "elastic speed", plan_.largest_speed / p.sound_speed, of + ".young",
              ", the largest speed over that of sound,");
    for (const PlanEntry& e : plan_.entries)
      if (e.a == k && e.b == k) compare(kind, "radius", e.radius / e.spacing, "interactions." + e.name, " spacings");
    for (std::size_t f = 0; f < scene_.fills.size(); ++f)
      if (scene_.fills[f].phase == p.name && scene_.fills[f].perturb > 0)
        compare(kind, "disorder", scene_.fills[f].perturb, "fill." + std::to_string(f) + ".perturb", " spacings");
  }

  void entry(const PlanEntry& e) {
    if (!e.continues_fluid || e.extends || e.a == e.b) return;  // no interface of two fluids
    const double a = scene_.phases[e.a].density, b = scene_.phases[e.b].density;
    compare(plan_.phases[e.a].physics, "density ratio", std::max(a, b) / std::min(a, b), "interactions." + e.name,
            ", the ratio of the densities,");
  }

 private:
  /// Of the waves in a fluid or a body (s); 0: it has none. That of contacts counts only where grains touch.
  double limit_at_safety_one(const std::string& phase) const {
    double least = 0;
    for (const StepLimit& l : plan_.limits)
      if ((l.name == "acoustic " + phase || l.name == "elastic " + phase) && (least == 0 || l.value < least))
        least = l.value;
    return least / scene_.time.safety;
  }
  void compare(const std::string& kind, std::string_view quantity, double value, const std::string& key,
               const std::string& unit) {
    const StableRange* r = range_of(kind, quantity);
    constexpr double rounding = 1e-6;
    if (!r || (value >= r->low * (1 - rounding) && value <= r->high * (1 + rounding))) return;
    plan_.warnings.push_back(key + ": " + brief(value) + unit +
                             " is outside what the stability atlas found stable for " + kind + ", " + range_text(*r) +
                             " (docs/stability.md)");
  }

  const Scene& scene_;
  Plan& plan_;
};

}  // namespace

void warn_outside_stable_ranges(const Scene& scene, Plan& plan) {
  Comparison comparison(scene, plan);
  for (std::size_t k = 0; k < plan.phases.size(); ++k) comparison.phase(k);
  for (const PlanEntry& e : plan.entries) comparison.entry(e);
}

}  // namespace barchan
