#include "plan/plan.hpp"

#include <algorithm>
#include <cmath>

#include "base/errors.hpp"
#include "plan/enclosed.hpp"
#include "plan/limits.hpp"
#include "scene/couplings.hpp"
#include "scene/formula.hpp"

namespace barchan {

std::string to_string(Law law) {
  switch (law) {
    case Law::fluid: return "fluid";
    case Law::boundary: return "boundary";
    case Law::repulsive: return "repulsive";
    case Law::coupling: return "coupling";
    case Law::contact: return "contact";
    case Law::elastic: return "elastic";
  }
  return "";
}

double Plan::particles() const {
  double n = 0;
  for (const auto& p : phases) n += static_cast<double>(p.count);
  return n;
}

double Plan::step() const {
  if (fixed_step > 0) return fixed_step;
  double dt = 1e300;
  for (const auto& l : limits) dt = std::min(dt, l.value);
  return dt;
}

namespace {

Law law_of(const Phase& a, const Phase& b) {
  const auto is = [&](PhaseKind k, PhaseKind l) {
    return (a.kind == k && b.kind == l) || (a.kind == l && b.kind == k);
  };
  using enum PhaseKind;
  if (is(fluid, fluid)) return Law::fluid;
  if (is(fluid, wall)) return (a.kind == wall ? a : b).wall_law == WallLaw::adami ? Law::boundary : Law::repulsive;
  if (is(fluid, grains) || is(fluid, elastic)) return Law::coupling;
  if (is(elastic, elastic)) return Law::elastic;
  return Law::contact;
}

double largest_speed(const Scene& scene, const std::vector<ParticleBlock>& blocks) {
  double speed = scene.time.largest_speed;
  if (speed > 0) return speed;
  for (const auto& b : blocks)
    for (const auto& v : b.velocity) speed = std::max(speed, norm(v));
  for (const auto& p : scene.phases)
    if (p.kind == PhaseKind::wall) {
      const Formula u(p.wall_velocity[0]), v(p.wall_velocity[1]), w(p.wall_velocity[2]);
      for (int k = 0; k <= 16; ++k) {
        const double t = scene.time.end * k / 16.0;
        speed = std::max(speed, norm({u({0, 0, 0}, t), v({0, 0, 0}, t), w({0, 0, 0}, t)}));
      }
    }
  double height = 0;
  for (std::size_t d = 0; d < 3; ++d) height += std::abs(scene.domain.gravity[d]) * scene.domain.size[d];
  return std::max(speed, std::sqrt(2.0 * height) / std::sqrt(2.0));
}

std::vector<Field> fields_of(const Phase& phase, bool eddies, bool free_surface) {
  using enum Field;
  switch (phase.kind) {
    case PhaseKind::fluid: {
      std::vector<Field> f{position, velocity, density, pressure, acceleration, density_rate};
      if (phase.shifting > 0) f.push_back(shift_velocity);
      if (phase.scheme == FluidScheme::consistent) f.push_back(anisotropy);
      if (free_surface) f.insert(f.end(), {wholeness, surface_normal});
      if (eddies) f.insert(f.end(), {eddy_viscosity, ground_distance});
      if (phase.energy) f.insert(f.end(), {energy, energy_rate});
      return f;
    }
    case PhaseKind::elastic: {
      std::vector<Field> f{position, velocity, density, pressure, acceleration, stress};
      if (phase.energy) f.push_back(energy);
      return f;
    }
    case PhaseKind::grains: return {position, velocity, acceleration};
    case PhaseKind::wall: return {position, velocity, wall_normal, wall_depth};
  }
  return {};
}

double compression_speed(const Phase& p) {
  const double lame = p.young * p.poisson / ((1 + p.poisson) * (1 - 2 * p.poisson));
  const double shear = p.young / (2 * (1 + p.poisson));
  return std::sqrt((lame + 2 * shear) / p.density);
}

void add_entries(const Scene& scene, Plan& plan) {
  const auto number = [&](const std::string& name) {
    for (std::size_t k = 0; k < scene.phases.size(); ++k)
      if (scene.phases[k].name == name) return k;
    throw SceneError("interactions: no phase \"" + name + "\"");
  };
  for (const auto& i : scene.interactions) {
    PlanEntry e;
    e.a = number(i.a);
    e.b = number(i.b);
    if (e.a > e.b) std::swap(e.a, e.b);
    e.name = i.a + "-" + i.b;
    e.law = law_of(scene.phases[e.a], scene.phases[e.b]);
    e.kernel = i.kernel;
    e.radius = i.radius * scene.spacing;
    e.drag = i.drag;
    e.consistency = lattice_consistency(i.kernel, i.radius, scene.dimensions);
    const Phase& fluid = scene.phases[scene.phases[e.a].kind == PhaseKind::fluid ? e.a : e.b];
    e.corrected = (e.law == Law::fluid || e.law == Law::boundary || e.law == Law::coupling) &&
                  fluid.scheme == FluidScheme::consistent;
    const auto direction = [&](std::size_t from, std::size_t to) {
      plan.directions.push_back({from, to, e.radius});
      return static_cast<int>(plan.directions.size()) - 1;
    };
    const bool a_wall = scene.phases[e.a].kind == PhaseKind::wall, b_wall = scene.phases[e.b].kind == PhaseKind::wall;
    const bool wall_looks = e.law == Law::boundary;  // extension needs the fluid about the wall; contacts do not
    if (!a_wall || wall_looks) e.forward = direction(e.a, e.b);
    if (e.a != e.b && (!b_wall || wall_looks)) e.backward = direction(e.b, e.a);
    plan.entries.push_back(e);
    if (e.a == e.b || e.law == Law::contact) {
      for (const std::size_t p : {e.a, e.b})
        if (e.a == e.b || plan.phases[p].smoothing_length == 0) plan.phases[p].smoothing_length = 0.5 * e.radius;
    }
  }
  for (std::size_t k = 0; k < plan.phases.size(); ++k) {
    auto& p = plan.phases[k];
    if (p.smoothing_length == 0)
      for (const auto& e : plan.entries)
        if (e.a == k || e.b == k) p.smoothing_length = std::max(p.smoothing_length, 0.5 * e.radius);
  }
}

/// Enclosed as the scene says, or else as the particles show; a fluid that is neither and ends somewhere has a free
/// surface.
void enclose(const Scene& scene, const std::vector<ParticleBlock>& blocks, std::size_t fluid, PlanPhase& p,
             std::vector<std::string>& warnings) {
  const std::optional<bool>& said = scene.phases[fluid].enclosed;
  const Enclosure seen = find_enclosure(scene, blocks, fluid);
  p.enclosed = said.value_or(seen.shut_in);
  p.enclosure = said ? "as the scene says" : seen.why;
  p.free_surface = !p.enclosed && seen.open;
  if (said.value_or(false) && !seen.free_space.empty())
    warnings.push_back("phases." + p.name + ".enclosed: there is free space at " + seen.free_space +
                       ", so that the mean density should be free; leave the key out");
}

void add_passes(const Scene& scene, Plan& plan) {
  const auto any_law = [&](Law law) {
    return std::any_of(plan.entries.begin(), plan.entries.end(), [&](const PlanEntry& e) { return e.law == law; });
  };
  const auto any_kind = [&](PhaseKind kind) {
    return std::any_of(plan.phases.begin(), plan.phases.end(), [&](const PlanPhase& p) { return p.kind == kind; });
  };
  const auto pass = [&](const char* name, bool needed) { (needed ? plan.passes : plan.skipped).emplace_back(name); };
  pass("kick and drift", true);
  pass("elastic strain", any_kind(PhaseKind::elastic));
  pass("wall motion", any_kind(PhaseKind::wall));
  pass("neighbours", true);
  pass("pack", true);
  pass("eddies", std::any_of(plan.phases.begin(), plan.phases.end(), [](const PlanPhase& p) { return p.eddies; }));
  pass("extension into walls", any_law(Law::boundary));
  pass("extension into solids", any_law(Law::coupling));
  pass("fluid rates", any_kind(PhaseKind::fluid));
  pass("free surface",
       std::any_of(plan.phases.begin(), plan.phases.end(), [](const PlanPhase& p) { return p.free_surface; }));
  pass("fluid energy", std::any_of(scene.phases.begin(), scene.phases.end(),
                                   [](const Phase& p) { return p.kind == PhaseKind::fluid && p.energy; }));
  pass("wall repulsion", any_law(Law::repulsive));
  pass("elastic forces", any_kind(PhaseKind::elastic));
  pass("contacts", any_law(Law::contact));
  pass("reaction on solids", any_law(Law::coupling));
  pass("drag", std::any_of(plan.entries.begin(), plan.entries.end(), [](const PlanEntry& e) { return e.drag > 0; }));
  pass("bulk speed",
       std::any_of(scene.forcings.begin(), scene.forcings.end(), [](const Forcing& f) { return f.hold_bulk_speed; }));
  pass("kick", true);
  pass("watch", true);
}

}  // namespace

Plan make_plan(const Scene& scene, const std::vector<ParticleBlock>& blocks) {
  Plan plan;
  plan.dimensions = scene.dimensions;
  plan.spacing = scene.spacing;
  plan.fixed_step = scene.time.fixed_step.value_or(0.0);
  plan.bounds.dimensions = scene.dimensions;
  plan.bounds.low = scene.domain.origin;
  plan.bounds.high = scene.domain.origin + scene.domain.size;
  plan.bounds.periodic = scene.domain.periodic;
  plan.largest_speed = largest_speed(scene, blocks);
  const double volume = std::pow(scene.spacing, scene.dimensions);
  for (std::size_t k = 0; k < scene.phases.size(); ++k) {
    const Phase& p = scene.phases[k];
    PlanPhase q;
    q.name = p.name;
    q.kind = p.kind;
    q.count = blocks[k].position.size();
    q.mass = (p.density > 0 ? p.density : 1.0) * volume;
    q.eddies = has_eddies(scene, p);
    for (const auto& f : scene.forcings) q.held = q.held || (f.hold_bulk_speed && f.phase == p.name);
    if (p.kind == PhaseKind::fluid) enclose(scene, blocks, k, q, plan.warnings);
    q.fields = fields_of(p, q.eddies, q.free_surface);
    if (p.kind == PhaseKind::fluid) q.sound_speed = p.sound_speed.value_or(10.0 * plan.largest_speed);
    if (p.kind == PhaseKind::elastic) q.sound_speed = compression_speed(p);
    if (p.kind == PhaseKind::grains) {
      // c^2 = 1000 g H: a bed as deep as the domain (H) is compressed by a thousandth at its bottom. At least 1 m/s.
      // The speed of the grains is not looked at: `contact-speed` is there for fast ones.
      double weight = 0;
      for (std::size_t d = 0; d < 3; ++d) weight += std::abs(scene.domain.gravity[d]) * scene.domain.size[d];
      q.sound_speed = p.contact_speed.value_or(std::max(std::sqrt(1000.0 * weight), 1.0));
    }
    if (p.kind == PhaseKind::fluid && q.sound_speed <= 0)
      throw SceneError(scene.file + ": phases." + p.name +
                       ".sound-speed: nothing in the scene moves or weighs, so that no sound speed "
                       "can be chosen; give sound-speed or time.largest-speed");
    plan.phases.push_back(q);
  }
  add_entries(scene, plan);
  add_passes(scene, plan);
  std::vector<double> sound_speeds;
  for (const auto& p : plan.phases) sound_speeds.push_back(p.sound_speed);
  plan.instruments = make_instruments(scene, plan.bounds, sound_speeds);
  plan.limits = initial_limits(scene, plan);
  if (plan.limits.empty() && plan.fixed_step == 0)
    throw SceneError(scene.file + ": time.step: missing: nothing limits the step; expected a number > 0 (s)");
  add_warnings(scene, plan);
  return plan;
}

}  // namespace barchan
