// The verbs of a step that evaluate forces and rates.
#include <algorithm>
#include <cmath>

#include "models/air/energy.hpp"
#include "plan/limits.hpp"
#include "simulation/wiring.hpp"

namespace barchan {

namespace {

template <int Dim>
void pack_motion(const PhaseParticles& p, RecordArray& records, bool with_pressure, bool fixed_volume, double volume) {
  using R = MotionRecord<Dim>;
  const auto n = static_cast<std::int64_t>(p.size());
  std::array<const double*, Dim> x{}, v{};
  for (int d = 0; d < Dim; ++d) {
    x[static_cast<std::size_t>(d)] = p.column(Field::position, d);
    v[static_cast<std::size_t>(d)] = p.column(Field::velocity, d);
  }
  const double* pressure = with_pressure ? p.column(Field::pressure) : nullptr;
  const double* rho = with_pressure && !fixed_volume ? p.column(Field::density) : nullptr;
  const double mass = p.mass();
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < n; ++i) {
    const auto k = static_cast<std::size_t>(i);
    double* r = records[k];
    for (std::size_t d = 0; d < Dim; ++d) {
      r[R::position + d] = x[d][k];
      r[R::velocity + d] = v[d][k];
    }
    r[R::pressure] = pressure ? pressure[k] : 0.0;
    r[R::volume] = rho ? mass / rho[k] : volume;
  }
}

/// The same in mixed precision, with the images.
template <int Dim>
void pack_compact(const PhaseParticles& p, CompactRecords& records, const CellGrid& grid, bool fixed_volume,
                  double volume) {
  const auto n = static_cast<std::int64_t>(p.size());
  std::array<const double*, Dim> x{}, v{};
  for (int d = 0; d < Dim; ++d) {
    x[static_cast<std::size_t>(d)] = p.column(Field::position, d);
    v[static_cast<std::size_t>(d)] = p.column(Field::velocity, d);
  }
  const double* pressure = p.column(Field::pressure);
  const double* rho = fixed_volume ? nullptr : p.column(Field::density);
  const double mass = p.mass();
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < n; ++i) {
    const auto k = static_cast<std::size_t>(i);
    std::array<double, Dim> at, speed;
    for (std::size_t d = 0; d < Dim; ++d) {
      at[d] = x[d][k];
      speed[d] = v[d][k];
    }
    records.write<Dim>(k, at, speed, pressure[k], rho ? mass / rho[k] : volume);
  }
  records.fill_images<Dim>(grid, x);
}

/// Adds the forces of [[forcing]] on a phase to its accelerations; `numbers`: those without a formula too, which the
/// law of fluids has already.
template <class Forces>
void add_forces(PhaseParticles& p, std::size_t phase, const Forces& forces, double time, bool numbers) {
  for (const auto& force : forces) {
    if (force.phase != phase) continue;
    for (int d = 0; d < p.dimensions(); ++d) {
      const Formula& formula = force.acceleration[static_cast<std::size_t>(d)];
      if (formula.is_constant() && !numbers) continue;
      double* a = p.column(Field::acceleration, d);
      for (std::size_t k = 0; k < p.size(); ++k) {
        Vec3 x{};
        for (int e = 0; e < p.dimensions(); ++e) x[static_cast<std::size_t>(e)] = p.column(Field::position, e)[k];
        a[k] += formula.is_constant() ? formula.constant() : formula(x, time);
      }
    }
  }
}

/// A wall whose stress is given leaves the fluid's velocity along it alone.
bool given_friction(const Phase& wall) { return wall.roughness || wall.shear_stress; }

}  // namespace

void Simulation::pack() {
  const double volume = std::pow(plan_.spacing, plan_.dimensions);
  for (std::size_t k = 0; k < particles_.size(); ++k) {
    if (!neighbours_.has_grid(k)) continue;
    const auto& p = particles_[k];
    const bool fluid = p.kind() == PhaseKind::fluid;
    const auto fill = [&](RecordArray& records) {
      // The consistent operators weigh neighbours by the spacing's volume: what they sum is exact for any weights.
      const bool fixed = fluid && scene_.phases[k].scheme == FluidScheme::consistent;
      plan_.dimensions == 2 ? pack_motion<2>(p, records, fluid, fixed, volume)
                            : pack_motion<3>(p, records, fluid, fixed, volume);
      records.fill_images(neighbours_.grid(k), plan_.dimensions);
    };
    if (fluid && compact_[k]) {
      const bool fixed = scene_.phases[k].scheme == FluidScheme::consistent;
      plan_.dimensions == 2 ? pack_compact<2>(p, *compact_[k], neighbours_.grid(k), fixed, volume)
                            : pack_compact<3>(p, *compact_[k], neighbours_.grid(k), fixed, volume);
    }
    if (motion_[k].stride() > 0) fill(motion_[k]);
    if (extended_[k].stride() > 0) fill(extended_[k]);
    if (stress_[k].stride() > 0) {
      pack_stress(p, stress_[k]);
      stress_[k].fill_images(neighbours_.grid(k), plan_.dimensions);
    }
  }
  // Accelerations are gathered from several laws; extension into a solid still needs the last ones.
}

void Simulation::find_eddies() {
  for (auto& f : fluids_) {
    if (f.eddy_neighbours.empty()) continue;
    auto& p = particles_[f.phase];
    f.largest_viscosity = pack_eddies(p, eddies_[f.phase], *f.ground, f.eddies);
    auto& eddies = eddies_[f.phase];
    eddies.fill_images(p.size(), neighbours_.grid(f.phase));
    const std::size_t count = p.size() + neighbours_.grid(f.phase).images();
    if (plan_.dimensions == 2 && compact_[f.phase]) eddies.give_roots(*compact_[f.phase], count);
    else if (plan_.dimensions == 2) eddies.give_roots(motion_[f.phase], count);
    for (auto& e : f.eddy_neighbours)
      if (e.wall && e.wall->size() > 0)
        for (int d = 0; d < plan_.dimensions; ++d)
          e.wall_velocity[static_cast<std::size_t>(d)] = e.wall->column(Field::velocity, d)[0];
  }
}

void Simulation::extend_into_walls() {
  for (auto& x : extensions_) {
    if (particles_[x.phase].kind() != PhaseKind::wall) continue;
    extend_into_solid(particles_[x.phase], extended_[x.phase], x.sources, scene_.domain.gravity,
                      given_friction(scene_.phases[x.phase]) ? Slip::free_slip : scene_.phases[x.phase].slip, x.bend);
    extended_[x.phase].fill_images(neighbours_.grid(x.phase), plan_.dimensions);
  }
}

void Simulation::extend_into_grains() {
  for (auto& x : extensions_) {
    if (particles_[x.phase].kind() == PhaseKind::wall) continue;
    extend_into_solid(particles_[x.phase], extended_[x.phase], x.sources, scene_.domain.gravity, Slip::no_slip);
    extended_[x.phase].fill_images(neighbours_.grid(x.phase), plan_.dimensions);
  }
}

void Simulation::rate_fluids() {
  for (auto& x : extensions_) {
    if (!compact_[x.phase]) continue;
    const std::size_t count = particles_[x.phase].size() + neighbours_.grid(x.phase).images();
    plan_.dimensions == 2 ? compact_[x.phase]->copy<2>(extended_[x.phase], count)
                          : compact_[x.phase]->copy<3>(extended_[x.phase], count);
  }
  for (auto& f : fluids_) {
    auto& q = f.parameters;
    const Phase& s = scene_.phases[f.phase];
    // c^2 dt makes the one-pass step the leapfrog that its velocities, half a step old, would miss; the rest is
    // delta-SPH's own diffusion.
    const double centring = q.sound_speed * q.sound_speed * dt_;
    const double delta = s.density_diffusion * q.smoothing_length * q.sound_speed;
    q.diffusivity = StepConstants::theta * centring + delta;
    q.source_diffusivity = (StepConstants::theta - 0.5) * centring + delta;
    q.acceleration = {0, 0, 0};
    for (const auto& force : forcings_) {
      if (force.phase != f.phase) continue;
      for (std::size_t d = 0; d < 3; ++d)
        if (force.acceleration[d].is_constant()) q.acceleration[d] += force.acceleration[d].constant();
    }
    auto& p = particles_[f.phase];
    const auto rate = [&](const auto& own) {
      if (f.eddy_neighbours.empty()) fluid_rates(p, own, f.neighbours, q, s.scheme);
      else eddy_rates(p, own, eddies_[f.phase], f.eddy_neighbours, q, f.eddies);
    };
    if (compact_[f.phase]) rate(*compact_[f.phase]);
    else rate(motion_[f.phase]);
    if (plan_.phases[f.phase].enclosed) keep_mean_density(p, f.mean);
    add_forces(p, f.phase, forcings_, time_, false);
  }
}

void Simulation::find_free_surfaces() {
  for (auto& f : fluids_)
    if (f.surface)
      f.surface->find(particles_[f.phase], neighbours_.grid(f.phase), *f.neighbours.front().list,
                      f.neighbours.front().radius, surface_wholeness(scene_.phases[f.phase].scheme));
}

void Simulation::rate_energies() {
  for (const auto& f : fluids_)
    if (particles_[f.phase].has(Field::energy)) fluid_energy(particles_[f.phase], motion_[f.phase], f.neighbours);
}

void Simulation::repel_from_walls() {
  for (const auto& c : contacts_)
    if (c.is_repulsion) contact_forces(particles_[c.a], motion_[c.a], *c.list, motion_[c.b], c.kernel, c.radius, c.law);
}

void Simulation::stress_bodies() {
  for (auto& b : bodies_) {
    elastic_forces(particles_[b.phase], stress_[b.phase], b.neighbours, b.parameters);
    add_forces(particles_[b.phase], b.phase, forcings_, time_, true);
  }
}

void Simulation::touch() {
  for (std::size_t k = 0; k < particles_.size(); ++k) {
    auto& p = particles_[k];
    if (p.kind() != PhaseKind::grains) continue;
    for (int d = 0; d < plan_.dimensions; ++d)
      std::fill_n(p.column(Field::acceleration, d), p.size(), scene_.domain.gravity[static_cast<std::size_t>(d)]);
    add_forces(p, k, forcings_, time_, true);
  }
  for (const auto& c : contacts_)
    if (!c.is_repulsion)
      contact_forces(particles_[c.a], motion_[c.a], *c.list, motion_[c.b], c.kernel, c.radius, c.law);
}

void Simulation::drag_grains() {
  for (const auto& d : drags_) drag_forces(particles_[d.a], motion_[d.a], *d.list, motion_[d.b], d.entry, d.a_is_fluid);
}

void Simulation::react() {
  for (auto& x : extensions_)
    for (const auto& fluid : x.felt)
      fluid_reaction(particles_[x.phase], extended_[x.phase], fluid, scene_.phases[x.phase].kind == PhaseKind::grains);
  for (auto& x : extensions_)
    for (std::size_t c = 0; c < x.felt.size(); ++c)
      if (plan_.phases[x.felt_fluids[c]].eddies && scene_.phases[x.phase].kind == PhaseKind::grains)
        eddy_reaction(particles_[x.phase], extended_[x.phase], x.felt[c], eddies_[x.felt_fluids[c]],
                      x.felt[c].viscosity);
}

void Simulation::hold_bulk_speeds() {
  for (auto& f : fluids_)
    if (f.hold.any()) hold_bulk_velocity(particles_[f.phase], f.hold, dt_, f.mean);
}

}  // namespace barchan
