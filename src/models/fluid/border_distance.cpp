#include "models/fluid/border_distance.hpp"

#include <algorithm>
#include <cmath>

#include "base/errors.hpp"
#include "scene/formula.hpp"

namespace barchan {

BorderDistance::BorderDistance(const Expression& formula, const Bounds& domain, double spacing,
                               const std::string& where)
    : bounds_(domain) {
  const auto dimensions = static_cast<std::size_t>(domain.dimensions);
  for (std::size_t d = 0; d < dimensions; ++d) {
    const double size = domain.high[d] - domain.low[d];
    count_[d] = static_cast<std::size_t>(std::max(1.0, std::ceil(size / spacing))) + 1;
    step_[d] = size / static_cast<double>(count_[d] - 1);
  }
  value_.resize(count_[0] * count_[1] * count_[2]);
  const Formula f(formula);
  const double small = 0.25 * spacing;
  for (std::size_t n = 0; n < value_.size(); ++n) {
    const std::array<std::size_t, 3> at{n % count_[0], n / count_[0] % count_[1], n / count_[0] / count_[1]};
    Vec3 x{};
    for (std::size_t d = 0; d < dimensions; ++d) x[d] = domain.low[d] + step_[d] * static_cast<double>(at[d]);
    double slope = 0.0;
    for (std::size_t d = 0; d < dimensions; ++d) {
      Vec3 up = x, down = x;
      up[d] += small;
      down[d] -= small;
      slope += std::pow((f(up) - f(down)) / (2.0 * small), 2);
    }
    const double value = f(x), size = std::sqrt(slope);
    if (!std::isfinite(value) || !std::isfinite(size))
      throw SceneError(where + ": no number at x = " + std::to_string(x[0]) + ", y = " + std::to_string(x[1]) +
                       "; expected a formula that has one in the whole domain");
    value_[n] = std::clamp(value / std::max(size, 1e-9), -most * spacing, most * spacing);
  }
}

double BorderDistance::operator()(const Vec3& x) const {
  std::array<std::size_t, 3> low{};
  Vec3 share{};
  for (std::size_t d = 0; d < 3; ++d) {
    if (count_[d] == 1) continue;
    const auto last = static_cast<double>(count_[d] - 1);
    const double s = std::clamp((x[d] - bounds_.low[d]) / step_[d], 0.0, last);
    low[d] = std::min(static_cast<std::size_t>(s), count_[d] - 2);
    share[d] = s - static_cast<double>(low[d]);
  }
  double sum = 0.0;
  for (std::size_t corner = 0; corner < 8; ++corner) {
    double weight = 1.0;
    std::array<std::size_t, 3> at{};
    for (std::size_t d = 0; d < 3; ++d) {
      const std::size_t up = corner >> d & 1u;
      weight *= up ? share[d] : 1.0 - share[d];
      at[d] = low[d] + up;
    }
    if (weight > 0.0) sum += weight * value_[(at[2] * count_[1] + at[1]) * count_[0] + at[0]];
  }
  return sum;
}

}  // namespace barchan
