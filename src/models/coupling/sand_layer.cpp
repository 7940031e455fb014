#include "models/coupling/sand_layer.hpp"

#include <algorithm>
#include <cmath>

#include "base/errors.hpp"
#include "laws/drag_coefficients.hpp"
#include "laws/kept_drag.hpp"
#include "models/coupling/wind_exchange.hpp"

namespace barchan {

void describe_sand_layer(const Scene&, const Interaction&, const Layout&, PlanEntry& e) {
  e.law = "drag";
  e.meaning = "no kernel: the mean wind about the grain, in layers near the ground";
  e.pairs = Pairs::own;  // by place
  e.blows = true;
}

std::unique_ptr<Model> make_sand_layer(const Scene& scene, const Layout& layout, const PlanEntry& entry) {
  if (airs_about(layout, entry.other).front() != entry.fluid) return nullptr;
  return std::make_unique<SandLayer>(scene, layout, entry);
}

SandLayer::SandLayer(const Scene& scene, const Layout& layout, const PlanEntry& entry)
    : scene_(scene),
      layout_(layout),
      fluid_(entry.fluid),
      grains_(entry.other),
      law_(entry.given.drag_law),
      name_(entry.name),
      density_(scene.phases[fluid_].density),
      viscosity_(scene.phases[fluid_].fluid().viscosity),
      diameter_(layout.phases[grains_].diameter),
      top_(reach * layout.phases[fluid_].spacing),
      lift_(entry.given.lift),
      magnus_(entry.given.magnus),
      interval_(entry.given.coupling_interval.value_or(0.0) > 0.0
                    ? *entry.given.coupling_interval
                    : interval * std::sqrt(diameter_ / std::max(std::abs(scene.domain.gravity[1]), 1e-300))),
      grid_(layout, airs_about(layout, grains_)),
      may_rest_(scene.phases[grains_].grains().sleep) {
  if (!(entry.given.gusts > 0.0)) return;
  const double heavier = scene.phases[grains_].density / density_ - 1.0, gravity = std::abs(scene.domain.gravity[1]);
  const double low = layout.domain.low[0], size = layout.domain.high[0] - low;
  gusts_.emplace(entry.given.gusts, viscosity_, bagnold_threshold(heavier, gravity, diameter_), low, size,
                 static_cast<std::size_t>(std::max(1.0, std::round(size / layout.phases[fluid_].spacing))));
}

void SandLayer::begin(State& state, const std::vector<ParticleBlock>&) {
  if (may_rest_) keeps_ = state.phases[grains_].add_own<std::uint8_t>(name_ + ".keeps");
  for (const std::size_t fluid : grid_.phases()) {
    slowed_.emplace_back();
    if (scene_.phases[fluid].fluid().turbulence == Turbulence::k_omega)
      slowed_.back() = state.phases[fluid].add_own<GrainsInEddies>(name_ + ".grains in eddies");
  }
}

void SandLayer::attach(Workspace& w) {
  w_ = &w;
  const double spacing = layout_.phases[fluid_].spacing;
  const double long_enough = std::max(spacing, long_as * diameter_);
  for (const std::size_t q : {0u, 1u}) {
    const std::size_t axis = 2 * q;
    if (axis >= static_cast<std::size_t>(layout_.dimensions)) continue;
    const double size = layout_.domain.high[axis] - layout_.domain.low[axis];
    count_[q] = static_cast<std::size_t>(std::max(1.0, std::round(size / long_enough)));
    width_[q] = size / static_cast<double>(count_[q]);
    samples_[q] = static_cast<std::size_t>(std::max(1.0, std::round(width_[q] / spacing)));
  }
  area_ = layout_.dimensions == 2 ? width_[0] : width_[0] * width_[1];
  const std::size_t n = count_[0] * count_[1];
  ground_ = fitted_heights(scene_, {static_cast<int>(count_[0] * samples_[0] * heights), 0});
  refuse_ground_along_z();
  if (ground_.empty())
    throw SceneError(scene_.file + ": interactions." + name_ +
                     ".drag: no ground under the air; expected a wall with "
                     "roughness and shape = { bed = ... }, packing = \"fitted\" that interacts with the fluid");
  place_ = w.state.air.size();
  const AirProfile one =
      AirColumn::grid(-(deep + 2.0) * diameter_, std::min(fine * diameter_, top_), top_, diameter_ / cells);
  const AirColumn::Air air{density_, viscosity_, MixingLength::duran, Slip::no_slip};
  for (std::size_t k = 0; k < n; ++k) {
    w.state.air.push_back(one);
    profile(k).phase = fluid_;
  }
  layers_.reserve(n);
  for (std::size_t k = 0; k < n; ++k) {
    layers_.emplace_back(air, profile(k));
    pulls_.emplace_back(one.cells());
    rates_.emplace_back(one.cells());
    loads_.emplace_back(one.cells());
    if (!may_rest_) continue;
    rest_loads_.emplace_back(one.cells());
    speed_before_.emplace_back(one.cells());
  }
  const std::size_t grains = w.particles(grains_).size();
  places_.reserve(grains);
  near_.reserve(grains);
  flying_.reserve(grains);
  rate_.assign(grains, 0.0);
  for (std::size_t k = 0; k < grid_.phases().size(); ++k) {
    const std::size_t fluid = grid_.phases()[k];
    w.ground_stress[fluid].assign(w.particles(fluid).size(), 0.0);
    w.grains_in_eddies[fluid] = slowed_[k];
  }
}

/// Layers know the ground along x.
void SandLayer::refuse_ground_along_z() const {
  if (layout_.dimensions == 2) return;
  constexpr int rows = 16;
  const auto all = fitted_heights(scene_, {static_cast<int>(count_[0] * samples_[0] * heights), rows});
  for (std::size_t k = 0; k < all.size(); ++k)
    if (std::abs(all[k] - ground_[k % ground_.size()]) > 1e-6 * diameter_)
      throw SceneError(scene_.file + ": interactions." + name_ +
                       ".drag: the ground is not the same along z, and a law of drag by name knows the ground along x; "
                       "expected a flat bed, or one that is the same along z");
}

/// Beyond an open side the ground goes on as it is at the side, and the last layer does.
SandLayer::Ground SandLayer::ground(double x) const {
  const double step = width_[0] / static_cast<double>(samples_[0] * heights), low = layout_.domain.low[0];
  const auto n = static_cast<long>(ground_.size()) - 1;
  const bool repeats = layout_.domain.periodic[0];
  const double s = repeats ? (x - low) / step : std::clamp((x - low) / step, 0.0, static_cast<double>(n));
  const double cell = repeats ? std::floor(s) : std::min(std::floor(s), static_cast<double>(n - 1));
  const long k = ((static_cast<long>(cell) % n) + n) % n;
  const double share = s - cell, a = ground_[static_cast<std::size_t>(k)], b = ground_[static_cast<std::size_t>(k) + 1];
  const bool beyond = !repeats && (x < low || x > layout_.domain.high[0]);
  const double slope = beyond ? 0.0 : (b - a) / step, length = std::sqrt(1.0 + slope * slope);
  return {a + share * (b - a), 1.0 / length, slope / length};
}

SandLayer::Between SandLayer::between(double x, double z) const {
  Between b = along(0, x);
  if (layout_.dimensions == 2) return b;
  const Between row = along(2, z);
  b.up = (row.right - row.left) * count_[0];  // downwards over the period, as unsigned numbers add
  b.left += row.left * count_[0];
  b.right += row.left * count_[0];
  b.share_up = row.share;
  return b;
}

SandLayer::Between SandLayer::along(std::size_t axis, double x) const {
  const auto n = static_cast<long>(count_[axis / 2]);
  double s = (x - layout_.domain.low[axis]) / width_[axis / 2] - 0.5;
  if (!layout_.domain.periodic[axis]) {
    s = std::clamp(s, 0.0, static_cast<double>(n - 1));
    const long left = std::min(static_cast<long>(s), std::max(n - 2, 0L)), right = std::min(left + 1, n - 1);
    return {static_cast<std::size_t>(left), static_cast<std::size_t>(right), s - static_cast<double>(left)};
  }
  const double whole = std::floor(s);
  const long k = static_cast<long>(whole);
  return {static_cast<std::size_t>(((k % n) + n) % n), static_cast<std::size_t>((((k + 1) % n) + n) % n), s - whole};
}

void SandLayer::schedule(Schedule& s) {
  using enum Field;
  const std::string& grains = layout_.phases[grains_].name;
  Touches exchanged{{grains, {position, velocity, radius}, {drag_acceleration}}};
  if (magnus_) exchanged.front().writes = {drag_acceleration, angular_velocity};
  Touches acting{{grains, {drag_acceleration}, {acceleration}}};
  for (const std::size_t k : grid_.phases()) {
    const std::string& fluid = layout_.phases[k].name;
    s.add({stage::eddies, k == fluid_ ? name_ : fluid + "-" + grains, {{fluid, {position}, {}}}, [this, k] {
             give_stress(k);
           }});
    exchanged.push_back({fluid, {position, velocity}, {drag_acceleration}});
    acting.push_back({fluid, {drag_acceleration}, {acceleration}});
  }
  s.add({stage::drag, name_, exchanged, [this] { exchange(); },
         Repeat{wind_exchanges, interval_, [this] { return exchange_is_due() ? 1L : 0L; }}});
  s.add({stage::drag, name_, acting, [this] { act(); }});
}

/// The stress on the top of the layers, for each particle of the air that may rub on the ground.
void SandLayer::give_stress(std::size_t fluid) {
  auto& stress = w_->ground_stress[fluid];
  const PhaseParticles& air = w_->particles(fluid);
  stress.resize(air.size());
  const double* x = air.column(Field::position, 0);
  const double* z = layout_.dimensions == 2 ? nullptr : air.column(Field::position, 2);
  const auto n = static_cast<std::int64_t>(air.size());
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < n; ++i) {
    const auto k = static_cast<std::size_t>(i);
    stress[k] =
        mean_of(between(x[k], z ? z[k] : 0.0), [&](std::size_t c) { return std::abs(profile(c).stress.back()); });
  }
}

/// Lets the clock of the exchanges go on.
bool SandLayer::exchange_is_due() {
  AirProfile& clock = profile(0);
  const State& state = w_->state;
  const bool first = clock.step < 0;
  if (!first && clock.step != state.steps) clock.elapsed += state.dt;
  clock.step = state.steps;
  finds_steady_wind_ = first;
  return first || barchan::exchange_is_due(clock.elapsed, interval_);
}

void SandLayer::exchange() {
  AirProfile& clock = profile(0);
  const double dt = w_->state.dt;
  hold_ = dt > 0.0 ? time_to_next_exchange(interval_, dt) : interval_;
  all_due_ = all_are_due();
  if (all_due_) grid_.forget();
  grid_.gather(w_->state);
  if (finds_steady_wind_) find_steady_wind();
  exchange(clock.elapsed, clock.last);
  clock.elapsed = 0.0;
  clock.last = hold_;
}

/// Whether this exchange is one of all grains, of those that rest too: now and then, and when grains came or left.
bool SandLayer::all_are_due() {
  if (!may_rest_) return true;
  const long changes = w_->particles(grains_).changes();
  const bool due = --to_all_ <= 0 || changes != seen_changes_;
  if (due) to_all_ = rest_keeps;
  seen_changes_ = changes;
  return due;
}

/// The drag of the last exchange.
void SandLayer::act() {
  for (const std::size_t phase : grid_.phases()) add_kept_drag(w_->particles(phase));
  add_kept_drag(w_->particles(grains_));
}

/// The speed of the air's particles along the ground, where the layer ends: by the weights by which places feel it.
double SandLayer::top_speed(std::size_t column) const {
  const std::size_t row = column / count_[0];
  const auto all = static_cast<long>(samples_[0]);
  const double middle = layout_.domain.low[0] + (static_cast<double>(column % count_[0]) + 0.5) * width_[0];
  double sum = 0.0;
  for (long k = 1 - all; k < all; ++k) {
    const double away = static_cast<double>(k) / static_cast<double>(all);
    sum += (1.0 - std::abs(away)) * speed_over(middle + away * width_[0], row);
  }
  return sum / static_cast<double>(all);
}

/// The same at one x; in 3D by the same weights along z.
double SandLayer::speed_over(double x, std::size_t row) const {
  const Ground g = ground(x);
  const auto along = [&](double z) {
    const Vec3 u = grid_.velocity({x - top_ * g.along_y, g.height + top_ * g.along_x, z});
    return u[0] * g.along_x + u[1] * g.along_y;
  };
  if (layout_.dimensions == 2) return along(0.0);
  const auto all = static_cast<long>(samples_[1]);
  const double middle = layout_.domain.low[2] + (static_cast<double>(row) + 0.5) * width_[1];
  double sum = 0.0;
  for (long k = 1 - all; k < all; ++k) {
    const double away = static_cast<double>(k) / static_cast<double>(all);
    sum += (1.0 - std::abs(away)) * along(middle + away * width_[1]);
  }
  return sum / static_cast<double>(all);
}

/// The layers that the grains at their initial speeds let pass: steps that grow until the air rests.
void SandLayer::find_steady_wind() {
  const double hold = hold_;
  for (int k = 0; k < 80; ++k) {
    for (std::size_t c = 0; c < layers_.size(); ++c) {
      layers_[c].integrate_speed();
      std::fill(loads_[c].owed.begin(), loads_[c].owed.end(), 0.0);
    }
    feel();
    spread();
    blow(hold * std::min(std::pow(1.3, k), 1e6));
  }
  for (std::size_t c = 0; c < layers_.size(); ++c) {
    std::fill(profile(c).given.begin(), profile(c).given.end(), 0.0);
    profile(c).boundary = 0.0;
  }
}

/// The air of the layers goes on by a time (s).
void SandLayer::blow(double dt) {
  const auto n = static_cast<std::int64_t>(layers_.size());
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < n; ++i) {
    const auto c = static_cast<std::size_t>(i);
    layers_[c].advance(dt, AirColumn::Top::at_speed(top_speed(c)), loads_[c]);
  }
}

/// Mean wind (m/s) between two heights over the ground where a grain is.
double SandLayer::wind_about(const Between& b, double low, double high) const {
  return mean_of(b, [&](std::size_t c) { return layers_[c].mean_speed(low, high); });
}

/// Grains and air for the time to the next exchange: the drag in the present wind, the wind that this leaves, and the
/// drag in that. A drag that was kept for another time than was meant gave the grains more or less than the air lost.
void SandLayer::exchange(double kept, double meant) {
  for (std::size_t c = 0; c < layers_.size(); ++c)
    for (std::size_t k = 0; k < loads_[c].owed.size(); ++k)
      loads_[c].owed[k] = profile(c).given[k] * (meant > 0.0 ? kept / meant - 1.0 : 0.0);
  feel();
  spread();
  for (std::size_t c = 0; c < speed_before_.size(); ++c) speed_before_[c] = profile(c).speed;
  blow(hold_);
  if (may_rest_ && all_due_) keep_rest();
  PhaseParticles& p = w_->particles(grains_);
  const double *x = p.column(Field::position, 0), *y = p.column(Field::position, 1);
  double *ax = p.column(Field::drag_acceleration, 0), *ay = p.column(Field::drag_acceleration, 1);
  const bool flat = layout_.dimensions == 2;
  const double* z = flat ? nullptr : p.column(Field::position, 2);
  const double* az = flat ? nullptr : p.column(Field::drag_acceleration, 2);
  const auto near = static_cast<std::int64_t>(near_.size());
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < near; ++i) {
    Near& q = near_[static_cast<std::size_t>(i)];
    q.more = rate_[q.grain] * (wind_about(q.place, q.height - q.radius, q.height + q.radius) - q.wind);
  }
  const auto gust_of = [&](const Near& q) {
    return ax[q.grain] * q.ground.along_x + ay[q.grain] * q.ground.along_y - q.pull;
  };
  const auto add_more = [&](const Near& q) {
    ax[q.grain] += q.more * q.ground.along_x;
    ay[q.grain] += q.more * q.ground.along_y;
  };
  const auto push_gust = [&](const Near& q) {
    const double force = -p.mass_of(q.grain) * gust_of(q);
    grid_.push({x[q.grain], y[q.grain], z ? z[q.grain] : 0.0},
               {force * q.ground.along_x, force * q.ground.along_y, 0.0});
  };
  // What those give that rest is kept on the grid: they come first.
  for (const Near& q : near_) {
    if (!q.rests) continue;
    if (gusts_) push_gust(q);
    add_more(q);
    push_across(p, q);
  }
  if (may_rest_ && all_due_) grid_.keep_forces();
  for (const Near& q : near_) {
    if (q.rests) continue;
    if (gusts_) push_gust(q);
    add_more(q);
  }
  // What the layers do not take, the particles of the air do (of gusts before); from the bed the ground takes what is
  // across it.
  for (const std::size_t k : flying_) {
    const double m = p.mass_of(k);
    const Vec3 place{x[k], y[k], z ? z[k] : 0.0};
    grid_.push(place, {-m * ax[k], -m * ay[k], az ? -m * az[k] : 0.0});
    if (slowed_.front()) grid_.put(place, m, rate_[k]);
  }
  for (const Near& q : near_)
    if (!q.rests) push_across(p, q);
  grid_.give(w_->state);
  for (std::size_t k = 0; k < slowed_.size(); ++k)
    if (slowed_[k]) grid_.give_grains(w_->state, k, w_->particles(grid_.phases()[k]).own(*slowed_[k]));
}

void SandLayer::push_across(const PhaseParticles& p, const Near& q) {
  if (q.height < diameter_) return;
  const std::size_t k = q.grain;
  const double ax = p.column(Field::drag_acceleration, 0)[k], ay = p.column(Field::drag_acceleration, 1)[k];
  const double across = -p.mass_of(k) * (ay * q.ground.along_x - ax * q.ground.along_y);
  Vec3 x{p.column(Field::position, 0)[k], p.column(Field::position, 1)[k], 0.0};
  Vec3 force{-across * q.ground.along_y, across * q.ground.along_x, 0.0};
  if (layout_.dimensions == 3) {
    x[2] = p.column(Field::position, 2)[k];
    force[2] = -p.mass_of(k) * p.column(Field::drag_acceleration, 2)[k];
  }
  grid_.push(x, force);
}

/// The profiles are in the state; their integrals are made again.
void SandLayer::archive(Archive& a) {
  if (may_rest_) {
    a.number(name_ + " exchanges to that of all", to_all_);
    const long changes = w_->particles(grains_).changes();
    long late = changes - seen_changes_;
    a.number(name_ + " changes to take over", late);
    seen_changes_ = changes - late;
    for (auto& load : rest_loads_) a.array(name_ + " kept drag", load.pull);
    grid_.archive(a);
  }
  if (!a.loads()) return;
  for (auto& layer : layers_) layer.integrate_speed();
}

/// Means over the ground: of the stress on top of the layers, and at the height of the bed.
void SandLayer::history(HistoryRow& row) const {
  double top = 0.0, bed = 0.0;
  for (std::size_t c = 0; c < layers_.size(); ++c) {
    const AirProfile& p = profile(c);
    top += p.stress.back();
    bed += p.stress[layers_[c].cell_at(0.5 * diameter_)];
  }
  row.add(name_ + "_ground_stress [Pa]", top / static_cast<double>(layers_.size()));
  row.add(name_ + "_bed_stress [Pa]", bed / static_cast<double>(layers_.size()));
}

}  // namespace barchan
