#include "models/fluid/control_volume.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/reproducible_sum.hpp"
#include "start/point_cells.hpp"

namespace barchan {
namespace {

constexpr double softness = 0.5;  // spacings, of the smooth distance

/// The weights of four nodes about a place `t` (0 to 1) between the middle two, and their two derivatives.
struct Spline {
  std::array<double, 4> value, first, second;
};

Spline cubic(double t) {
  const double u = 1.0 - t;
  return {{u * u * u / 6.0, (4.0 - 6.0 * t * t + 3.0 * t * t * t) / 6.0, (4.0 - 6.0 * u * u + 3.0 * u * u * u) / 6.0,
           t * t * t / 6.0},
          {-0.5 * u * u, -2.0 * t + 1.5 * t * t, 2.0 * u - 1.5 * u * u, 0.5 * t * t},
          {u, 3.0 * t - 2.0, 3.0 * u - 2.0, t}};
}

/// erfc, brought to one and zero at the ends of what counts.
double weight_at(double distance) {
  using CV = ControlVolume;
  const auto tail = [](double d) { return 0.5 * std::erfc((d - CV::middle) / (std::numbers::sqrt2 * CV::width)); };
  const double least = tail(CV::end);
  return std::clamp((tail(distance) - least) / (1.0 - 2.0 * least), 0.0, 1.0);
}

Vec3 place_of(const PhaseParticles& p, std::size_t k) {
  Vec3 x{};
  for (int d = 0; d < p.dimensions(); ++d) x[static_cast<std::size_t>(d)] = p.column(Field::position, d)[k];
  return x;
}

}  // namespace

ControlVolume::ControlVolume(const PhaseParticles& wall, double spacing, const Layout& layout)
    : dimensions_(static_cast<std::size_t>(layout.dimensions)),
      step_(layout.dimensions == 2 ? 0.5 * spacing : spacing) {
  const double reach = (end + 2.0) * spacing;
  low_ = {1e300, 1e300, 1e300};
  high_ = {-1e300, -1e300, -1e300};
  for (std::size_t k = 0; k < wall.size(); ++k) {
    const Vec3 x = place_of(wall, k);
    for (std::size_t d = 0; d < dimensions_; ++d) {
      low_[d] = std::min(low_[d], x[d] - reach);
      high_[d] = std::max(high_[d], x[d] + reach);
    }
  }
  std::size_t total = 1;
  for (std::size_t d = 0; d < dimensions_; ++d) {
    if (!(low_[d] > layout.domain.low[d] && high_[d] < layout.domain.high[d])) return;
    count_[d] = static_cast<std::size_t>(std::ceil((high_[d] - low_[d]) / step_)) + 4;
    total *= count_[d];
  }
  Domain space;
  for (std::size_t d = 0; d < 3; ++d) {
    space.origin[d] = layout.domain.low[d];
    space.size[d] = layout.domain.high[d] - layout.domain.low[d];
  }
  PointCells points(PeriodicSpace(space), reach + 2.0 * spacing, layout.dimensions);
  for (std::size_t k = 0; k < wall.size(); ++k) points.add(place_of(wall, k), 1.0);
  points.arrange();
  nodes_.resize(total);
  for (std::size_t n = 0; n < total; ++n) {
    const std::array<std::size_t, 3> at{n % count_[0], n / count_[0] % count_[1], n / count_[0] / count_[1]};
    Vec3 x{};
    for (std::size_t d = 0; d < dimensions_; ++d) x[d] = low_[d] + (static_cast<double>(at[d]) - 1.5) * step_;
    double sum = 0.0;
    points.for_each_near(x, [&](const Vec3&, double r, double) { sum += std::exp(-r / (softness * spacing)); });
    nodes_[n] = sum > 0.0 ? weight_at(-softness * std::log(sum)) : 0.0;
  }
}

ControlVolume::Weight ControlVolume::at(const Vec3& x) const {
  std::array<Spline, 3> spline{};
  std::array<std::size_t, 3> first{};
  for (std::size_t d = 0; d < dimensions_; ++d) {
    const double place = (x[d] - low_[d]) / step_ + 1.5, cell = std::floor(place);
    first[d] = static_cast<std::size_t>(cell) - 1;
    spline[d] = cubic(place - cell);
  }
  Weight sum;
  const std::size_t deep = dimensions_ == 3 ? 4 : 1;
  if (deep == 1) spline[2] = {{1.0}, {}, {}};
  for (std::size_t k = 0; k < deep; ++k)
    for (std::size_t j = 0; j < 4; ++j)
      for (std::size_t i = 0; i < 4; ++i) {
        const double node = nodes_[((first[2] + k) * count_[1] + first[1] + j) * count_[0] + first[0] + i];
        const std::array<double, 3> v{spline[0].value[i], spline[1].value[j], spline[2].value[k]},
            s{spline[0].first[i], spline[1].first[j], spline[2].first[k]},
            b{spline[0].second[i], spline[1].second[j], spline[2].second[k]};
        sum.w += node * v[0] * v[1] * v[2];
        for (std::size_t d = 0; d < dimensions_; ++d) {
          const std::size_t e = (d + 1) % 3, f = (d + 2) % 3;
          sum.slope[d] += node * s[d] * v[e] * v[f];
          sum.bend[d][d] += node * b[d] * v[e] * v[f];
          sum.bend[d][e] += node * s[d] * s[e] * v[f];
        }
      }
  for (std::size_t d = 0; d < dimensions_; ++d) {
    for (std::size_t e = 0; e < 3; ++e) sum.bend[d][e] *= 1.0 / (step_ * step_);
    sum.slope[d] *= 1.0 / step_;
  }
  for (std::size_t d = 0; d < 3; ++d) sum.bend[(d + 1) % 3][d] = sum.bend[d][(d + 1) % 3];
  return sum;
}

ControlVolume::Share ControlVolume::share(const Vec3& x, const Vec3& v, const Vec3& a, double mass, double density,
                                          double pressure, double viscosity) const {
  const Weight here = at(x);
  const double volume = mass / density, lap = here.bend[0][0] + here.bend[1][1] + here.bend[2][2];
  Share share{(-mass * here.w) * a, volume * here.slope, pressure, {}, v};
  for (std::size_t d = 0; d < dimensions_; ++d) {
    share.rubbed[d] = (viscosity * volume) * here.bend[d];
    share.rubbed[d][d] += viscosity * volume * lap;
  }
  return share;
}

/// The sums of V grad w and of V grad grad w are zero but for the error of a sum: less a mean, a uniform pressure and a
/// uniform velocity give nothing.
Vec3 ControlVolume::force(const std::vector<Share>& shares) {
  const auto sum = [&](const auto& term) {
    return reproducible_sum(shares.size(), [&](std::size_t k) { return term(shares[k]); });
  };
  const auto size = [](const Share& s) {
    return std::sqrt(dot(s.rubbed[0], s.rubbed[0]) + dot(s.rubbed[1], s.rubbed[1]) + dot(s.rubbed[2], s.rubbed[2]));
  };
  const double border = sum([](const Share&s) { return norm(s.slope); }), rubbed = sum(size);
  const double mean = border > 0.0 ? sum([](const Share& s) { return norm(s.slope) * s.pressure; }) / border : 0.0;
  Vec3 velocity{}, force{};
  for (std::size_t d = 0; d < 3 && rubbed > 0.0; ++d)
    velocity[d] = sum([&](const Share& s) { return size(s) * s.velocity[d]; }) / rubbed;
  for (std::size_t d = 0; d < 3; ++d)
    force[d] = sum([&](const Share& s) {
      return s.inertia[d] + (s.pressure - mean) * s.slope[d] + dot(s.rubbed[d], s.velocity - velocity);
    });
  return force;
}

}  // namespace barchan
