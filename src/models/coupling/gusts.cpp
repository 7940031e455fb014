#include "models/coupling/gusts.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

namespace barchan {

Gusts::Gusts(double intensity, double viscosity, double friction_velocity, double low, double size, std::size_t nodes)
    : spread_(std::sqrt(std::log1p(intensity * intensity))),
      friction_velocity_(friction_velocity),
      low_(low),
      size_(size),
      node_(nodes, 0.0) {
  constexpr double shortest = 200.0, longest = 3000.0, slowest = 7.0, fastest = 13.0;  // nu/u*; u*
  const double unit = viscosity / friction_velocity;
  std::mt19937 random(1);  // its numbers are laid down by the C++ standard
  const auto share = [&] { return static_cast<double>(random()) / 4294967296.0; };
  for (std::size_t j = 0; j < waves; ++j) {
    const double place = (static_cast<double>(j) + 0.5) / static_cast<double>(waves);
    const double length = unit * shortest * std::pow(longest / shortest, place);
    const double periods = std::max(1.0, std::round(size / length));
    wave_[j] = {2.0 * std::numbers::pi * periods / size, friction_velocity * (slowest + (fastest - slowest) * share()),
                2.0 * std::numbers::pi * share()};
  }
}

void Gusts::blow(double time) {
  const double amplitude = std::sqrt(2.0 / static_cast<double>(waves)),
               step = size_ / static_cast<double>(node_.size());
  for (std::size_t k = 0; k < node_.size(); ++k) {
    double sum = 0.0;
    for (const Wave& w : wave_) sum += std::cos(w.number * (static_cast<double>(k) * step - w.speed * time) + w.phase);
    node_[k] = std::expm1(spread_ * amplitude * sum - 0.5 * spread_ * spread_);
  }
}

double Gusts::at(double x) const {
  const auto n = static_cast<long>(node_.size());
  const double s = (x - low_) / size_ * static_cast<double>(n), share = s - std::floor(s);
  const long k = ((static_cast<long>(std::floor(s)) % n) + n) % n;
  return (1.0 - share) * node_[static_cast<std::size_t>(k)] + share * node_[static_cast<std::size_t>((k + 1) % n)];
}

}  // namespace barchan
