// What the grains of a layer feel: who is in it, the drag, the lift, and the sums by height that the air gets.
#include <algorithm>
#include <cmath>

#include "laws/drag_coefficients.hpp"
#include "laws/kept_drag.hpp"
#include "models/coupling/sand_layer.hpp"

namespace barchan {

/// Which grains are in the layers and which over them.
void SandLayer::find_near() {
  PhaseParticles& p = w_->particles(grains_);
  const double *x = p.column(Field::position, 0), *y = p.column(Field::position, 1);
  const double *u = p.column(Field::velocity, 0), *v = p.column(Field::velocity, 1);
  const double* own = p.has(Field::radius) ? p.column(Field::radius) : nullptr;
  const double half = 0.5 * hold_;
  near_.clear();
  flying_.clear();
  rate_.resize(p.size());
  std::uint8_t* keeps = may_rest_ ? p.own(keeps_) : nullptr;
  for (std::size_t k = 0; k < p.size(); ++k) {
    if (keeps && !all_due_ && keeps[k]) continue;
    const bool rests = keeps && all_due_ && u[k] == 0.0 && v[k] == 0.0;
    if (keeps) keeps[k] = rests;
    const Ground g = ground(x[k]);
    const double height = (y[k] - g.height) * g.along_x + half * (v[k] * g.along_x - u[k] * g.along_y);
    if (height >= top_) {
      if (keeps) keeps[k] = 0;
      flying_.push_back(k);
    } else if (height > -deep * diameter_) {
      near_.push_back({k, between(x[k]), height, own ? own[k] : 0.5 * diameter_, 0.0, 0.0, 0.0, g, rests});
    } else {
      p.column(Field::drag_acceleration, 0)[k] = p.column(Field::drag_acceleration, 1)[k] = rate_[k] = 0.0;
    }
  }
}

/// The wind (m/s) that a grain at x feels where its mean is `wind`.
double SandLayer::felt(double x, double wind) const {
  if (!gusts_) return wind;
  const double most = gusts_->largest_gusty_speed();
  return wind + gusts_->at(x) * std::clamp(wind, -most, most);
}

/// Lift (m/s2) across the ground on a grain of speed `along` the ground that feels the wind `blows`, whose drag by
/// difference of speed is `rate`.
double SandLayer::lift(const Near& q, double blows, double along, double rate) const {
  const double shear =
      wind_about(q.place, q.height, q.height + q.radius) - wind_about(q.place, q.height - q.radius, q.height);
  const double gain = q.wind != 0.0 ? blows / q.wind : 1.0, difference = blows - along;
  return lift_ * rate * gain * shear * difference / std::max({std::abs(difference), std::abs(blows), 1e-300});
}

void SandLayer::feel() {
  find_near();
  if (gusts_) gusts_->blow(w_->state.time + 0.5 * hold_);
  PhaseParticles& p = w_->particles(grains_);
  const double *x = p.column(Field::position, 0), *y = p.column(Field::position, 1);
  const double *u = p.column(Field::velocity, 0), *v = p.column(Field::velocity, 1);
  const double* own = p.has(Field::radius) ? p.column(Field::radius) : nullptr;
  double *ax = p.column(Field::drag_acceleration, 0), *ay = p.column(Field::drag_acceleration, 1);
  const double solid = scene_.phases[grains_].density, half = 0.5 * hold_;
  const double weight = layout_.phases[grains_].weight_share;
  const std::array<double, 2> gravity{weight * scene_.domain.gravity[0], weight * scene_.domain.gravity[1]};
  with_drag_law(law_, [&](auto law) {
    const auto excess = [](double re) { return decltype(law)::excess(re); };
    const auto of = [&](std::size_t k, const std::array<double, 2>& wind) {
      const double d = own ? 2.0 * own[k] : diameter_, stokes = 18.0 * density_ * viscosity_ / (solid * d * d);
      const auto kept = kept_drag<2>(wind, {u[k], v[k]}, gravity, stokes, d / viscosity_, excess, hold_);
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
      Near& q = near_[static_cast<std::size_t>(i)];
      q.wind = wind_about(q.place, q.height - q.radius, q.height + q.radius);
      const Ground& g = q.ground;
      of(q.grain, {q.wind * g.along_x, q.wind * g.along_y});
      q.pull = ax[q.grain] * g.along_x + ay[q.grain] * g.along_y;
      const double blows = felt(x[q.grain], q.wind), mean_rate = rate_[q.grain];
      if (gusts_) of(q.grain, {blows * g.along_x, blows * g.along_y});
      const double rate = rate_[q.grain];
      rate_[q.grain] = mean_rate;  // of the layer
      if (!(lift_ > 0.0)) continue;
      const double up = lift(q, blows, u[q.grain] * g.along_x + v[q.grain] * g.along_y, rate);
      ax[q.grain] -= up * g.along_y;
      ay[q.grain] += up * g.along_x;
    }
  });
}

/// The drag of the grains in a layer's cells by area, and its derivative by the speed of the air.
void SandLayer::spread() {
  if (!may_rest_) return spread(false, loads_);
  if (all_due_) spread(true, rest_loads_);
  spread(false, loads_);
  for (std::size_t c = 0; c < layers_.size(); ++c)
    for (std::size_t k = 0; k < loads_[c].pull.size(); ++k) {
      loads_[c].pull[k] += rest_loads_[c].pull[k];
      if (all_due_) loads_[c].rate[k] += rest_loads_[c].rate[k];
      else rest_loads_[c].rate[k] = 0.0;
    }
}

/// That of the grains that rest, or of the others.
void SandLayer::spread(bool resting, std::vector<AirColumn::Load>& loads) {
  const PhaseParticles& p = w_->particles(grains_);
  const auto each = [&](auto&& amount_of, auto&& sums_of) {
    for (auto& s : spreads_) s.clear();
    for (const Near& q : near_) {
      if (q.rests != resting) continue;
      const double amount = p.mass_of(q.grain) * amount_of(q) * q.ground.along_x / width_;
      const double low = q.height - q.radius, high = q.height + q.radius;
      const Between& b = q.place;
      spreads_[b.left].add(layers_[b.left], low, high, (1.0 - b.share) * amount);
      spreads_[b.right].add(layers_[b.right], low, high, b.share * amount);
    }
    for (std::size_t c = 0; c < layers_.size(); ++c) spreads_[c].gather(layers_[c], sums_of(loads[c]));
  };
  each([](const Near& q) { return q.pull; }, [](AirColumn::Load& load) -> std::vector<double>& { return load.pull; });
  each([&](const Near& q) { return rate_[q.grain]; },
       [](AirColumn::Load& load) -> std::vector<double>& { return load.rate; });
}

/// After the layers went on: what those that rest took is what they take until the next exchange of all.
void SandLayer::keep_rest() {
  for (std::size_t c = 0; c < layers_.size(); ++c)
    for (std::size_t k = 0; k < rest_loads_[c].pull.size(); ++k)
      rest_loads_[c].pull[k] += rest_loads_[c].rate[k] * (profile(c).speed[k] - speed_before_[c][k]);
}

}  // namespace barchan
