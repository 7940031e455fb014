#include "plan/plan.hpp"

#include <algorithm>
#include <cmath>

#include "base/errors.hpp"
#include "engine/exchange.hpp"
#include "models/catalogue.hpp"
#include "models/grains/grain_source.hpp"
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

/// m/s, that an inflow gives, at a hundred or so of its particles and 17 times. On ranks that share a fluid out: at
/// those of this one.
double entering_speed(const Scene& scene, const std::vector<ParticleBlock>& blocks) {
  double speed = 0.0;
  for (std::size_t k = 0; k < scene.phases.size(); ++k)
    for (const FlowEnd& end : flow_ends(scene, scene.phases[k])) {
      if (!end.inflow) continue;
      const GivenVelocity velocity(scene, end);
      const auto& places = blocks[k].position;
      const std::size_t stride = 1 + blocks[k].count() / 4000, before = blocks[k].first();
      for (std::size_t i = (stride - before % stride) % stride; i < places.size(); i += stride)
        for (int q = 0; q <= 16 && end.beyond(places[i][end.axis()]) > 0.0; ++q)
          speed = std::max(speed, norm(velocity(places[i], scene.time.end * q / 16.0)));
    }
  return speed;
}

/// m/s, of grains that enter.
double influx_speed(const Scene& scene) {
  double speed = 0.0;
  for (std::size_t k = 0; k < scene.influxes.size(); ++k) speed = std::max(speed, Arrivals(scene, k, 1.0).fastest());
  return speed;
}

/// The domain and the zones beyond its sides, with room for a particle that is on its way out.
Bounds bounds_with_zones(const Scene& scene, Bounds bounds) {
  for (const Phase& phase : scene.phases)
    for (const FlowEnd& end : flow_ends(scene, phase)) {
      double& side = (end.upper() ? bounds.high : bounds.low)[end.axis()];
      const double far = end.at(end.length + phase.spacing);
      side = end.upper() ? std::max(side, far) : std::min(side, far);
    }
  return bounds;
}

double largest_speed(const Scene& scene, const std::vector<ParticleBlock>& blocks, const Plan& plan) {
  double speed = scene.time.largest_speed;
  if (speed > 0) return speed;
  for (const auto& b : blocks)
    for (const auto& v : b.velocity) speed = std::max(speed, norm(v));
  for (const PlanPhase& p : plan.phases) speed = std::max(speed, p.surface.speed);
  for (const auto& motion : scene.motions) speed = std::max(speed, driven_speed(scene, motion, blocks));
  speed = Exchange().largest(std::max({speed, entering_speed(scene, blocks), influx_speed(scene)}));
  double height = 0;
  for (std::size_t d = 0; d < 3; ++d) height += std::abs(scene.domain.gravity[d]) * scene.domain.size[d];
  return std::max(speed, std::sqrt(2.0 * height) / std::sqrt(2.0));
}

/// Motions that are faster than the scene promises.
void warn_of_fast_motions(const Scene& scene, const std::vector<ParticleBlock>& blocks, Plan& plan) {
  for (std::size_t k = 0; k < scene.motions.size() && scene.time.largest_speed > 0.0; ++k) {
    const double speed = driven_speed(scene, scene.motions[k], blocks);
    if (speed > 2.0 * scene.time.largest_speed)  // the back of a wall is faster than its surface
      plan.warnings.push_back(
          "motion." + std::to_string(k) + ": its fastest place has " + brief(speed) +
          " m/s, more than time.largest-speed, " + brief(scene.time.largest_speed) + " m/s" +
          (scene.motions[k].angular_velocity ? "; angular velocities are in 1/s (60 rpm are 6.28)" : ""));
  }
}

/// A phase that moves looks for its partner. A phase that stays feels nothing, and looks only for a fluid that is
/// extended into it.
void add_directions(Plan& plan, PlanEntry& e) {
  if (e.pairs != Pairs::searched) return;
  const auto direction = [&](std::size_t from, std::size_t to) {
    plan.directions.push_back({from, to, e.radius});
    return static_cast<int>(plan.directions.size()) - 1;
  };
  const auto looks = [&](std::size_t k) { return plan.phases[k].moves() || e.extends; };
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
    e.given = i;
    e.kernel = i.kernel;
    e.spacing = spacing_of(scene, i);
    e.radius = i.radius * e.spacing;
    describe_entry(scene, i, plan, e);
    add_directions(plan, e);
    plan.entries.push_back(e);
    if (e.a == e.b || e.gives_length) {
      for (const std::size_t p : {e.a, e.b})
        if (e.a == e.b || plan.phases[p].smoothing_length == 0) plan.phases[p].smoothing_length = 0.5 * e.radius;
    }
    if (auto contact = contact_with_itself(scene, i, plan, e)) {
      add_directions(plan, *contact);
      plan.entries.push_back(*contact);
    }
  }
  for (std::size_t k = 0; k < plan.phases.size(); ++k) {
    auto& p = plan.phases[k];
    if (p.smoothing_length == 0)
      for (const auto& e : plan.entries)
        if (e.a == k || e.b == k) p.smoothing_length = std::max(p.smoothing_length, 0.5 * e.radius);
    if (p.smoothing_length == 0 && p.moves()) p.smoothing_length = 0.5 * scene.spacing;  // no search
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

/// A field that no phase has is zeros in every frame. What all frames have, and the radius of spheres, are told without
/// a field.
void look_at_output_fields(const Scene& scene, Plan& plan) {
  using enum Field;
  for (const std::string& name : scene.output.fields) {
    const auto field = find_field(name);
    if (!field || FieldSet{position, velocity, density, pressure, smoothing_length}.has(*field)) continue;
    if (std::none_of(plan.phases.begin(), plan.phases.end(), [&](const PlanPhase& p) {
          return (*field == radius && p.own_steps()) ||
                 std::find(p.fields.begin(), p.fields.end(), *field) != p.fields.end();
        }))
      plan.warnings.push_back("output.fields: no phase of this scene has \"" + name + "\" (" +
                              std::string(info(*field).meaning) + "): it is zero in every frame");
  }
}

}  // namespace

Plan make_plan(const Scene& scene, const std::vector<ParticleBlock>& blocks) {
  Plan plan;
  plan.dimensions = scene.dimensions;
  plan.fixed_step = scene.time.fixed_step.value_or(0.0);
  plan.domain.dimensions = scene.dimensions;
  plan.domain.low = scene.domain.origin;
  plan.domain.high = scene.domain.origin + scene.domain.size;
  plan.domain.periodic = scene.domain.periodic;
  plan.bounds = bounds_with_zones(scene, plan.domain);
  for (std::size_t k = 0; k < scene.phases.size(); ++k) {
    const Phase& p = scene.phases[k];
    PlanPhase q;
    q.name = p.name;
    q.count = blocks[k].count();
    q.spacing = q.largest_size = p.spacing;
    q.mass = (p.density > 0 ? p.density : 1.0) * std::pow(p.spacing, scene.dimensions);
    plan.phases.push_back(q);
  }
  declare_phases(scene, plan);
  plan.largest_speed = largest_speed(scene, blocks, plan);
  warn_of_fast_motions(scene, blocks, plan);
  describe_phases(scene, blocks, plan, plan.warnings);
  add_entries(scene, plan);
  const Models models = make_models(scene, plan);
  add_passes(plan, models);
  plan.instruments = make_instruments(scene, plan);
  for (const auto& model : models) model->limits(plan.limits);
  if (plan.limits.empty() && plan.fixed_step == 0)
    throw SceneError(located(scene, "time.step") + ": missing: nothing limits the step; expected a number > 0 (s)");
  check_steps(scene, plan);
  look_at_output_fields(scene, plan);
  add_warnings(scene, blocks, plan);
  return plan;
}

}  // namespace barchan
