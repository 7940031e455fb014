// Defaults that depend on other keys. All other defaults stand in the rows of the table of keys.
#include <algorithm>

#include "scene/couplings.hpp"
#include "scene/read.hpp"

namespace barchan {
namespace {

/// A wall without a density of its own weighs as much as the first phase that feels it.
void complete_wall_densities(Scene& scene) {
  const auto density_of = [&](const std::string& name) {
    for (const Phase& phase : scene.phases)
      if (phase.name == name && phase.kind() != PhaseKind::wall) return phase.density;
    return 0.0;
  };
  for (Phase& phase : scene.phases) {
    if (phase.kind() != PhaseKind::wall) continue;
    for (const Interaction& pair : scene.interactions) {
      if (phase.density > 0.0) break;
      if (pair.a == phase.name) phase.density = density_of(pair.b);
      if (pair.b == phase.name) phase.density = density_of(pair.a);
    }
  }
}

/// A sieve curve without a mean has that which half of the mass passes.
void complete_size(SphereSize& size) {
  for (std::size_t k = 1; k < size.sieve.size() && !(size.mean > 0.0); ++k)
    if (const auto& a = size.sieve[k - 1], &b = size.sieve[k]; b[1] >= 0.5 && b[1] > a[1])
      size.mean = a[0] + (b[0] - a[0]) * std::max(0.5 - a[1], 0.0) / (b[1] - a[1]);
}

/// A fitted bed has one layer more than a plain wall, because its rows bend.
void complete_layers(Fill& fill) {
  if (auto* bed = std::get_if<BedShape>(&fill.shape); bed && bed->layers == 0) bed->layers = 4;
  if (auto* sides = std::get_if<SidesShape>(&fill.shape); sides && sides->layers == 0) sides->layers = 3;
}

}  // namespace

/// Fluids: the least error at a given time (docs/accuracy.md), and no pairs. Contacts: eq. (16) of Halik et al. 2015;
/// their stiffness grows less with the overlap under the cubic spline.
Interaction recommended(const std::vector<Phase>& phases, const std::string& a, const std::string& b) {
  Interaction pair;
  pair.a = a;
  pair.b = b;
  bool fluid = false, plain = false, repulsive = false, bodies = true, column = false;
  for (const Phase& phase : phases) {
    if (phase.name != a && phase.name != b) continue;
    fluid = fluid || phase.kind() == PhaseKind::fluid;
    plain = plain || (phase.kind() == PhaseKind::fluid && phase.fluid().scheme == FluidScheme::plain);
    column = column || phase.kind() == PhaseKind::column;
    repulsive = repulsive || (phase.kind() == PhaseKind::wall && phase.wall().law == WallLaw::repulsive);
    bodies = bodies && phase.kind() == PhaseKind::elastic;
  }
  pair.kernel = fluid ? KernelKind::wendland_c2 : KernelKind::cubic_spline;
  if (fluid) pair.radius = repulsive ? 0.0 : plain ? 3.0 : 2.1;
  else pair.radius = bodies || column ? 0.0 : 1.1;
  const Phase *first = nullptr, *second = nullptr;
  for (const Phase& phase : phases) {
    if (phase.name == a) first = &phase;
    if (phase.name == b) second = &phase;
  }
  if (first && second && first == second && is_total(*first)) {
    pair.radius = 1.6;
    pair.kernel = KernelKind::wendland_c2;
  }
  if (column) pair.drag_law = DragLaw::duran;
  return pair;
}

void complete(Scene& scene) {
  for (Phase& phase : scene.phases)
    std::visit(
        [](auto& keys) {
          if constexpr (requires { keys.diameter->sieve; })
            if (keys.diameter) complete_size(*keys.diameter);
        },
        phase.own);
  for (Phase& phase : scene.phases)
    if (!(phase.spacing > 0.0)) phase.spacing = phase.diameter() ? phase.diameter()->largest() : scene.spacing;
  for (Interaction& pair : scene.interactions)
    if (const double dx = spacing_of(scene, pair); pair.radius_in_metres && dx > 0.0)
      pair.radius = *pair.radius_in_metres / dx;
  complete_wall_densities(scene);
  for (Fill& fill : scene.fills) complete_layers(fill);
}

}  // namespace barchan
