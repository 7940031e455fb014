// The drag of a grain as a mean over a time for which it is kept: exact for a wind and a rate that do not change, which
// are taken in the middle of that time.
//
//   dv/dt = k (u - v) + g,   k = excess(Re)/tau_S,   mean over T: (1 - exp(-k T))/(k T) [k (u - v) + g]
#pragma once

#include <array>
#include <cmath>

namespace barchan {

/// What a grain feels: the mean acceleration by drag (m/s2), and how much more of it as the wind gets faster (1/s).
template <std::size_t Dim>
struct KeptDrag {
  std::array<double, Dim> drag{};
  double rate = 0.0;
};

/// wind, velocity: m/s; gravity: m/s2; stokes: 1/tau_S (1/s); reach: d/nu (s/m); excess(Re): C_D Re/24; time: s.
template <std::size_t Dim, class Excess>
KeptDrag<Dim> kept_drag(const std::array<double, Dim>& wind, const std::array<double, Dim>& velocity,
                        const std::array<double, Dim>& gravity, double stokes, double reach, const Excess& excess,
                        double time) {
  KeptDrag<Dim> kept;
  std::array<double, Dim> mean{};  // total acceleration, gravity and drag
  for (int pass = 0; pass < 2; ++pass) {
    double square = 0.0;
    for (std::size_t c = 0; c < Dim; ++c) {
      const double difference = wind[c] - velocity[c] - 0.5 * time * mean[c];
      square += difference * difference;
    }
    const double rate = stokes * excess(std::sqrt(square) * reach);
    const double x = rate * time, share = x < 1e-5 ? 1.0 - 0.5 * x : -std::expm1(-x) / x;
    for (std::size_t c = 0; c < Dim; ++c) mean[c] = share * (rate * (wind[c] - velocity[c]) + gravity[c]);
    kept.rate = share * rate;
  }
  for (std::size_t c = 0; c < Dim; ++c) kept.drag[c] = mean[c] - gravity[c];
  return kept;
}

}  // namespace barchan
