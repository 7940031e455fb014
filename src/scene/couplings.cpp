#include "scene/couplings.hpp"

#include <algorithm>

namespace barchan {

const Phase* find_phase(const Scene& scene, const std::string& name) {
  for (const Phase& phase : scene.phases)
    if (phase.name == name) return &phase;
  return nullptr;
}

double spacing_of(const Scene& scene, const Fill& fill) {
  const Phase* phase = find_phase(scene, fill.phase);
  return phase ? phase->spacing : scene.spacing;
}

double spacing_of(const Scene& scene, const Interaction& pair) {
  const Phase *a = find_phase(scene, pair.a), *b = find_phase(scene, pair.b);
  return a && b ? std::max(a->spacing, b->spacing) : scene.spacing;
}

const Interaction* entry_between(const Scene& scene, const Phase& a, const Phase& b) {
  for (const Interaction& pair : scene.interactions)
    if ((pair.a == a.name && pair.b == b.name) || (pair.a == b.name && pair.b == a.name)) return &pair;
  return nullptr;
}

bool meets(const Scene& scene, const Phase& phase, PhaseKind kind) {
  return std::any_of(scene.phases.begin(), scene.phases.end(), [&](const Phase& other) {
    return other.kind() == kind && other.name != phase.name && entry_between(scene, phase, other);
  });
}

bool rubs_on_energy(const Scene& scene, const Phase& phase) {
  return std::any_of(scene.phases.begin(), scene.phases.end(), [&](const Phase& other) {
    return other.kind() == PhaseKind::fluid && other.fluid().energy && entry_between(scene, phase, other);
  });
}

bool touches_by(const Scene& scene, const Phase& phase, ContactLaw law) {
  return std::any_of(scene.interactions.begin(), scene.interactions.end(), [&](const Interaction& pair) {
    return pair.law == law && (pair.a == phase.name || pair.b == phase.name);
  });
}

bool drags_by_law(const Scene& scene, const Phase& phase) {
  return std::any_of(scene.interactions.begin(), scene.interactions.end(), [&](const Interaction& pair) {
    const Phase *a = find_phase(scene, pair.a), *b = find_phase(scene, pair.b);
    if (!a || !b || pair.drag_law == DragLaw::none || (a->name != phase.name && b->name != phase.name)) return false;
    return a->kind() == PhaseKind::fluid || b->kind() == PhaseKind::fluid;
  });
}

double weight_share(const Scene& scene, const Phase& grains) {
  double share = 1.0;
  for (const Interaction& pair : scene.interactions) {
    if (!pair.buoyancy || (pair.a != grains.name && pair.b != grains.name)) continue;
    const Phase* fluid = find_phase(scene, pair.a == grains.name ? pair.b : pair.a);
    if (fluid && fluid->kind() != PhaseKind::grains) share -= fluid->density / grains.density;
  }
  return share;
}

bool solids_move_in(const Scene& scene, const Phase& fluid) {
  for (const Phase& other : scene.phases) {
    const PhaseKind kind = other.kind();
    if (kind != PhaseKind::grains && kind != PhaseKind::elastic) continue;
    const Interaction* pair = entry_between(scene, fluid, other);
    if (pair && pair->drag_law == DragLaw::none && !ends_at_border(scene, other)) return true;
  }
  return false;
}

bool is_wall_or_body(const Phase& phase) {
  const PhaseKind kind = phase.kind();
  return kind == PhaseKind::wall || kind == PhaseKind::elastic || kind == PhaseKind::rigid;
}

bool ends_at_border(const Scene& scene, const Phase& body) {
  if (!is_total(body)) return false;
  bool any = false;
  for (const Phase& fluid : scene.phases) {
    if (fluid.kind() != PhaseKind::fluid || !entry_between(scene, fluid, body)) continue;
    if (fluid.fluid().scheme != FluidScheme::consistent || has_eddies(scene, fluid)) return false;
    any = true;
  }
  return any && std::all_of(scene.fills.begin(), scene.fills.end(), [&](const Fill& fill) {
           return fill.phase != body.name || has_surface(fill.shape, scene.dimensions);
         });
}

const Motion* motion_of(const Scene& scene, const Phase& phase) {
  for (const Motion& motion : scene.motions)
    if (motion.phase == phase.name) return &motion;
  return nullptr;
}

double wall_pull(const Scene& scene, const Phase& fluid) {
  double pull = 0.0;
  for (const Fill& fill : scene.fills) {
    const Phase* wall = find_phase(scene, fill.phase);
    const auto* sides = std::get_if<SidesShape>(&fill.shape);
    if (!wall || !sides || !wall->if_wall() || !wall->if_wall()->shear_stress || !entry_between(scene, fluid, *wall))
      continue;
    for (const std::string& side : sides->sides)
      if (side == "bottom" || side == "top") pull += (*wall->if_wall()->shear_stress)[0];
  }
  return pull;
}

bool has_eddies(const Scene& scene, const Phase& fluid) {
  if (fluid.kind() != PhaseKind::fluid) return false;
  return fluid.fluid().turbulence != Turbulence::none ||
         std::any_of(scene.phases.begin(), scene.phases.end(), [&](const Phase& wall) {
           return wall.kind() == PhaseKind::wall && (wall.wall().roughness || wall.wall().shear_stress) &&
                  entry_between(scene, fluid, wall);
         });
}

int facet_dimensions(const Shape& shape) {
  if (const auto* surface = std::get_if<SurfaceShape>(&shape)) return surface->triangles ? 3 : 2;
  return std::holds_alternative<PolygonShape>(shape) ? 2 : 0;
}

bool has_surface(const Shape& shape, int dimensions) {
  const bool box = std::holds_alternative<BoxShape>(shape) || std::holds_alternative<CubeShape>(shape),
             sides = std::holds_alternative<SidesShape>(shape);
  if (dimensions == 3) return box || sides || std::holds_alternative<SphereShape>(shape);
  return box || sides || std::holds_alternative<DiscShape>(shape) || std::holds_alternative<RingShape>(shape) ||
         facet_dimensions(shape) == 2;
}

bool has_artificial_stress(const Scene& scene) {
  return std::any_of(scene.phases.begin(), scene.phases.end(), [](const Phase& p) {
    return p.kind() == PhaseKind::elastic && !is_total(p) && p.elastic().artificial_stress > 0.0;
  });
}

bool is_total(const Phase& phase) {
  return phase.kind() == PhaseKind::elastic && phase.elastic().formulation == Formulation::total_lagrangian;
}

bool bodies_may_touch(const Phase& a, const Phase& b) {
  const auto is_body = [](const Phase& p) { return p.kind() == PhaseKind::elastic || p.kind() == PhaseKind::rigid; };
  const auto body_or_wall = [&](const Phase& p) { return is_body(p) || p.kind() == PhaseKind::wall; };
  if (a.name == b.name) return a.kind() == PhaseKind::rigid;
  return (is_body(a) || is_body(b)) && body_or_wall(a) && body_or_wall(b);
}

bool touch_by_surfaces(const Phase& a, const Phase& b) {
  const auto rigid = [](const Phase& p) { return p.kind() == PhaseKind::rigid; };
  return (rigid(a) && rigid(b)) || (rigid(a) && b.if_wall()) || (a.if_wall() && rigid(b));
}

bool has_surfaces(const Scene& scene, const Phase& wall) {
  return wall.if_wall() && std::all_of(scene.fills.begin(), scene.fills.end(), [&](const Fill& fill) {
           const bool prism = facet_dimensions(fill.shape) == 2;  // in 3D along z, through the whole domain
           return fill.phase != wall.name || prism || has_surface(fill.shape, scene.dimensions);
         });
}

bool touch_as_bodies(const Interaction& pair, const Phase& a, const Phase& b) {
  const bool rigid = a.kind() == PhaseKind::rigid || b.kind() == PhaseKind::rigid;
  return bodies_may_touch(a, b) && (pair.restitution || is_total(a) || is_total(b) || rigid);
}

bool touches_itself(const Interaction& pair, const Phase& a, const Phase& b) {
  return a.name == b.name && a.kind() == PhaseKind::elastic && pair.restitution;
}

bool touches_as_body(const Scene& scene, const Phase& phase) {
  return std::any_of(scene.interactions.begin(), scene.interactions.end(), [&](const Interaction& pair) {
    if (pair.a != phase.name && pair.b != phase.name) return false;
    const Phase &a = *find_phase(scene, pair.a), &b = *find_phase(scene, pair.b);
    return touch_as_bodies(pair, a, b) || touches_itself(pair, a, b);
  });
}

}  // namespace barchan
