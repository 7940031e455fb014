#include "models/grains/spheres.hpp"

#include <omp.h>

#include <algorithm>
#include <cmath>
#include <span>

#include "engine/exchange.hpp"
#include "models/grains/pair_order.hpp"
#include "models/grains/sphere_forces.hpp"
#include "models/grains/sphere_room.hpp"
#include "scene/side_names.hpp"

namespace barchan {

Spheres::Spheres(const Scene& scene, const Layout& layout) : scene_(scene), layout_(layout), laws_(scene, layout) {}

void Spheres::begin(State& state, const std::vector<ParticleBlock>& blocks) {
  for (std::size_t k = 0; k < layout_.phases.size(); ++k) {
    const PlanPhase& plan = layout_.phases[k];
    if (plan.own_steps()) {
      parts_.push_back({k, moving_, plan.count, 0.5 * plan.diameter});
      moving_ += plan.count;
      PhaseParticles& p = state.phases[k];
      p.set_mean_radius(0.5 * plan.diameter);
      rest_.add(parts_.back().first, blocks[k].contacts);
      forcing_.add(scene_, k);
      if (p.has(Field::radius)) std::copy(blocks[k].radius.begin(), blocks[k].radius.end(), p.column(Field::radius));
    }
  }
  const std::size_t n = layout_.phases.size();
  for (std::size_t k = 0; k < n; ++k) {
    if (const auto size = scene_.phases[k].diameter(); size && !layout_.phases[k].own_steps()) {
      PhaseParticles& wall = state.phases[k];
      wall.set_mean_radius(0.5 * size->mean);
      if (wall.has(Field::radius))
        std::copy(blocks[k].radius.begin(), blocks[k].radius.end(), wall.column(Field::radius));
    }
    const auto row = laws_.table().begin() + static_cast<std::ptrdiff_t>(k * n);
    if (layout_.phases[k].moves() ||
        std::all_of(row, row + static_cast<std::ptrdiff_t>(n), [](auto law) { return law == SphereSearch::none; }))
      continue;
    add_wall(k, blocks[k]);
  }
  check_room_at_start(scene_, layout_, laws_.table(), blocks);
  wall_touches_.resize(n);
  if (solid_walls_.any())
    for (const Part& part : parts_)
      wall_touches_[part.phase] = state.phases[part.phase].add_own<SolidTouches>("walls that it touches");
  bodies_.begin(layout_, state);
}

void Spheres::attach(Workspace& w) {
  w_ = &w;
  const std::size_t n = layout_.phases.size();
  // Particles of a fluid that have new places in memory say nothing of these.
  w.when_sorted.emplace_back([this] {
    for (const Part& part : parts_) must_search_ = must_search_ || w_->neighbours.has_grid(part.phase);
  });
  columns_.resize(n);
  step_.dimensions = layout_.dimensions;
  step_.has = laws_.parts();
  step_.numbers = laws_.numbers(layout_.dimensions);
  step_.laws = laws_.laws().data();
  step_.inverse_densities = laws_.inverse_densities().data();
  step_.columns = columns_.data();
  search_.prepare(layout_.bounds, laws_.reach(), n, laws_.table(), sides_with_spheres(), step_.numbers);
  watch_walls();
  bind_walls();
  solid_walls_.attach(layout_, laws_.table(), w.wall_motions);
  step_.walls = &solid_walls_;
  bodies_.attach(scene_, layout_, laws_, w.state);
  body_parts_.reserve(parts_.size());
  kept_of_bodies_.reserve(steps_told_together);
  ids_ = present_ids();
  sleep_.prepare(parts_that_may_sleep(), layout_, norm(scene_.domain.gravity));
  make_room();
  number();
  listed_numbers_ = numbers_;
  for (std::size_t d = 0; d < 3; ++d)
    step_.period[d] = layout_.bounds.periodic[d] ? layout_.bounds.high[d] - layout_.bounds.low[d] : 0.0;
}

/// The sides of the domain that hold spheres.
std::vector<SphereSearch::Side> Spheres::sides_with_spheres() const {
  std::vector<SphereSearch::Side> sides;
  for (const Fill& fill : scene_.fills) {
    const auto* shape = std::get_if<SidesShape>(&fill.shape);
    if (!shape) continue;
    const auto kind =
        std::find_if(layout_.phases.begin(), layout_.phases.end(), [&](const auto& p) { return p.name == fill.phase; });
    const SideNames& names = side_names(scene_.domain);
    for (std::uint16_t axis = 0; axis < layout_.dimensions; ++axis)
      for (const bool high : {false, true})
        if (std::find(shape->sides.begin(), shape->sides.end(), names[axis][high]) != shape->sides.end())
          sides.push_back({axis, static_cast<std::int16_t>(high ? -1 : 1),
                           high ? layout_.domain.high[axis] : layout_.domain.low[axis],
                           static_cast<std::uint8_t>(kind - layout_.phases.begin())});
  }
  return sides;
}

void Spheres::schedule(Schedule& s) {
  using enum Field;
  std::string owners;
  const FieldSet moved{position, velocity, contact_acceleration, angular_velocity, angular_acceleration};
  Touches sorted, stepped;
  for (const auto& p : layout_.phases)
    if (p.own_steps()) {
      owners += (owners.empty() ? "" : ", ") + p.name;
      sorted.push_back(p.all_fields());
      stepped.push_back({p.name, {acceleration, radius}, moved});
    }
  s.add({stage::grain_contacts, owners, sorted, [this] { begin_steps(); }});
  s.add({stage::grain_contacts, owners, stepped, [this] { go(); },
         Repeat{"steps of contacts", std::min(longest_step(), scene_.time.end), [this] { return left_; }}});
}

void Spheres::limits(std::vector<StepLimit>& limits) const {
  // Sound in a fluid limits the step besides.
  const bool sound = std::any_of(layout_.phases.begin(), layout_.phases.end(), [](const auto& p) { return p.flows(); });
  if (laws_.laws().empty() || sound) return;
  limits.push_back({"contacts", 8.0 * scene_.time.safety * laws_.step(),
                    "eight steps of the grains, each a twelfth of a contact's duration or less"});
}

void Spheres::point_at_columns() {
  for (const Part& part : parts_) {
    PhaseParticles& p = w_->particles(part.phase);
    SphereColumns& c = columns_[part.phase];
    c.first = part.first;
    c.walls = solid_walls_.any() ? p.own(wall_touches_[part.phase]) : nullptr;
    c.bodies = bodies_.touches(part.phase);
    for (int d = 0; d < layout_.dimensions; ++d) {
      c.position[d] = p.column(Field::position, d);
      c.velocity[d] = p.column(Field::velocity, d);
      c.acceleration[d] = p.column(Field::contact_acceleration, d);
    }
    for (int d = 0; p.has(Field::angular_velocity) && d < p.components(Field::angular_velocity); ++d) {
      c.spin[d] = p.column(Field::angular_velocity, d);
      c.spin_rate[d] = p.column(Field::angular_acceleration, d);
    }
  }
}

/// s; where the scene fixes its step, contacts have the same.
double Spheres::longest_step() const {
  return scene_.time.fixed_step ? *scene_.time.fixed_step : scene_.time.safety * laws_.step();
}

/// A step of the scene begins: as many steps of the contacts as it needs.
void Spheres::begin_steps() {
  if (others_are_there()) renumber();
  if (Exchange().is_shared() && !divided_) divide();
  if (must_search_ || since_sort_ >= searches_a_sort) sort();
  point_at_columns();
  if (sleep_.on() && sleep_.look(*w_, numbers_.data(), lost_)) others_sleep_ = true;
  rest_anew_ = sleep_.on() && (sleep_.some_fell_asleep() || loaded_ || must_search_);
  const double dt = w_->state.dt, longest = std::min(longest_step(), longest_forced_step()),
               steps = scene_.time.fixed_step ? 1.0 : std::ceil(dt / std::min(longest, dt) * (1.0 - 1e-9));
  left_ = bundle_ = static_cast<long>(std::max(1.0, steps));
  const double each = dt / static_cast<double>(left_), before = each_;
  if (before > 0.0) {
    step_.contacts = StepOfContacts::after(before, each);
  } else {
    start();
    step_.contacts = StepOfContacts::first(each);
  }
  for (auto& push : w_->sphere_pushes) push.impulse = push.turn = {};
  sum_pushes(0.5 * each);
  begin_bundle(dt, each);
}

/// The forces of contacts at the start of the run, which the first half kick needs: a step without length.
void Spheres::start() {
  const long steps = left_;
  const double dt = w_->state.dt;
  step_.contacts = StepOfContacts::start(dt / static_cast<double>(steps));
  left_ = bundle_ = 1;
  begin_bundle(dt, 0.0);
  go();
  left_ = bundle_ = steps;
  kept_ = 0;
}

/// Spheres, walls and bodies go to where the first step of a bundle ends. `step` (s): of the scene; `each` (s): of
/// contacts.
void Spheres::begin_bundle(double step, double each) {
  each_ = each;
  carry_walls(each);
  if (bodies_.any()) bodies_.begin_steps(step, each);
  layout_.dimensions == 2 ? pack<2>(each) : pack<3>(each);
  if (forcing_.any()) {
    forcing_.make_room(moving_);
    forcing_.begin(own_chunks(), columns_.data(), passive_.data(), w_->state.time);
  }
  share_out();
}

/// s, that the formulas of a [[forcing]] allow where the spheres are.
double Spheres::longest_forced_step() {
  if (!forcing_.any() || scene_.time.fixed_step) return 1e300;
  forcing_.make_room(moving_);
  constexpr double apart = 1e-2;  // of the reach
  double stiffest = forcing_.stiffest(own_chunks(), columns_.data(), w_->state.time, apart * laws_.reach());
  if (shares_.on()) Exchange().reduce(&stiffest, 1, Exchange::Take::largest);
  return scene_.time.safety * SphereForcing::step / std::sqrt(std::max(stiffest, 1e-300));
}

/// Puts neighbours near in memory, and particles into the periodic domain, where nobody else does.
void Spheres::sort() {
  must_search_ = true;
  for (const Part& part : parts_) {
    if (w_->neighbours.has_grid(part.phase)) continue;
    PhaseParticles& p = w_->particles(part.phase);
    std::array<const double*, 3> x{};
    for (std::size_t d = 0; d < static_cast<std::size_t>(layout_.dimensions); ++d) {
      double* place = p.column(Field::position, static_cast<int>(d));
      x[d] = place;
      const double low = layout_.bounds.low[d], period = step_.period[d];
      for (std::size_t k = 0; period > 0.0 && k < p.size(); ++k)
        place[k] -= period * std::floor((place[k] - low) / period);
    }
    search_.order(x, p.id(), order_);
    p.permute(order_.data());
  }
  since_sort_ = 0;
  number();
}

/// One step of the contacts; then searches if it must.
void Spheres::go() {
  const bool last = --left_ == 0;
  const double dt = each_;
  const std::span<SphereChunk> chunks = own_chunks();
  step_.records = records_[now_].data();
  step_.next = records_[1 - now_].data();
  step_.passive = passive_.data();
  step_.dt = dt;
  step_.last = last;
  const double time = w_->state.time + (last && dt > 0.0 ? w_->state.dt : dt * static_cast<double>(bundle_ - left_));
  step_.fastest = fastest_;
  step_.far = static_cast<std::uint32_t>(all());
  step_.sleep = sleep_.step(numbers_.data());
  if (bodies_.any()) touch_bodies(last);
#pragma omp parallel
  {
    const double threads = omp_get_num_threads(), own = omp_get_thread_num();
    for (std::size_t c = 0; c < chunks.size(); ++c) {
      if (std::floor(middles_[c] * threads) != own) continue;
      if (forcing_.any()) forcing_.push(chunks[c], step_.records, passive_.data(), time);
      step_spheres(step_, chunks[c]);
      if (last && sleep_.on()) order_pairs(chunks[c], step_.numbers, step_.far);
    }
  }
  Extremes found;
  for (const SphereChunk& chunk : chunks) {
    found.fastest = std::max(found.fastest, chunk.fastest);
    found.farthest = std::max(found.farthest, chunk.farthest);
    found.wakes = std::max(found.wakes, chunk.wakes ? 1.0 : 0.0);
  }
  found = of_all_ranks(found);
  fastest_ = found.fastest;
  sum_up(last);
  const bool wakes = found.wakes > 0.0;
  ++kept_;
  std::span<const std::uint32_t> woken;
  if (wakes) woken = sleep_.wake(chunks, numbers_.data(), shares_.on());
  others_sleep_ = wakes;
  step_.contacts = StepOfContacts{dt};
  if (last) return share_columns();
  if (bodies_.any()) bodies_.go_on(dt);
  now_ = 1 - now_;
  carry_walls(static_cast<double>(bundle_ - left_ + 1) * dt);
  if (bodies_.any()) tell_all_records();
  if (walls_left_) return search();
  if (wakes) sort_out_woken(woken);
  if (!(found.farthest < SphereChunk::used_up) && search_strays(dt, true)) return;
  tell_records();
}

/// Contacts with rigid bodies in the present step of contacts; the bodies get what the spheres lose.
void Spheres::touch_bodies(bool last) {
  body_parts_.clear();
  for (const Part& part : parts_) body_parts_.push_back({part.phase, part.first, part.count});
  bodies_.touch({body_parts_, step_.records, step_.passive, moving_, each_, last ? 0.5 : 1.0}, step_);
  step_.by_bodies = bodies_.forces();
  if (last && each_ > 0.0) bodies_.end_steps();
}

}  // namespace barchan
