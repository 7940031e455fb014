// A fluid phase before its first step: its description for the plan, and the records and lists of its tasks.
#include <algorithm>
#include <cmath>

#include "base/errors.hpp"
#include "engine/exchange.hpp"
#include "engine/reproducible_sum.hpp"
#include "kernels/kernel.hpp"
#include "models/fluid/enclosed.hpp"
#include "models/fluid/fluid_phase.hpp"
#include "models/open_sides.hpp"
#include "models/walls/sides.hpp"
#include "output/numbers.hpp"
#include "scene/couplings.hpp"
#include "scene/located.hpp"

namespace barchan {

namespace {

/// rho0 h sqrt(g h) (Pa s): what friction of the rows beside a heavy free surface is measured in (fluid_surface.hpp).
double viscosity_of_rows(const Scene& scene, const Layout& layout, std::size_t fluid) {
  const double h = layout.phases[fluid].smoothing_length;
  return scene.phases[fluid].density * h * std::sqrt(norm(scene.domain.gravity) * h);
}

/// Enclosed as the scene says, or else as the particles show; a fluid that is neither and ends somewhere has a free
/// surface.
void enclose(const Scene& scene, const std::vector<ParticleBlock>& blocks, std::size_t fluid, Layout& layout,
             std::vector<std::string>& warnings) {
  PlanPhase& p = layout.phases[fluid];
  const std::optional<bool>& said = scene.phases[fluid].fluid().enclosed;
  const Enclosure seen = find_enclosure(scene, layout, blocks, fluid);
  p.enclosed = said.value_or(seen.shut_in);
  p.enclosure = said ? "as the scene says" : seen.why;
  p.free_surface = !p.enclosed && seen.open;
  p.open = open_sides(scene, fluid, p.free_surface);
  p.flow_ends = flow_ends(scene, scene.phases[fluid]);
  for (const FlowEnd& end : p.flow_ends) {
    const auto& places = blocks[fluid].position;
    if (Exchange().any(
            std::any_of(places.begin(), places.end(), [&](const Vec3& x) { return end.beyond(x[end.axis()]) > 0.0; })))
      continue;
    throw SceneError(located(scene, end.inflow ? "inflow" : "outflow") + ": no particle of \"" + p.name +
                     "\" stands in the last row at the side \"" + word_of(end.side) +
                     "\" at the start, from which lanes follow; expected a fill that reaches this side");
  }
  if (said.value_or(false) && !seen.free_space.empty())
    warnings.push_back("phases." + p.name + ".enclosed: there is free space at " + seen.free_space +
                       ", so that the mean density should be free; leave the key out");
}

std::vector<Field> fields_of(const Scene& scene, const Phase& phase, const PlanPhase& plan) {
  using enum Field;
  const FluidKeys& keys = phase.fluid();
  std::vector<Field> f{position, velocity, density, pressure, acceleration, density_rate};
  if (keys.shifting > 0) f.push_back(shift_velocity);
  if (keys.scheme == FluidScheme::consistent) f.push_back(anisotropy);
  if (keys.scheme == FluidScheme::consistent && !plan.free_surface && !solids_move_in(scene, phase))
    f.push_back(near_void);
  if (plan.free_surface) f.insert(f.end(), {wholeness, surface_normal});
  if (plan.eddies) f.insert(f.end(), {eddy_viscosity, ground_distance});
  if (keys.turbulence == Turbulence::k_omega)
    f.insert(f.end(), {turbulent_kinetic_energy, specific_dissipation_rate, shear_rate});
  else if (is_output(scene, shear_rate)) f.push_back(shear_rate);  // FluidPhase::derive
  if (is_output(scene, velocity_gradient)) f.push_back(velocity_gradient);
  if (keys.energy) f.insert(f.end(), {energy, energy_rate});
  return f;
}

/// How the watch guards a fluid. `movers`: "; or ...", what else may press it.
PhaseRules rules_of(const PlanPhase& p, const std::string& step_key, const std::string& movers) {
  PhaseRules r;
  r.signal_speed = p.sound_speed;
  r.density_share = 0.3;
  r.remedy = [key = "phases." + p.name + ".", own = p.name, c = p.sound_speed, step_key, movers](Fault fault, double,
                                                                                                 double) {
    switch (fault) {
      case Fault::not_finite: return key + "sound-speed or " + key + "density-diffusion";
      case Fault::passed_wall: return "lower " + step_key + " or raise " + key + "sound-speed";
      case Fault::density:
        return "the pressure ran away, or neighbours are too few: lower the spacing or " + step_key +
               ", raise the radius of interactions." + own + "-" + own + ", or " + key +
               "sound-speed where the flow is faster than " + brief(0.1 * c) + " m/s, a tenth of it" + movers;
      case Fault::too_fast:
        return "sound (" + brief(c) + " m/s); the flow ran away, or the scene has too slow a sound: raise " + key +
               "sound-speed to ten times the largest speed, " + key + "viscosity or " + key +
               "artificial-viscosity, or lower " + step_key;
      case Fault::too_far: return "lower " + step_key;
      case Fault::too_near: break;
    }
    return std::string();
  };
  return r;
}

}  // namespace

void declare_fluid(const Scene&, std::size_t number, Layout& layout) { layout.phases[number].mover = Mover::fluid; }

void describe_fluid(const Scene& scene, const std::vector<ParticleBlock>& blocks, std::size_t number, Layout& layout,
                    std::vector<std::string>& warnings) {
  const Phase& phase = scene.phases[number];
  PlanPhase& p = layout.phases[number];
  p.surface.friction = Friction::fluid;
  p.physics = phase.fluid().scheme == FluidScheme::plain ? "plain fluid" : "consistent fluid";
  p.eddies = has_eddies(scene, phase);
  for (const auto& f : scene.forcings) p.wind.held = p.wind.held || (f.hold != Hold::none && f.phase == phase.name);
  p.wind.driven = Drive::exists(scene, phase);
  p.wind.friction_velocity = stated_friction_velocity(scene, phase);
  enclose(scene, blocks, number, layout, warnings);
  check_k_omega(scene, number, layout);
  p.fields = fields_of(scene, phase, p);
  p.sound_speed = phase.fluid().sound_speed.value_or(10.0 * layout.largest_speed);
  if (p.sound_speed <= 0)
    throw SceneError(scene.file + ": phases." + p.name +
                     ".sound-speed: nothing in the scene moves or weighs, so that no sound speed "
                     "can be chosen; give sound-speed or time.largest-speed");
  std::string movers;
  for (std::size_t k = 0; k < layout.phases.size(); ++k)
    if (layout.phases[k].travels() && entry_between(scene, phase, scene.phases[k]))
      movers += "; or \"" + layout.phases[k].name + "\", which moves, leaves it too little or too much room";
  if (scene.time.largest_speed > 0.0)
    movers += "; time.largest-speed promises " + brief(scene.time.largest_speed) + " m/s at most";
  p.rules = rules_of(p, scene.time.fixed_step ? "time.step" : "time.safety", movers);
}

std::string correction_of(const Scene& scene, std::size_t fluid) {
  return scene.phases[fluid].fluid().scheme == FluidScheme::consistent ? "by the consistent scheme" : "";
}

void describe_fluids(const Scene& scene, const Interaction& pair, const Layout& layout, PlanEntry& e) {
  if (e.a == e.b) check_energy_budget(scene, e.a, layout);
  e.law = "fluid";
  e.continues_fluid = true;
  describe_approximation(pair, scene.dimensions, correction_of(scene, e.fluid), e);
}

PressureLaw pressure_law(const Scene& scene, const Layout& layout, std::size_t fluid) {
  const FluidKeys& keys = scene.phases[fluid].fluid();
  const double c = layout.phases[fluid].sound_speed, density = scene.phases[fluid].density;
  return {density, c, keys.equation_of_state == EquationOfState::linear ? 1.0 : keys.tait_exponent,
          keys.background_pressure * density * c * c};
}

namespace {

/// Its own and the artificial one (Pa s).
double viscosity_of(const Scene& scene, const Layout& layout, std::size_t fluid) {
  const FluidKeys& keys = scene.phases[fluid].fluid();
  const PlanPhase& p = layout.phases[fluid];
  const double artificial =
      keys.artificial_viscosity * p.smoothing_length * p.sound_speed / (2.0 * (layout.dimensions + 2));
  return scene.phases[fluid].density * (keys.viscosity + artificial);
}

}  // namespace

double pair_viscosity(const Scene& scene, const Layout& layout, std::size_t a, std::size_t b) {
  const bool a_fluid = layout.phases[a].flows(), b_fluid = layout.phases[b].flows();
  if (!a_fluid || !b_fluid || a == b) return viscosity_of(scene, layout, a_fluid ? a : b);
  const double mu_a = viscosity_of(scene, layout, a), mu_b = viscosity_of(scene, layout, b);
  return 2.0 * mu_a * mu_b / std::max(mu_a + mu_b, 1e-300);
}

double viscosity_of_sums(const Scene& scene, const Layout& layout, const PlanEntry& e) {
  return pair_viscosity(scene, layout, e.a, e.b) / (e.corrected ? 1.0 : e.consistency.gradient_sum);
}

bool has_interface(const Scene& scene, const Layout& layout, const PlanEntry& e) {
  const auto laminar = [&](std::size_t k) {
    return layout.phases[k].flows() && !layout.phases[k].eddies &&
           scene.phases[k].fluid().scheme == FluidScheme::consistent;
  };
  if (e.a == e.b || !e.continues_fluid || !laminar(e.a) || !laminar(e.b)) return false;
  const auto differ = [](double a, double b) { return std::abs(a - b) > 1e-12 * std::max(a, b); };
  return differ(scene.phases[e.a].density, scene.phases[e.b].density) ||
         differ(viscosity_of(scene, layout, e.a), viscosity_of(scene, layout, e.b));
}

double wall_rub(const Scene& scene, const Layout& layout, std::size_t solid) {
  double rub = 0.0;
  for (const PlanEntry& e : layout.entries) {
    if (!e.extends || e.other != solid) continue;
    const double least =
        calmed(scene, layout, e.fluid) ? bulk_friction * viscosity_of_rows(scene, layout, e.fluid) : 0.0;
    rub = std::max(rub, least > 0.0 ? std::min(pair_viscosity(scene, layout, solid, e.fluid) / least, 1.0) : 1.0);
  }
  return rub > 0.0 ? rub : 1.0;
}

void FluidPhase::begin(State& state, const std::vector<ParticleBlock>& blocks) {
  PhaseParticles& p = state.phases[number_];
  const ParticleBlock& block = blocks[number_];
  const std::vector<double> rest = pressure_at_rest(scene_, layout_, blocks, number_);
  const double c2 = plan_.sound_speed * plan_.sound_speed;
  for (std::size_t i = 0; i < p.size(); ++i) {
    const double pressure = !rest.empty() ? rest[i] : block.pressure.empty() ? 0.0 : block.pressure[i];
    p.column(Field::density)[i] =
        keys_.equation_of_state == EquationOfState::linear
            ? phase_.density + pressure / c2
            : phase_.density *
                  std::pow(1.0 + keys_.tait_exponent * pressure / (phase_.density * c2), 1.0 / keys_.tait_exponent);
    p.column(Field::pressure)[i] = pressure_(p.column(Field::density)[i]);
  }
}

/// The ground of fitted rows, if the fluid feels the wall that it is of.
Relief FluidPhase::relief() const {
  for (const auto& e : layout_.entries) {
    if (!e.extends || e.fluid != number_ || layout_.phases[e.other].moves()) continue;
    const std::string& wall = scene_.phases[e.other].name;
    for (const auto& fill : scene_.fills) {
      if (fill.phase != wall || fill.packing != Packing::fitted) continue;
      std::array<int, 2> counts{};
      for (std::size_t c = 0; c < (layout_.dimensions == 3 ? 2 : 1); ++c)
        counts[c] = static_cast<int>(std::ceil(2.0 * scene_.domain.size[2 * c] / plan_.spacing));
      return {layout_.domain, counts, fitted_heights(scene_, counts)};  // beyond it goes on as at its sides
    }
  }
  return {};
}

namespace {

/// From now on the fluid keeps the mean velocity along periodic axes that it has.
void hold_as_it_is(BulkHold& hold, const PhaseParticles& fluid, const Bounds& bounds) {
  const bool any = Exchange().total(fluid.size()) > 0;
  for (int d = 0; d < fluid.dimensions() && any; ++d) {
    const auto c = static_cast<std::size_t>(d);
    hold.axes[c] = bounds.periodic[c];
    if (hold.axes[c]) hold.velocity[c] = reproducible_mean(fluid.column(Field::velocity, d), fluid.size());
  }
}

/// The plain sums push with p_a + p_b: where that is below zero they pull, and particles that no friction holds clump
/// (Swegle, Hicks & Attaway 1995). Where every side is periodic the pressure has a constant that means nothing; adding
/// one in the sums stops the clumping and costs accuracy by disorder. Clumps grow at the rate U/h, friction takes
/// nu/h^2 of them: so none up to U h/nu = 10, and 0.45 rho0 U^2 without friction. Measured: docs/method.md, plain
/// scheme.
double pressure_lift(double density, double speed, double smoothing_length, double viscosity) {
  return 0.45 * density * speed * speed * std::max(0.0, 1.0 - 10.0 * viscosity / (speed * smoothing_length));
}

/// Whether every side is periodic and so many particles fill all between them.
bool fills_periodic_domain(const Scene& scene, double count, double spacing) {
  double room = 0.99;
  for (std::size_t axis = 0; axis < static_cast<std::size_t>(scene.dimensions); ++axis) {
    if (!scene.domain.periodic[axis]) return false;
    room *= scene.domain.size[axis] / spacing;
  }
  return count >= room;
}

}  // namespace

double FluidPhase::largest_speed() const {
  return layout_.largest_speed > 0 ? layout_.largest_speed : 0.1 * plan_.sound_speed;
}

void FluidPhase::attach(Workspace& w) {
  w_ = &w;
  particles_ = &w.particles(number_);
  const bool corrected = keys_.scheme == FluidScheme::consistent;
  // The consistent operators weigh neighbours by the spacing's volume: what they sum is exact for any weights.
  w.packing[number_] = {true, corrected};
  auto& q = parameters_;
  q.reference_density = phase_.density;
  q.sound_speed = plan_.sound_speed;
  q.smoothing_length = plan_.smoothing_length;
  const double speed = largest_speed();
  // Strengths measured in docs/method.md: 2 in the consistent scheme, 4 in the plain one, whose sums need more order.
  const double pace = speed + keys_.viscosity / q.smoothing_length;
  q.shift_speed = (corrected ? 2.0 : 4.0) * keys_.shifting * pace;
  q.shift_limit = 0.2 * pace;
  q.gravity = scene_.domain.gravity;
  q.acceleration = forces_.uniform();
  if (solids_move_in(scene_, phase_)) q.pores = 0.5 * q.sound_speed / q.smoothing_length;  // they may leave holes
  const Consistency& lattice = own_consistency(layout_, number_);
  q.lattice_moment = lattice.gradient_sum;
  if (plan_.free_surface) {
    surface_ = std::make_unique<SurfaceFinder>();
    if (!plan_.eddies) q.least_viscosity = viscosity_of_rows(scene_, layout_, number_);
    q.surface_depth = 0.5 * plan_.spacing;
    if (q.least_viscosity > 0.0) q.surface_diffusivity = surface_diffusion * q.smoothing_length * q.sound_speed;
    const double rubbing = plan_.eddies ? 0.0 : phase_.density * keys_.viscosity;
    if (corrected && (plan_.eddies || rubbing > 0.0 || q.least_viscosity > 0.0))
      set_surface_stress(q, rubbing, plan_.spacing, lattice.surface_sum);
    q.loosening = 4.0 * q.sound_speed / q.smoothing_length;
    q.void_pressure = pressure_(phase_.density);
  } else {
    q.void_pressure = -0.2 * phase_.density * speed * speed;
  }
  bind_entries();
  q.ends = true;
  if (particles_->has(Field::near_void)) look_for_voids();
  held_.margin = border_room * plan_.spacing;
  if (corrected && plan_.enclosed) {
    parameters_.calming = 0.5 * parameters_.sound_speed / parameters_.smoothing_length;
    held_.margin_of_off = border_room_of_off * plan_.spacing;
    held_.rest = phase_.density;
  }
  if (!corrected) {
    const bool lifted = plan_.enclosed && neighbours_.size() == 1 && !keys_.energy &&
                        fills_periodic_domain(scene_, static_cast<double>(plan_.count), plan_.spacing);
    q.void_pressure = lifted ? -pressure_lift(phase_.density, speed, q.smoothing_length, keys_.viscosity) : 0.0;
  }
  keeps_inside_ = (corrected || plan_.free_surface) && held_.any();
  if (plan_.free_surface || plan_.eddies) held_shapes_ = held_shapes(scene_, layout_, number_, *particles_);
  if (plan_.free_surface) moving_boxes_ = moving_boxes(w, number_, *particles_);
  if (corrected) relief_ = relief();
  if (plan_.eddies) {
    bind_eddies();
    w.largest_of_ranks.push_back(&largest_viscosity_);
  }
  if (keys_.energy_budget) open_books();
  if (plan_.wind.held && !(drive_ && drive_->holds_force())) hold_as_it_is(hold_, *particles_, layout_.bounds);
}

void FluidPhase::bind_entries() {
  for (const auto& e : layout_.entries) {
    if (!e.has(number_) || !e.continues_fluid) continue;
    const std::size_t other = e.partner(number_);
    const bool solid = e.extends;
    if ((keys_.energy || derives_gradient()) && !solid) w_->need(other, Record::motion);
    FluidNeighbour n{&w_->list(e.direction(number_)),
                     &w_->records(other, solid ? Record::extended : Record::motion),
                     e.kernel,
                     e.radius,
                     viscosity_of_sums(scene_, layout_, e),
                     solid || other == number_,
                     w_->compact(other)};
    if (has_interface(scene_, layout_, e)) bind_interface(e, n);
    if (keys_.scheme == FluidScheme::plain && !solid)
      n.pressure_share = 2.0 * phase_.density / (phase_.density + scene_.phases[other].density);
    // The phase's own entry comes first: its viscosity is the phase's.
    if (other == number_) neighbours_.insert(neighbours_.begin(), n);
    else neighbours_.push_back(n);
    if (!keys_.energy) continue;
    if (solid) solids_.push_back({n, &w_->records(other, Record::carried)});
    else fluids_.push_back(n);
  }
  for (const auto& e : layout_.entries)
    if (e.extends && e.fluid == number_ && !layout_.phases[e.other].moves() && !layout_.phases[e.other].travels())
      close_sides(held_, w_->particles(e.other), layout_.bounds, layout_.phases[e.other].spacing);
}

/// The entry with another fluid; the particles of both need the motion records for their distances to the interface.
void FluidPhase::bind_interface(const PlanEntry& e, FluidNeighbour& n) {
  const std::size_t other = e.partner(number_);
  for (const std::size_t k : {number_, other}) {
    w_->need(k, Record::motion);
    w_->need(k, Record::eddies);
  }
  n.joined = scene_.phases[other].density;
  n.beyond = viscosity_of(scene_, layout_, other);
  n.distances = &w_->eddies(other);
  n.nearest = InterfaceDistance::nearest * std::min(plan_.spacing, layout_.phases[other].spacing);
  parameters_.distances = &w_->eddies(number_);
  parameters_.planes = &planes_;
  std::array<double, 3> down{};
  if (const double g = norm(scene_.domain.gravity); g > 0.0)
    for (std::size_t d = 0; d < 3; ++d) down[d] = scene_.domain.gravity[d] / g;
  const auto join = [&](const PlanEntry& entry, std::size_t k, double own) {
    const PairList* list = &w_->list(entry.direction(number_));
    const RecordArray* records = &w_->records(k, Record::motion);
    sides_of_interface_.push_back({list, records, entry.kernel, entry.radius, {{}, own}});
    interface_planes_.push_back({list, records, entry.kernel, entry.radius, {{}, 2.0 * own - 1.0, e.radius, down}});
    distances_of_.push_back(&w_->eddies(k));
  };
  if (sides_of_interface_.empty())
    for (const auto& own : layout_.entries)
      if (own.a == number_ && own.b == number_) {
        join(own, number_, 1.0);
        interface_distance_ = {{own.kernel, own.radius, plan_.spacing},
                               {e.kernel, e.radius, layout_.phases[other].spacing},
                               layout_.dimensions};
      }
  join(e, other, 0.0);
}

/// The fluid is whole until a void is found.
void FluidPhase::look_for_voids() {
  parameters_.ends = false;
  parameters_.loose = &loose_;
  for (const FlowEnd& end : plan_.flow_ends) voids_.leave_out(end);
  for (const auto& e : layout_.entries) {
    if (!e.has(number_) || !e.continues_fluid) continue;
    const std::size_t other = e.partner(number_);
    const VoidFinder::Seen seen{&w_->list(e.direction(number_)), &w_->particles(other), &w_->neighbours.grid(other),
                                VoidFinder::ball * std::max(plan_.spacing, layout_.phases[other].spacing)};
    seen_.insert(other == number_ ? seen_.begin() : seen_.end(), seen);
  }
  voids_.look_at(seen_.size());
}

/// Its entries again with the friction of each, and the ground under it.
void FluidPhase::bind_eddies() {
  eddies_.model = keys_.turbulence;
  eddies_.density = phase_.density;
  eddies_.viscosity = neighbours_.front().viscosity / phase_.density;
  eddies_.spacing = plan_.spacing;
  eddies_.length = keys_.smagorinsky * plan_.spacing;
  Sides sides;
  bool particles = false;
  for (const auto& n : neighbours_) {
    EddyNeighbour e;
    e.pair = n;
    for (std::size_t other = 0; other < layout_.phases.size(); ++other)
      if (n.records == &w_->records(other, Record::motion) || n.records == &w_->records(other, Record::extended))
        bind_friction(e, other, sides, particles);
    eddy_neighbours_.push_back(e);
  }
  eddies_.rough_ground = keys_.turbulence == Turbulence::mixing_length && over_rough_walls(eddy_neighbours_);
  if (has_k_omega()) bind_k_omega();
  if ((keys_.turbulence == Turbulence::mixing_length || has_k_omega()) && ground_phases_.empty())
    throw SceneError(scene_.file + ": phases." + plan_.name +
                     ".turbulence: a mixing length needs ground, and this fluid touches no wall with friction and no "
                     "grains; expected such an entry in [interactions], or \"smagorinsky\"");
  double cell = plan_.spacing;
  for (const auto& phase : ground_phases_) cell = std::max(cell, phase.spacing);
  ground_ = std::make_unique<GroundDistance>(layout_.bounds, sides, cell, particles);
  w_->when_sorted.emplace_back([this] { ground_->refresh(ground_phases_); });
}

/// How this fluid rubs on another phase, and whether that is ground.
void FluidPhase::bind_friction(EddyNeighbour& e, std::size_t other, Sides& sides, bool& particles) {
  const PlanPhase& o = layout_.phases[other];
  e.friction = o.surface.friction;
  if (e.friction == Friction::fluid) {
    if (o.eddies) e.eddies = &w_->eddies(other);
    e.root = std::sqrt(e.pair.viscosity);
  }
  if (!o.moves()) {
    if (o.surface.speed > 0.0 || o.travels()) e.wall = &w_->particles(other);
    e.stress = o.surface.stress;
    e.roughness = o.surface.roughness;
    if (e.friction == Friction::rough && drags_by_law(scene_, phase_)) e.given = &w_->ground_stress[number_];
  }
  if (e.friction == Friction::grains) {
    // A form drag is the whole friction of the grains. The logarithmic law of rough ground beside it would take the
    // same momentum twice.
    const bool drag = std::any_of(layout_.entries.begin(), layout_.entries.end(), [&](const PlanEntry& entry) {
      return entry.given.drag > 0 && entry.has(number_) && entry.has(other);
    });
    e.roughness = eddies_.roughness = drag ? 0.0 : o.surface.roughness;
    eddies_.grain_reach = std::max(eddies_.grain_reach, e.pair.radius);
  }
  if (e.friction != Friction::rough && e.friction != Friction::smooth && e.friction != Friction::grains) return;
  ground_phases_.push_back({&w_->particles(other), o.spacing, o.moves() || o.travels()});
  if (o.moves()) {
    particles = true;
    return;
  }
  close_sides(sides, w_->particles(other), layout_.bounds, o.spacing);
  for (std::size_t i = 0; i < w_->particles(other).size() && !particles; ++i)
    particles = !behind_a_side(w_->particles(other), i, layout_.bounds, o.spacing);
}

}  // namespace barchan
