// What sand and wind do along the ground: the stress of a wind over sand by x, and the flux of grains of slices.
//
// The stress of the wind over sand is divided as Owen (1964) and Raupach (1991) do: the total shear stress, which the
// air has above the grains, is carried to the bed by the air (airborne) and by the grains (grain-borne),
//   tau = tau_a + tau_g.
// The layers of the wind (models/coupling/sand_layer.hpp) have tau on their top and tau_a at the bed.
#include <algorithm>
#include <cmath>
#include <limits>

#include "measure/measurements.hpp"
#include "models/grains/saltation_layer.hpp"

namespace barchan {

namespace {

constexpr double no_value = std::numeric_limits<double>::quiet_NaN();
enum OfGround : std::size_t { total, airborne };

/// A number of the layers at a place along the ground: linear between their middles, over a periodic side; beyond the
/// first and the last middle that of the nearest.
class AlongGround {
 public:
  AlongGround(const Bounds& bounds, std::size_t layers)
      : low_(bounds.low[0]),
        width_((bounds.high[0] - bounds.low[0]) / static_cast<double>(layers)),
        count_(static_cast<double>(layers)),
        periodic_(bounds.periodic[0]) {}
  template <class F>
  double operator()(double x, F&& of_layer) const {
    double s = (x - low_) / width_ - 0.5;
    if (!periodic_) s = std::clamp(s, 0.0, count_ - 1.0);
    const double left = std::floor(s), share = s - left;
    const double right = periodic_ ? left + 1.0 : std::min(left + 1.0, count_ - 1.0);
    return (1.0 - share) * of_layer(number(left)) + share * of_layer(number(right));
  }

 private:
  std::size_t number(double layer) const {
    return static_cast<std::size_t>(layer - count_ * std::floor(layer / count_));
  }
  double low_, width_, count_;
  bool periodic_;
};

/// The air's stress (Pa) on the lower face of the cell at a height: what history.csv calls the stress of the bed.
double stress_under(const AirProfile& air, double y) {
  const auto above = std::upper_bound(air.face.begin(), air.face.end(), y) - air.face.begin();
  return air.stress[static_cast<std::size_t>(std::max<std::ptrdiff_t>(above, 1)) - 1];
}

}  // namespace

void Measurements::take_ground(std::size_t k, const State& state) {
  const Instrument& i = instruments_[k];
  std::size_t first = 0, count = 0;
  for (std::size_t a = 0; a < state.air.size(); ++a)
    if (state.air[a].phase == i.phase && count++ == 0) first = a;
  if (count == 0) return;
  const AlongGround along(i.domain, count);
  for (std::size_t row = 0; row < i.rows.size(); ++row) {
    const double x = i.rows[row][0];
    const double top = along(x, [&](std::size_t n) { return state.air[first + n].stress.back(); });
    const double bed = along(x, [&](std::size_t n) { return stress_under(state.air[first + n], i.bed); });
    const Sample sample{top, bed};
    average(k, row).add({sample.data(), i.quantities()});
  }
}

Table Measurements::ground(std::size_t k) {
  const Instrument& i = instruments_[k];
  FrameField whole{"total_shear_stress_mean", "Pa", 1, {}}, air{"airborne_shear_stress_mean", "Pa", 1, {}};
  FrameField grains{"grain_borne_shear_stress_mean", "Pa", 1, {}}, rms{"total_shear_stress_rms", "Pa", 1, {}};
  FrameField air_rms{"airborne_shear_stress_rms", "Pa", 1, {}}, friction{"friction_velocity", "m/s", 1, {}};
  FrameField samples{"samples", "", 1, {}};
  for (std::size_t row = 0; row < i.rows.size(); ++row) {
    const Average a = average(k, row);
    const bool any = a.count() > 0;
    const auto root = [&](double square) { return any ? std::sqrt(std::max(square, 0.0)) : no_value; };
    whole.values.push_back(any ? a.mean(total) : no_value);
    air.values.push_back(any ? a.mean(airborne) : no_value);
    grains.values.push_back(any ? a.mean(total) - a.mean(airborne) : no_value);
    rms.values.push_back(root(a.covariance(total, total)));
    air_rms.values.push_back(root(a.covariance(airborne, airborne)));
    friction.values.push_back(root(std::abs(a.mean(total)) / i.density));
    samples.values.push_back(static_cast<double>(a.count()));
  }
  Table t;
  t.dimensions = i.dimensions;
  t.moments = static_cast<long>(memory_.moments[k]);
  t.places = i.rows;
  t.fields = {std::move(whole),   std::move(air),      std::move(grains), std::move(rms),
              std::move(air_rms), std::move(friction), std::move(samples)};
  return t;
}

/// The mean mass flux of a slice by area across it, over all moments; of slices along the ground also the flux that the
/// height of the box lets pass, by the metre of width.
void Measurements::add_flux(std::size_t k, Table& t) const {
  const Instrument& i = instruments_[k];
  const auto moments = static_cast<double>(memory_.moments[k]);
  FrameField by_area{"mass_flux", "kg/m2/s", 3, {}}, by_width{"flux", "kg/m/s", 1, {}};
  for (std::size_t row = 0; row < i.rows.size(); ++row) {
    const double* sum = memory_.flux.data() + places_[k].flux + 3 * row;
    for (std::size_t d = 0; d < 3; ++d) by_area.values.push_back(moments > 0 ? sum[d] / moments : no_value);
    by_width.values.push_back(moments > 0 ? sum[0] / moments * (i.high[1] - i.low[1]) : no_value);
  }
  t.fields.push_back(std::move(by_area));
  if (i.axis != 1) t.fields.push_back(std::move(by_width));
}

}  // namespace barchan
