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

namespace {

constexpr std::int64_t block = 4096;

/// Adds to each of four sums the values of its column from place `from` to `to`, one after another. The next addition
/// of one sum waits for the last; four of them keep the processor busy.
void add_side_by_side(const std::array<const double*, 4>& column, std::int64_t from, std::int64_t to,
                      std::array<double, 4>& sums) {
  auto [a, b, c, d] = sums;
  for (std::int64_t k = from; k < to; ++k) {
    a += column[0][k];
    b += column[1][k];
    c += column[2][k];
    d += column[3][k];
  }
  sums = {a, b, c, d};
}

/// The sums of the blocks first .. first + count - 1, at most four, of n values; each from its first value to its last.
std::array<double, 4> block_sums(const double* values, std::int64_t n, std::int64_t first, std::int64_t count) {
  std::array<const double*, 4> column{};
  for (std::int64_t q = 0; q < 4; ++q)  // where there are fewer, one is summed more than once
    column[static_cast<std::size_t>(q)] = values + (first + std::min(q, count - 1)) * block;
  const std::int64_t last = first + count - 1, size = std::min(block, n - last * block);
  std::array<double, 4> sums{};
  add_side_by_side(column, 0, size, sums);
  const double of_last = sums[static_cast<std::size_t>(count - 1)];
  if (size == block || count == 1) return sums;
  for (std::int64_t q = count - 1; q < 4; ++q) column[static_cast<std::size_t>(q)] = column[0];
  add_side_by_side(column, size, block, sums);
  sums[static_cast<std::size_t>(count - 1)] = of_last;
  return sums;
}

}  // namespace

double BlockMean::operator()(const double* values, std::size_t size) {
  const auto n = static_cast<std::int64_t>(size);
  const std::int64_t blocks = (n + block - 1) / block;
  if (static_cast<std::int64_t>(parts_.size()) < blocks) parts_.resize(static_cast<std::size_t>(blocks));
#pragma omp parallel for schedule(static)
  for (std::int64_t b = 0; b < blocks; b += 4) {
    const std::int64_t count = std::min<std::int64_t>(4, blocks - b);
    const auto sums = block_sums(values, n, b, count);
    std::copy_n(sums.begin(), count, parts_.begin() + b);
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

void accelerate(PhaseParticles& fluid, int axis, double amount) {
  add_everywhere(fluid.column(Field::acceleration, axis), fluid.size(), amount);
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
