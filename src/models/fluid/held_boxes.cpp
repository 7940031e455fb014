#include "models/fluid/held_boxes.hpp"

#include <algorithm>
#include <cmath>

#include "engine/exchange.hpp"
#include "scene/couplings.hpp"

namespace barchan {

namespace {

bool is_in(const HeldBox& box, const Vec3& x, int dimensions) {
  for (std::size_t d = 0; d < static_cast<std::size_t>(dimensions); ++d)
    if (!(x[d] > box.low[d] && x[d] < box.high[d])) return false;
  return true;
}

bool is_free(const std::vector<HeldBox>& boxes, const Bounds& bounds, const Vec3& x) {
  for (std::size_t d = 0; d < static_cast<std::size_t>(bounds.dimensions); ++d)
    if (!bounds.periodic[d] && (x[d] <= bounds.low[d] || x[d] >= bounds.high[d])) return false;
  return std::none_of(boxes.begin(), boxes.end(), [&](const HeldBox& b) { return is_in(b, x, bounds.dimensions); });
}

Vec3 place_of(const PhaseParticles& p, std::size_t k) {
  Vec3 x{};
  for (int d = 0; d < p.dimensions(); ++d) x[static_cast<std::size_t>(d)] = p.column(Field::position, d)[k];
  return x;
}

/// Puts a particle back that is in `box`.
void put_back(PhaseParticles& phase, std::size_t k, const HeldBox& box, const std::vector<HeldBox>& boxes,
              const Bounds& bounds) {
  const Vec3 x = place_of(phase, k);
  const auto dimensions = static_cast<std::size_t>(phase.dimensions());
  double least = 1e300, sign = 0.0;
  std::size_t axis = 0;
  for (std::size_t d = 0; d < dimensions; ++d)
    for (const bool above : {false, true}) {
      Vec3 to = x;
      to[d] = above ? box.high[d] : box.low[d];
      const double way = std::abs(to[d] - x[d]);
      if (way >= least || !is_free(boxes, bounds, to)) continue;
      least = way;
      axis = d;
      sign = above ? 1.0 : -1.0;
    }
  if (sign == 0.0) return;  // nowhere is room: the watch tells
  double& v = phase.column(Field::velocity, static_cast<int>(axis))[k];
  phase.column(Field::position, static_cast<int>(axis))[k] = sign > 0.0 ? box.high[axis] : box.low[axis];
  v = sign > 0.0 ? std::max(v, 0.0) : std::min(v, 0.0);
}

/// How far a surface keeps the normals of its inside (spacings): a step is far shorter.
constexpr double depth_of_surfaces = 2.0;

bool is_in(const ContactSurface& surface, const Vec3& x, double tolerance) {
  const auto gap = surface.gap(x);
  return gap && gap->distance < -tolerance;
}

}  // namespace

HeldShapes held_shapes(const Scene& scene, const Layout& layout, std::size_t fluid, const PhaseParticles& particles) {
  HeldShapes shapes;
  const auto stands_in = [&](auto&& holds) {
    bool any = false;
    for (std::size_t k = 0; k < particles.size() && !any; ++k) any = holds(place_of(particles, k));
    return Exchange().any(any);
  };
  for (const Fill& fill : scene.fills) {
    const Phase* wall = find_phase(scene, fill.phase);
    if (!wall || !entry_between(scene, scene.phases[fluid], *wall)) continue;
    const PlanPhase& plan = layout.phases[static_cast<std::size_t>(wall - scene.phases.data())];
    if (plan.moves() || plan.travels()) continue;
    if (const auto* box = std::get_if<BoxShape>(&fill.shape)) {
      const HeldBox held{box->min, box->max};
      if (!stands_in([&](const Vec3& x) { return is_in(held, x, layout.dimensions); })) shapes.boxes.push_back(held);
      continue;
    }
    if (layout.dimensions != 2) continue;
    for (ContactSurface& surface : surfaces_of(fill.shape, scene, plan.spacing)) {
      surface.prepare(depth_of_surfaces * plan.spacing, plan.spacing);
      const double tolerance = 1e-9 * plan.spacing;
      if (!stands_in([&](const Vec3& x) { return is_in(surface, x, tolerance); }))
        shapes.surfaces.push_back(std::move(surface));
    }
  }
  return shapes;
}

static void hold_outside(PhaseParticles& phase, const ContactSurface& surface) {
  const auto n = static_cast<std::int64_t>(phase.size());
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < n; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const auto gap = surface.gap(place_of(phase, k));
    if (!gap || !(gap->distance < 0.0) || !std::isfinite(gap->distance)) continue;
    double inwards = 0.0;
    for (int d = 0; d < phase.dimensions(); ++d)
      inwards += phase.column(Field::velocity, d)[k] * gap->normal[static_cast<std::size_t>(d)];
    for (int d = 0; d < phase.dimensions(); ++d) {
      const double normal = gap->normal[static_cast<std::size_t>(d)];
      phase.column(Field::position, d)[k] -= gap->distance * normal;
      phase.column(Field::velocity, d)[k] -= std::min(inwards, 0.0) * normal;
    }
  }
}

static void hold_outside(PhaseParticles& phase, const std::vector<HeldBox>& boxes, const Bounds& bounds) {
  const auto n = static_cast<std::int64_t>(phase.size());
  const bool solid = phase.dimensions() == 3;
  const double *x = phase.column(Field::position, 0), *y = phase.column(Field::position, 1),
               *z = phase.column(Field::position, solid ? 2 : 0);
  for (const HeldBox& box : boxes) {
    int any = 0;
#pragma omp parallel for simd schedule(static) reduction(| : any)
    for (std::int64_t k = 0; k < n; ++k)
      any |= static_cast<int>(x[k] > box.low[0]) & static_cast<int>(x[k] < box.high[0]) &
             static_cast<int>(y[k] > box.low[1]) & static_cast<int>(y[k] < box.high[1]) &
             (static_cast<int>(!solid) | (static_cast<int>(z[k] > box.low[2]) & static_cast<int>(z[k] < box.high[2])));
    if (any == 0) continue;
    for (std::size_t k = 0; k < phase.size(); ++k)
      if (is_in(box, place_of(phase, k), phase.dimensions())) put_back(phase, k, box, boxes, bounds);
  }
}

void hold_outside(PhaseParticles& phase, const HeldShapes& shapes, const Bounds& bounds) {
  hold_outside(phase, shapes.boxes, bounds);
  for (const ContactSurface& surface : shapes.surfaces) hold_outside(phase, surface);
}

}  // namespace barchan
