#include "measure/decay.hpp"

#include <cmath>

namespace barchan {

Decay decay(const std::vector<double>& y, const std::vector<double>& q, const std::vector<double>& errors) {
  Decay d;
  double w = 0.0, wy = 0.0, wl = 0.0, wyy = 0.0, wyl = 0.0, wll = 0.0;
  for (std::size_t k = 0; k < y.size() && q[k] > 2.0 * errors[k] && q[k] > 0.0; ++k) {
    // A value that no sample scattered about is as good as one of a thousandth.
    const double error = std::fmax(errors[k] / q[k], 1e-3), weight = 1.0 / (error * error), l = std::log(q[k]);
    w += weight;
    wy += weight * y[k];
    wl += weight * l;
    wyy += weight * y[k] * y[k];
    wyl += weight * y[k] * l;
    wll += weight * l * l;
    ++d.used;
  }
  if (d.used < 3) return {};
  const double spread = wyy - wy * wy / w, slope = (wyl - wy * wl / w) / spread;
  if (!(slope < 0.0)) return {};
  const double scatter = std::fmax(wll - wl * wl / w - slope * slope * spread, 0.0) / (d.used - 2);
  d.height = -1.0 / slope;
  d.error = std::sqrt(scatter / spread) * d.height * d.height;
  d.at_zero = std::exp((wl - slope * wy) / w);
  return d;
}

}  // namespace barchan
