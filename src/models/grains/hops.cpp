#include "models/grains/hops.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <numbers>

#include "output/whole_file.hpp"

namespace barchan {

namespace {

constexpr double unexplained = 1e-6;  // of speed and step's change of it: more than rounding, less than any contact
constexpr double degrees = 180.0 / std::numbers::pi;

constexpr std::array<const char*, Hop::count> names{"length",       "apex",         "flight_time", "launch_speed",
                                                    "launch_angle", "impact_speed", "impact_angle"};
constexpr std::array<const char*, Hop::count> units{"m", "m", "s", "m/s", "degrees", "m/s", "degrees"};

double speed(const std::array<double, 3>& v) { return std::hypot(v[0], v[1], v[2]); }
double angle_above(const std::array<double, 3>& v) { return degrees * std::atan2(v[1], std::hypot(v[0], v[2])); }

}  // namespace

Hop hop_of(const Flight& flight, double time) {
  Hop hop;
  hop.number = {flight.way,
                flight.top - flight.low,
                time - flight.begun,
                speed(flight.launch_velocity),
                angle_above(flight.launch_velocity),
                speed(flight.velocity),
                -angle_above(flight.velocity)};
  return hop;
}

void HopMeans::add(const Hop& hop) {
  hops += 1.0;
  diameter += (hop.diameter - diameter) / hops;
  for (std::size_t n = 0; n < Hop::count; ++n) {
    const double before = hop.number[n] - mean[n];
    mean[n] += before / hops;
    square[n] += before * (hop.number[n] - mean[n]);
  }
}

double HopMeans::deviation(std::size_t number) const { return hops > 0.0 ? std::sqrt(square[number] / hops) : 0.0; }

HopStatistics::HopStatistics(const Scene& scene, const Layout& layout, const SaltationLayer& layer, std::size_t phase)
    : layer_(layer),
      phase_(phase),
      name_(layout.phases[phase].name),
      rise_(layer.flight * layout.phases[phase].diameter),
      period_(layout.bounds.periodic[0] ? layout.bounds.high[0] - layout.bounds.low[0] : 0.0) {
  const SphereSize size = *scene.phases[phase].diameter();
  // Thirds of the number of grains.
  bounds_ = {size.least()};
  for (int k = 1; k <= 3 && size.differ(); ++k) bounds_.push_back(size.mean * size.quantile(k / 3.0));
  means_.resize(std::max<std::size_t>(bounds_.size(), 1));
  landed_.reserve(256);
}

void HopStatistics::begin(State& state, const std::vector<ParticleBlock>&) {
  flights_ = state.phases[phase_].add_own<Flight>("hops." + layer_.name);
}

void HopStatistics::schedule(Schedule& s) {
  using enum Field;
  s.add({stage::grain_contacts,
         name_,
         {{name_, {position, velocity, acceleration, contact_acceleration, radius}, {}}},
         [this] { follow(); }});
}

/// A step of the contacts of all grains has ended: who flies on, who has landed, who begins to fly.
void HopStatistics::follow() {
  PhaseParticles& p = w_->particles(phase_);
  const double time = w_->state.time, dt = w_->state.dt;  // the step has moved grains; its time is to come
  Flight* flights = p.own(flights_);
  std::array<const double*, 3> x{}, v{}, a{}, pushed{};
  const auto dimensions = static_cast<std::size_t>(p.dimensions());
  for (std::size_t d = 0; d < dimensions; ++d) {
    x[d] = p.column(Field::position, static_cast<int>(d));
    v[d] = p.column(Field::velocity, static_cast<int>(d));
    a[d] = p.column(Field::acceleration, static_cast<int>(d));
    pushed[d] = p.column(Field::contact_acceleration, static_cast<int>(d));
  }
  landed_.clear();
  for (std::size_t k = 0; k < p.size(); ++k) {
    Flight& f = flights[k];
    bool touches = false, touched = false;
    std::array<double, 3> velocity{};
    for (std::size_t d = 0; d < dimensions; ++d) {
      velocity[d] = v[d][k];
      touches = touches || pushed[d][k] != 0.0;
      const double by_contact = velocity[d] - f.velocity[d] - dt * a[d][k];
      touched = touched || std::abs(by_contact) > unexplained * (std::abs(velocity[d]) + std::abs(dt * a[d][k]));
    }
    touched = f.followed == 1 && (touched || touches);
    if (f.flies == 1 && touched) {
      if (f.top - f.low >= rise_ && time >= layer_.start) {
        landed_.push_back(hop_of(f, time));
        landed_.back().diameter = 2.0 * (p.has(Field::radius) ? p.column(Field::radius)[k] : p.mean_radius());
        landed_.back().id = p.id()[k];
      }
      f.flies = 0;
    }
    double go = x[0][k] - f.place[0];
    if (period_ > 0.0) go -= period_ * std::round(go / period_);
    f.place = {x[0][k], x[1][k]};
    f.velocity = velocity;
    if (f.flies == 1) {
      f.way += go;
      f.top = std::max(f.top, x[1][k]);
    } else if ((touched || f.touches == 1) && !touches) {
      f.flies = 1;
      f.launch_velocity = velocity;
      f.begun = time + dt;
      f.low = f.top = x[1][k];
      f.way = 0.0;
    }
    f.touches = touches ? 1 : 0;
    f.followed = 1;
  }
  count_landed();
}

/// By id: sums must not depend on how grains stand in memory.
void HopStatistics::count_landed() {
  std::sort(landed_.begin(), landed_.end(), [](const Hop& a, const Hop& b) { return a.id < b.id; });
  for (const Hop& hop : landed_) {
    means_[0].add(hop);
    if (bounds_.size() < 2) continue;
    const auto above = std::upper_bound(bounds_.begin() + 1, bounds_.end() - 1, hop.diameter) - bounds_.begin();
    means_[static_cast<std::size_t>(above)].add(hop);
  }
}

void HopStatistics::archive(Archive& a) { a.array("hops of " + layer_.name, means_); }

void HopStatistics::write(const std::string& folder, double time) const {
  std::string text = "time [s],diameter_low [m],diameter_high [m],hops,diameter_mean [m]";
  for (std::size_t n = 0; n < Hop::count; ++n)
    for (const char* what : {"_mean [", "_std ["}) text += std::string(",") + names[n] + what + units[n] + "]";
  text += '\n';
  char number[32];
  const auto put = [&](double value, const char* before = ",") {
    std::snprintf(number, sizeof number, "%s%.9g", before, value);
    text += number;
  };
  for (std::size_t row = 0; row < means_.size(); ++row) {
    const HopMeans& m = means_[row];
    const double none = std::nan("");
    put(time, "");
    put(row > 0 ? bounds_[row - 1] : bounds_.front());
    put(row > 0 ? bounds_[row] : bounds_.back());
    put(m.hops);
    put(m.hops > 0.0 ? m.diameter : none);
    for (std::size_t n = 0; n < Hop::count; ++n) {
      put(m.hops > 0.0 ? m.mean[n] : none);
      put(m.hops > 0.0 ? m.deviation(n) : none);
    }
    text += '\n';
  }
  write_whole_file(std::filesystem::path(folder) / ("hops_" + layer_.name + ".csv"), text);
}

void add_hop_statistics(const Scene& scene, const Layout& layout, Models& models) {
  for (const SaltationLayer& layer : scene.measuring.saltation)
    for (std::size_t k = 0; k < layout.phases.size(); ++k)
      if (layout.phases[k].name == layer.phase && layout.phases[k].own_steps())
        models.push_back(std::make_unique<HopStatistics>(scene, layout, layer, k));
}

}  // namespace barchan
