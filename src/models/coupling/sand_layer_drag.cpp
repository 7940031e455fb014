// What the grains of a layer feel: who is in it, the drag, the lift, and the sums by height that the air gets.
#include <omp.h>

#include <algorithm>
#include <cmath>

#include "laws/drag_coefficients.hpp"
#include "laws/kept_drag.hpp"
#include "laws/turning_sphere.hpp"
#include "models/coupling/sand_layer.hpp"

namespace barchan {

/// Which grains are in the layers and which over them.
void SandLayer::find_near() {
  PhaseParticles& p = w_->particles(grains_);
  const double *x = p.column(Field::position, 0), *y = p.column(Field::position, 1);
  const double *u = p.column(Field::velocity, 0), *v = p.column(Field::velocity, 1);
  const double* own = p.has(Field::radius) ? p.column(Field::radius) : nullptr;
  double *ax = p.column(Field::drag_acceleration, 0), *ay = p.column(Field::drag_acceleration, 1);
  const bool flat = layout_.dimensions == 2;
  const double* z = flat ? nullptr : p.column(Field::position, 2);
  const double* w = flat ? nullptr : p.column(Field::velocity, 2);
  double* az = flat ? nullptr : p.column(Field::drag_acceleration, 2);
  const double half = 0.5 * hold_;
  rate_.resize(p.size());
  places_.resize(p.size());
  std::uint8_t* keeps = may_rest_ ? p.own(keeps_) : nullptr;
  const auto n = static_cast<std::int64_t>(p.size());
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < n; ++i) {
    const auto k = static_cast<std::size_t>(i);
    Place& at = places_[k];
    at.where = Place::unasked;
    if (keeps && !all_due_ && keeps[k]) continue;
    at.rests = keeps && all_due_ && u[k] == 0.0 && v[k] == 0.0 && (!w || w[k] == 0.0);
    at.ground = ground(x[k]);
    const Ground& g = at.ground;
    at.height = (y[k] - g.height) * g.along_x + half * (v[k] * g.along_x - u[k] * g.along_y);
    at.where = at.height >= top_ ? Place::over : at.height > -deep * diameter_ ? Place::in : Place::under;
    if (keeps) keeps[k] = at.rests && at.where != Place::over;
    if (at.where == Place::under) ax[k] = ay[k] = rate_[k] = 0.0;
    if (az && at.where == Place::under) az[k] = 0.0;
  }
  near_.clear();
  flying_.clear();
  for (std::size_t k = 0; k < p.size(); ++k) {
    const Place& at = places_[k];
    if (at.where == Place::over) flying_.push_back(k);
    if (at.where == Place::in)
      near_.push_back({k, between(x[k], z ? z[k] : 0.0), at.height, own ? own[k] : 0.5 * diameter_, 0.0, 0.0, 0.0,
                       at.ground, at.rests});
  }
}

/// The wind (m/s) that a grain at x feels where its mean is `wind`.
double SandLayer::felt(double x, double wind) const { return gusts_ ? gusts_->felt(x, wind) : wind; }

/// Lift (m/s2) across the ground on a grain of speed `along` the ground that feels the wind `blows`, whose drag by
/// difference of speed is `rate`.
double SandLayer::lift(const Near& q, double blows, double along, double rate) const {
  const double shear =
      wind_about(q.place, q.height, q.height + q.radius) - wind_about(q.place, q.height - q.radius, q.height);
  const double gain = q.wind != 0.0 ? blows / q.wind : 1.0, difference = blows - along;
  return lift_ * rate * gain * shear * difference / std::max({std::abs(difference), std::abs(blows), 1e-300});
}

template <std::size_t Dim>
void SandLayer::feel() {
  find_near();
  if (gusts_) gusts_->blow(w_->state.time + 0.5 * hold_);
  PhaseParticles& p = w_->particles(grains_);
  const double *x = p.column(Field::position, 0), *y = p.column(Field::position, 1);
  const double *u = p.column(Field::velocity, 0), *v = p.column(Field::velocity, 1);
  const double* own = p.has(Field::radius) ? p.column(Field::radius) : nullptr;
  double *ax = p.column(Field::drag_acceleration, 0), *ay = p.column(Field::drag_acceleration, 1);
  const double* z = Dim == 2 ? nullptr : p.column(Field::position, 2);
  const double* w = Dim == 2 ? nullptr : p.column(Field::velocity, 2);
  double* az = Dim == 2 ? nullptr : p.column(Field::drag_acceleration, 2);
  std::array<double*, spins(Dim)> spin{};
  if (magnus_) spin = spin_columns<Dim>(p, Field::angular_velocity);
  const double solid = scene_.phases[grains_].density, half = 0.5 * hold_;
  const double weight = layout_.phases[grains_].weight_share;
  std::array<double, Dim> gravity{};
  for (std::size_t c = 0; c < Dim; ++c) gravity[c] = weight * scene_.domain.gravity[c];
  with_drag_law(law_, [&](auto law) {
    const auto excess = [](double re) { return decltype(law)::excess(re); };
    const auto of = [&](std::size_t k, const Vec3& wind) {
      std::array<double, Dim> blown{}, moves{};
      for (std::size_t c = 0; c < Dim; ++c) {
        blown[c] = wind[c];
        moves[c] = c == 0 ? u[k] : c == 1 ? v[k] : w[k];
      }
      const double d = own ? 2.0 * own[k] : diameter_, stokes = 18.0 * density_ * viscosity_ / (solid * d * d);
      const auto kept = kept_drag<Dim>(blown, moves, gravity, stokes, d / viscosity_, excess, hold_);
      ax[k] = kept.drag[0];
      ay[k] = kept.drag[1];
      if constexpr (Dim == 3) az[k] = kept.drag[2];
      rate_[k] = kept.rate;
    };
    // The acceleration of a grain that turns in a wind with a rotation (1/s) about z.
    const auto turn = [&](std::size_t k, const Vec3& wind, double rotation) {
      std::array<double, Dim> through{};
      bool moves = false;
      for (std::size_t c = 0; c < Dim; ++c) {
        const double own_speed = c == 0 ? u[k] : c == 1 ? v[k] : w[k];
        through[c] = own_speed - wind[c];
        moves = moves || own_speed != 0.0;
      }
      if (!moves) return std::array<double, Dim>{};
      std::array<double, spins(Dim)> turns{};
      for (std::size_t c = 0; c < turns.size(); ++c) turns[c] = spin[c][k];
      const TurningSphere sphere{density_ / solid, viscosity_, own ? 2.0 * own[k] : diameter_, rotation};
      const auto pushed = sphere.turn<Dim>(turns, through, hold_);
      for (std::size_t c = 0; c < turns.size(); ++c) spin[c][k] = turns[c];
      return pushed;
    };
    const auto flying = static_cast<std::int64_t>(flying_.size()), near = static_cast<std::int64_t>(near_.size());
#pragma omp parallel for schedule(static)
    for (std::int64_t i = 0; i < flying; ++i) {
      const std::size_t k = flying_[static_cast<std::size_t>(i)];
      const Vec3 wind = grid_.velocity({x[k] + half * u[k], y[k] + half * v[k], Dim == 2 ? 0.0 : z[k] + half * w[k]});
      of(k, wind);
      if (!magnus_) continue;
      const auto pushed = turn(k, wind, 0.0);  // the wind's own rotation is small there
      ax[k] += pushed[0];
      ay[k] += pushed[1];
      if constexpr (Dim == 3) az[k] += pushed[2];
    }
#pragma omp parallel for schedule(static)
    for (std::int64_t i = 0; i < near; ++i) {
      Near& q = near_[static_cast<std::size_t>(i)];
      q.wind = wind_about(q.place, q.height - q.radius, q.height + q.radius);
      const Ground& g = q.ground;
      of(q.grain, {q.wind * g.along_x, q.wind * g.along_y, 0.0});
      q.pull = ax[q.grain] * g.along_x + ay[q.grain] * g.along_y;
      const double blows = felt(x[q.grain], q.wind), mean_rate = rate_[q.grain];
      if (gusts_) of(q.grain, {blows * g.along_x, blows * g.along_y, 0.0});
      const double rate = rate_[q.grain];
      rate_[q.grain] = mean_rate;  // of the layer
      if (magnus_) {
        const double difference =
            wind_about(q.place, q.height - q.radius, q.height) - wind_about(q.place, q.height, q.height + q.radius);
        const auto pushed = turn(q.grain, {blows * g.along_x, blows * g.along_y, 0.0}, 0.5 * difference / q.radius);
        ax[q.grain] += pushed[0];
        ay[q.grain] += pushed[1];
        if constexpr (Dim == 3) az[q.grain] += pushed[2];
        q.pull += pushed[0] * g.along_x + pushed[1] * g.along_y;
      }
      if (!(lift_ > 0.0)) continue;
      const double up = lift(q, blows, u[q.grain] * g.along_x + v[q.grain] * g.along_y, rate);
      ax[q.grain] -= up * g.along_y;
      ay[q.grain] += up * g.along_x;
    }
  });
}

template void SandLayer::feel<2>();
template void SandLayer::feel<3>();

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

/// That of the grains that rest, or of the others. Each thread has columns side by side, and adds to a column in the
/// order of the grains.
void SandLayer::spread(bool resting, std::vector<AirColumn::Load>& loads) {
  const PhaseParticles& p = w_->particles(grains_);
#pragma omp parallel
  {
    const auto threads = static_cast<std::size_t>(omp_get_num_threads()),
               own = static_cast<std::size_t>(omp_get_thread_num());
    const std::size_t first = layers_.size() * own / threads, end = layers_.size() * (own + 1) / threads;
    for (std::size_t c = first; c < end; ++c) {
      pulls_[c].clear();
      rates_[c].clear();
    }
    for (const Near& q : near_) {
      const Between& b = q.place;
      const auto here = [&](std::size_t c) { return c >= first && c < end; };
      if (q.rests != resting) continue;
      if (!here(b.left) && !here(b.right) && (b.share_up < 0.0 || (!here(b.left + b.up) && !here(b.right + b.up))))
        continue;
      const double mass = p.mass_of(q.grain), along = q.ground.along_x;
      const double pull = mass * q.pull * along / area_, rate = mass * rate_[q.grain] * along / area_;
      const double low = q.height - q.radius, high = q.height + q.radius;
      each(b, [&](std::size_t c, double share) {
        if (!here(c)) return;
        pulls_[c].add(layers_[c], low, high, share * pull);
        rates_[c].add(layers_[c], low, high, share * rate);
      });
    }
    for (std::size_t c = first; c < end; ++c) {
      pulls_[c].gather(layers_[c], loads[c].pull);
      rates_[c].gather(layers_[c], loads[c].rate);
    }
  }
}

/// After the layers went on: what those that rest took is what they take until the next exchange of all.
void SandLayer::keep_rest() {
  for (std::size_t c = 0; c < layers_.size(); ++c)
    for (std::size_t k = 0; k < rest_loads_[c].pull.size(); ++k)
      rest_loads_[c].pull[k] += rest_loads_[c].rate[k] * (profile(c).speed[k] - speed_before_[c][k]);
}

}  // namespace barchan
