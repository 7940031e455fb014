// What the plan has to know of a column of air and of its entries.
#include <algorithm>
#include <cmath>

#include "models/column/column_phase.hpp"
#include "models/drive.hpp"
#include "output/numbers.hpp"
#include "scene/couplings.hpp"
#include "scene/log_wind.hpp"

namespace barchan {

namespace {

constexpr double most_over_friction_velocity = 35.0;  // of a wind: ln(1 m/1 um)/0.4
constexpr double strongest_column = 0.7;              // m/s, u* up to which its flux agrees with measurements

/// The warning of a column that is stronger; empty: it is not.
std::string beyond_measured_winds(const Scene& scene, const Phase& wind, const ColumnKeys& keys) {
  const double u = keys.held ? 0.0 : largest_friction_velocity(scene, keys.friction_velocity);
  if (!(u > strongest_column)) return "";
  return "phases." + wind.name + ".friction-velocity: " + brief(u) +
         " m/s is beyond the winds in which a column's flux of sand agrees with measurements, 0.24 to 0.7 m/s: above "
         "0.8 m/s it is 1.5 times too large, and the height of the layer grows with the wind, which measured ones do "
         "not";
}

/// A fill of the wind's grains with a dune, which a mean along x does not know; empty: there is none.
std::string dune_in_mean_wind(const Scene& scene, const Phase& wind) {
  for (std::size_t k = 0; k < scene.fills.size(); ++k) {
    const auto* bed = std::get_if<BedShape>(&scene.fills[k].shape);
    const Phase* grains = find_phase(scene, scene.fills[k].phase);
    if (!bed || !bed->dune || !grains || !entry_between(scene, wind, *grains)) continue;
    return "fill." + std::to_string(k) + ".shape.dune: the wind of \"" + wind.name +
           "\" is one mean along x, over a flat bed: over the crest and behind it, it is the same; expected air of "
           "kind fluid, as in the scene dune, or a flat bed";
  }
  return "";
}

}  // namespace

void declare_column(const Scene&, std::size_t, Layout&) {}  // the defaults: nothing of it moves

void describe_column(const Scene& scene, const std::vector<ParticleBlock>&, std::size_t number, Layout& layout,
                     std::vector<std::string>& warnings) {
  if (const std::string told = dune_in_mean_wind(scene, scene.phases[number]); !told.empty()) warnings.push_back(told);
  const ColumnKeys& keys = scene.phases[number].column();
  PlanPhase& p = layout.phases[number];
  p.physics = "column";
  p.wind.driven = !keys.held;
  p.wind.beyond_measured = beyond_measured_winds(scene, scene.phases[number], keys);
  if (!keys.held)
    p.wind.friction_velocity = [u = keys.friction_velocity](double time) { return std::abs(Formula(u)({}, time)); };
  const Formula friction_velocity(keys.friction_velocity);
  constexpr int moments = 64;
  double& largest = p.wind.largest_speed;
  for (int k = 0; k <= moments; ++k)
    largest =
        std::max(largest, most_over_friction_velocity * std::abs(friction_velocity({}, scene.time.end * k / moments)));
  if (keys.speed) largest = std::max(largest, std::abs(*keys.speed));
  if (keys.log_profile) largest = std::max(largest, std::abs(log_wind(*keys.log_profile, scene.domain.size[1])));
}

void describe_grains_in_column(const Scene&, const Interaction&, const Layout&, PlanEntry& e) {
  e.law = "column";
  e.meaning = "no kernel: the wind of the grain's height";
  e.pairs = Pairs::own;  // by height
  e.blows = e.wind_by_height = true;
}

}  // namespace barchan
