// Sand in flight by height: what one moment gives to the averages, their table, and the height over which the flux
// falls by a factor e.
#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>

#include "measure/decay.hpp"
#include "measure/measurements.hpp"
#include "models/grains/saltation_layer.hpp"
#include "output/whole_file.hpp"
#include "scene/log_wind.hpp"

namespace barchan {

namespace {

constexpr double absent = std::numeric_limits<double>::quiet_NaN();
enum Quantity : std::size_t { concentration, flux, stress, wind, wind_stress };

/// The speed that a grain at this height meets: of a logarithmic profile that is held the profile's own, of other air
/// that of its cell.
double speed_at(const AirProfile& air, const std::optional<LogProfile>& held, double y) {
  if (!(y > air.face.front())) return 0.0;
  if (held) return log_wind(*held, y - air.face.front());
  const auto above = static_cast<std::size_t>(std::upper_bound(air.face.begin(), air.face.end(), y) - air.face.begin());
  return air.speed[std::min(above, air.cells()) - 1];
}

}  // namespace

/// All grains are sorted into slices; a moment is one sample of each slice.
void Measurements::take_layers(std::size_t k, const State& state) {
  const Instrument& i = instruments_[k];
  const PhaseParticles& p = state.phases[i.phase];
  const std::size_t rows = i.rows.size();
  const double height = (i.high[1] - i.low[1]) / static_cast<double>(rows), volume = height * i.area;
  sums_.assign(3 * rows, 0.0);
  const double *y = p.column(Field::position, 1), *vx = p.column(Field::velocity, 0),
               *vy = p.column(Field::velocity, 1);
  for (std::size_t a = 0; a < p.size(); ++a) {
    const double at = (y[a] - i.low[1]) / height, m = p.mass_of(a) / volume;
    if (!(at >= 0.0) || at >= static_cast<double>(rows)) continue;
    double* sum = sums_.data() + 3 * static_cast<std::size_t>(at);
    sum[concentration] += m;
    sum[flux] += m * vx[a];
    sum[stress] -= m * vx[a] * vy[a];
  }
  const AirProfile* air = nullptr;
  for (const AirProfile& profile : state.air)
    if (static_cast<int>(profile.phase) == i.air) air = &profile;
  for (std::size_t row = 0; row < rows; ++row) {
    const double* sum = sums_.data() + 3 * row;
    Sample sample{sum[concentration], sum[flux], sum[stress]};
    if (air) {
      sample[wind] = speed_at(*air, i.held_wind, i.rows[row][1]);
      sample[wind_stress] = air_stress(*air, i.rows[row][1]);
    }
    average(k, row).add({sample.data(), i.quantities()});
  }
}

/// The bed is where the mean concentration falls through half of its largest value.
double Measurements::bed_of(std::size_t k) {
  const Instrument& i = instruments_[k];
  const auto c = [&](std::size_t row) { return average(k, row).mean(concentration); };
  double most = 0.0;
  std::size_t row = i.rows.size() - 1;
  for (std::size_t r = 0; r <= row; ++r) most = std::max(most, c(r));
  if (!(most > 0.0)) return i.low[1];
  while (c(row) < 0.5 * most) --row;
  const double above = row + 1 < i.rows.size() ? c(row + 1) : 0.0;
  const double height = (i.high[1] - i.low[1]) / static_cast<double>(i.rows.size());
  return i.rows[row][1] + height * (c(row) - 0.5 * most) / (c(row) - above);
}

Table Measurements::layers(std::size_t k) {
  const Instrument& i = instruments_[k];
  const double bed = bed_of(k);
  FrameField over{"height_over_bed", "m", 1, {}}, density{"concentration", "kg/m3", 1, {}};
  FrameField flow{"flux", "kg/m2/s", 1, {}}, speed{"mean_speed", "m/s", 1, {}};
  FrameField carried{"grain_stress", "Pa", 1, {}}, air{"air_speed", "m/s", 1, {}}, shear{"air_stress", "Pa", 1, {}};
  FrameField samples{"samples", "", 1, {}};
  for (std::size_t row = 0; row < i.rows.size(); ++row) {
    const Average a = average(k, row);
    const bool any = a.count() > 0;
    over.values.push_back(i.rows[row][1] - bed);
    density.values.push_back(any ? a.mean(concentration) : absent);
    flow.values.push_back(any ? a.mean(flux) : absent);
    speed.values.push_back(any && a.mean(concentration) > 0.0 ? a.mean(flux) / a.mean(concentration) : absent);
    carried.values.push_back(any ? a.mean(stress) : absent);
    air.values.push_back(any ? a.mean(wind) : absent);
    shear.values.push_back(any ? a.mean(wind_stress) : absent);
    samples.values.push_back(static_cast<double>(a.count()));
  }
  Table t;
  t.dimensions = i.dimensions;
  t.moments = static_cast<long>(memory_.moments[k]);
  t.places = i.rows;
  t.fields = {std::move(over), std::move(density), std::move(flow), std::move(speed), std::move(carried)};
  if (i.air >= 0) {
    t.fields.push_back(std::move(air));
    t.fields.push_back(std::move(shear));
  }
  t.fields.push_back(std::move(samples));
  return t;
}

/// Bed, flux and the decay of flux and concentration above the height of flight.
void Measurements::write_decay(std::size_t k, const std::filesystem::path& file, double time) {
  const Instrument& i = instruments_[k];
  const double bed = bed_of(k), height = (i.high[1] - i.low[1]) / static_cast<double>(i.rows.size());
  double all = 0.0, flying = 0.0;
  std::vector<double> y, values[2], errors[2];
  for (std::size_t row = 0; row < i.rows.size(); ++row) {
    const Average a = average(k, row);
    const bool flies = i.rows[row][1] - bed >= i.flight;
    if (a.count() == 0) continue;
    all += a.mean(flux) * height;
    if (!flies) continue;
    flying += a.mean(flux) * height;
    y.push_back(i.rows[row][1] - bed);
    for (const Quantity q : {concentration, flux}) {
      values[q].push_back(a.mean(q));
      errors[q].push_back(std::sqrt(std::max(a.covariance(q, q), 0.0) / static_cast<double>(a.count())));
    }
  }
  const Decay of_concentration = decay(y, values[concentration], errors[concentration]);
  const Decay of_flux = decay(y, values[flux], errors[flux]);
  nlohmann::ordered_json j;
  j["time"] = time;
  j["samples"] = memory_.moments[k];
  j["diameter"] = i.diameter;
  j["bed"] = bed;
  j["flux"] = all;
  j["flux_in_flight"] = flying;
  for (const auto& [name, d] : {std::pair{"flux_decay", of_flux}, std::pair{"concentration_decay", of_concentration}})
    j[name] = {{"height", d.height}, {"standard_error", d.error}, {"at_bed", d.at_zero}, {"slices", d.used}};
  write_whole_file(file, j.dump(2) + "\n");
}

}  // namespace barchan
