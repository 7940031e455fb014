#include <algorithm>
#include <cmath>

#include "models/grains/spheres.hpp"
#include "scene/contact_words.hpp"
#include "scene/couplings.hpp"
#include "start/ball_surfaces.hpp"

namespace barchan {

namespace {

/// Mass of a sphere of the phase (kg, not by depth): of the mean diameter, times a share of its radius cubed.
double mass_of(const Layout& layout, std::size_t phase, double share = 1.0) {
  return layout.phases[phase].mass * layout.slab * share * share * share;
}

/// Whether spheres touch the wall by surfaces of shapes and by sides of the domain alone.
bool by_surfaces(const Scene& scene, const Phase& wall) {
  bool any = false;
  for (const Fill& fill : scene.fills) {
    if (fill.phase != wall.name || std::holds_alternative<SidesShape>(fill.shape)) continue;
    if (!touched_by_surface(scene, wall, fill.shape)) return false;
    any = true;
  }
  return any;
}

/// The phases of an entry whose particles are moved; the other one is a wall.
std::vector<std::size_t> grains_of(const Layout& layout, const PlanEntry& e) {
  std::vector<std::size_t> grains;
  for (const std::size_t k : {e.a, e.b})
    if (layout.phases[k].own_steps()) grains.push_back(k);
  return grains;
}

/// The constants of an entry's contacts.
template <class Row>
typename Row::Law law_of(const Scene& scene, const Layout& layout, const std::vector<std::size_t>& grains) {
  std::vector<typename Row::Law::Normal> springs;
  std::vector<const SphereMaterial*> materials;
  for (const std::size_t k : grains) {
    springs.push_back(normal_spring<Row>(scene, layout, k));
    materials.push_back(&scene.phases[k].grains());
  }
  return Row::Law::between(springs, materials);
}

}  // namespace

void describe_sphere_contact(const Scene& scene, const Interaction& pair, const Layout& layout, PlanEntry& e) {
  for (const Word& w : words_of<ContactLaw>)
    if (w.meaning == static_cast<int>(pair.law)) e.law = w.word;
  e.meaning = "spheres: touching decides";
  e.pairs = Pairs::spheres;  // by SphereSearch
  for (const std::size_t k : {e.a, e.b})
    if (by_surfaces(scene, scene.phases[k])) {
      e.pairs = Pairs::spheres_and_outlines;
      e.meaning = "spheres and surfaces of shapes: touching decides";
    }
  e.radius = layout.touching_distance(e);
  e.gives_length = true;
}

SphereImpact impact_of(const Layout& layout, std::size_t phase, double speed) {
  return {0.5 * mass_of(layout, phase), 0.25 * layout.phases[phase].diameter, speed};
}

void refuse_unknown_stiffness(const Scene& scene, std::size_t phase, std::string_view key) {
  throw SceneError(scene.file +
                   ": time.largest-speed: missing: nothing in the scene moves or weighs, so that no stiffness of \"" +
                   scene.phases[phase].name + "\" follows; expected it, or " + std::string(key) + " of the phase");
}

bool spheres_turn(const Scene& scene, std::size_t phase) {
  const Phase& p = scene.phases[phase];
  return (p.grains().friction > 0.0 || p.grains().rolling_friction > 0.0) && touches_as_spheres(scene, p);
}

SphereLaws::SphereLaws(const Scene& scene, const Layout& layout) {
  const std::size_t n = layout.phases.size();
  table_.assign(n * n, SphereSearch::none);
  for (const auto& e : layout.entries) {
    if (!e.own_steps()) continue;
    const std::vector<std::size_t> grains = grains_of(layout, e);
    double restitution = 1.0;
    for (const std::size_t k : grains) restitution = std::min(restitution, scene.phases[k].grains().restitution);
    table_[e.a * n + e.b] = table_[e.b * n + e.a] = static_cast<std::uint32_t>(laws_.size());
    const SphereImpact hardest = shortest_impact(scene, layout, e);
    each_sphere_law([&](auto row) {
      using Row = decltype(row);
      if (e.given.law != Row::word) return;
      const auto law = law_of<Row>(scene, layout, grains);
      const double steps = restitution < 1.0 ? NormalDashpot::steps(restitution) : Row::Law::Normal::steps_without_loss;
      step_ = std::min(step_, law.normal.duration(hardest) / steps);
      has_.damps = has_.damps || restitution < 1.0;
      has_.rolls = has_.rolls || law.rolling.friction > 0.0;
      has_.rubs = has_.rubs || law.friction.friction > 0.0 || has_.rolls;
      laws_.emplace_back(law);
    });
    const bool stays = !layout.phases[e.a].moves() || !layout.phases[e.b].moves();
    if (!stays || !e.by_outlines()) reach_ = std::max(reach_, e.radius);
  }
  for (const auto& p : layout.phases)
    if (p.own_steps()) reach_ = std::max(reach_, p.largest_size);
}

std::size_t SphereLaws::numbers(int dimensions) const {
  std::size_t most = 0;
  for (const AnySphereContact& any : laws_)
    with_parts(any, has_, [&](const auto& law) {
      using Law = std::decay_t<decltype(law)>;
      most = std::max(most, dimensions == 2 ? Law::template numbers<2> : Law::template numbers<3>);
    });
  return most;
}

/// Of the smallest spheres of an entry, at the largest speed of the scene. Adds their densities to the table.
SphereImpact SphereLaws::shortest_impact(const Scene& scene, const Layout& layout, const PlanEntry& e) {
  double inverse_mass = 0.0, curvature = 0.0;
  // Walls are the second of all pairs.
  const bool turned = !layout.phases[e.a].own_steps();
  for (const std::size_t k : {turned ? e.b : e.a, turned ? e.a : e.b}) {
    const PlanPhase& p = layout.phases[k];
    const bool moves = p.own_steps();
    inverse_densities_.push_back(moves ? std::pow(0.5 * p.diameter, 3) / mass_of(layout, k) : 0.0);
    const auto size = scene.phases[k].diameter();
    const double least = size ? size->least_share() : 1.0;
    inverse_mass += moves ? 1.0 / mass_of(layout, k, least) : 0.0;
    curvature += moves ? 2.0 / (p.diameter * least) : 0.0;
  }
  return {1.0 / inverse_mass, 1.0 / curvature, std::max(layout.largest_speed, 1e-300)};
}

}  // namespace barchan
