#include "engine/means.hpp"

#include <algorithm>
#include <cstdint>

namespace barchan {

namespace {

void add_everywhere(double* values, std::size_t size, double amount) {
  const auto n = static_cast<std::int64_t>(size);
#pragma omp parallel for simd schedule(static)
  for (std::int64_t k = 0; k < n; ++k) values[k] += amount;
}

}  // namespace

double BlockMean::operator()(const double* values, std::size_t size) {
  constexpr std::int64_t block = 4096;
  const auto n = static_cast<std::int64_t>(size);
  const std::int64_t blocks = (n + block - 1) / block;
  if (static_cast<std::int64_t>(parts_.size()) < blocks) parts_.resize(static_cast<std::size_t>(blocks));
#pragma omp parallel for schedule(static)
  for (std::int64_t b = 0; b < blocks; ++b) {
    double sum = 0.0;
    for (std::int64_t k = b * block; k < std::min((b + 1) * block, n); ++k) sum += values[k];
    parts_[static_cast<std::size_t>(b)] = sum;
  }
  double sum = 0.0;
  for (std::int64_t b = 0; b < blocks; ++b) sum += parts_[static_cast<std::size_t>(b)];
  return sum / static_cast<double>(n);
}

void keep_mean_density(PhaseParticles& fluid, BlockMean& mean) {
  if (fluid.size() == 0) return;
  double* rate = fluid.column(Field::density_rate);
  add_everywhere(rate, fluid.size(), -mean(rate, fluid.size()));
}

void hold_bulk_velocity(PhaseParticles& fluid, BulkHold& hold, double dt, BlockMean& mean) {
  if (fluid.size() == 0) return;
  for (int d = 0; d < fluid.dimensions(); ++d) {
    const auto c = static_cast<std::size_t>(d);
    if (!hold.axes[c]) continue;
    double* a = fluid.column(Field::acceleration, d);
    const double missing = hold.velocity[c] - mean(fluid.column(Field::velocity, d), fluid.size());
    hold.acceleration[c] = missing / dt - mean(a, fluid.size());
    add_everywhere(a, fluid.size(), hold.acceleration[c]);
  }
}

}  // namespace barchan
