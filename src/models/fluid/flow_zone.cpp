#include "models/fluid/flow_zone.hpp"

#include <algorithm>
#include <cmath>

#include "engine/exchange.hpp"
#include "models/fluid/fluid_phase.hpp"
#include "models/workspace.hpp"

namespace barchan {

namespace {

constexpr std::size_t kept_steps = 64;  // of an inflow's pressures: longer than sound takes through the zone

}  // namespace

FlowZone::FlowZone(const Scene& scene, const Layout& layout, std::size_t fluid, const FlowEnd& end)
    : scene_(scene),
      plan_(layout.phases[fluid]),
      domain_(layout.domain),
      fluid_(fluid),
      end_(end),
      law_(pressure_law(scene, layout, fluid)),
      name_(plan_.name + "_" + word_of(end.side)),
      c_(plan_.sound_speed),
      rho_(law_.reference_density),
      dx_(plan_.spacing),
      reach_(dx_ * std::max((end.inflow ? seen : end_seen) - end.layer / plan_.spacing, 0.0)),
      pressure_(end.outflow ? end.outflow->pressure : Expression{}) {
  whole_ = domain_.high[end.axis()] - domain_.low[end.axis()];
  for (const FlowEnd& other : flow_ends(scene, scene.phases[fluid])) whole_ += other.layer;
  if (!end.inflow) return;
  velocity_.emplace(scene, end);
  if (end.inflow->fluctuations)
    fluctuations_.emplace(end, InflowFluctuations(*end.inflow->fluctuations, rho_, scene.dimensions, periods()));
}

void FlowZone::begin(State& state, const std::vector<ParticleBlock>&) {
  PhaseParticles& p = state.phases[fluid_];
  p.number_may_change();
  where_ = p.add_own<std::uint8_t>(name_, std::uint8_t{away});
  std::vector<Vec3> outermost;
  for (std::size_t k = 0; k < p.size(); ++k) {
    const Vec3 x = place_of(p, k);
    const double d = end_.beyond(x[end_.axis()]);
    p.own(where_)[k] = d > 0.0 ? beyond : d > -reach_ ? near : away;
    if (d > end_.length - (1.0 + 1e-6) * dx_ && d <= end_.length) outermost.push_back(x);
  }
  if (p.is_part()) Exchange().join(outermost);
  changes_ = flow_changes(scene_, scene_.phases[fluid_]) || starts_otherwise(p) ? 1.0 : 0.0;
  lanes_ = FlowLanes(std::move(outermost), end_.axis(), dx_, periods());
  lane_.assign(lanes_.size(), {});
  sums_.resize(lanes_.size());
  if (end_.inflow) {
    past_.assign(kept_steps * lanes_.size(), 0.0);
    past_times_.assign(kept_steps, 0.0);
  }
  if (end_.outflow || end_.layer > 0.0) {
    const auto cells = lanes_.size() * static_cast<std::size_t>(std::max(1.0, std::round(end_.layer / dx_)));
    means_.assign(cells, {});
    layer_sums_.resize(cells);
    layer_counts_.resize(cells);
  }
}

void FlowZone::attach(Workspace& w) { w_ = &w; }

void FlowZone::schedule(Schedule& s) {
  s.add({stage::walls, name_, {plan_.all_fields()}, [this] { renew(); }});
  s.add({stage::hold, name_, {plan_.all_fields()}, [this] { absorb(); }});
}

Vec3 FlowZone::place_of(const PhaseParticles& p, std::size_t k) const {
  Vec3 x{};
  for (int d = 0; d < p.dimensions(); ++d) x[static_cast<std::size_t>(d)] = p.column(Field::position, d)[k];
  return x;
}

Vec3 FlowZone::periods() const {
  Vec3 periods{};
  for (std::size_t d = 0; d < 3; ++d)
    if (domain_.periodic[d]) periods[d] = domain_.high[d] - domain_.low[d];
  return periods;
}

/// The cell of the layer that a place of a lane is in.
std::size_t FlowZone::cell_of(std::size_t lane, double d) const {
  const auto deep = static_cast<std::int64_t>(means_.size() / lanes_.size());
  const std::int64_t row = std::clamp<std::int64_t>(static_cast<std::int64_t>(d / dx_), 0, deep - 1);
  return lane * static_cast<std::size_t>(deep) + static_cast<std::size_t>(row);
}

// ---- before the neighbours are searched -----------------------------------------------------------------------------

void FlowZone::renew() {
  if (lanes_.size() == 0) return;
  const double dt = w_->state.dt;
  sort_out();
  gather();
  const double common_before = common_.velocity;
  learn_common();
  const double share = started_ > 0.0 ? std::min(1.0, dt * c_ / (settling * dx_)) : 1.0;
  if (end_.inflow) {
    if (changes_ > 0.0) turn_inflow();
    learn_inflow(share_of(memory_in_lengths * (domain_.high[end_.axis()] - domain_.low[end_.axis()])));
    remember_pressures(dt);
    if (fluctuations_) fluctuations_->carry(lanes_, *velocity_, w_->state.time, started_ > 0.0 ? dt : 0.0);
  } else {
    turn_outflow();
    learn_outflow(share, common_.velocity - common_before);
  }
  learn_layer();
  started_ = 1.0;
  if (gone_ >= 0.5) remove_and_create();
  prescribe();
}

/// Of a mean whose memory is so many passages of a length (m) that this step's value has; 1 at the start.
double FlowZone::share_of(double memory) const {
  if (started_ == 0.0) return 1.0;
  return std::min(1.0, w_->state.dt * c_ / memory);
}

/// Who is near the side or beyond it now, and who has passed it.
void FlowZone::sort_out() {
  PhaseParticles& p = w_->particles(fluid_);
  const double* x = p.column(Field::position, static_cast<int>(end_.axis()));
  const double* v = p.column(Field::velocity, static_cast<int>(end_.axis()));
  std::uint8_t* where = p.own(where_);
  std::int64_t in = 0, out = 0;
  double fastest = 0.0;  // m/s
  const auto n = static_cast<std::int64_t>(p.size());
#pragma omp parallel for schedule(static) reduction(+ : in, out) reduction(max : fastest)
  for (std::int64_t k = 0; k < n; ++k) {
    const double d = end_.beyond(x[k]);
    const std::uint8_t now = d > 0.0 ? beyond : d > -reach_ ? near : away;
    if (now != where[k]) {
      in += where[k] == beyond ? 1 : 0;
      out += now == beyond ? 1 : 0;
      where[k] = now;
    }
    if (now == beyond) fastest = std::max(fastest, std::abs(v[k]));
  }
  passed_ = {in, out};
  fastest_ = fastest;
  members_.clear();
  for (std::int64_t k = 0; k < n; ++k)
    if (where[k] != away) members_.push_back(static_cast<std::uint32_t>(k));
}

/// Sums by lane over those from which the zone learns; the last particle of each lane; pressures of the layer.
void FlowZone::gather() {
  const PhaseParticles& p = w_->particles(fluid_);
  std::fill(sums_.begin(), sums_.end(), Gathered{});
  std::fill(layer_sums_.begin(), layer_sums_.end(), std::array<LaneSum, 2>{});
  std::fill(layer_counts_.begin(), layer_counts_.end(), 0);
  for (Lane& lane : lane_) lane.outermost = -1e300;
  const double* pressure = p.column(Field::pressure);
  const double from = end_.layer - (end_.inflow ? seen : end_seen) * dx_, to = end_.layer;
  for (const std::uint32_t k : members_) {
    const Vec3 x = place_of(p, k);
    const double d = end_.beyond(x[end_.axis()]), level = pressure[k] / (rho_ * c_ * c_);
    const std::size_t lane = lanes_.nearest(x);
    if (d > 0.0) lane_[lane].outermost = std::max(lane_[lane].outermost, d);
    if (d > 0.0 && d <= end_.layer) {
      const std::size_t cell = cell_of(lane, d);
      layer_sums_[cell][0].add(level);
      layer_sums_[cell][1].add(p.column(Field::velocity, static_cast<int>(end_.axis()))[k] / c_);
      ++layer_counts_[cell];
    }
    if (d <= from || d > to) continue;
    Gathered& sum = sums_[lane];
    const double depth = (end_.layer - d) / dx_;
    ++sum.count;
    for (int c = 0; c < p.dimensions(); ++c)
      sum.velocity[static_cast<std::size_t>(c)].add(p.column(Field::velocity, c)[k] / c_);
    sum.pressure.add(level);
    sum.depth.add(depth);
    sum.depth2.add(depth * depth);
    sum.sloped.add(depth * level);
  }
  if (Exchange().is_shared()) gather_ranks();
  entered_ += p.mass() * static_cast<double>(passed_[0]);
  left_ += p.mass() * static_cast<double>(passed_[1]);
  gone_ += fastest_ * w_->state.dt / dx_;
}

/// The pressure where the velocity of the scene begins, and its slope, by lane.
void FlowZone::learn_inflow(double mean_share) {
  const double scale = rho_ * c_ * c_;
  for (std::size_t k = 0; k < lane_.size(); ++k) {
    const Gathered& sum = sums_[k];
    if (sum.count == 0) continue;
    Lane& lane = lane_[k];
    const auto n = static_cast<double>(sum.count);
    const double depth = sum.depth.value() / n, level = sum.pressure.value() / n;
    const double spread = sum.depth2.value() / n - depth * depth;
    const double pushed = rho_ * lane.push;  // Pa/m
    if (started_ > 0.0 && sum.count > 1 && spread > 0.1)
      lane.slope +=
          mean_share * (scale * (sum.sloped.value() / n - depth * level) / (spread * dx_) - pushed - lane.slope);
    lane.depth = depth * dx_;
    lane.now = scale * level - (lane.slope + pushed) * lane.depth + pushed * whole_;
    lane.pressure += mean_share * (lane.now - lane.pressure);
    lane.velocity_now = outwards() * c_ * sum.velocity[end_.axis()].value() / n;
  }
}

void FlowZone::remember_pressures(double dt) {
  const bool first = past_times_[static_cast<std::size_t>(newest_)] == 0.0;
  if (!first) newest_ = (newest_ + 1) % static_cast<std::int64_t>(kept_steps);
  const auto row = static_cast<std::size_t>(newest_);
  past_times_[row] = dt;
  for (std::size_t k = 0; k < lane_.size(); ++k) {
    double& sound = past_[row * lane_.size() + k];
    sound = lane_[k].now - lane_[k].pressure;
    if (changes_ == 0.0) continue;
    sound = 0.5 * (sound + rho_ * c_ * (lane_[k].velocity_now - lane_[k].given));
  }
}

/// p' of a lane some time ago (s).
double FlowZone::earlier(std::size_t lane, double ago) const {
  const auto value = [&](std::size_t row) { return past_[row * lane_.size() + lane]; };
  auto row = static_cast<std::size_t>(newest_);
  for (std::size_t k = 1; k < kept_steps; ++k) {
    const std::size_t before = (row + kept_steps - 1) % kept_steps;
    const double step = past_times_[row];
    if (!(past_times_[before] > 0.0)) return value(row);
    if (ago <= step) return value(row) + ago / step * (value(before) - value(row));
    ago -= step;
    row = before;
  }
  return value(row);
}

/// The velocity at the end of the layer; what all of the layer `gained` is there at once.
void FlowZone::learn_outflow(double share, double gained) {
  for (std::size_t k = 0; k < lane_.size(); ++k) {
    const Gathered& sum = sums_[k];
    lane_[k].velocity[end_.axis()] += started_ > 0.0 ? gained : 0.0;
    if (sum.count == 0) continue;
    for (std::size_t c = 0; c < 3; ++c) {
      const double mean = c_ * sum.velocity[c].value() / static_cast<double>(sum.count);
      lane_[k].velocity[c] += share * (mean - lane_[k].velocity[c]);
    }
  }
}

/// The mean pressures and velocities in the layer, less what all of it has.
void FlowZone::learn_layer() {
  const double slow = share_of(memory_in_layers * std::max(end_.layer, dx_));
  for (std::size_t k = 0; k < means_.size(); ++k)
    if (const double n = layer_counts_[k]; n > 0) {
      const double common = common_.pressure + common_.slope * depth_of_cell(k);
      means_[k].pressure += slow * (rho_ * c_ * c_ * layer_sums_[k][0].value() / n - common - means_[k].pressure);
      means_[k].velocity += slow * (c_ * layer_sums_[k][1].value() / n - common_.velocity - means_[k].velocity);
    }
}

/// Whether no particle near the end of the zone stands within `room` of a place.
bool FlowZone::has_room(const Vec3& x) const {
  const PhaseParticles& p = w_->particles(fluid_);
  const std::size_t axis = end_.axis();
  return !Exchange().any(std::any_of(members_.begin(), members_.end(), [&](std::uint32_t k) {
    if (std::abs(p.column(Field::position, static_cast<int>(axis))[k] - x[axis]) > dx_) return false;
    Vec3 r = place_of(p, k) - x;
    for (std::size_t d = 0; d < 3; ++d)
      if (domain_.periodic[d])
        r[d] -= (domain_.high[d] - domain_.low[d]) * std::round(r[d] / (domain_.high[d] - domain_.low[d]));
    return norm(r) < room * dx_;
  }));
}

/// m, between a row at `d` and the next one: so far apart that their mass fills the lane with the density there.
double FlowZone::row_spacing(std::size_t lane, double d) const {
  Vec3 at = lanes_.place(lane);
  at[end_.axis()] = end_.at(d);
  const double pressure = end_.inflow ? mean_behind(lane_[lane], d - end_.layer)
                                      : pressure_(at, w_->state.time) - lane_[lane].behind + law_.background;
  return dx_ * rho_ / law_.density(pressure);
}

void FlowZone::remove_and_create() {
  gone_ = 0.0;
  PhaseParticles& p = w_->particles(fluid_);
  const auto axis = static_cast<int>(end_.axis());
  const double* x = p.column(Field::position, axis);
  const auto leaves = [&](std::size_t k) { return end_.beyond(x[k]) > end_.length; };
  const long changes = p.changes();
  if (std::any_of(members_.begin(), members_.end(), leaves)) {
    p.remove_if(leaves);
    members_.clear();
    for (std::size_t k = 0; k < p.size(); ++k)
      if (p.own(where_)[k] != away) members_.push_back(static_cast<std::uint32_t>(k));
  }
  for (std::size_t lane = 0; lane < lanes_.size(); ++lane) {
    double last = lane_[lane].outermost;
    if (last < 0.0) last = end_.layer;
    const bool enters = end_.inflow || (end_.upper() ? lane_[lane].velocity[end_.axis()] < 0.0
                                                     : lane_[lane].velocity[end_.axis()] > 0.0);
    while (enters && last + row_spacing(lane, last) <= end_.length * (1.0 + 1e-9)) {
      last += row_spacing(lane, last);
      Vec3 at = lanes_.place(lane);
      at[end_.axis()] = end_.at(last);
      if (end_.outflow && !has_room(at)) break;
      make_at(at);
    }
  }
  if (Exchange().any(p.changes() != changes)) w_->must_search = true;  // on all ranks
}

// ---- what the scene gives -------------------------------------------------------------------------------------------

void FlowZone::set_pressure(PhaseParticles& p, std::size_t k, double pressure) {
  const double density = law_.density(pressure);
  p.column(Field::density)[k] = density;
  p.column(Field::pressure)[k] = law_(density);
}

void FlowZone::prescribe_inflow(PhaseParticles& p, std::size_t k, const Vec3& x, std::size_t lane, double d) {
  const double behind = d - end_.layer, sound = earlier(lane, (behind + lane_[lane].depth) / c_);
  Vec3 v = (*velocity_)(x, w_->state.time);
  v[end_.axis()] -= outwards() * lane_[lane].behind;
  if (fluctuations_) v = v + (*fluctuations_)(x, v);
  v[end_.axis()] += outwards() * sound / (rho_ * c_);
  for (int c = 0; c < p.dimensions(); ++c) p.column(Field::velocity, c)[k] = v[static_cast<std::size_t>(c)];
  set_pressure(p, k, mean_behind(lane_[lane], behind) + sound);
  if (p.has(Field::turbulent_kinetic_energy))  // none: a logarithmic layer enters (two_equations.hpp)
    p.column(Field::turbulent_kinetic_energy)[k] = 0.0;
}

void FlowZone::prescribe_outflow(PhaseParticles& p, std::size_t k, const Vec3& x, std::size_t lane) {
  for (int c = 0; c < p.dimensions(); ++c)
    p.column(Field::velocity, c)[k] = lane_[lane].velocity[static_cast<std::size_t>(c)];
  set_pressure(p, k, pressure_(x, w_->state.time) - lane_[lane].behind + law_.background);
}

void FlowZone::prescribe() {
  PhaseParticles& p = w_->particles(fluid_);
  for (const std::uint32_t k : members_) {
    const Vec3 x = place_of(p, k);
    const double d = end_.beyond(x[end_.axis()]);
    if (d <= end_.layer) continue;
    const std::size_t lane = lanes_.nearest(x);
    if (end_.inflow) prescribe_inflow(p, k, x, lane, d);
    else prescribe_outflow(p, k, x, lane);
  }
}

// ---- after all forces -----------------------------------------------------------------------------------------------

namespace {

/// The part of a velocity u' (outwards) that belongs to sound going outwards: p'/(rho c), at most twice u' and nothing
/// against it. So the layer takes energy and never gives any; without this bound it drove slow waves of the whole
/// channel, to a fifth of its speed in 20 s. Vortices have little p' and pass.
double of_sound(double by_pressure, double velocity) {
  if (!(by_pressure * velocity > 0.0)) return 0.0;
  return std::abs(by_pressure) < 2.0 * std::abs(velocity) ? by_pressure : 2.0 * velocity;
}

}  // namespace

/// Sound fades in the layer; what the scene gives has no rates.
void FlowZone::absorb() {
  PhaseParticles& p = w_->particles(fluid_);
  const std::uint8_t* where = p.own(where_);
  const auto axis = static_cast<int>(end_.axis());
  double *rate = p.column(Field::density_rate), *push = p.column(Field::acceleration, axis);
  const double *rho = p.column(Field::density), *pressure = p.column(Field::pressure);
  const double* v = p.column(Field::velocity, axis);
  const double out = outwards(), layer = end_.layer;
  const double strongest = layer > 0.0 ? std::min(3.0 * absorbed * c_ / layer, 0.5 / w_->state.dt) : 0.0;
  const auto n = static_cast<std::int64_t>(p.size());
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < n; ++i) {
    const auto k = static_cast<std::size_t>(i);
    if (where[k] != beyond) continue;
    const Vec3 x = place_of(p, k);
    const double d = end_.beyond(x[end_.axis()]);
    if (d > layer) {
      rate[k] = 0.0;
      for (int c = 0; c < p.dimensions(); ++c) {
        p.column(Field::acceleration, c)[k] = 0.0;
        if (p.has(Field::shift_velocity)) p.column(Field::shift_velocity, c)[k] = 0.0;
      }
    } else if (d > 0.0) {
      const double s = strongest * (d / layer) * (d / layer);
      const Mean& mean = means_[cell_of(lanes_.nearest(x), d)];
      const double over = pressure[k] - (common_.pressure + common_.slope * d) - mean.pressure;
      rate[k] -= s * over / (c_ * c_);
      push[k] -= s * out * of_sound(over / (rho[k] * c_), out * (v[k] - common_.velocity - mean.velocity));
    }
  }
}

// ---- history, state -------------------------------------------------------------------------------------------------

void FlowZone::history(HistoryRow& row) const {
  row.add(name_ + "_in [kg]", entered_);
  row.add(name_ + "_out [kg]", left_);
}

void FlowZone::archive(Archive& a) {
  a.array(name_ + ": lanes", lane_);
  a.array(name_ + ": mean pressures", means_);
  a.array(name_ + ": earlier pressures", past_);
  a.array(name_ + ": earlier steps", past_times_);
  a.number(name_ + ": newest", newest_);
  a.number(name_ + ": entered", entered_);
  a.number(name_ + ": left", left_);
  a.number(name_ + ": gone", gone_);
  a.number(name_ + ": started", started_);
  a.number(name_ + ": late", late_);
  a.number(name_ + ": changes", changes_);
  a.number(name_ + ": common", common_);
  if (fluctuations_) fluctuations_->archive(a, name_);
}

}  // namespace barchan
