#include "measure/measurements.hpp"
#include "engine/exchange.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

namespace barchan {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// Adds wall time to a sum until it goes.
class Stopwatch {
 public:
  explicit Stopwatch(double& seconds) : seconds_(seconds), start_(Clock::now()) {}
  ~Stopwatch() { seconds_ += std::chrono::duration<double>(Clock::now() - start_).count(); }
  Stopwatch(const Stopwatch&) = delete;
  Stopwatch& operator=(const Stopwatch&) = delete;

 private:
  using Clock = std::chrono::steady_clock;
  double& seconds_;
  Clock::time_point start_;
};

Vec3 wall_velocity(const PhaseParticles& wall) {
  Vec3 v{};
  for (int d = 0; d < wall.dimensions(); ++d) v[static_cast<std::size_t>(d)] = wall.column(Field::velocity, d)[0];
  return v;
}

/// A row's averages. Those of slices belong to the row's place: along the axis, the line of least squares through the
/// samples of the slice is followed there, and fluctuations are about that line, not about the mean. So a gradient
/// within a slice neither shifts its mean nor counts as a fluctuation.
class Statistics {
 public:
  Statistics(const Average& average, bool has_distance, double width)
      : average_(average), offset_(has_distance ? 1 : 0) {
    if (!has_distance) return;
    const double spread = average.covariance(0, 0);
    if (spread > 0.01 * width * width) inverse_spread_ = 1.0 / spread;  // a flat row of particles has no slope
  }
  bool any() const { return average_.count() > 0; }
  double mean(std::size_t q) const {
    const double at_mean = average_.mean(q + offset_);
    return offset_ == 0 ? at_mean : at_mean - with_distance(q) * inverse_spread_ * average_.mean(0);
  }
  double covariance(std::size_t p, std::size_t q) const {
    const double whole = average_.covariance(p + offset_, q + offset_);
    return offset_ == 0 ? whole : whole - with_distance(p) * with_distance(q) * inverse_spread_;
  }
  double rms(std::size_t q) const { return std::sqrt(std::max(covariance(q, q), 0.0)); }

 private:
  double with_distance(std::size_t q) const { return average_.covariance(0, q + offset_); }

  const Average& average_;
  std::size_t offset_;
  double inverse_spread_ = 0.0;
};

double slice_width(const Instrument& i) {
  return (i.high[i.axis] - i.low[i.axis]) / static_cast<double>(i.rows.size());
}

/// The height (m) where the fluid of a gauge's points ends: the lowest place at which the covered part of the kernel
/// falls through half of its largest value. By the largest, since at a wall and in a thin layer the kernel is never
/// full.
Reading surface_over(const Instrument& gauge, const std::vector<Reading>& column) {
  Reading surface;
  for (const Reading& r : column) surface.fraction = std::max(surface.fraction, r.fraction);
  if (!(surface.fraction >= least_fraction)) return surface;
  const double half = 0.5 * surface.fraction;
  std::size_t p = 0;
  while (column[p].fraction < half) ++p;
  while (p + 1 < column.size() && column[p + 1].fraction >= half) ++p;
  const double height = gauge.points[p][gauge.axis];
  surface.found = true;
  surface.value[0] = height;
  if (p + 1 < column.size())
    surface.value[0] += (gauge.points[p + 1][gauge.axis] - height) * (column[p].fraction - half) /
                        (column[p].fraction - column[p + 1].fraction);
  return surface;
}

}  // namespace

Measurements::Measurements(std::vector<Instrument> instruments, const Bounds& bounds, std::vector<double> densities)
    : instruments_(std::move(instruments)), bounds_(bounds), densities_(std::move(densities)) {
  Place place;
  for (const Instrument& i : instruments_) {
    places_.push_back(place);
    const std::size_t q = i.quantities();
    place.row += i.rows.size();
    place.mean += i.rows.size() * q;
    place.comoment += i.rows.size() * q * (q + 1) / 2;
    const auto same = [&](const Searched& s) { return s.phase == i.phase && s.radius == i.radius; };
    if (i.has_flux()) place.flux += 3 * i.rows.size();
    const bool interpolates = i.kind != InstrumentKind::slices && i.kind != InstrumentKind::saltation && !i.over_sand();
    if (interpolates && std::none_of(lookups_.begin(), lookups_.end(), same))
      lookups_.push_back({i.phase, i.radius, Lookup(bounds, i.radius), -1});
  }
  memory_.due.assign(instruments_.size(), 0);
  memory_.moments.assign(instruments_.size(), 0);
  memory_.count.assign(place.row, 0);
  memory_.fraction.assign(place.row, 0.0);
  memory_.flux.assign(place.flux, 0.0);
  memory_.mean.assign(place.mean, 0.0);
  memory_.comoment.assign(place.comoment, 0.0);
}

void Measurements::open(const std::filesystem::path& directory, bool append, double until) {
  for (const Instrument& i : instruments_) {
    if (!i.in_time()) continue;
    std::vector<std::string> columns{"time [s]"};
    for (const char* suffix : {"", "_mean", "_rms"}) {
      if (i.kind == InstrumentKind::gauge) {
        columns.push_back(std::string("height") + suffix + " [m]");
        continue;
      }
      for (int d = 0; d < i.dimensions; ++d)
        columns.push_back(std::string("velocity") + suffix + "_" + "xyz"[d] + " [m/s]");
      columns.push_back(std::string("pressure") + suffix + " [Pa]");
    }
    if (i.kind == InstrumentKind::probe) columns.emplace_back("volume_fraction");
    probes_.emplace_back(directory / i.files().front(), columns, append, until);
  }
}

void Measurements::archive(Archive& a) {
  a.array("measured: due", memory_.due);
  a.array("measured: moments", memory_.moments);
  a.array("measured: count", memory_.count);
  a.array("measured: fraction", memory_.fraction);
  if (!memory_.flux.empty()) a.array("measured: flux", memory_.flux);
  a.array("measured: mean", memory_.mean);
  a.array("measured: comoment", memory_.comoment);
}

void Measurements::sample(const State& state) {
  const Stopwatch stopwatch(seconds_);
  due_.clear();
  for (std::size_t k = 0; k < instruments_.size(); ++k)
    if (due(k, state.time)) due_.push_back(k);
  if (due_.empty()) return;
  if (Exchange().is_shared()) gather(state);
  for (const std::size_t k : due_) {
    const Instrument& i = instruments_[k];
    const bool averaged = state.time >= i.start * (1.0 - 1e-12);
    if (averaged) ++memory_.moments[k];
    if (!Exchange::is_first_process()) continue;  // the first one samples
    if (i.points.empty()) {
      if (i.over_sand()) take_ground(k, state);
      else i.kind == InstrumentKind::slices ? take_slices(k, state) : take_layers(k, state);
      continue;
    }
    read_points(k, state);
    if (i.kind == InstrumentKind::gauge) readings_.assign(1, surface_over(i, readings_));
    if (averaged) take_points(k);
    if (i.in_time() && !probes_.empty()) write_probe(k, state.time);
  }
}

/// Probes and gauges are read from the beginning, the others from `start`.
bool Measurements::due(std::size_t k, double time) {
  const Instrument& i = instruments_[k];
  const double first = i.in_time() ? 0.0 : i.start;
  const double now = time * (1.0 + 1e-12) - first;
  if (now < static_cast<double>(memory_.due[k]) * i.every) return false;
  // Moments that a long step has passed over are left out.
  memory_.due[k] = std::max(memory_.due[k], static_cast<std::int64_t>(now / i.every)) + 1;
  return true;
}

Average Measurements::average(std::size_t k, std::size_t row) {
  const std::size_t q = instruments_[k].quantities();
  const Place& first = places_[k];
  return {memory_, first.row + row, first.mean + row * q, first.comoment + row * q * (q + 1) / 2, q};
}

Lookup& Measurements::lookup(std::size_t k, const State& state) {
  const Instrument& i = instruments_[k];
  auto& searched = *std::find_if(lookups_.begin(), lookups_.end(),
                                 [&](const Searched& s) { return s.phase == i.phase && s.radius == i.radius; });
  if (searched.step != state.steps) searched.lookup.build(seen(state, i.phase));
  searched.step = state.steps;
  return searched.lookup;
}

void Measurements::read_points(std::size_t k, const State& state) {
  const Instrument& i = instruments_[k];
  const Lookup& near = lookup(k, state);
  const FluidView fluid(seen(state, i.phase));
  const ReadyKernel kernel(i.kernel, i.radius, i.dimensions);
  const bool wall = i.kind == InstrumentKind::wall_shear;
  const Vec3 velocity = wall ? wall_velocity(seen(state, i.wall)) : Vec3{};
  readings_.resize(i.points.size());
  const auto n = static_cast<std::int64_t>(i.points.size());
  const RoughWall rough{i.density, i.roughness, i.spacing};
#pragma omp parallel for schedule(dynamic, 64)
  for (std::int64_t p = 0; p < n; ++p) {
    const auto at = static_cast<std::size_t>(p);
    if (!wall) {
      readings_[at] = interpolate(i.points[at], fluid, near, kernel, i.radius);
      continue;
    }
    const WallPoint point{i.points[at], i.normals[at], velocity};
    readings_[at] = i.shear == ShearOf::rough ? rough_stress(point, rough, fluid, near, kernel, i.radius)
                                              : wall_slope(point, fluid, near, kernel, i.radius);
  }
}

/// The mean of a row's points is its sample; slopes at a wall become stresses.
void Measurements::take_points(std::size_t k) {
  const Instrument& i = instruments_[k];
  const std::size_t q = i.quantities();
  for (std::size_t row = 0; row < i.rows.size(); ++row) {
    Sample sample{};
    double found = 0, fraction = 0;
    for (std::size_t p = row * i.points_per_row; p < (row + 1) * i.points_per_row; ++p) {
      fraction += readings_[p].fraction;
      if (!readings_[p].found) continue;
      ++found;
      for (std::size_t c = 0; c < q; ++c) sample[c] += readings_[p].value[c];
    }
    memory_.fraction[places_[k].row + row] += fraction / static_cast<double>(i.points_per_row);
    if (found == 0) continue;
    for (std::size_t c = 0; c < q; ++c) sample[c] /= found;
    if (i.kind == InstrumentKind::wall_shear && i.shear == ShearOf::slope)
      for (std::size_t c = 0; c + 1 < q; ++c) sample[c] *= i.viscosity;
    average(k, row).add({sample.data(), q});
  }
}

void Measurements::take_slices(std::size_t k, const State& state) {
  const Instrument& i = instruments_[k];
  const PhaseParticles& p = seen(state, i.phase);
  const double reference = densities_[i.phase];
  const double* density = p.has(Field::density) ? p.column(Field::density) : nullptr;
  const double* pressure = i.has_pressure ? p.column(Field::pressure) : nullptr;
  const Bounds& bounds = bounds_;
  const double width = slice_width(i);
  double volume = width;
  const auto dimensions = static_cast<std::size_t>(i.dimensions);
  for (std::size_t d = 0; d < dimensions; ++d)
    if (d != i.axis) volume *= i.high[d] - i.low[d];
  std::array<const double*, 3> x{}, v{};
  for (std::size_t d = 0; d < dimensions; ++d) {
    x[d] = p.column(Field::position, static_cast<int>(d));
    v[d] = p.column(Field::velocity, static_cast<int>(d));
  }
  for (std::size_t a = 0; a < p.size(); ++a) {
    bool inside = true;
    Vec3 at{};
    for (std::size_t d = 0; d < dimensions; ++d) {
      at[d] = x[d][a];
      const double period = bounds.high[d] - bounds.low[d];
      if (bounds.periodic[d]) at[d] -= period * std::floor((at[d] - bounds.low[d]) / period);
      inside = inside && at[d] >= i.low[d] && at[d] < i.high[d];
    }
    if (!inside) continue;
    const std::size_t row = std::min(static_cast<std::size_t>((at[i.axis] - i.low[i.axis]) / width), i.rows.size() - 1);
    Sample sample{at[i.axis] - i.rows[row][i.axis]};
    for (std::size_t d = 0; d < dimensions; ++d) sample[1 + d] = v[d][a];
    sample[1 + dimensions] = pressure ? pressure[a] : 0.0;
    average(k, row).add({sample.data(), i.quantities()});
    memory_.fraction[places_[k].row + row] += p.mass_of(a) / (density ? density[a] : reference) / volume;
    for (std::size_t d = 0; i.has_flux() && d < dimensions; ++d)
      memory_.flux[places_[k].flux + 3 * row + d] += p.mass_of(a) * v[d][a] / volume;
  }
}

void Measurements::write_probe(std::size_t k, double time) {
  const Reading& now = readings_.front();
  const Average mean = average(k, 0);
  const std::size_t q = instruments_[k].quantities();
  std::vector<double> row{time};
  for (std::size_t c = 0; c < q; ++c) row.push_back(now.found ? now.value[c] : nan);
  for (std::size_t c = 0; c < q; ++c) row.push_back(mean.count() > 0 ? mean.mean(c) : nan);
  for (std::size_t c = 0; c < q; ++c) row.push_back(mean.count() > 0 ? std::sqrt(mean.covariance(c, c)) : nan);
  if (instruments_[k].kind == InstrumentKind::probe) row.push_back(now.fraction);
  probes_[k].row(row);  // probes and gauges are the first instruments
}

Table Measurements::table(std::size_t k) {
  const Instrument& i = instruments_[k];
  if (i.kind == InstrumentKind::saltation) return layers(k);
  if (i.over_sand()) return ground(k);
  const bool wall = i.kind == InstrumentKind::wall_shear, slices = i.kind == InstrumentKind::slices;
  const auto dimensions = static_cast<std::size_t>(i.dimensions);
  const std::string vector = wall ? "shear_stress" : "velocity", unit = wall ? "Pa" : "m/s";
  FrameField mean{vector + "_mean", unit, 3, {}}, rms{vector + "_rms", unit, 3, {}};
  FrameField stress{"reynolds_shear_stress", "m2/s2", 1, {}}, friction{"friction_velocity", "m/s", 1, {}};
  FrameField pressure{"pressure_mean", "Pa", 1, {}}, pressure_rms{"pressure_rms", "Pa", 1, {}};
  FrameField fraction{"volume_fraction", "", 1, {}}, samples{"samples", "", 1, {}};
  for (std::size_t row = 0; row < i.rows.size(); ++row) {
    const Average average_of_row = average(k, row);
    const Statistics s(average_of_row, slices, slices ? slice_width(i) : 0.0);
    for (std::size_t d = 0; d < 3; ++d) {
      const double absent = d < dimensions ? nan : 0.0;
      mean.values.push_back(s.any() && d < dimensions ? s.mean(d) : absent);
      rms.values.push_back(s.any() && d < dimensions ? s.rms(d) : absent);
    }
    stress.values.push_back(s.any() ? -s.covariance(0, 1) : nan);
    friction.values.push_back(
        s.any() ? std::sqrt(std::hypot(s.mean(0), s.mean(1), dimensions == 3 ? s.mean(2) : 0.0) / i.density) : nan);
    pressure.values.push_back(s.any() ? s.mean(dimensions) : nan);
    pressure_rms.values.push_back(s.any() ? s.rms(dimensions) : nan);
    const auto moments = static_cast<double>(memory_.moments[k]);
    fraction.values.push_back(moments > 0 ? memory_.fraction[places_[k].row + row] / moments : nan);
    samples.values.push_back(static_cast<double>(average_of_row.count()));
  }
  Table t;
  t.dimensions = i.dimensions;
  t.moments = static_cast<long>(memory_.moments[k]);
  t.places = i.rows;
  t.count = i.count;
  t.step = i.step;
  t.fields = {std::move(mean), std::move(rms)};
  t.fields.push_back(wall ? std::move(friction) : std::move(stress));
  if (i.has_pressure) {
    t.fields.push_back(std::move(pressure));
    t.fields.push_back(std::move(pressure_rms));
  }
  if (!wall) t.fields.push_back(std::move(fraction));
  if (i.has_flux()) add_flux(k, t);
  t.fields.push_back(std::move(samples));
  return t;
}

void Measurements::write(const std::filesystem::path& directory, double time) {
  const Stopwatch stopwatch(seconds_);
  for (std::size_t k = 0; k < instruments_.size(); ++k) {
    const Instrument& i = instruments_[k];
    if (i.in_time()) continue;
    Table t = table(k);
    t.time = time;
    if (i.kind == InstrumentKind::grid) {
      write_image(directory / (i.stem + ".vti"), t);
    } else {
      write_csv(directory / (i.stem + ".csv"), t);
      write_polyline(directory / (i.stem + ".vtp"), t);
      if (i.kind == InstrumentKind::saltation) write_decay(k, directory / (i.stem + ".json"), time);
    }
  }
}

}  // namespace barchan
