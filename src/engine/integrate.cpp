#include "engine/integrate.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace barchan {

double PressureLaw::operator()(double density) const {
  if (exponent == 1.0) return sound_speed * sound_speed * (density - reference_density) + background;
  const double stiffness = reference_density * sound_speed * sound_speed / exponent;
  return stiffness * (std::pow(density / reference_density, exponent) - 1.0) + background;
}

double PressureLaw::density(double pressure) const {
  const double over = (pressure - background) / (reference_density * sound_speed * sound_speed);
  if (exponent == 1.0) return reference_density * (1.0 + over);
  return reference_density * std::pow(1.0 + exponent * over, 1.0 / exponent);
}

namespace {

template <std::size_t Dim>
std::array<double*, Dim> columns(PhaseParticles& phase, Field field) {
  std::array<double*, Dim> c{};
  if (phase.has(field))
    for (std::size_t d = 0; d < Dim; ++d) c[d] = phase.column(field, static_cast<int>(d));
  return c;
}

// Called by all threads of a team; each thread goes through the same particles in every loop, so no thread waits for
// another.
template <std::size_t Dim, bool Shifted>
void kick_and_drift_all(PhaseParticles& phase, double half_kick, double time) {
  const auto x = columns<Dim>(phase, Field::position), v = columns<Dim>(phase, Field::velocity),
             a = columns<Dim>(phase, Field::acceleration), du = columns<Dim>(phase, Field::shift_velocity);
  const auto n = static_cast<std::int64_t>(phase.size());
#pragma omp for simd schedule(static) nowait
  for (std::int64_t k = 0; k < n; ++k)
    for (std::size_t d = 0; d < Dim; ++d) {
      const double speed = v[d][k] + half_kick * a[d][k];
      v[d][k] = speed;
      if constexpr (Shifted) x[d][k] += time * (speed + du[d][k]);
      else x[d][k] += time * speed;
    }
}

void advance_density(PhaseParticles& phase, double time, const PressureLaw& law) {
  double *rho = phase.column(Field::density), *p = phase.column(Field::pressure);
  const double* rate = phase.column(Field::density_rate);
  const auto n = static_cast<std::int64_t>(phase.size());
  if (law.exponent == 1.0) {
    const double stiffness = law.sound_speed * law.sound_speed;
#pragma omp for simd schedule(static) nowait
    for (std::int64_t k = 0; k < n; ++k) {
      rho[k] += time * rate[k];
      p[k] = stiffness * (rho[k] - law.reference_density) + law.background;
    }
  } else {
#pragma omp for schedule(static) nowait
    for (std::int64_t k = 0; k < n; ++k) {
      rho[k] += time * rate[k];
      p[k] = law(rho[k]);
    }
  }
}

template <std::size_t Dim>
double kick_all(PhaseParticles& phase, double half_kick) {
  const auto v = columns<Dim>(phase, Field::velocity), a = columns<Dim>(phase, Field::acceleration);
  const auto n = static_cast<std::int64_t>(phase.size());
  double most = 0.0, sum = 0.0;  // the sum of zeros is NaN when an acceleration is not finite, whatever the order
#pragma omp parallel for simd schedule(static) reduction(max : most) reduction(+ : sum)
  for (std::int64_t k = 0; k < n; ++k)
    for (std::size_t d = 0; d < Dim; ++d) {
      const double size = std::abs(a[d][k]);
      v[d][k] += half_kick * a[d][k];
      most = size > most ? size : most;
      sum += 0.0 * size;
    }
  return std::isfinite(sum) ? most : std::numeric_limits<double>::infinity();
}

}  // namespace

void kick_and_drift(PhaseParticles& phase, double half_kick, double time, const PressureLaw* pressure) {
  const bool shifted = phase.has(Field::shift_velocity);
#pragma omp parallel
  {
    if (phase.dimensions() == 2)
      shifted ? kick_and_drift_all<2, true>(phase, half_kick, time)
              : kick_and_drift_all<2, false>(phase, half_kick, time);
    else
      shifted ? kick_and_drift_all<3, true>(phase, half_kick, time)
              : kick_and_drift_all<3, false>(phase, half_kick, time);
    if (pressure) advance_density(phase, time, *pressure);
  }
}

void advance_energy(PhaseParticles& phase, double time) {
  const auto n = static_cast<std::int64_t>(phase.size());
  double* e = phase.column(Field::energy);
  const double* rate = std::as_const(phase).column(Field::energy_rate);
#pragma omp parallel for simd schedule(static)
  for (std::int64_t k = 0; k < n; ++k) e[k] += time * rate[k];
}

void drift(PhaseParticles& phase, double time) {
  const auto n = static_cast<std::int64_t>(phase.size());
  for (int d = 0; d < phase.dimensions(); ++d) {
    double* x = phase.column(Field::position, d);
    const double* v = phase.column(Field::velocity, d);
#pragma omp parallel for simd schedule(static)
    for (std::int64_t k = 0; k < n; ++k) x[k] += time * v[k];
  }
}

double kick(PhaseParticles& phase, double half_kick) {
  return phase.dimensions() == 2 ? kick_all<2>(phase, half_kick) : kick_all<3>(phase, half_kick);
}

void hold_inside(PhaseParticles& phase, const Sides& sides) {
  const auto n = static_cast<std::int64_t>(phase.size());
  const double* rho = sides.margin_of_off > 0.0 ? phase.column(Field::density) : nullptr;
  const double most = Sides::off * sides.rest;
#pragma omp parallel
  for (int d = 0; d < phase.dimensions(); ++d) {
    const auto c = static_cast<std::size_t>(d);
    double *x = phase.column(Field::position, d), *v = phase.column(Field::velocity, d);
#pragma omp for simd schedule(static) nowait
    for (std::int64_t k = 0; k < n; ++k) {
      const double place = x[k], speed = v[k];
      const double margin = rho != nullptr && std::abs(rho[k] - sides.rest) > most ? sides.margin_of_off : sides.margin;
      const double low = sides.low[c] + margin, high = sides.high[c] - margin;
      v[k] = place < low ? std::max(speed, 0.0) : place > high ? std::min(speed, 0.0) : speed;
      x[k] = place < low ? low : place > high ? high : place;
    }
  }
}

}  // namespace barchan
