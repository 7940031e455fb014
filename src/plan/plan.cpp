#include "plan/plan.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/errors.hpp"
#include "models/catalogue.hpp"
#include "output/numbers.hpp"
#include "scene/couplings.hpp"
#include "scene/formula.hpp"
#include "scene/located.hpp"

namespace barchan {

double Plan::step() const {
  if (fixed_step > 0) return fixed_step;
  double dt = 1e300;
  for (const auto& l : limits) dt = std::min(dt, l.value);
  return dt;
}

namespace {

/// m/s or 1/s, the largest size of a vector of time at 65 times.
double largest_in_time(const Scene& scene, const VectorExpression& vector) {
  const Formula u(vector[0]), v(vector[1]), w(vector[2]);
  double largest = 0.0;
  for (int k = 0; k <= 64; ++k) {
    const double t = scene.time.end * k / 64.0;
    largest = std::max(largest, norm({u({0, 0, 0}, t), v({0, 0, 0}, t), w({0, 0, 0}, t)}));
  }
  return largest;
}

/// m/s, of a driven set or rigid body.
double driven_speed(const Scene& scene, const Motion& motion, const std::vector<ParticleBlock>& blocks) {
  const double speed = largest_in_time(scene, motion.velocity);
  if (!motion.angular_velocity) return speed;
  double reach = 0.0;
  for (std::size_t k = 0; k < scene.phases.size(); ++k)
    if (scene.phases[k].name == motion.phase && !blocks[k].position.empty())
      for (const Vec3& x : blocks[k].position)
        reach = std::max(reach, norm(x - motion.about.value_or(blocks[k].position.front())));
  return speed + reach * largest_in_time(scene, motion.angular_velocity->about);
}

double largest_speed(const Scene& scene, const std::vector<ParticleBlock>& blocks) {
  double speed = scene.time.largest_speed;
  if (speed > 0) return speed;
  for (const auto& b : blocks)
    for (const auto& v : b.velocity) speed = std::max(speed, norm(v));
  for (const auto& p : scene.phases) {
    const WallKeys* wall = p.if_wall();
    if (!wall) continue;
    const Formula u(wall->velocity[0]), v(wall->velocity[1]), w(wall->velocity[2]);
    for (int k = 0; k <= 16; ++k) {
      const double t = scene.time.end * k / 16.0;
      speed = std::max(speed, norm({u({0, 0, 0}, t), v({0, 0, 0}, t), w({0, 0, 0}, t)}));
    }
  }
  for (const auto& motion : scene.motions) speed = std::max(speed, driven_speed(scene, motion, blocks));
  double height = 0;
  for (std::size_t d = 0; d < 3; ++d) height += std::abs(scene.domain.gravity[d]) * scene.domain.size[d];
  return std::max(speed, std::sqrt(2.0 * height) / std::sqrt(2.0));
}

/// The first direction of an entry, and its opposite. A wall searches only the fluid that is extended into it.
void add_directions(const Scene& scene, Plan& plan, PlanEntry& e) {
  if (e.kind == EntryKind::column || e.kind == EntryKind::drag) return;  // the wind is found by height: no search
  if (e.of_surfaces) return;  // models/bodies/rigid_contact.hpp looks at outlines
  const auto direction = [&](std::size_t from, std::size_t to) {
    plan.directions.push_back({from, to, e.radius});
    return static_cast<int>(plan.directions.size()) - 1;
  };
  if (e.kind == EntryKind::elastic && plan.phases[e.a].fixed_neighbours) return;
  if (e.of_bodies && (has_surfaces(scene, scene.phases[e.a]) || has_surfaces(scene, scene.phases[e.b]))) return;
  if (e.of_spheres()) return;  // models/grains/spheres.hpp has its own search
  const auto looks = [&](std::size_t k) { return plan.phases[k].moves || e.kind == EntryKind::boundary; };
  if (looks(e.a)) e.forward = direction(e.a, e.b);
  if (e.a != e.b && looks(e.b)) e.backward = direction(e.b, e.a);
}

void add_entries(const Scene& scene, Plan& plan) {
  const auto number = [&](const std::string& name) {
    for (std::size_t k = 0; k < scene.phases.size(); ++k)
      if (scene.phases[k].name == name) return k;
    throw SceneError(located(scene, "interactions") + ": no phase \"" + name + "\"");
  };
  for (const auto& i : scene.interactions) {
    PlanEntry e;
    e.a = number(i.a);
    e.b = number(i.b);
    if (e.a > e.b) std::swap(e.a, e.b);
    e.name = i.a + "-" + i.b;
    e.kernel = i.kernel;
    e.spacing = spacing_of(scene, i);
    e.radius = i.radius * e.spacing;
    e.drag = i.drag;
    e.contact = i.law;
    e.drag_law = i.drag_law;
    e.lift = i.lift;
    e.gusts = i.gusts;
    e.of_bodies = touch_as_bodies(i, scene.phases[e.a], scene.phases[e.b]);
    e.of_surfaces = e.of_bodies && touch_by_surfaces(scene.phases[e.a], scene.phases[e.b]);
    for (const PlanPhase& p : {plan.phases[e.a], plan.phases[e.b]}) e.of_many_elastic |= p.body && p.count > 1;
    e.restitution = i.restitution.value_or(1.0);
    e.friction = i.friction.value_or(0.0);
    classify(scene, e);
    if (e.of_spheres() || e.of_bodies) {
      const auto across = [&](std::size_t k) {
        return plan.phases[k].diameter > 0 ? plan.phases[k].largest_diameter : plan.phases[k].spacing;
      };
      e.radius = 0.5 * (across(e.a) + across(e.b));
    } else if (e.kind != EntryKind::column && e.kind != EntryKind::drag) {
      e.consistency = lattice_consistency(i.kernel, i.radius, scene.dimensions);
    }
    add_directions(scene, plan, e);
    plan.entries.push_back(e);
    if (e.a == e.b || (e.kind == EntryKind::contact && !e.of_bodies)) {
      for (const std::size_t p : {e.a, e.b})
        if (e.a == e.b || plan.phases[p].smoothing_length == 0) plan.phases[p].smoothing_length = 0.5 * e.radius;
    }
    if (touches_itself(i, scene.phases[e.a], scene.phases[e.b])) {  // an entry of its own: it is searched
      e.name += " contact";
      e.kind = EntryKind::contact;
      e.of_bodies = true;
      e.corrected = false;
      e.consistency = {};
      e.radius = plan.phases[e.a].spacing;
      add_directions(scene, plan, e);
      plan.entries.push_back(e);
    }
  }
  for (std::size_t k = 0; k < plan.phases.size(); ++k) {
    auto& p = plan.phases[k];
    if (p.smoothing_length == 0)
      for (const auto& e : plan.entries)
        if (e.a == k || e.b == k) p.smoothing_length = std::max(p.smoothing_length, 0.5 * e.radius);
    if (p.smoothing_length == 0 && p.moves) p.smoothing_length = 0.5 * scene.spacing;  // no search
    if (p.flows) p.rules.way = 2.0 * p.smoothing_length;
  }
}

/// The schedule that a step will execute; the watch looks at its end.
void add_passes(Plan& plan, const Models& models) {
  const Schedule schedule = make_schedule(models);
  for (std::size_t k = 0; k < schedule.stages(); ++k)
    (schedule.has(k) || k == stage::watch ? plan.passes : plan.skipped).push_back(schedule.name(k));
  plan.repeats = schedule.repeats();
}

/// Where a step is below the rounding of the time, the time does not grow: the end is never reached.
void check_steps(const Scene& scene, Plan& plan) {
  const double steps = scene.time.end / plan.step();
  constexpr double most = 1e12;  // 4500 roundings of the time a step are left
  constexpr double remarkable = 1e9;
  const std::string number =
      brief(scene.time.end) + " s are " + brief(steps) + " steps of " + brief(plan.step()) + " s";
  if (!(steps <= most))
    throw SceneError(located(scene, "time.end") + ": " + number +
                     "; expected at most 10^12 steps, beyond which the time stands still in its last digits");
  if (steps > remarkable) plan.warnings.push_back("time.end: " + number + ", which will take long");
}

}  // namespace

Plan make_plan(const Scene& scene, const std::vector<ParticleBlock>& blocks) {
  Plan plan;
  plan.dimensions = scene.dimensions;
  plan.fixed_step = scene.time.fixed_step.value_or(0.0);
  plan.bounds.dimensions = scene.dimensions;
  plan.bounds.low = scene.domain.origin;
  plan.bounds.high = scene.domain.origin + scene.domain.size;
  plan.bounds.periodic = scene.domain.periodic;
  plan.largest_speed = largest_speed(scene, blocks);
  double thickest = 0;
  for (std::size_t k = 0; k < scene.phases.size(); ++k) {
    const Phase& p = scene.phases[k];
    PlanPhase q;
    q.name = p.name;
    q.count = blocks[k].position.size();
    q.spacing = p.spacing;
    q.mass = (p.density > 0 ? p.density : 1.0) * std::pow(p.spacing, scene.dimensions);
    if (p.if_grains()) q.weight_share = weight_share(scene, p);
    if (const auto size = p.diameter(); size && p.if_grains()) {
      q.diameter = size->mean;
      q.largest_diameter = size->largest();
      thickest = std::max(thickest, size->mean);
    }
    plan.phases.push_back(q);
  }
  if (scene.dimensions == 2 && thickest > 0) plan.slab = thickest;
  for (std::size_t k = 0; k < plan.phases.size(); ++k)
    if (PlanPhase& q = plan.phases[k]; q.diameter > 0)
      q.mass = scene.phases[k].density * std::numbers::pi / 6.0 * std::pow(q.diameter, 3) / plan.slab;
  describe_phases(scene, blocks, plan, plan.warnings);
  add_entries(scene, plan);
  const Models models = make_models(scene, plan);
  add_passes(plan, models);
  plan.instruments = make_instruments(scene, plan);
  for (const auto& model : models) model->limits(plan.limits);
  if (plan.limits.empty() && plan.fixed_step == 0)
    throw SceneError(located(scene, "time.step") + ": missing: nothing limits the step; expected a number > 0 (s)");
  check_steps(scene, plan);
  add_warnings(scene, blocks, plan);
  return plan;
}

}  // namespace barchan
