#include "measure/lookup.hpp"

#include <cmath>

namespace barchan {

Lookup::Lookup(const Bounds& bounds, double radius)
    : bounds_(bounds), dimensions_(static_cast<std::size_t>(bounds.dimensions)), radius_(radius) {
  for (std::size_t d = 0; d < dimensions_; ++d) {
    period_[d] = bounds.high[d] - bounds.low[d];
    count_[d] = static_cast<std::size_t>(std::max(std::floor(period_[d] / radius), 1.0));
  }
}

std::size_t Lookup::cell_coordinate(double x, std::size_t axis) const {
  double s = (x - bounds_.low[axis]) / period_[axis];
  if (bounds_.periodic[axis]) s -= std::floor(s);
  const auto n = static_cast<double>(count_[axis]);
  const double c = s * n;
  if (!(c > 0.0)) return 0;  // not a number, too: a run that breaks down may be measured before it is checked
  return static_cast<std::size_t>(std::min(c, n - 1.0));
}

std::array<std::size_t, 2> Lookup::cells_about(double x, std::size_t axis) const {
  if (axis >= dimensions_) return {0, 0};
  const std::size_t c = cell_coordinate(x, axis), n = count_[axis];
  if (bounds_.periodic[axis]) {
    if (n < 3) return {0, n - 1};
    return {c + n - 1, c + n + 1};
  }
  return {c > 0 ? c - 1 : 0, std::min(c + 1, n - 1)};
}

void Lookup::build(const PhaseParticles& particles) {
  const std::size_t n = particles.size(), cells = count_[0] * count_[1] * count_[2];
  begin_.assign(cells + 1, 0);
  order_.resize(n);
  cell_of_.resize(n);
  for (std::size_t d = 0; d < dimensions_; ++d) column_[d] = particles.column(Field::position, static_cast<int>(d));
  for (std::size_t i = 0; i < n; ++i) {
    std::size_t cell = 0;
    for (std::size_t d = dimensions_; d-- > 0;) cell = cell * count_[d] + cell_coordinate(column_[d][i], d);
    cell_of_[i] = static_cast<std::uint32_t>(cell);
    ++begin_[cell + 1];
  }
  for (std::size_t c = 0; c < cells; ++c) begin_[c + 1] += begin_[c];
  for (std::size_t i = n; i-- > 0;) order_[--begin_[cell_of_[i] + 1]] = static_cast<std::uint32_t>(i);
  // Every begin_[c + 1] has come down to where its cell begins: one place to the left, and the end behind the last.
  for (std::size_t c = 0; c < cells; ++c) begin_[c] = begin_[c + 1];
  begin_[cells] = n;
}

}  // namespace barchan
