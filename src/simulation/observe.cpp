// What a Simulation tells: frames, rows of history.csv, warnings.
#include <algorithm>
#include <cmath>

#include "simulation/wiring.hpp"

namespace barchan {

namespace {

/// Sum of f(k) in an order that only n decides.
template <class F>
double ordered_sum(std::size_t n, F&& f) {
  constexpr std::size_t block = 1024;
  double total = 0.0;
  for (std::size_t first = 0; first < n; first += block) {
    double part = 0.0;
    for (std::size_t k = first; k < std::min(first + block, n); ++k) part += f(k);
    total += part;
  }
  return total;
}

}  // namespace

std::uint64_t Simulation::pairs(const PlanEntry& e) const {
  std::uint64_t n = 0;
  if (e.forward >= 0) n += neighbours_.list(static_cast<std::size_t>(e.forward)).entries();
  if (e.backward >= 0) n += neighbours_.list(static_cast<std::size_t>(e.backward)).entries();
  return n;
}

std::size_t Simulation::bytes() const {
  std::size_t total = neighbours_.bytes();
  for (const auto& p : particles_) total += p.bytes();
  if (watch_) total += watch_->bytes();
  for (const auto* set : {&motion_, &extended_, &stress_})
    for (const auto& r : *set) total += r.bytes();
  return total;
}

Frame Simulation::frame(int index) const {
  Frame f;
  f.index = index;
  f.step = steps_;
  f.time = time_;
  for (std::size_t d = 0; d < static_cast<std::size_t>(plan_.dimensions); ++d) {
    f.domain[2 * d] = plan_.bounds.low[d];
    f.domain[2 * d + 1] = plan_.bounds.high[d];
  }
  std::size_t n = 0;
  std::vector<std::size_t> written;
  for (std::size_t k = 0; k < particles_.size(); ++k) {
    f.phase_names.push_back(particles_[k].name());
    f.phase_kinds.emplace_back(particles_[k].kind() == PhaseKind::fluid     ? "fluid"
                               : particles_[k].kind() == PhaseKind::elastic ? "elastic"
                               : particles_[k].kind() == PhaseKind::grains  ? "grains"
                                                                            : "wall");
    if (particles_[k].kind() == PhaseKind::wall && !scene_.output.walls) continue;
    written.push_back(k);
    n += particles_[k].size();
  }
  f.points.reserve(3 * n);
  f.id.reserve(n);
  f.phase.reserve(n);
  // Between two sorts a particle may be a little past a periodic side; what is written stands within it.
  const auto inside = [&](double x, int axis) {
    const auto d = static_cast<std::size_t>(axis);
    const double low = plan_.bounds.low[d], high = plan_.bounds.high[d];
    if (!plan_.bounds.periodic[d] || (x >= low && x < high)) return x;
    x -= (high - low) * std::floor((x - low) / (high - low));
    return x >= low && x < high ? x : low;
  };
  for (const std::size_t k : written) {
    const auto& p = particles_[k];
    for (std::size_t i = 0; i < p.size(); ++i) {
      for (int d = 0; d < 3; ++d)
        f.points.push_back(d < plan_.dimensions ? inside(p.column(Field::position, d)[i], d) : 0.0);
      f.id.push_back(p.id()[i]);
      f.phase.push_back(static_cast<std::int32_t>(k));
    }
  }
  const std::vector<Field> fields = frame_fields(scene_);
  for (const Field field : fields) {
    const FieldInfo& about = info(field);
    FrameField out;
    out.name = about.name;
    out.unit = about.unit;
    const int width = components(about.rank, plan_.dimensions);
    out.components = about.rank == Rank::scalar      ? 1
                     : about.rank == Rank::vector    ? 3
                     : about.rank == Rank::symmetric ? 6
                                                     : width;
    out.values.reserve(n * static_cast<std::size_t>(out.components));
    for (const std::size_t k : written) {
      const auto& p = particles_[k];
      for (std::size_t i = 0; i < p.size(); ++i)
        for (int c = 0; c < out.components; ++c) {
          double value = 0.0;
          if (field == Field::smoothing_length) value = plan_.phases[k].smoothing_length;
          else if (field == Field::density && !p.has(field)) value = scene_.phases[k].density;
          else if (p.has(field) && c < width) value = p.column(field, c)[i];
          out.values.push_back(value);
        }
    }
    f.fields.push_back(std::move(out));
  }
  return f;
}

std::vector<std::string> Simulation::history_columns(const Plan& plan) {
  std::vector<std::string> c{"time [s]",
                             "step",
                             "dt [s]",
                             "momentum_x [kg m/s]",
                             "momentum_y [kg m/s]",
                             "momentum_z [kg m/s]",
                             "largest_speed [m/s]",
                             "largest_density_error"};
  for (const auto& p : plan.phases) {
    if (p.kind == PhaseKind::wall) continue;
    c.push_back(p.name + "_kinetic_energy [J]");
    c.push_back(p.name + "_largest_speed [m/s]");
    c.push_back(p.name + "_mean_vx [m/s]");
    if (p.kind == PhaseKind::fluid) {
      c.push_back(p.name + "_mean_pressure [Pa]");
      c.push_back(p.name + "_density_error_rms");
      if (p.held) c.push_back(p.name + "_held_acceleration_x [m/s2]");
    }
  }
  return c;
}

std::vector<double> Simulation::history_row() const {
  std::vector<double> row{time_, static_cast<double>(steps_), dt_, 0, 0, 0, 0, 0};
  for (std::size_t k = 0; k < particles_.size(); ++k) {
    const auto& p = particles_[k];
    if (p.kind() == PhaseKind::wall) continue;
    const std::size_t n = p.size();
    std::array<const double*, 3> v{};
    for (int d = 0; d < plan_.dimensions; ++d) v[static_cast<std::size_t>(d)] = p.column(Field::velocity, d);
    double fastest = 0.0;
    const double square = ordered_sum(n, [&](std::size_t i) {
      double s = 0;
      for (int d = 0; d < plan_.dimensions; ++d)
        s += v[static_cast<std::size_t>(d)][i] * v[static_cast<std::size_t>(d)][i];
      fastest = std::max(fastest, s);
      return s;
    });
    std::array<double, 3> mean{};
    for (int d = 0; d < plan_.dimensions; ++d) {
      const auto c = static_cast<std::size_t>(d);
      const double total = ordered_sum(n, [&](std::size_t i) { return v[c][i]; });
      row[3 + c] += p.mass() * total;
      mean[c] = n > 0 ? total / static_cast<double>(n) : 0.0;
    }
    fastest = std::sqrt(fastest);
    row[6] = std::max(row[6], fastest);
    row.push_back(0.5 * p.mass() * square);
    row.push_back(fastest);
    row.push_back(mean[0]);
    if (p.kind() == PhaseKind::fluid) {
      const double* rho = p.column(Field::density);
      const double* pressure = p.column(Field::pressure);
      const double rho0 = scene_.phases[k].density;
      double worst = 0.0;
      const double squares = ordered_sum(n, [&](std::size_t i) {
        const double e = std::abs(rho[i] / rho0 - 1.0);
        worst = std::max(worst, e);
        return e * e;
      });
      row[7] = std::max(row[7], worst);
      row.push_back(n > 0 ? ordered_sum(n, [&](std::size_t i) { return pressure[i]; }) / static_cast<double>(n) : 0.0);
      row.push_back(n > 0 ? std::sqrt(squares / static_cast<double>(n)) : 0.0);
      if (plan_.phases[k].held)
        for (const auto& f : fluids_)
          if (f.phase == k) row.push_back(f.hold.acceleration[0]);
    }
  }
  return row;
}

Frame Simulation::good_frame(int index) {
  KeptState& good = watch_->good();
  const double time = time_;
  const long step = steps_;
  good.exchange(particles_);
  time_ = good.time();
  steps_ = good.step();
  Frame f = frame(index);
  good.exchange(particles_);
  time_ = time;
  steps_ = step;
  return f;
}

Warnings Simulation::warnings() const {
  Warnings all;
  watch_->report(all);
  return all;
}

}  // namespace barchan
