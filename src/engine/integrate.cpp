#include "engine/integrate.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <utility>

#include "engine/reproducible_sum.hpp"

namespace barchan::BARCHAN_TARGET {

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
  std::int64_t most = 0;
#pragma omp parallel for simd schedule(static) reduction(max : most)
  for (std::int64_t k = 0; k < n; ++k)
    for (std::size_t d = 0; d < Dim; ++d) {
      const double rate = a[d][k];
      v[d][k] += half_kick * rate;
      most = std::max(most, bits_of_size(rate));
    }
  const auto largest = std::bit_cast<double>(most);
  return std::isfinite(largest) ? largest : std::numeric_limits<double>::infinity();
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

}  // namespace barchan::BARCHAN_TARGET
