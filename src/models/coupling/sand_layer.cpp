#include "models/coupling/sand_layer.hpp"

#include <algorithm>
#include <cmath>

#include "base/errors.hpp"
#include "laws/drag_coefficients.hpp"
#include "laws/kept_drag.hpp"

namespace barchan {

SandLayer::SandLayer(const Scene& scene, const Layout& layout, const PlanEntry& entry)
    : scene_(scene),
      layout_(layout),
      fluid_(entry.fluid),
      grains_(entry.other),
      law_(entry.drag_law),
      name_(entry.name),
      density_(scene.phases[fluid_].density),
      viscosity_(scene.phases[fluid_].fluid().viscosity),
      diameter_(layout.phases[grains_].diameter),
      top_(reach * layout.phases[fluid_].spacing),
      interval_(interval * std::sqrt(diameter_ / std::max(std::abs(scene.domain.gravity[1]), 1e-300))),
      grid_(layout.bounds, layout.phases[fluid_].spacing) {}

void SandLayer::attach(Workspace& w) {
  w_ = &w;
  const double size = layout_.bounds.high[0] - layout_.bounds.low[0];
  const auto n = static_cast<std::size_t>(std::max(1.0, std::round(size / layout_.phases[fluid_].spacing)));
  width_ = size / static_cast<double>(n);
  ground_ = fitted_heights(scene_, {static_cast<int>(n * heights), 0});
  if (ground_.empty())
    throw SceneError(scene_.file + ": interactions." + name_ +
                     ".drag: no ground under the air; expected a wall with "
                     "roughness and shape = { bed = ... }, packing = \"fitted\" that the fluid feels");
  place_ = w.state.air.size();
  const AirProfile one =
      AirColumn::grid(-(deep + 2.0) * diameter_, std::min(fine * diameter_, top_), top_, diameter_ / cells);
  const AirColumn::Air air{density_, viscosity_, MixingLength::duran, Slip::no_slip};
  for (std::size_t k = 0; k < n; ++k) {
    w.state.air.push_back(one);
    profile(k).phase = fluid_;
    profile(k).pull.assign(one.cells(), 0.0);
  }
  layers_.reserve(n);
  for (std::size_t k = 0; k < n; ++k) {
    layers_.emplace_back(air, profile(k));
    spreads_.emplace_back(one.cells());
  }
  taken_.assign(one.cells(), 0.0);
  const std::size_t grains = w.particles(grains_).size();
  near_.reserve(grains);
  flying_.reserve(grains);
  rate_.assign(grains, 0.0);
  w.ground_stress[fluid_].assign(w.particles(fluid_).size(), 0.0);
}

SandLayer::Ground SandLayer::ground(double x) const {
  const double step = width_ / static_cast<double>(heights), low = layout_.bounds.low[0];
  const auto n = static_cast<long>(ground_.size()) - 1;
  const double s = (x - low) / step;
  const long k = ((static_cast<long>(std::floor(s)) % n) + n) % n;
  const double share = s - std::floor(s), a = ground_[static_cast<std::size_t>(k)],
               b = ground_[static_cast<std::size_t>(k) + 1];
  const double slope = (b - a) / step, length = std::sqrt(1.0 + slope * slope);
  return {a + share * (b - a), 1.0 / length, slope / length};
}

std::size_t SandLayer::column_at(double x) const {
  const auto n = static_cast<long>(layers_.size());
  const long k = static_cast<long>(std::floor((x - layout_.bounds.low[0]) / width_));
  return static_cast<std::size_t>(((k % n) + n) % n);
}

void SandLayer::schedule(Schedule& s) {
  using enum Field;
  s.add({stage::eddies, name_, {position}, {}, [this] { give_stress(); }});
  s.add(
      {stage::drag, name_, {position, velocity, radius, drag_acceleration}, {acceleration, drag_acceleration}, [this] {
         act();
       }});
}

/// The stress on the top of the layers, for each particle of the air that may rub on the ground.
void SandLayer::give_stress() {
  auto& stress = w_->ground_stress[fluid_];
  const PhaseParticles& air = w_->particles(fluid_);
  const double* x = air.column(Field::position, 0);
  const std::size_t n = layers_.size();
  for (std::size_t k = 0; k < air.size(); ++k) {
    const double s = (x[k] - layout_.bounds.low[0]) / width_ - 0.5, cell = std::floor(s), share = s - cell;
    const long left = static_cast<long>(cell), all = static_cast<long>(n);
    const AirProfile &a = profile(static_cast<std::size_t>(((left % all) + all) % all)),
                     &b = profile(static_cast<std::size_t>((((left + 1) % all) + all) % all));
    stress[k] = (1.0 - share) * std::abs(a.stress.back()) + share * std::abs(b.stress.back());
  }
}

void SandLayer::act() {
  AirProfile& clock = profile(0);
  const State& state = w_->state;
  const bool first = clock.step < 0;
  if (!first && clock.step != state.steps) clock.elapsed += state.dt;
  clock.step = state.steps;
  if (first || clock.elapsed >= interval_ * (1.0 - 1e-9)) {
    const double dt = std::max(state.dt, 1e-300);
    hold_ = dt * std::max(1.0, std::ceil(interval_ / dt * (1.0 - 1e-9)));
    if (state.dt <= 0.0) hold_ = interval_;
    grid_.gather(w_->particles(fluid_));
    if (first) find_steady_wind();
    exchange();
  }
  for (const std::size_t phase : {fluid_, grains_}) {
    PhaseParticles& p = w_->particles(phase);
    const auto n = static_cast<std::int64_t>(p.size());
    for (int d = 0; d < 2; ++d) {
      double* a = p.column(Field::acceleration, d);
      const double* drag = p.column(Field::drag_acceleration, d);
#pragma omp parallel for simd schedule(static)
      for (std::int64_t k = 0; k < n; ++k) a[k] += drag[k];
    }
  }
}

/// The speed of the air's particles along the ground, where the layer ends.
double SandLayer::top_speed(std::size_t column) const {
  const double x = layout_.bounds.low[0] + (static_cast<double>(column) + 0.5) * width_;
  const Ground g = ground(x);
  const auto u = grid_.velocity({x - top_ * g.along_y, g.height + top_ * g.along_x});
  return u[0] * g.along_x + u[1] * g.along_y;
}

/// The layers that the grains at their initial speeds let pass: steps that grow until the air rests.
void SandLayer::find_steady_wind() {
  double dt = interval_;
  for (int k = 0; k < 80; ++k, dt = std::min(1.3 * dt, 10.0)) {
    for (auto& layer : layers_) layer.integrate_speed();
    feel();
    spread();
    for (std::size_t c = 0; c < layers_.size(); ++c) std::fill(profile(c).given.begin(), profile(c).given.end(), 0.0);
    blow(dt);
  }
  for (std::size_t c = 0; c < layers_.size(); ++c) {
    std::fill(profile(c).given.begin(), profile(c).given.end(), 0.0);
    profile(c).boundary = 0.0;
  }
}

/// The air of the layers goes on by a time (s), in which the grains took what they pull.
void SandLayer::blow(double dt) {
  for (std::size_t c = 0; c < layers_.size(); ++c) {
    const auto& pull = profile(c).pull;
    for (std::size_t k = 0; k < pull.size(); ++k) taken_[k] = dt * pull[k];
    layers_[c].advance(dt, {0.0, top_speed(c)}, taken_);
  }
}

void SandLayer::exchange() {
  AirProfile& clock = profile(0);
  if (clock.elapsed > 0.0) blow(clock.elapsed);
  clock.elapsed = 0.0;
  feel();
  spread();
  // What the layers do not take, the particles of the air do.
  const PhaseParticles& p = w_->particles(grains_);
  const double *x = p.column(Field::position, 0), *y = p.column(Field::position, 1);
  const double *ax = p.column(Field::drag_acceleration, 0), *ay = p.column(Field::drag_acceleration, 1);
  for (const std::size_t k : flying_) {
    const double m = p.mass_of(k);
    grid_.push({x[k], y[k]}, {-m * ax[k], -m * ay[k]});
  }
  for (const auto& [k, column] : near_) {
    const Ground g = ground(x[k]);
    if (height_over(g, y[k]) < diameter_) continue;  // the ground takes what is across it
    const double m = p.mass_of(k), across = -m * (ay[k] * g.along_x - ax[k] * g.along_y);
    grid_.push({x[k], y[k]}, {-across * g.along_y, across * g.along_x});
  }
  grid_.give(w_->particles(fluid_));
}

void SandLayer::feel() {
  PhaseParticles& p = w_->particles(grains_);
  const double *x = p.column(Field::position, 0), *y = p.column(Field::position, 1);
  const double *u = p.column(Field::velocity, 0), *v = p.column(Field::velocity, 1);
  const double* own = p.has(Field::radius) ? p.column(Field::radius) : nullptr;
  double *ax = p.column(Field::drag_acceleration, 0), *ay = p.column(Field::drag_acceleration, 1);
  const double solid = scene_.phases[grains_].density, g_y = scene_.domain.gravity[1], half = 0.5 * hold_;
  near_.clear();
  flying_.clear();
  for (std::size_t k = 0; k < p.size(); ++k) {
    const double height = height_over(ground(x[k]), y[k]);
    if (height >= top_) flying_.push_back(k);
    else if (height > -deep * diameter_) near_.push_back({k, column_at(x[k])});
    else ax[k] = ay[k] = rate_[k] = 0.0;
  }
  with_drag_law(law_, [&](auto law) {
    const auto excess = [](double re) { return decltype(law)::excess(re); };
    const auto of = [&](std::size_t k, const std::array<double, 2>& wind) {
      const double d = own ? 2.0 * own[k] : diameter_, stokes = 18.0 * density_ * viscosity_ / (solid * d * d);
      const auto kept =
          kept_drag<2>(wind, {u[k], v[k]}, {scene_.domain.gravity[0], g_y}, stokes, d / viscosity_, excess, hold_);
      ax[k] = kept.drag[0];
      ay[k] = kept.drag[1];
      rate_[k] = kept.rate;
    };
    const auto flying = static_cast<std::int64_t>(flying_.size()), near = static_cast<std::int64_t>(near_.size());
#pragma omp parallel for schedule(static)
    for (std::int64_t i = 0; i < flying; ++i) {
      const std::size_t k = flying_[static_cast<std::size_t>(i)];
      of(k, grid_.velocity({x[k] + half * u[k], y[k] + half * v[k]}));
    }
#pragma omp parallel for schedule(static)
    for (std::int64_t i = 0; i < near; ++i) {
      const auto& [k, column] = near_[static_cast<std::size_t>(i)];
      const Ground g = ground(x[k]);
      const double r = own ? own[k] : 0.5 * diameter_;
      const double at = height_over(g, y[k]) + half * (v[k] * g.along_x - u[k] * g.along_y);
      const double speed = layers_[column].mean_speed(at - r, at + r);
      of(k, {speed * g.along_x, speed * g.along_y});
    }
  });
}

/// What the grains of a layer's cells pull by area, and how much more as the air gets faster.
void SandLayer::spread() {
  const PhaseParticles& p = w_->particles(grains_);
  const double *x = p.column(Field::position, 0), *y = p.column(Field::position, 1);
  const double *ax = p.column(Field::drag_acceleration, 0), *ay = p.column(Field::drag_acceleration, 1);
  const double* own = p.has(Field::radius) ? p.column(Field::radius) : nullptr;
  const auto each = [&](auto&& amount_of, auto&& sums_of) {
    for (auto& s : spreads_) s.clear();
    for (const auto& [k, column] : near_) {
      const Ground g = ground(x[k]);
      const double at = height_over(g, y[k]), r = own ? own[k] : 0.5 * diameter_, area = width_ / g.along_x;
      spreads_[column].add(layers_[column], at - r, at + r, p.mass_of(k) * amount_of(k, g) / area);
    }
    for (std::size_t c = 0; c < layers_.size(); ++c) spreads_[c].gather(layers_[c], sums_of(profile(c)));
  };
  each([&](std::size_t k, const Ground& g) { return ax[k] * g.along_x + ay[k] * g.along_y; },
       [](AirProfile& air) -> std::vector<double>& { return air.pull; });
  each([&](std::size_t k, const Ground&) { return rate_[k]; },
       [](AirProfile& air) -> std::vector<double>& { return air.rate; });
}

void SandLayer::columns(std::vector<std::string>& names) const {
  names.push_back(name_ + "_ground_stress [Pa]");
  names.push_back(name_ + "_bed_stress [Pa]");
}

/// Means over the ground: of the stress on top of the layers, and at the height of the bed.
void SandLayer::row(std::vector<double>& values) const {
  double top = 0.0, bed = 0.0;
  for (std::size_t c = 0; c < layers_.size(); ++c) {
    const AirProfile& p = profile(c);
    top += p.stress.back();
    bed += p.stress[layers_[c].cell_at(0.5 * diameter_)];
  }
  values.push_back(top / static_cast<double>(layers_.size()));
  values.push_back(bed / static_cast<double>(layers_.size()));
}

}  // namespace barchan
