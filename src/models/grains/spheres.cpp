#include "models/grains/spheres.hpp"

#include <omp.h>

#include <algorithm>
#include <cmath>
#include <span>

#include "models/grains/pair_order.hpp"
#include "models/grains/sphere_forces.hpp"

namespace barchan {

Spheres::Spheres(const Scene& scene, const Layout& layout) : scene_(scene), layout_(layout), laws_(scene, layout) {}

void Spheres::begin(State& state, const std::vector<ParticleBlock>& blocks) {
  for (std::size_t k = 0; k < layout_.phases.size(); ++k) {
    const PlanPhase& plan = layout_.phases[k];
    if (plan.own_steps) {
      parts_.push_back({k, moving_, plan.count, 0.5 * plan.diameter});
      moving_ += plan.count;
      PhaseParticles& p = state.phases[k];
      p.set_mean_radius(0.5 * plan.diameter);
      rest_.add(parts_.back().first, blocks[k].contacts);
      if (p.has(Field::radius)) std::copy(blocks[k].radius.begin(), blocks[k].radius.end(), p.column(Field::radius));
    }
  }
  const std::size_t n = layout_.phases.size();
  for (std::size_t k = 0; k < n; ++k) {
    const auto row = laws_.table().begin() + static_cast<std::ptrdiff_t>(k * n);
    if (layout_.phases[k].moves ||
        std::all_of(row, row + static_cast<std::ptrdiff_t>(n), [](auto law) { return law == SphereSearch::none; }))
      continue;
    add_wall(k, blocks[k]);
  }
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
  step_.rubs = laws_.rubs();
  step_.rolls = laws_.rolls();
  step_.numbers = laws_.numbers(layout_.dimensions);
  step_.laws = laws_.laws().data();
  step_.inverse_densities = laws_.inverse_densities().data();
  step_.columns = columns_.data();
  search_.prepare(layout_.bounds, laws_.reach(), n, laws_.table(), sides_with_spheres(), step_.numbers);
  watch_walls();
  bind_walls();
  bodies_.attach(scene_, layout_, laws_, w.state);
  body_parts_.reserve(parts_.size());
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
    const char* const names[3][2] = {{"left", "right"}, {"bottom", "top"}, {"back", "front"}};
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
    if (p.own_steps) {
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
  const bool sound = std::any_of(layout_.phases.begin(), layout_.phases.end(), [](const auto& p) { return p.flows; });
  if (laws_.laws().empty() || sound) return;
  limits.push_back({"contacts", 8.0 * scene_.time.safety * laws_.step(),
                    "eight steps of the grains, each a twelfth of a contact's duration (without loss less)"});
}

void Spheres::point_at_columns() {
  for (const Part& part : parts_) {
    PhaseParticles& p = w_->particles(part.phase);
    SphereColumns& c = columns_[part.phase];
    c.first = part.first;
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
  const double dt = w_->state.dt, longest = scene_.time.fixed_step ? 1e300 : longest_step();
  left_ = bundle_ = static_cast<long>(std::max(1.0, std::ceil(dt / std::min(longest, dt) * (1.0 - 1e-9))));
  if (others_are_there()) renumber();
  if (must_search_ || since_sort_ >= searches_a_sort) sort();
  point_at_columns();
  if (sleep_.on() && sleep_.look(*w_, numbers_.data(), lost_)) others_sleep_ = true;
  rest_anew_ = sleep_.on() && (sleep_.some_fell_asleep() || loaded_ || must_search_);
  each_ = dt / static_cast<double>(left_);
  for (auto& push : w_->sphere_pushes) push.impulse = push.turn = {};
  sum_pushes(0.5 * each_);
  carry_walls(each_);
  if (bodies_.any()) bodies_.begin_steps(dt, each_);
  layout_.dimensions == 2 ? pack<2>(each_) : pack<3>(each_);
  share_out();
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

/// Both records of a sphere that sleeps: where it is, at rest.
template <int Dim>
static void rest_in(double* one, double* other, const SphereColumns& c, std::size_t k, double radius) {
  using R = SphereRecord<Dim>;
  std::array<float, Dim> way{};
  for (std::size_t d = 0; d < Dim; ++d) way[d] = way_of<Dim>(one, d);
  for (double* record : {one, other}) {
    std::fill_n(record, R::size, 0.0);
    for (std::size_t d = 0; d < Dim; ++d) record[d] = c.position[d][k];
    for (std::size_t d = 0; d < Dim; ++d) set_way<Dim>(record, d, way[d]);
    record[R::radius] = radius;
  }
}

/// The state into the records; half a kick and the first drift.
template <int Dim>
void Spheres::pack(double dt) {
  using R = SphereRecord<Dim>;
  const double half = 0.5 * dt;
  double* records = records_[now_].data();
  double* passive = passive_.data();
  float farthest = 0.0f;
  double fastest2 = 0.0;
  const float* tightness = strays_.tightness();
  for (const Part& part : parts_) {
    const PhaseParticles& p = w_->particles(part.phase);
    const SphereColumns& c = columns_[part.phase];
    const double* radius = p.has(Field::radius) ? p.column(Field::radius) : nullptr;
    std::array<const double*, Dim> a{};
    for (int d = 0; d < Dim; ++d) a[static_cast<std::size_t>(d)] = p.column(Field::acceleration, d);
    const double inverse_mass = 1.0 / (p.mass() * layout_.slab);
    const auto n = static_cast<std::int64_t>(part.count);
    const bool fresh = must_search_;
    double* others = records_[1 - now_].data();
#pragma omp parallel for schedule(static) reduction(max : farthest, fastest2)
    for (std::int64_t i = 0; i < n; ++i) {
      const auto k = static_cast<std::size_t>(i);
      double* r = records + (part.first + k) * R::size;
      double* q = passive + (part.first + k) * passive_size;
      if (sleep_.sleeps(numbers_[part.first + k])) {
        for (std::size_t d = 0; d < Dim; ++d) q[d] = a[d][k];
        if (!rest_anew_) continue;
        const double own = radius ? radius[k] : part.mean_radius;
        rest_in<Dim>(r, others + (part.first + k) * R::size, c, k, own);
        q[passive_mass] = inverse_mass * std::pow(part.mean_radius / own, 3);
        continue;
      }
      double v2 = 0.0;
      for (std::size_t d = 0; d < Dim; ++d) {
        const double v = c.velocity[d][k] + half * (c.acceleration[d][k] + a[d][k]);
        r[d] = c.position[d][k] + dt * v;
        r[R::velocity + d] = v;
        q[d] = a[d][k];
        set_way<Dim>(r, d, fresh ? 0.0f : way_of<Dim>(r, d) + static_cast<float>(dt * v));
        v2 += v * v;
      }
      r[R::radius] = radius ? radius[k] : part.mean_radius;
      const double share = part.mean_radius / r[R::radius];
      q[passive_mass] = inverse_mass * share * share * share;
      for (std::size_t d = 0; d < R::spins; ++d)
        r[R::spin + d] = c.spin[d] ? c.spin[d][k] + half * c.spin_rate[d][k] : 0.0;
      farthest = std::max(farthest, next_way2<Dim>(r, dt) * tightness[part.first + k]);
      fastest2 = std::max(fastest2, v2);
    }
  }
  loaded_ = false;
  for (SphereChunk& chunk : chunks_) chunk.fastest = std::sqrt(fastest2);
  if (must_search_ || walls_left_) return search();
  if (others_sleep_) sort_out_sleepers(false);
  if (!(static_cast<double>(farthest) < SphereChunk::used_up)) search_strays(dt, false);
}

SphereSet Spheres::set() {
  return {layout_.dimensions, records_[now_].data(), moving_,        all(),
          numbers_.data(),    kinds_.data(),         sleep_.flags(), strays_.places()};
}

/// Fills the lists from the present records.
void Spheres::search() {
  // A search costs about four steps of all pairs and a step (1 + s)^D pairs of the slack s (see
  // Neighbours::choose_skin).
  if (searches_ > 0) {
    const double per_slack = static_cast<double>(kept_ + 1) / slack_;
    slack_ = std::clamp(std::sqrt(4.0 / (layout_.dimensions * per_slack)), std::max(0.02, 0.5 * slack_),
                        std::min(0.4, 1.5 * slack_));
  }
  strays_.begin(set(), slack());
  if (!kept_memory_) search_.keep(set(), chunks_, listed_numbers_.data());
  kept_memory_ = false;
  search_.find(set(), slack(), chunks_);
  rest_.recall(step_, set(), chunks_);
  strays_.take_cells(search_.cells());
  if (sleep_.on()) sort_out_sleepers(true);
  cells_loaded_ = false;
  listed_numbers_ = numbers_;
  for (auto& records : {&records_[0], &records_[1]})
    for (std::size_t k = 0; k < moving_; ++k)
      for (int d = 0; d < layout_.dimensions; ++d)
        layout_.dimensions == 2
            ? set_way<2>(records->data() + k * SphereRecord<2>::size, static_cast<std::size_t>(d), 0.0f)
            : set_way<3>(records->data() + k * SphereRecord<3>::size, static_cast<std::size_t>(d), 0.0f);
  must_search_ = walls_left_ = false;
  kept_ = 0;
  ++searches_;
  ++since_sort_;
}

/// Whose way is longer than its allowance. `stepped`: the chunks know them.
template <int Dim>
void Spheres::list_strays(double dt, bool stepped) {
  gone_.clear();
  for (const SphereChunk& chunk : chunks_) {
    if (stepped) {
      gone_.insert(gone_.end(), chunk.gone.begin(), chunk.gone.end());
      continue;
    }
    chunk.each_moving([&](std::size_t k) {
      const float way2 = next_way2<Dim>(records_[now_].data() + k * SphereRecord<Dim>::size, dt);
      if (static_cast<double>(way2 * strays_.tightness()[k]) >= SphereChunk::used_up)
        gone_.push_back(static_cast<std::uint32_t>(k));
    });
  }
}

/// Searches those anew who have used up their allowances, or all.
void Spheres::search_strays(double dt, bool stepped) {
  layout_.dimensions == 2 ? list_strays<2>(dt, stepped) : list_strays<3>(dt, stepped);
  if (!strays_.few(gone_.size())) return search();
  const SphereSet s = set();
  if (cells_loaded_) {
    search_.sort(s, strays_.slack());
    strays_.take_cells(search_.cells());
    cells_loaded_ = false;
  }
  for (const std::uint32_t k : gone_) {
    strays_.renew(s, k, dt, search_.sides(), chunks_);
    for (std::size_t d = 0; d < static_cast<std::size_t>(layout_.dimensions); ++d)
      layout_.dimensions == 2 ? set_way<2>(records_[now_].data() + k * SphereRecord<2>::size, d, 0.0f)
                              : set_way<3>(records_[now_].data() + k * SphereRecord<3>::size, d, 0.0f);
  }
}

/// One step of the contacts; then searches if it must.
void Spheres::go() {
  const bool last = --left_ == 0;
  const double dt = each_;
  step_.records = records_[now_].data();
  step_.next = records_[1 - now_].data();
  step_.passive = passive_.data();
  step_.dt = dt;
  step_.last = last;
  step_.fastest = 0.0;
  for (const SphereChunk& chunk : chunks_) step_.fastest = std::max(step_.fastest, chunk.fastest);
  step_.far = static_cast<std::uint32_t>(all());
  step_.sleep = sleep_.step(numbers_.data());
  if (bodies_.any()) touch_bodies(last);
#pragma omp parallel
  {
    const double threads = omp_get_num_threads(), own = omp_get_thread_num();
    for (std::size_t c = 0; c < chunks_.size(); ++c) {
      if (std::floor(middles_[c] * threads) != own) continue;
      step_spheres(step_, chunks_[c]);
      if (last && sleep_.on()) order_pairs(chunks_[c], step_.numbers, step_.far);
    }
  }
  if (!watched_.empty()) {
    std::fill(pushing_.begin(), pushing_.end(), std::array<double, 6>{});
    for (const SphereChunk& chunk : chunks_)
      for (std::size_t k = 0; k < watched_.size(); ++k)
        for (std::size_t q = 0; q < 6; ++q) pushing_[k][q] += chunk.pushed[k][q];
    sum_pushes(last ? 0.5 * dt : dt);
  }
  stored_ = bodies_.stored();
  contacts_ = bodies_.contacts();
  lost_ += bodies_.lost();
  deepest_ = std::max(deepest_, bodies_.deepest());
  double farthest = 0.0;
  bool wakes = false;
  for (const SphereChunk& chunk : chunks_) {
    lost_ += chunk.lost;
    stored_ += chunk.stored;
    contacts_ += chunk.contacts + chunk.resting;
    deepest_ = std::max(deepest_, chunk.deepest);
    farthest = std::max(farthest, chunk.farthest);
    wakes = wakes || chunk.wakes;
  }
  ++kept_;
  std::span<const std::uint32_t> woken;
  if (wakes) woken = sleep_.wake(chunks_, numbers_.data());
  others_sleep_ = wakes;
  if (last) return;
  if (bodies_.any()) bodies_.go_on(dt);
  now_ = 1 - now_;
  carry_walls(static_cast<double>(bundle_ - left_ + 1) * dt);
  if (walls_left_) return search();
  if (wakes) sort_out_woken(woken);
  if (!(farthest < SphereChunk::used_up)) search_strays(dt, true);
}

/// Contacts with rigid bodies in the present step of contacts; the bodies get what the spheres lose.
void Spheres::touch_bodies(bool last) {
  body_parts_.clear();
  for (const Part& part : parts_) body_parts_.push_back({part.phase, part.first, part.count});
  bodies_.touch({body_parts_, step_.records, step_.passive, moving_, each_, last ? 0.5 : 1.0}, step_);
  step_.by_bodies = bodies_.forces();
  if (last) bodies_.end_steps();
}

}  // namespace barchan
