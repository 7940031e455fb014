#include "engine/means.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

#include "engine/reproducible_sum.hpp"

namespace barchan {

namespace {

void add_everywhere(double* values, std::size_t size, double amount) {
  const auto n = static_cast<std::int64_t>(size);
#pragma omp parallel for simd schedule(static)
  for (std::int64_t k = 0; k < n; ++k) values[k] += amount;
}

}  // namespace

double reproducible_total(const double* values, std::size_t size) {
  const auto n = static_cast<std::int64_t>(size);
  double high = 0.0, low = 0.0;
  std::int64_t most = 0;
#pragma omp parallel for simd schedule(static) reduction(max : most)
  for (std::int64_t k = 0; k < n; ++k) most = std::max(most, bits_of_size(values[k]));
  most = ranks::largest(most);
  const std::size_t all = ranks::total(size);
  const auto largest = std::bit_cast<double>(most);
  if (!std::isfinite(largest)) return std::numeric_limits<double>::quiet_NaN();
  if (largest < least_term) return 0.0;
  const SumCuts cuts(largest, all);
#pragma omp parallel for simd schedule(static) reduction(+ : high, low)
  for (std::int64_t k = 0; k < n; ++k) cuts.add(values[k], high, low);
  add_of_ranks(high, low, ranks::active());
  return high + low;
}

double reproducible_mean(const double* values, std::size_t size) {
  const std::size_t all = ranks::total(size);
  return all > 0 ? reproducible_total(values, size) / static_cast<double>(all) : 0.0;
}

void keep_mean_density(PhaseParticles& fluid) {
  if (ranks::total(fluid.size()) == 0) return;
  double* rate = fluid.column(Field::density_rate);
  add_everywhere(rate, fluid.size(), -reproducible_mean(rate, fluid.size()));
}

void accelerate(PhaseParticles& fluid, int axis, double amount) {
  add_everywhere(fluid.column(Field::acceleration, axis), fluid.size(), amount);
}

void keep_momentum(std::span<PhaseParticles* const> fluids, int axis, double wanted) {
  double force = 0.0, mass = 0.0;
  for (const PhaseParticles* fluid : fluids) {
    force += fluid->mass() * reproducible_total(fluid->column(Field::acceleration, axis), fluid->size());
    mass += fluid->mass() * static_cast<double>(ranks::total(fluid->size()));
  }
  if (!(mass > 0.0)) return;
  for (PhaseParticles* fluid : fluids) accelerate(*fluid, axis, wanted - force / mass);
}

void hold_bulk_velocity(PhaseParticles& fluid, BulkHold& hold, double dt) {
  if (ranks::total(fluid.size()) == 0) return;
  for (int d = 0; d < fluid.dimensions(); ++d) {
    const auto c = static_cast<std::size_t>(d);
    if (!hold.axes[c]) continue;
    double* a = fluid.column(Field::acceleration, d);
    const double missing = hold.velocity[c] - reproducible_mean(fluid.column(Field::velocity, d), fluid.size());
    hold.acceleration[c] = missing / dt - reproducible_mean(a, fluid.size());
    add_everywhere(a, fluid.size(), hold.acceleration[c]);
  }
}

}  // namespace barchan
