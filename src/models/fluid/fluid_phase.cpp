#include "models/fluid/fluid_phase.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/errors.hpp"
#include "engine/exchange.hpp"
#include "engine/phase_sums.hpp"
#include "engine/reproducible_sum.hpp"
#include "kernels/kernel.hpp"
#include "models/fluid/energy.hpp"
#include "models/fluid/velocity_gradient.hpp"
#include "models/walls/walls.hpp"
#include "scene/couplings.hpp"

namespace barchan {

FluidPhase::FluidPhase(const Scene& scene, const Layout& layout, std::size_t number)
    : scene_(scene),
      layout_(layout),
      phase_(scene.phases[number]),
      keys_(phase_.fluid()),
      plan_(layout.phases[number]),
      number_(number),
      pressure_(pressure_law(scene, layout, number)),
      forces_(scene, phase_.name),
      viscous_limit_{"viscous " + phase_.name, 0.0, ""} {
  if (Drive::exists(scene, phase_)) drive_.emplace(scene, phase_);
}

// ---- the schedule
// ---------------------------------------------------------------------------------------------------

void FluidPhase::schedule(Schedule& s) {
  using enum Field;
  const auto own = [this](const FieldSet& reads, const FieldSet& writes) -> Touches {
    return {{plan_.name, reads, writes}};
  };
  // With what goes on where the fluid ends: walls that move, places of solids and other fluids about a void.
  const auto beside = [this](Touches touches, const FieldSet& read_there, const RecordSet& ghosts = {}) {
    touches.front().records.ghosts = ghosts;
    for (const auto& e : layout_.entries)
      if (e.has(number_) && e.partner(number_) != number_)
        touches.push_back({layout_.phases[e.partner(number_)].name, read_there, {}, {{}, ghosts, {}}});
    return touches;
  };
  const RecordSet summed = scene_.precision == Precision::mixed
                               ? RecordSet{Record::compact, Record::eddies}
                               : RecordSet{Record::motion, Record::extended, Record::eddies};
  s.add({stage::kick_and_drift, plan_.name, {plan_.all_fields()}, [this] { kick_and_drift(); }});
  if (plan_.eddies) {
    Touches touches = beside(own({position, velocity, eddy_viscosity}, {ground_distance}), {velocity});
    touches.front().records.writes = {Record::eddies, Record::motion, Record::compact};
    if (has_k_omega()) {
      const FieldSet two{turbulent_kinetic_energy, specific_dissipation_rate};
      touches.front().reads = touches.front().reads | two;
      touches.front().writes = touches.front().writes | two | FieldSet{eddy_viscosity};
      touches.front().records.writes = touches.front().records.writes | RecordSet{Record::turbulence};
    }
    s.add({stage::eddies, plan_.name, touches, [this] { find_eddies(); }});
  }
  const bool meets = std::any_of(layout_.entries.begin(), layout_.entries.end(), [&](const PlanEntry& e) {
    return e.has(number_) && has_interface(scene_, layout_, e);
  });
  if (meets) {
    Touches touches = beside(own({position}, {}), {position}, {Record::motion});
    touches.front().records.writes = {Record::eddies};
    s.add({stage::eddies, plan_.name, touches, [this] { find_interface(); }});
    Touches fitted = beside(own({position}, {}), {position}, {Record::motion, Record::eddies});
    fitted.front().records.writes = {Record::eddies, Record::motion, Record::compact};
    s.add({stage::extend_walls, plan_.name, fitted, [this] { fit_interface(); }});
  }
  FieldSet reads{position, velocity, density, pressure, energy}, writes{acceleration, density_rate, shift_velocity};
  if (keys_.scheme == FluidScheme::consistent) writes = writes | FieldSet{anisotropy};
  if (plan_.eddies) {
    reads = reads | FieldSet{ground_distance};
    writes = writes | FieldSet{eddy_viscosity};
    if (has_k_omega()) writes = writes | FieldSet{shear_rate};
  }
  if (plan_.free_surface) writes = writes | FieldSet{wholeness, surface_normal};
  if (std::find(plan_.fields.begin(), plan_.fields.end(), near_void) != plan_.fields.end())
    writes = writes | FieldSet{near_void};
  s.add({stage::fluid, plan_.name, beside(own(reads, writes), {position}, summed), [this] { rate(); }});
  if (has_k_omega()) {
    const FieldSet two{turbulent_kinetic_energy, specific_dissipation_rate};
    const Touches touches = beside(
        own(FieldSet{ground_distance, shear_rate, anisotropy, shift_velocity} | two, FieldSet{eddy_viscosity} | two),
        {}, {Record::extended, Record::turbulence});
    s.add({stage::fluid, plan_.name, touches, [this] { step_k_omega(); }});
  }
  if (plan_.free_surface)
    s.add({stage::surface, plan_.name, own({position, wholeness}, {surface_normal}), [this] { find_surface(); }});
  if (keys_.energy) {
    const Touches worked = beside(own({position, velocity, density, pressure, acceleration}, {energy_rate}), {},
                                  {Record::motion, Record::extended, Record::carried});
    s.add({stage::energy, plan_.name, worked, [this] {
             fluid_energy(*particles_, w_->records(number_, Record::motion), fluids_, solids_, w_->kick_time);
           }});
    s.add({stage::kick, plan_.name, own({energy_rate}, {Field::energy}),
           [this] { advance_energy(*particles_, w_->kick_time); }});
  }
  if (plan_.wind.held) s.add({stage::hold, plan_.name, own({velocity}, {acceleration}), [this] { hold(); }});
  if (keys_.energy_budget) schedule_books(s);
  if (derives_gradient())
    s.add({stage::energy, plan_.name, beside(own({}, {}), {}, {Record::motion, Record::extended}),
           [] {}});  // derive() reads images
}

void FluidPhase::derive() {
  if (derives_gradient())
    derive_velocity_gradient(*particles_, w_->records(number_, Record::motion), neighbours_, derives_shear_rate());
}

/// After all other forces: what keeps the mean velocity, or what is missing of the force on the ground.
void FluidPhase::hold() {
  if (drive_ && drive_->holds_force()) {
    hold_.acceleration[0] =
        drive_->missing(w_->state.time, particles_->mass() * static_cast<double>(count_of(*particles_)));
    accelerate(*particles_, 0, hold_.acceleration[0]);
  } else {
    hold_bulk_velocity(*particles_, hold_, w_->state.dt);
  }
  if (drive_) drive_->remember(w_->state, hold_.acceleration[0]);
}

void FluidPhase::kick_and_drift() {
  const double dt = w_->state.dt;
  if (books_) books_->begin_step(dt);
  barchan::kick_and_drift(*particles_, 0.5 * dt, dt, &pressure_);
  if (keys_.energy) advance_energy(*particles_, 0.5 * dt);
  if (books_) books_->drifted();
  if (plan_.free_surface) release_surface(*particles_, surface_wholeness(keys_.scheme), pressure_);
  if (books_) books_->released();
  if (keeps_inside_) hold_inside(*particles_, held_);
  if (held_shapes_.any()) hold_outside(*particles_, held_shapes_, layout_.bounds);
  for (const MovingBox& box : moving_boxes_) hold_outside(*particles_, box, layout_.bounds, w_->state.time + 0.5 * dt);
  if (relief_.exists()) hold_above(*particles_, relief_, held_.margin);
  if (books_) books_->held();
}

void FluidPhase::step_k_omega() {
  k_omega_.step = w_->state.dt;
  const auto& grains = w_->grains_in_eddies[number_];
  k_omega_.grains = grains ? std::as_const(*particles_).own(*grains) : nullptr;
  k_omega_step(*particles_, w_->records(number_, Record::turbulence), k_omega_neighbours_, k_omega_);
}

void FluidPhase::find_eddies() {
  EddyRecords& records = w_->eddies_to_write(number_);
  largest_viscosity_ = pack_eddies(*particles_, records, *ground_, eddies_);
  if (has_k_omega()) {
    RecordArray& two = w_->to_write(number_, Record::turbulence);
    const double diffusivity = pack_k_omega(*particles_, two, k_omega_);
    if (w_->state.steps == 0) largest_viscosity_ = pack_eddies(*particles_, records, *ground_, eddies_);
    largest_viscosity_ = std::max(largest_viscosity_, diffusivity);
  }
  if (layout_.dimensions == 2) {
    if (CompactRecords* compact = w_->compact_to_write(number_)) records.give_roots(*compact, particles_->size());
    else records.give_roots(w_->to_write(number_, Record::motion), particles_->size());
  }
  for (auto& e : eddy_neighbours_) {
    if (!e.wall) continue;
    const bool here = e.wall->size() > 0;
    for (int d = 0; here && d < layout_.dimensions; ++d)
      e.wall_velocity[static_cast<std::size_t>(d)] = e.wall->column(Field::velocity, d)[0];
    e.wall_velocity = Exchange().of_first(here, e.wall_velocity);
  }
}

/// How far its particles are from the interface with another fluid, before the rates of both.
void FluidPhase::find_interface() {
  EddyRecords& records = w_->eddies_to_write(number_);
  const std::size_t n = particles_->size();
  barchan::find_interface(n, layout_.dimensions, w_->records(number_, Record::motion), sides_of_interface_,
                          interface_distance_, records.touch);
}

/// The planes about its particles, when the distances of all fluids are there.
void FluidPhase::fit_interface() {
  EddyRecords& records = w_->eddies_to_write(number_);
  const std::size_t n = particles_->size();
  for (std::size_t k = 0; k < interface_planes_.size(); ++k)
    interface_planes_[k].beside = distances_of_[k]->touch.data();
  barchan::fit_interface(n, layout_.dimensions, w_->records(number_, Record::motion), interface_planes_, records.touch,
                         records.root, planes_);
  if (layout_.dimensions != 2) return;
  if (CompactRecords* compact = w_->compact_to_write(number_)) records.give_roots(*compact, n);
  else records.give_roots(w_->to_write(number_, Record::motion), n);
}

void FluidPhase::rate() {
  auto& q = parameters_;
  // c^2 dt makes the one-pass step the leapfrog that its velocities, half a step old, would miss; the rest is
  // delta-SPH's own diffusion.
  const double centring = q.sound_speed * q.sound_speed * w_->state.dt;
  const double delta = keys_.density_diffusion * q.smoothing_length * q.sound_speed;
  q.diffusivity = StepConstants::theta * centring + delta;
  q.source_diffusivity = (StepConstants::theta - 0.5) * centring + delta;
  if (books_) {
    books_->find_left();
    books_->parts().centring = w_->state.dt;
  }
  const auto rates = [&](const auto& own) {
    if (books_) fluid_rate_parts(*particles_, own, neighbours_, q, keys_.scheme, books_->parts());
    if (eddy_neighbours_.empty()) fluid_rates(*particles_, own, neighbours_, q, keys_.scheme);
    else eddy_rates(*particles_, own, w_->eddies(number_), eddy_neighbours_, q, eddies_);
  };
  if (q.loose && loose_.place.size() < particles_->size()) loose_.place.resize(particles_->size());
  if (w_->compact(number_)) rates(*w_->compact(number_));
  else rates(w_->records(number_, Record::motion));
  if (q.loose) q.ends = voids_.find(*particles_, seen_, neighbours_.front().radius, plan_.spacing, loose_);
  if (plan_.enclosed) keep_mean_density(*particles_);
  forces_.add(*particles_, w_->state.time, false);
  forces_.relax(*particles_, w_->state.time, w_->state.dt);
}

void FluidPhase::find_surface() {
  const FluidNeighbour& own = neighbours_.front();
  surface_->find(*particles_, w_->neighbours.grid(number_), *own.list, own.radius, surface_wholeness(keys_.scheme),
                 calmed(scene_, layout_, number_) ? plan_.spacing : 0.0);
}

// ---- limits, history, state
// -----------------------------------------------------------------------------------------

void FluidPhase::limits(std::vector<StepLimit>& limits) const {
  if (plan_.count == 0) return;
  const double h = plan_.smoothing_length;
  limits.push_back({"acoustic " + plan_.name,
                    scene_.time.safety * (StepConstants::acoustic * h / (plan_.sound_speed + layout_.largest_speed)),
                    "0.4 h/(c + u): sound crosses a spacing"});
  const double nu =
      keys_.viscosity + keys_.artificial_viscosity * h * plan_.sound_speed / (2.0 * (layout_.dimensions + 2));
  if (nu > 0)
    limits.push_back({"viscous " + plan_.name, scene_.time.safety * (StepConstants::viscous * h * h / nu),
                      "0.125 h2/nu: momentum diffuses"});
}

const StepLimit* FluidPhase::moving_limit() {
  if (!(largest_viscosity_ > 0)) return nullptr;
  const double h = parameters_.smoothing_length;
  viscous_limit_.value = scene_.time.safety * StepConstants::viscous * h * h / largest_viscosity_;
  return &viscous_limit_;
}

void FluidPhase::history(HistoryRow& row) const {
  const std::size_t n = particles_->size();
  const bool all = plan_.flow_ends.empty();
  const auto counts = [&](std::size_t i) { return all || layout_.in_domain(*particles_, i); };
  const double count = all ? static_cast<double>(count_of(*particles_))
                           : reproducible_sum(n, [&](std::size_t i) { return counts(i) ? 1.0 : 0.0; });
  const double* rho = std::as_const(*particles_).column(Field::density);
  const double* pressure = std::as_const(*particles_).column(Field::pressure);
  double worst = 0.0;
  const double squares = reproducible_sum(n, [&](std::size_t i) {
    if (!counts(i)) return 0.0;
    const double e = std::abs(rho[i] / phase_.density - 1.0);
    worst = std::max(worst, e);
    return e * e;
  });
  row.raise(HistoryRow::largest_density_error, Exchange().largest(worst));
  row.add(
      plan_.name + "_mean_pressure [Pa]",
      count > 0.0 ? reproducible_sum(n, [&](std::size_t i) { return counts(i) ? pressure[i] : 0.0; }) / count : 0.0);
  row.add(plan_.name + "_density_error_rms", count > 0.0 ? std::sqrt(squares / count) : 0.0);
  if (keys_.energy) {
    const double* e = std::as_const(*particles_).column(Field::energy);
    row.add(plan_.name + "_internal_energy [J]",
            particles_->mass() * reproducible_sum(n, [&](std::size_t i) { return e[i]; }));
  }
  if (books_) books_->history(row);
  if (plan_.wind.held) row.add(plan_.name + "_held_acceleration_x [m/s2]", hold_.acceleration[0]);
  if (drive_)
    drive_->history(row, *particles_, forces_.sum(*particles_, w_->state.time, w_->state.dt)[0], hold_.acceleration[0]);
}

void FluidPhase::begin_row() {
  if (drive_) drive_->begin_row();
}

void FluidPhase::report(Warnings& warnings) const {
  if (drive_) drive_->report(particles_->mass() * static_cast<double>(count_of(*particles_)), warnings);
}

void FluidPhase::archive(Archive& a) {
  a.number(plan_.name + ": largest viscosity", largest_viscosity_);
  a.number(plan_.name + ": bulk hold", hold_);
  if (books_) books_->archive(a);
  if (parameters_.loose) {
    voids_.archive(a);
    parameters_.ends = voids_.any();
  }
  if (drive_) drive_->archive(a);
  if (ground_) ground_->archive(a);
}

}  // namespace barchan
