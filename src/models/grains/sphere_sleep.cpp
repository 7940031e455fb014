#include "models/grains/sphere_sleep.hpp"
#include "engine/exchange.hpp"

#include <algorithm>
#include <cmath>

namespace barchan {

namespace {

constexpr double nowhere = 1e300;  // m: of a sphere that nobody has looked at; it goes far until the next look

}  // namespace

void SphereSleep::prepare(std::vector<Part> parts, const Layout& layout, double gravity) {
  parts_ = std::move(parts);
  if (parts_.empty()) return;
  layout_ = &layout;
  gravity_ = gravity;
  dimensions_ = static_cast<std::size_t>(layout.dimensions);
  numbers_ = dimensions_ == 2 ? 3 : 6;
  double least = 1e300;
  for (const Part& part : parts_) least = std::min(least, part.diameter);
  interval_ = apart * std::sqrt(least / gravity);
  lag_ = most_speed / unrest * std::sqrt(least / gravity);
  for (std::size_t d = 0; d < 3; ++d)
    period_[d] = layout.bounds.periodic[d] ? layout.bounds.high[d] - layout.bounds.low[d] : 0.0;
}

void SphereSleep::make_room(std::vector<Part> parts, std::size_t moving, std::size_t all) {
  if (!on()) return;
  parts_ = std::move(parts);
  moving_ = moving;
  for (auto* bytes : {&asleep_, &calm_, &wakes_, &changed_, &fresh_}) bytes->resize(moving, 0);
  for (auto* vectors : {&place_, &pull_}) vectors->resize(moving * dimensions_, nowhere);
  for (auto* forces : {&offset_, &unrest_}) forces->resize(moving * numbers_, 0.0);
  at_.assign(all + 2, 1);
  changed_at_.assign(all + 2, 0);
}

void SphereSleep::keep_awake(std::size_t first, std::size_t count) {
  if (on()) std::fill_n(at_.begin() + static_cast<std::ptrdiff_t>(first), count, std::uint8_t{0});
}

void SphereSleep::renumber(const std::vector<std::uint32_t>& to, std::size_t moving) {
  if (!on()) return;
  const auto move = [&](auto& values, std::size_t each, auto of_new) {
    auto before = std::move(values);
    values.assign(moving * each, of_new);
    for (std::size_t n = 0; n < moving_; ++n)
      for (std::size_t q = 0; to[n] != ContactMemory::gone && q < each; ++q)
        values[to[n] * each + q] = before[n * each + q];
  };
  for (auto* bytes : {&asleep_, &calm_, &wakes_, &changed_, &fresh_}) move(*bytes, 1, std::uint8_t{0});
  for (auto* vectors : {&place_, &pull_}) move(*vectors, dimensions_, nowhere);
  for (auto* forces : {&offset_, &unrest_}) move(*forces, numbers_, 0.0);
  moving_ = moving;
  sleeping_ = static_cast<std::size_t>(std::count(asleep_.begin(), asleep_.end(), std::uint8_t{1}));
}

void SphereSleep::wake(const std::vector<std::uint32_t>& numbers) {
  for (const std::uint32_t n : numbers) {
    if (on() && n < moving_) rouse(n);
  }
}

void SphereSleep::rouse(std::uint32_t n) {
  changed_[n] = changed_[n] | asleep_[n];
  sleeping_ -= asleep_[n];
  asleep_[n] = calm_[n] = 0;
}

/// Wakes those whose acceleration by all but contacts is another than when they fell asleep.
bool SphereSleep::pushed(Workspace& w, const std::uint32_t* numbers) {
  const double most2 = std::pow(push * gravity_, 2);
  const std::size_t slept = sleeping_;
  for (const Part& part : parts_) {
    const PhaseParticles& p = w.particles(part.phase);
    for (std::size_t k = 0; k < part.count; ++k) {
      const std::uint32_t n = numbers[part.first + k];
      if (!asleep_[n]) continue;
      double change2 = 0.0;
      each_axis([&](std::size_t d) {
        change2 += std::pow(p.column(Field::acceleration, static_cast<int>(d))[k] - pull_[n * dimensions_ + d], 2);
      });
      if (change2 <= most2) continue;
      rouse(n);
    }
  }
  return sleeping_ != slept;
}

bool SphereSleep::look(Workspace& w, const std::uint32_t* numbers, double& lost) {
  bool changed = sleeping_ > 0 && pushed(w, numbers);
  fell_ = false;
  if (w.state.time < next_) return changed;
  const bool first = next_ == 0.0;
  next_ = w.state.time + interval_;
  for (const Part& part : parts_) {
    PhaseParticles& p = w.particles(part.phase);
    const double way2 = std::pow(most_way * part.diameter, 2),
                 speed2 = most_speed * most_speed * gravity_ * part.diameter, pull2 = std::pow(push * gravity_, 2);
    const double* radius = p.has(Field::radius) ? p.column(Field::radius) : nullptr;
    const int spins = p.has(Field::angular_velocity) ? p.components(Field::angular_velocity) : 0;
    for (std::size_t k = 0; k < part.count; ++k) {
      const std::uint32_t n = numbers[part.first + k];
      if (asleep_[n]) continue;
      const double r = radius ? radius[k] : 0.5 * part.diameter;
      double gone2 = 0.0, change2 = 0.0, v2 = 0.0, spin2 = 0.0;
      each_axis([&](std::size_t d) {
        const int axis = static_cast<int>(d);
        const double x = p.column(Field::position, axis)[k], a = p.column(Field::acceleration, axis)[k];
        double &place = place_[n * dimensions_ + d], &pull = pull_[n * dimensions_ + d];
        double way = x - place;
        if (period_[d] > 0.0) way -= period_[d] * std::round(way / period_[d]);
        gone2 += way * way;
        change2 += (a - pull) * (a - pull);
        v2 += std::pow(p.column(Field::velocity, axis)[k], 2);
        place = x;
        pull = a;
      });
      for (int d = 0; d < spins; ++d) spin2 += std::pow(r * p.column(Field::angular_velocity, d)[k], 2);
      const bool calm = !first && gone2 < way2 && v2 < speed2 && spin2 < speed2 && change2 < pull2;
      calm_[n] = calm ? static_cast<std::uint8_t>(calm_[n] + 1) : std::uint8_t{0};
      if (calm_[n] < looks) continue;
      asleep_[n] = changed_[n] = 1;
      changed = fell_ = true;
      ++sleeping_;
      lost += 0.5 * p.mass_of(k) * layout_->slab * (v2 + 0.4 * spin2);
      each_axis([&](std::size_t d) {
        p.column(Field::velocity, static_cast<int>(d))[k] = 0.0;
        p.column(Field::contact_acceleration, static_cast<int>(d))[k] = -pull_[n * dimensions_ + d];
      });
      for (int d = 0; d < spins; ++d)
        p.column(Field::angular_velocity, d)[k] = p.column(Field::angular_acceleration, d)[k] = 0.0;
      std::fill_n(unrest_.begin() + static_cast<std::ptrdiff_t>(n * numbers_), numbers_, 0.0);
    }
  }
  return changed;
}

std::span<const std::uint32_t> SphereSleep::wake(std::span<const SphereChunk> chunks, const std::uint32_t* numbers,
                                                 bool shared) {
  woken_.clear();
  for (const SphereChunk& chunk : chunks) {
    if (!chunk.wakes) continue;
    for (const std::uint32_t k : chunk.border) {
      if (!wakes_[numbers[k]]) continue;
      wakes_[numbers[k]] = 0;
      woken_.push_back(k);
    }
  }
  if (shared) Exchange().join(woken_);
  for (const std::uint32_t k : woken_) rouse(numbers[k]);
  return woken_;
}

void SphereSleep::share(const SphereShares& shares, const std::uint32_t* numbers) {
  if (!on() || !shares.on()) return;
  const std::vector<std::size_t> counts = shares.spheres_of_ranks(0, moving_);
  std::vector<double> forces(moving_ * 2 * numbers_);
  std::vector<std::uint8_t> fresh(moving_);
  for (std::size_t k = shares.begin(); k < shares.end(); ++k) {
    double* const to = forces.data() + k * 2 * numbers_;
    std::copy_n(offset_.data() + numbers[k] * numbers_, numbers_, to);
    std::copy_n(unrest_.data() + numbers[k] * numbers_, numbers_, to + numbers_);
    fresh[k] = fresh_[numbers[k]];
  }
  Exchange().gather_in_place(forces.data(), counts, 2 * numbers_ * sizeof(double));
  Exchange().gather_in_place(fresh.data(), counts, 1);
  for (std::size_t k = 0; k < moving_; ++k) {
    const double* const from = forces.data() + k * 2 * numbers_;
    std::copy_n(from, numbers_, offset_.data() + numbers[k] * numbers_);
    std::copy_n(from + numbers_, numbers_, unrest_.data() + numbers[k] * numbers_);
    fresh_[numbers[k]] = fresh[k];
  }
}

void SphereSleep::mark_woken() {
  std::fill(changed_at_.begin(), changed_at_.end(), std::uint8_t{0});
  for (const std::uint32_t k : woken_) {
    at_[k] = 0;
    changed_at_[k] = 1;
  }
}

void SphereSleep::mark(const std::uint32_t* numbers) {
  const auto n = static_cast<std::int64_t>(moving_);
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < n; ++i) {
    const auto k = static_cast<std::size_t>(i);
    at_[k] = asleep_[numbers[k]];
    changed_at_[k] = changed_[numbers[k]];
  }
}

/// What is out of balance is carried on when other neighbours are awake.
void SphereSleep::keep_balance(std::uint32_t n) {
  fresh_[n] = 1;
  for (std::size_t d = n * numbers_; d < (n + 1) * numbers_; ++d) offset_[d] = unrest_[d];
}

void SphereSleep::settled() { std::fill(changed_.begin(), changed_.end(), std::uint8_t{0}); }

const SleepStep* SphereSleep::step(const std::uint32_t* numbers) {
  if (sleeping_ == 0) return nullptr;
  step_ = {at_.data(), numbers, offset_.data(), unrest_.data(), wakes_.data(), fresh_.data(), unrest * gravity_, lag_};
  return &step_;
}

void SphereSleep::archive(Archive& a) {
  if (!on()) return;
  a.number("next look at sleepers", next_);
  a.number("sleepers", sleeping_);
  a.array("asleep", asleep_);
  a.array("calm", calm_);
  a.array("fell asleep or woke", changed_);
  a.array("beside such", fresh_);
  a.array("places of the last look", place_);
  a.array("accelerations of the last look", pull_);
  a.array("balance of sleepers", offset_);
  a.array("unrest of sleepers", unrest_);
}

}  // namespace barchan
