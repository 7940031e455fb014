#include "simulation/simulation.hpp"

#include <algorithm>
#include <cmath>
#include <ctime>

#include "base/errors.hpp"
#include "kernels/kernel.hpp"
#include "output/numbers.hpp"
#include "plan/limits.hpp"
#include "simulation/wiring.hpp"

namespace barchan {

namespace {
enum Pass : std::size_t {
  pass_kick_and_drift,
  pass_strain,
  pass_walls,
  pass_neighbours,
  pass_pack,
  pass_eddies,
  pass_extend_walls,
  pass_extend_solids,
  pass_fluid,
  pass_surface,
  pass_energy,
  pass_repel,
  pass_elastic,
  pass_contacts,
  pass_reaction,
  pass_drag,
  pass_hold,
  pass_kick,
  pass_watch,
  pass_count
};
constexpr std::array<const char*, pass_count> pass_names{"kick and drift",
                                                         "elastic strain",
                                                         "wall motion",
                                                         "neighbours",
                                                         "pack",
                                                         "eddies",
                                                         "extension into walls",
                                                         "extension into solids",
                                                         "fluid rates",
                                                         "free surface",
                                                         "fluid energy",
                                                         "wall repulsion",
                                                         "elastic forces",
                                                         "contacts",
                                                         "reaction on solids",
                                                         "drag",
                                                         "bulk speed",
                                                         "kick",
                                                         "watch"};

double thread_seconds() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

}  // namespace

template <class F>
void Simulation::timed(std::size_t pass, F&& verb) {
  const auto start = std::chrono::steady_clock::now();
  const double processor = thread_seconds();
  verb();
  ++executed_[pass];
  processor_seconds_[pass] += thread_seconds() - processor;
  seconds_[pass].second += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

Simulation::Simulation(const Scene& scene, const Plan& plan, const std::vector<ParticleBlock>& blocks)
    : scene_(scene),
      plan_(plan),
      neighbours_(plan.bounds, plan.directions, plan.phases.size(), plan.skin, plan.spacing,
                  scene.precision == Precision::mixed ? simd::native_width<float> : simd::native_width<double>) {
  for (const char* name : pass_names) seconds_.emplace_back(name, 0.0);
  processor_seconds_.assign(pass_count, 0.0);
  executed_.assign(pass_count, 0);
  neighbours_.adapt_skin();
  make_state(blocks);
  wire();
  for (const auto& l : plan_.limits) limit_counts_[l.name] = 0;
  for (const auto& f : fluids_)
    if (!f.eddy_neighbours.empty()) limit_counts_[f.viscous_limit] = 0;
  for (const char* name : {"force", "output", "fixed"}) limit_counts_[name] = 0;
  dt_ = plan_.step();
  rates(true);
  rates(true);  // the weights of the consistent Laplacian are those of the pass before
  watch_ = std::make_unique<Watch>(Watch::Sight{scene_, plan_, particles_, neighbours_, motion_, stress_});
  kick(0.0);  // moves nothing; finds the largest acceleration, which limits the first step
}

Simulation::~Simulation() = default;

void Simulation::step(double largest) {
  choose_step(largest);
  timed(pass_kick_and_drift, [&] { kick_and_drift(); });
  time_ += dt_;
  ++steps_;
  rates(false);
  timed(pass_kick, [&] { kick(0.5 * dt_); });
  if (!std::isfinite(largest_acceleration_)) watch_->explain(moment());
  if (watch_->due(steps_) || largest_acceleration_ * dt_ > watch_->signal_speed())
    timed(pass_watch, [&] { watch_->look(moment()); });
}

/// Everything that is evaluated at the new positions; passes that have nothing to do are left out.
void Simulation::rates(bool first) {
  const auto any_kind = [&](PhaseKind kind) {
    return std::any_of(particles_.begin(), particles_.end(), [&](const auto& p) { return p.kind() == kind; });
  };
  const auto any_contact = [&](bool repulsion) {
    return std::any_of(contacts_.begin(), contacts_.end(),
                       [&](const Contact& c) { return c.is_repulsion == repulsion; });
  };
  const auto is_wall = [&](const Extension& x) { return particles_[x.phase].kind() == PhaseKind::wall; };
  const bool walls = std::any_of(extensions_.begin(), extensions_.end(), is_wall);
  const bool solids = !std::all_of(extensions_.begin(), extensions_.end(), is_wall);
  const bool eddies =
      std::any_of(fluids_.begin(), fluids_.end(), [](const Fluid& f) { return !f.eddy_neighbours.empty(); });
  const bool surface = std::any_of(fluids_.begin(), fluids_.end(), [](const Fluid& f) { return f.surface != nullptr; });
  const bool held = std::any_of(fluids_.begin(), fluids_.end(), [](const Fluid& f) { return f.hold.any(); });
  const bool energy = std::any_of(fluids_.begin(), fluids_.end(),
                                  [&](const Fluid& f) { return particles_[f.phase].has(Field::energy); });
  if (!first && !bodies_.empty()) timed(pass_strain, [&] { strain_bodies(); });
  if (any_kind(PhaseKind::wall)) timed(pass_walls, [&] { move_walls(); });
  timed(pass_neighbours, [&] { find_neighbours(first); });
  timed(pass_pack, [&] { pack(); });
  if (eddies) timed(pass_eddies, [&] { find_eddies(); });
  if (walls) timed(pass_extend_walls, [&] { extend_into_walls(); });
  if (solids) timed(pass_extend_solids, [&] { extend_into_grains(); });
  if (!fluids_.empty()) timed(pass_fluid, [&] { rate_fluids(); });
  if (surface) timed(pass_surface, [&] { find_free_surfaces(); });
  if (energy) timed(pass_energy, [&] { rate_energies(); });
  if (any_contact(true)) timed(pass_repel, [&] { repel_from_walls(); });
  if (!bodies_.empty()) timed(pass_elastic, [&] { stress_bodies(); });
  if (any_contact(false) || any_kind(PhaseKind::grains)) timed(pass_contacts, [&] { touch(); });
  if (solids) timed(pass_reaction, [&] { react(); });
  if (!drags_.empty()) timed(pass_drag, [&] { drag_grains(); });
  if (held) timed(pass_hold, [&] { hold_bulk_speeds(); });
}

/// The step that stability allows (s). Throws BreakdownError when it collapsed.
double Simulation::stable_step() {
  double dt = 1e300;
  ruling_.clear();
  const auto limit = [&](const std::string& name, double value) {
    if (value < dt) {
      dt = value;
      ruling_ = name;
    }
  };
  if (plan_.fixed_step > 0) {
    limit("fixed", plan_.fixed_step);
    return dt;
  }
  for (const auto& l : plan_.limits) limit(l.name, l.value);
  for (const auto& f : fluids_)
    if (f.largest_viscosity > 0) {
      const double h = f.parameters.smoothing_length;
      limit(f.viscous_limit, scene_.time.safety * StepConstants::viscous * h * h / f.largest_viscosity);
    }
  double shortest = 1e300;
  for (const auto& p : plan_.phases)
    if (p.kind != PhaseKind::wall) shortest = std::min(shortest, p.smoothing_length);
  if (largest_acceleration_ > 0)
    limit("force", scene_.time.safety * StepConstants::force * std::sqrt(shortest / largest_acceleration_));
  if (dt < 1e-6 * plan_.step())
    throw BreakdownError("the time step collapsed to " + brief(dt) + " s (less than a millionth of " +
                         brief(plan_.step()) + " s), ruled by the limit \"" + ruling_ +
                         "\": " + watch_->most_accelerated(moment()) +
                         "; an enormous force acts: lower time.safety or the [[forcing]], raise the sound speed or the "
                         "contact-speed, or look for fills that overlap");
  return dt;
}

void Simulation::choose_step(double largest) {
  double dt = stable_step();
  // The last steps before an output share what is left, so that none is tiny.
  const double left = std::ceil(largest / dt * (1.0 - 1e-9));
  if (left * dt > largest) {
    const double share = largest / left;
    if (left <= 1.0) ruling_ = "output";
    dt = share;
  }
  dt_ = dt;
  ++limit_counts_[ruling_];
}

void Simulation::check_start() {
  try {
    if (!std::isfinite(largest_acceleration_)) watch_->explain(moment());
    check();
    const double dt = stable_step();
    if (largest_acceleration_ * dt > watch_->signal_speed())
      throw BreakdownError(watch_->most_accelerated(moment()) + ": in the first step of " + brief(dt) +
                           " s it gains more than the signal speed, " + brief(watch_->signal_speed()) +
                           " m/s: lower the [[forcing]] or the pressure of the fills, or raise the sound speed or the "
                           "contact-speed");
  } catch (const BreakdownError& e) {
    throw SceneError(scene_.file + ": the scene is wrong at its start: " + e.what());
  }
}

// ---- kick, drift, kick
// -----------------------------------------------------------------------------------------------

PressureLaw Simulation::pressure_law(std::size_t phase) const {
  const Phase& s = scene_.phases[phase];
  const double c = plan_.phases[phase].sound_speed;
  return {s.density, c, s.equation_of_state == EquationOfState::linear ? 1.0 : s.tait_exponent,
          s.background_pressure * s.density * c * c};
}

void Simulation::kick_and_drift() {
  for (std::size_t k = 0; k < particles_.size(); ++k) {
    auto& p = particles_[k];
    if (p.kind() == PhaseKind::wall) continue;
    if (p.kind() == PhaseKind::fluid) {
      const PressureLaw law = pressure_law(k);
      barchan::kick_and_drift(p, 0.5 * dt_, dt_, &law);
      if (p.has(Field::wholeness)) release_surface(p, surface_wholeness(scene_.phases[k].scheme), law);
    } else {
      // Bodies stop half-way: their strain is taken there (see strain_bodies).
      barchan::kick_and_drift(p, 0.5 * dt_, p.kind() == PhaseKind::elastic ? 0.5 * dt_ : dt_, nullptr);
    }
  }
  for (const auto& f : fluids_)
    if ((scene_.phases[f.phase].scheme == FluidScheme::consistent || f.surface) && f.held.any())
      hold_inside(particles_[f.phase], f.held);
  for (const auto& f : fluids_)
    if (f.relief.exists()) hold_above(particles_[f.phase], f.relief, f.held.margin);
}

void Simulation::strain_bodies() {
  for (auto& b : bodies_) pack_stress(particles_[b.phase], stress_[b.phase]);
  for (auto& b : bodies_) stress_[b.phase].fill_images(neighbours_.grid(b.phase), plan_.dimensions);
  for (auto& b : bodies_) {
    elastic_strain(particles_[b.phase], stress_[b.phase], b.neighbours, b.parameters, dt_);
    drift(particles_[b.phase], 0.5 * dt_);
  }
}

void Simulation::move_walls() {
  for (std::size_t k = 0; k < particles_.size(); ++k) {
    if (particles_[k].kind() != PhaseKind::wall) continue;
    for (int d = 0; d < plan_.dimensions; ++d) {
      const Formula& u = wall_velocity_[k][static_cast<std::size_t>(d)];
      if (u.is_constant() && steps_ > 0) continue;
      const double value = u({0, 0, 0}, time_);
      double* v = particles_[k].column(Field::velocity, d);
      std::fill(v, v + particles_[k].size(), value);
    }
  }
}

void Simulation::find_neighbours(bool force) {
  const auto find_ground = [this] {
    for (auto& f : fluids_)
      if (f.ground) f.ground->refresh(f.ground_phases);
  };
  if (!neighbours_.update(particles_, force, find_ground)) return;
  for (std::size_t k = 0; k < particles_.size(); ++k) {
    if (!neighbours_.has_grid(k)) continue;
    const std::size_t images = neighbours_.grid(k).images();
    if (motion_[k].stride() > 0) motion_[k].resize(particles_[k].size(), images);
    if (compact_[k]) compact_[k]->resize(particles_[k].size(), images);
    if (extended_[k].stride() > 0) extended_[k].resize(particles_[k].size(), images);
    if (stress_[k].stride() > 0) stress_[k].resize(particles_[k].size(), images);
    if (plan_.phases[k].eddies) eddies_[k].resize(particles_[k].size(), images);
  }
}

void Simulation::kick(double time) {
  double largest = 0.0;
  for (auto& p : particles_)
    if (p.kind() != PhaseKind::wall) largest = std::max(largest, barchan::kick(p, time));
  largest_acceleration_ = largest;
}

}  // namespace barchan
