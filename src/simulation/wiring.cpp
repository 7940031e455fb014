#include "simulation/wiring.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/errors.hpp"
#include "kernels/kernel.hpp"
#include "models/walls/wall_normals.hpp"

namespace barchan {

namespace {

std::array<Formula, 3> compile(const VectorExpression& e) { return {Formula(e[0]), Formula(e[1]), Formula(e[2])}; }

/// Distance to the surface and the direction to it: given for fitted walls; behind the domain's sides for a wall
/// particle outside the domain.
void set_wall_geometry(PhaseParticles& wall, const Bounds& bounds, const ParticleBlock& block) {
  for (std::size_t k = 0; k < wall.size(); ++k) {
    if (k < block.depth.size() && block.depth[k] > 0.0) {
      wall.column(Field::wall_depth)[k] = block.depth[k];
      for (int d = 0; d < wall.dimensions(); ++d)
        wall.column(Field::wall_normal, d)[k] = block.normal[k][static_cast<std::size_t>(d)];
      continue;
    }
    double depth2 = 0;
    std::array<double, 3> out{};
    for (int d = 0; d < wall.dimensions(); ++d) {
      const auto c = static_cast<std::size_t>(d);
      if (bounds.periodic[c]) continue;
      const double x = wall.column(Field::position, d)[k];
      out[c] = x < bounds.low[c] ? x - bounds.low[c] : x > bounds.high[c] ? x - bounds.high[c] : 0.0;
      depth2 += out[c] * out[c];
    }
    const double depth = std::sqrt(depth2);
    wall.column(Field::wall_depth)[k] = depth;
    if (depth > 0)
      for (int d = 0; d < wall.dimensions(); ++d)
        wall.column(Field::wall_normal, d)[k] = -out[static_cast<std::size_t>(d)] / depth;
  }
}

/// Kernel contact for an entry: stiffness of the softer of the phases that move, damping from the restitution.
KernelContact contact_law(const Scene& scene, const Plan& plan, const PlanEntry& e, double strength) {
  const Phase &a = scene.phases[e.a], &b = scene.phases[e.b];
  const bool a_moves = a.kind != PhaseKind::wall, b_moves = b.kind != PhaseKind::wall;
  const auto stiffness_of = [&](std::size_t k) {
    return plan.phases[k].mass * std::pow(plan.phases[k].sound_speed, 2);
  };
  const PlanPhase& soft = plan.phases[!b_moves || (a_moves && stiffness_of(e.a) <= stiffness_of(e.b)) ? e.a : e.b];
  const double d = scene.spacing;
  const double m_a = plan.phases[e.a].mass, m_b = plan.phases[e.b].mass;
  const double reduced = a_moves && b_moves ? m_a * m_b / (m_a + m_b) : (a_moves ? m_a : m_b);
  double restitution = 1.0;
  if (a.kind == PhaseKind::grains) restitution = std::min(restitution, a.restitution);
  if (b.kind == PhaseKind::grains) restitution = std::min(restitution, b.restitution);
  KernelContact law{};
  with_kernel<double>(e.kernel, e.radius, plan.dimensions, [&](const auto& kernel) {
    law.rest_value = kernel.value(d);
    const double slope = std::abs(kernel.derivative(d));
    if (slope <= 0)
      throw SceneError("interactions." + e.name +
                       ": a contact needs a radius beyond one spacing (1.1 in eq. 16 of "
                       "Halik et al. 2015), so that touching grains feel each other");
    law.inverse_slope = 1.0 / slope;
  });
  law.stiffness = strength * soft.mass / (d * d) * soft.sound_speed * soft.sound_speed;
  const double zeta = KernelContact::damping_ratio(restitution);
  law.damping = 2.0 * zeta * std::sqrt(law.stiffness * reduced);
  return law;
}

/// Where a fluid begins along gravity, and what lies on it: its pressure at rest follows.
struct Surface {
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

/// One of each phase. A fluid under another fluid with which it has an entry carries its weight.
std::vector<Surface> find_surfaces(const Scene& scene, const Plan& plan, const std::vector<ParticleBlock>& blocks) {
  const Vec3& g = scene.domain.gravity;
  std::vector<Surface> surfaces(blocks.size());
  std::vector<std::size_t> order;
  for (std::size_t k = 0; k < blocks.size(); ++k) {
    const Phase& s = scene.phases[k];
    Surface& surface = surfaces[k];
    bool perturbed = false;
    for (const auto& f : scene.fills) {
      if (f.phase != s.name) continue;
      surface.hydrostatic = surface.hydrostatic || f.hydrostatic;
      perturbed = perturbed || f.perturb > 0;
    }
    if (s.kind != PhaseKind::fluid || !surface.hydrostatic || blocks[k].position.empty()) continue;
    surface.density = s.density;
    surface.sound_speed = plan.phases[k].sound_speed;
    surface.linear = s.equation_of_state == EquationOfState::linear;
    const auto highest = std::min_element(blocks[k].position.begin(), blocks[k].position.end(),
                                          [&](const Vec3& a, const Vec3& b) { return dot(g, a) < dot(g, b); });
    surface.potential = dot(g, *highest) - 0.5 * scene.spacing * norm(g);
    for (std::size_t d = 0; d < 3; ++d) {  // disturbed rows: where the lattice has its surface
      if (!perturbed || g[d] == 0 || std::abs(g[d]) < norm(g)) continue;
      const double row = surface.potential / g[d] - scene.domain.origin[d];
      surface.potential = g[d] * (scene.domain.origin[d] + scene.spacing * std::round(row / scene.spacing));
    }
    order.push_back(k);
  }
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return surfaces[a].potential < surfaces[b].potential; });
  for (std::size_t k = 0; k < order.size(); ++k)
    for (std::size_t above = k; above-- > 0;) {
      const std::size_t a = order[k], b = order[above];
      if (std::none_of(plan.entries.begin(), plan.entries.end(),
                       [&](const PlanEntry& e) { return (e.a == a && e.b == b) || (e.a == b && e.b == a); }))
        continue;
      surfaces[a].pressure = surfaces[b].pressure_at(surfaces[a].potential);
      break;
    }
  return surfaces;
}

}  // namespace

void close_sides(Sides& sides, const PhaseParticles& wall, const Bounds& bounds, double spacing) {
  for (std::size_t k = 0; k < wall.size(); ++k) {
    if (!behind_a_side(wall, k, bounds, spacing)) continue;
    int outside = 0, axis = 0;
    bool above = false;
    for (int d = 0; d < wall.dimensions(); ++d) {
      const auto c = static_cast<std::size_t>(d);
      const double x = wall.column(Field::position, d)[k];
      if (bounds.periodic[c] || (x >= bounds.low[c] && x <= bounds.high[c])) continue;
      ++outside;
      axis = d;
      above = x > bounds.high[c];
    }
    if (outside != 1) continue;
    const auto c = static_cast<std::size_t>(axis);
    (above ? sides.high[c] : sides.low[c]) = above ? bounds.high[c] : bounds.low[c];
  }
}

void Simulation::make_state(const std::vector<ParticleBlock>& blocks) {
  std::int64_t first = 0;
  const std::vector<Surface> surfaces = find_surfaces(scene_, plan_, blocks);
  for (std::size_t k = 0; k < blocks.size(); ++k) {
    const PlanPhase& q = plan_.phases[k];
    const Phase& s = scene_.phases[k];
    const ParticleBlock& block = blocks[k];
    PhaseParticles p(q.name, q.kind, plan_.dimensions, q.count, q.mass, first);
    first += static_cast<std::int64_t>(q.count);
    for (const Field f : q.fields) p.add(f);
    for (int d = 0; d < plan_.dimensions; ++d)
      for (std::size_t i = 0; i < q.count; ++i) {
        p.column(Field::position, d)[i] = block.position[i][static_cast<std::size_t>(d)];
        p.column(Field::velocity, d)[i] = block.velocity[i][static_cast<std::size_t>(d)];
      }
    if (p.has(Field::density)) std::fill_n(p.column(Field::density), q.count, s.density);
    if (q.kind == PhaseKind::fluid) {
      const Surface& surface = surfaces[k];
      const double c2 = q.sound_speed * q.sound_speed;
      for (std::size_t i = 0; i < q.count; ++i) {
        const double pressure = surface.hydrostatic ? surface.pressure_at(dot(scene_.domain.gravity, block.position[i]))
                                : block.pressure.empty() ? 0.0
                                                         : block.pressure[i];
        p.column(Field::density)[i] =
            s.equation_of_state == EquationOfState::linear
                ? s.density + pressure / c2
                : s.density * std::pow(1.0 + s.tait_exponent * pressure / (s.density * c2), 1.0 / s.tait_exponent);
      }
    }
    bends_.emplace_back();
    if (!block.bend.empty()) {
      bends_.back().first = p.id().empty() ? 0 : p.id()[0];
      for (const auto& b : block.bend)
        if (plan_.dimensions == 2) bends_.back().values.push_back(b[0]);
        else bends_.back().values.insert(bends_.back().values.end(), b.begin(), b.end());
    }
    if (q.kind == PhaseKind::wall) set_wall_geometry(p, plan_.bounds, block);
    if (q.kind == PhaseKind::fluid) {
      const PressureLaw law = pressure_law(k);
      for (std::size_t i = 0; i < q.count; ++i) p.column(Field::pressure)[i] = law(p.column(Field::density)[i]);
    }
    particles_.push_back(std::move(p));
  }
  // Walls inside the domain along which the fluid slips need to know which way they face.
  std::vector<PhaseParticles*> walls;
  bool slips = false;
  for (std::size_t k = 0; k < particles_.size(); ++k) {
    if (particles_[k].kind() != PhaseKind::wall) continue;
    const Phase& s = scene_.phases[k];
    walls.push_back(&particles_[k]);
    slips = slips || s.slip == Slip::free_slip || s.roughness || s.shear_stress;
  }
  if (slips) find_wall_normals(walls, plan_.bounds, plan_.spacing);
}

namespace {

Friction friction_with(const Phase& other) {
  if (other.kind == PhaseKind::fluid) return Friction::fluid;
  if (other.kind == PhaseKind::grains) return Friction::grains;
  if (other.shear_stress) return Friction::driven;
  if (other.slip == Slip::free_slip) return Friction::slip;
  return other.roughness ? Friction::rough : Friction::smooth;
}

/// From now on the fluid keeps the mean velocity along periodic axes that it has.
void hold_as_it_is(BulkHold& hold, BlockMean& mean, const PhaseParticles& fluid, const Bounds& bounds) {
  for (int d = 0; d < fluid.dimensions() && fluid.size() > 0; ++d) {
    const auto c = static_cast<std::size_t>(d);
    hold.axes[c] = bounds.periodic[c];
    if (hold.axes[c]) hold.velocity[c] = mean(fluid.column(Field::velocity, d), fluid.size());
  }
}

/// -tr M/Dim of a fluid's own entry on a lattice.
double lattice_moment(const Plan& plan, std::size_t fluid) {
  for (const auto& e : plan.entries)
    if (e.a == fluid && e.b == fluid) return e.consistency.gradient_sum;
  return 1.0;
}

/// sum V W of a full neighbourhood less the particle itself.
double weight_about_a_lone_particle(const Plan& plan, const PlanEntry& e) {
  double own = 0.0;
  with_kernel<double>(e.kernel, e.radius, plan.dimensions,
                      [&](const auto& kernel) { own = kernel.value(0.0) * std::pow(plan.spacing, plan.dimensions); });
  return e.consistency.volume_sum - own;
}

/// Whether the grains of the other phase resist the fluid by a form drag: that is then the whole of their friction. The
/// logarithmic law of rough ground beside it would take the same momentum twice.
bool has_form_drag(const Plan& plan, std::size_t fluid, std::size_t other) {
  return std::any_of(plan.entries.begin(), plan.entries.end(), [&](const PlanEntry& e) {
    return e.drag > 0 && ((e.a == fluid && e.b == other) || (e.a == other && e.b == fluid));
  });
}

}  // namespace

/// The ground of fitted rows, if the fluid feels the wall that it is of.
Relief Simulation::relief_under(std::size_t fluid) const {
  for (const auto& e : plan_.entries) {
    if (e.law != Law::boundary || (e.a != fluid && e.b != fluid)) continue;
    const std::string& wall = scene_.phases[e.a == fluid ? e.b : e.a].name;
    for (const auto& fill : scene_.fills) {
      if (fill.phase != wall || fill.packing != Packing::fitted) continue;
      std::array<int, 2> counts{};
      for (std::size_t c = 0; c < (plan_.dimensions == 3 ? 2 : 1); ++c)
        counts[c] = static_cast<int>(std::ceil(2.0 * scene_.domain.size[2 * c] / plan_.spacing));
      return {plan_.bounds, counts, fitted_heights(scene_, counts)};
    }
  }
  return {};
}

/// Its entries again with the friction of each, and the ground under it.
void Simulation::wire_eddies(Fluid& f) {
  const Phase& s = scene_.phases[f.phase];
  const PlanPhase& q = plan_.phases[f.phase];
  f.viscous_limit = "viscous " + s.name;
  f.eddies.model = s.turbulence;
  f.eddies.density = s.density;
  f.eddies.viscosity = f.neighbours.front().viscosity / s.density;
  f.eddies.spacing = plan_.spacing;
  f.eddies.length = s.smagorinsky * plan_.spacing;
  Sides sides;
  bool particles = false;
  for (const auto& n : f.neighbours) {
    EddyNeighbour e;
    e.pair = n;
    for (std::size_t other = 0; other < particles_.size(); ++other) {
      if (n.records != &motion_[other] && n.records != &extended_[other]) continue;
      const Phase& o = scene_.phases[other];
      e.friction = friction_with(o);
      if (e.friction == Friction::fluid) {
        if (plan_.phases[other].eddies) e.eddies = &eddies_[other];
        e.root = std::sqrt(n.viscosity);
      }
      e.stress = o.shear_stress.value_or(Vec3{});
      if (o.kind == PhaseKind::wall) e.wall = &particles_[other];
      if (e.friction == Friction::grains) {
        const bool drag = has_form_drag(plan_, f.phase, other);
        e.roughness = f.eddies.roughness = drag ? 0.0 : o.roughness.value_or(plan_.spacing / 30.0);
        f.eddies.grain_reach = std::max(f.eddies.grain_reach, n.radius);
      } else {
        e.roughness = o.roughness.value_or(0.0);
      }
      const bool ground =
          e.friction == Friction::rough || e.friction == Friction::smooth || e.friction == Friction::grains;
      if (!ground) continue;
      f.ground_phases.push_back(&particles_[other]);
      if (o.kind == PhaseKind::wall) {
        close_sides(sides, particles_[other], plan_.bounds, plan_.spacing);
        for (std::size_t i = 0; i < particles_[other].size() && !particles; ++i)
          particles = !behind_a_side(particles_[other], i, plan_.bounds, plan_.spacing);
      } else {
        particles = true;
      }
    }
    f.eddy_neighbours.push_back(e);
  }
  if (s.turbulence == Turbulence::mixing_length && f.ground_phases.empty())
    throw SceneError(scene_.file + ": phases." + q.name +
                     ".turbulence: a mixing length needs ground, and this fluid touches no wall with friction and no "
                     "grains; expected such an entry in [interactions], or \"smagorinsky\"");
  f.ground = std::make_unique<GroundDistance>(plan_.bounds, sides, plan_.spacing, particles);
}

void Simulation::wire() {
  const std::size_t phases = particles_.size();
  const int motion = plan_.dimensions == 2 ? MotionRecord<2>::size : MotionRecord<3>::size;
  const int stress = plan_.dimensions == 2 ? StressRecord<2>::size : StressRecord<3>::size;
  std::vector<bool> seen(phases, false);
  for (const auto& e : plan_.entries)
    if (e.law == Law::boundary || e.law == Law::coupling)
      seen[scene_.phases[e.a].kind == PhaseKind::fluid ? e.b : e.a] = true;
  const bool mixed = scene_.precision == Precision::mixed;
  // Who reads records in double: every law but the fluid's own in mixed precision.
  std::vector<bool> read(phases, !mixed);
  for (const auto& e : plan_.entries)
    if (e.law != Law::fluid) read[e.a] = read[e.b] = true;
  eddies_.reserve(phases);
  motion_.reserve(phases);
  extended_.reserve(phases);
  for (std::size_t k = 0; k < phases; ++k) {
    const bool fluid = particles_[k].kind() == PhaseKind::fluid;
    motion_.emplace_back(read[k] || particles_[k].has(Field::energy) ? motion : 0);
    compact_.push_back(mixed && (fluid || seen[k]) ? std::make_unique<CompactRecords>(plan_.bounds) : nullptr);
    extended_.emplace_back(seen[k] ? motion : 0);
    stress_.emplace_back(particles_[k].kind() == PhaseKind::elastic ? stress : 0);
    eddies_.emplace_back();
    wall_velocity_.push_back(compile(scene_.phases[k].wall_velocity));
  }
  for (const auto& f : scene_.forcings)
    for (std::size_t k = 0; k < phases && !f.hold_bulk_speed; ++k)
      if (particles_[k].name() == f.phase) forcings_.push_back({k, compile(f.acceleration)});

  const auto viscosity = [&](std::size_t a, std::size_t b) {
    const auto of = [&](std::size_t k) {
      const Phase& s = scene_.phases[k];
      const PlanPhase& p = plan_.phases[k];
      const double artificial =
          s.artificial_viscosity * p.smoothing_length * p.sound_speed / (2.0 * (plan_.dimensions + 2));
      return s.density * (s.viscosity + artificial);
    };
    const bool a_fluid = particles_[a].kind() == PhaseKind::fluid, b_fluid = particles_[b].kind() == PhaseKind::fluid;
    if (a_fluid && b_fluid) return a == b ? of(a) : 2.0 * of(a) * of(b) / std::max(of(a) + of(b), 1e-300);
    return of(a_fluid ? a : b);
  };
  for (std::size_t k = 0; k < phases; ++k) {
    const auto& p = particles_[k];
    const Phase& s = scene_.phases[k];
    const PlanPhase& q = plan_.phases[k];
    if (p.kind() == PhaseKind::fluid) {
      Fluid f;
      f.phase = k;
      f.parameters.reference_density = s.density;
      f.parameters.sound_speed = q.sound_speed;
      f.parameters.smoothing_length = q.smoothing_length;
      const double speed = plan_.largest_speed > 0 ? plan_.largest_speed : 0.1 * q.sound_speed;
      // Strengths measured in docs/method.md: 2 in the consistent scheme, 4 in the plain one, whose sums need more
      // order.
      const double pace = speed + s.viscosity / q.smoothing_length;
      f.parameters.shift_speed = (s.scheme == FluidScheme::consistent ? 2.0 : 4.0) * s.shifting * pace;
      f.parameters.shift_limit = 0.2 * pace;
      f.parameters.gravity = scene_.domain.gravity;
      for (const auto& e : plan_.entries)
        if (e.law == Law::coupling && (e.a == k || e.b == k))
          f.parameters.pores = 0.5 * q.sound_speed / q.smoothing_length;
      f.parameters.lattice_moment = lattice_moment(plan_, k);
      if (q.free_surface) {
        f.surface = std::make_unique<SurfaceFinder>();
        if (!q.eddies)
          f.parameters.least_viscosity =
              s.density * q.smoothing_length * std::sqrt(norm(scene_.domain.gravity) * q.smoothing_length);
        f.parameters.loosening = 4.0 * q.sound_speed / q.smoothing_length;
        f.parameters.void_pressure = pressure_law(k)(s.density);
      } else {
        f.parameters.void_pressure = -0.2 * s.density * speed * speed;
      }
      for (const auto& e : plan_.entries) {
        if ((e.a != k && e.b != k) || e.law == Law::repulsive) continue;
        const std::size_t other = e.a == k ? e.b : e.a;
        const int direction = e.a == k ? e.forward : e.backward;
        const bool solid = particles_[other].kind() != PhaseKind::fluid;
        FluidNeighbour n{
            &neighbours_.list(static_cast<std::size_t>(direction)),
            solid ? &extended_[other] : &motion_[other],
            e.kernel,
            e.radius,
            viscosity(k, other),
            solid || other == k,
            compact_[other].get(),
            !solid && other != k && s.scheme == FluidScheme::consistent ? scene_.phases[other].density : 0};
        // The phase's own entry comes first: its viscosity is the phase's.
        if (other == k) f.neighbours.insert(f.neighbours.begin(), n);
        else f.neighbours.push_back(n);
      }
      for (const auto& e : plan_.entries)
        if (e.law == Law::boundary && (e.a == k || e.b == k))
          close_sides(f.held, particles_[e.a == k ? e.b : e.a], plan_.bounds, plan_.spacing);
      f.held.margin = 0.02 * plan_.spacing;
      if (s.scheme == FluidScheme::consistent) f.relief = relief_under(k);
      if (q.eddies) wire_eddies(f);
      for (const auto& force : scene_.forcings)
        if (force.hold_bulk_speed && force.phase == s.name) hold_as_it_is(f.hold, f.mean, p, plan_.bounds);
      fluids_.push_back(std::move(f));
    } else if (seen[k]) {
      Extension x;
      x.phase = k;
      for (const auto& e : plan_.entries) {
        if ((e.a != k && e.b != k) || (e.law != Law::boundary && e.law != Law::coupling)) continue;
        const std::size_t fluid = e.a == k ? e.b : e.a;
        const PairList* list = &neighbours_.list(static_cast<std::size_t>(e.a == k ? e.forward : e.backward));
        x.sources.push_back({list, &motion_[fluid], e.kernel, e.radius, scene_.phases[fluid].density,
                             e.drag > 0 ? weight_about_a_lone_particle(plan_, e) : 0.0});
        if (e.law == Law::coupling) x.felt_fluids.push_back(fluid);
        if (e.law == Law::coupling)
          x.felt.push_back({list, &motion_[fluid], e.kernel, e.radius, viscosity(k, fluid), false});
      }
      if (k < bends_.size()) x.bend = bends_[k];
      extensions_.push_back(std::move(x));
    }
    if (p.kind() == PhaseKind::elastic) {
      Body b;
      b.phase = k;
      const double shear = s.young / (2.0 * (1.0 + s.poisson)), bulk = s.young / (3.0 * (1.0 - 2.0 * s.poisson));
      b.parameters = {s.density,
                      shear,
                      bulk,
                      s.artificial_viscosity,
                      s.artificial_viscosity_beta,
                      std::sqrt(bulk / s.density),
                      scene_.domain.gravity};
      for (const auto& e : plan_.entries) {
        if ((e.a != k && e.b != k) || e.law != Law::elastic) continue;
        const std::size_t other = e.a == k ? e.b : e.a;
        b.neighbours.push_back({&neighbours_.list(static_cast<std::size_t>(e.a == k ? e.forward : e.backward)),
                                &stress_[other], e.kernel, e.radius, plan_.phases[other].mass});
      }
      bodies_.push_back(std::move(b));
    }
  }
  for (const auto& e : plan_.entries) {
    if (!(e.drag > 0)) continue;
    const bool a_fluid = particles_[e.a].kind() == PhaseKind::fluid;
    const double d = plan_.spacing, section = plan_.dimensions == 2 ? d : 0.25 * std::numbers::pi * d * d;
    const std::size_t fluid = a_fluid ? e.a : e.b;
    const double density = scene_.phases[fluid].density, reach = GrainBarrier::reach * d;
    // What flows at a tenth of the sound speed is turned back before it reaches a grain's centre.
    const double speed = 0.1 * plan_.phases[fluid].sound_speed;
    const GrainBarrier barrier{reach, speed / reach, 4.0 / (speed * speed)};
    const DragEntry entry{e.kernel, e.radius, 0.5 * e.drag * density * section, density, barrier};
    drags_.push_back({e.a, e.b, &neighbours_.list(static_cast<std::size_t>(e.forward)), entry, a_fluid});
    drags_.push_back({e.b, e.a, &neighbours_.list(static_cast<std::size_t>(e.backward)), entry, !a_fluid});
  }
  for (const auto& e : plan_.entries) {
    if (e.law != Law::contact && e.law != Law::repulsive) continue;
    const auto law = [&] {
      if (e.law == Law::contact) return contact_law(scene_, plan_, e, 1.0);
      // Ghosts push a fluid without damping, K = m c u / d^2 with u = c/10: the largest speed where the sound speed is
      // automatic.
      KernelContact k = contact_law(scene_, plan_, e, 1.0);
      const std::size_t fluid = scene_.phases[e.a].kind == PhaseKind::fluid ? e.a : e.b;
      const PlanPhase& p = plan_.phases[fluid];
      k.stiffness = p.mass / (scene_.spacing * scene_.spacing) * p.sound_speed * 0.1 * p.sound_speed;
      k.damping = 0.0;
      return k;
    }();
    const auto direction = [&](std::size_t a, std::size_t b, int number) {
      if (number < 0 || particles_[a].kind() == PhaseKind::wall) return;
      Contact c;
      c.a = a;
      c.b = b;
      c.list = &neighbours_.list(static_cast<std::size_t>(number));
      c.kernel = e.kernel;
      c.radius = e.radius;
      c.law = law;
      c.is_repulsion = e.law == Law::repulsive;
      contacts_.push_back(c);
    };
    direction(e.a, e.b, e.forward);
    if (e.a != e.b) direction(e.b, e.a, e.backward);
  }
}

}  // namespace barchan
