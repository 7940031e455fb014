// The pressure of fluids at rest under gravity, one above another.
#include <algorithm>
#include <cmath>

#include "engine/exchange.hpp"
#include "models/fluid/fluid_phase.hpp"

namespace barchan {

namespace {

/// Where a fluid begins along gravity, and what lies on it: its pressure at rest follows.
struct Column {
  bool hydrostatic = false;
  double potential = 0;  // g.x of the surface, m2/s2: the smallest of the fluid
  double pressure = 0;   // Pa, there
  double density = 0, sound_speed = 0;
  bool linear = true;

  /// Weight of what lies above the places where g.x has this value; of the compressible column, rho = rho_s
  /// exp(gz/c^2), when the equation of state is linear.
  double pressure_at(double place) const {
    const double c2 = sound_speed * sound_speed;
    if (!linear) return pressure + density * (place - potential);
    return pressure + (density * c2 + pressure) * std::expm1((place - potential) / c2);
  }
};

/// The column of one fluid, as if nothing lay on it.
Column column_of(const Scene& scene, const Layout& layout, const ParticleBlock& block, std::size_t k) {
  const Vec3& g = scene.domain.gravity;
  const Phase& s = scene.phases[k];
  Column column;
  bool perturbed = false;
  for (const auto& f : scene.fills) {
    if (f.phase != s.name) continue;
    column.hydrostatic = column.hydrostatic || f.hydrostatic;
    perturbed = perturbed || f.perturb > 0;
  }
  if (!layout.phases[k].flows() || block.count() == 0) column.hydrostatic = false;
  if (!column.hydrostatic) return column;
  column.density = s.density;
  column.sound_speed = layout.phases[k].sound_speed;
  column.linear = s.fluid().equation_of_state == EquationOfState::linear;
  double highest = 1e300;
  for (const Vec3& x : block.position) highest = std::min(highest, dot(g, x));
  column.potential = Exchange().least(highest) - 0.5 * layout.phases[k].spacing * norm(g);
  for (std::size_t d = 0; d < 3; ++d) {  // disturbed rows: where the lattice has its surface
    if (!perturbed || g[d] == 0 || std::abs(g[d]) < norm(g)) continue;
    const double row = column.potential / g[d] - scene.domain.origin[d];
    column.potential =
        g[d] * (scene.domain.origin[d] + layout.phases[k].spacing * std::round(row / layout.phases[k].spacing));
  }
  return column;
}

}  // namespace

bool calmed(const Scene& scene, const Layout& layout, std::size_t fluid) {
  const PlanPhase& p = layout.phases[fluid];
  return p.free_surface && !p.eddies && norm(scene.domain.gravity) > 0.0 &&
         scene.phases[fluid].fluid().scheme == FluidScheme::consistent;
}

std::vector<double> pressure_at_rest(const Scene& scene, const Layout& layout, const std::vector<ParticleBlock>& blocks,
                                     std::size_t fluid) {
  std::vector<Column> columns;
  std::vector<std::size_t> order;
  for (std::size_t k = 0; k < blocks.size(); ++k) {
    columns.push_back(column_of(scene, layout, blocks[k], k));
    if (columns[k].hydrostatic) order.push_back(k);
  }
  if (!columns[fluid].hydrostatic) return {};
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return columns[a].potential < columns[b].potential; });
  for (std::size_t k = 0; k < order.size(); ++k)
    for (std::size_t above = k; above-- > 0;) {
      const std::size_t a = order[k], b = order[above];
      if (std::none_of(layout.entries.begin(), layout.entries.end(),
                       [&](const PlanEntry& e) { return e.has(a) && e.partner(a) == b; }))
        continue;
      columns[a].pressure = columns[b].pressure_at(columns[a].potential);
      break;
    }
  std::vector<double> pressure;
  for (const Vec3& x : blocks[fluid].position)
    pressure.push_back(columns[fluid].pressure_at(dot(scene.domain.gravity, x)));
  return pressure;
}

}  // namespace barchan
