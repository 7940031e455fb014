// Finds wrong particles by comparing everything with everything: the naive twin of the watch.
#pragma once

#include <cmath>
#include <string>

#include "simulation/simulation.hpp"

namespace barchan::stress {

class Detector {
 public:
  explicit Detector(const Simulation& simulation) : s_(simulation) {}

  /// What is wrong with the present state; "" if nothing is.
  std::string wrong() const {
    for (std::size_t k = 0; k < s_.phases().size(); ++k) {
      if (wall(k)) continue;
      for (std::size_t i = 0; i < s_.phases()[k].size(); ++i)
        if (std::string w = wrong_alone(k, i); !w.empty()) return w;
    }
    for (const auto& e : s_.plan().entries) {
      if (e.keeps_apart || e.pairs == Pairs::first_shape || e.by_outlines() || e.own_steps())
        if (least_distance(e.a, e.b) < (wall(e.a) || wall(e.b) ? 0.6 : 0.2)) return "two in one place";
      if (e.a == e.b && s_.plan().phases[e.a].flows() && paired(e.a) > 0.05) return "pairs";
    }
    return "";
  }

 private:
  bool wall(std::size_t phase) const { return !s_.plan().phases[phase].moves(); }

  static double squared_speed(const PhaseParticles& p, std::size_t i) {
    double v2 = 0;
    for (int d = 0; d < p.dimensions(); ++d) v2 += std::pow(p.column(Field::velocity, d)[i], 2);
    return v2;
  }

  bool closed(int axis, bool above) const {
    for (std::size_t k = 0; k < s_.phases().size(); ++k) {
      if (!wall(k)) continue;
      const PhaseParticles& p = s_.phases()[k];
      const auto c = static_cast<std::size_t>(axis);
      for (std::size_t i = 0; i < p.size(); ++i) {
        const double x = p.column(Field::position, axis)[i];
        if (above ? x > s_.plan().bounds.high[c] : x < s_.plan().bounds.low[c]) return true;
      }
    }
    return false;
  }

  std::string wrong_alone(std::size_t k, std::size_t i) const {
    const PhaseParticles& p = s_.phases()[k];
    const bool fluid = s_.plan().phases[k].kind == "fluid", grains = s_.plan().phases[k].kind == "grains";
    const double dx = s_.plan().phases[k].spacing, c = s_.plan().phases[k].sound_speed;
    for (int d = 0; d < p.dimensions(); ++d) {
      const double x = p.column(Field::position, d)[i];
      if (!std::isfinite(x) || !std::isfinite(p.column(Field::velocity, d)[i])) return "not finite";
      const auto axis = static_cast<std::size_t>(d);
      if (s_.plan().bounds.periodic[axis]) continue;
      const double below = s_.plan().bounds.low[axis] - x, above = x - s_.plan().bounds.high[axis];
      if (below > 0 && below > (!fluid && closed(d, false) ? 0.0 : 0.5 * dx)) return "outside";
      if (above > 0 && above > (!fluid && closed(d, true) ? 0.0 : 0.5 * dx)) return "outside";
    }
    const double speed = std::sqrt(squared_speed(p, i));
    if (!grains && speed > c) return "faster than sound";
    if (grains && speed * s_.last_step() > 0.25 * dx) return "a quarter of a spacing in a step";
    if (fluid && !(std::abs(p.column(Field::density)[i] / s_.scene().phases[k].density - 1) <= 0.3)) return "density";
    return "";
  }

  /// In spacings, of the particles of phase a (all, or one) to others of phase b.
  double distance(std::size_t a, std::size_t i, std::size_t b) const {
    const PhaseParticles &p = s_.phases()[a], &q = s_.phases()[b];
    double least = 1e300;
    for (std::size_t j = 0; j < q.size(); ++j) {
      if (a == b && i == j) continue;
      double r2 = 0;
      for (int d = 0; d < p.dimensions(); ++d) {
        const auto axis = static_cast<std::size_t>(d);
        double r = p.column(Field::position, d)[i] - q.column(Field::position, d)[j];
        const double period = s_.plan().bounds.high[axis] - s_.plan().bounds.low[axis];
        if (s_.plan().bounds.periodic[axis]) r = std::remainder(r, period);
        r2 += r * r;
      }
      least = std::min(least, r2);
    }
    return std::sqrt(least) / (0.5 * (s_.plan().phases[a].spacing + s_.plan().phases[b].spacing));
  }
  double least_distance(std::size_t a, std::size_t b) const {
    double least = 1e300;
    for (std::size_t i = 0; i < s_.phases()[a].size(); ++i) least = std::min(least, distance(a, i, b));
    return least;
  }
  double paired(std::size_t a) const {
    double near = 0;
    const std::size_t n = s_.phases()[a].size();
    for (std::size_t i = 0; i < n; ++i) near += distance(a, i, a) < 0.3 ? 1 : 0;
    return near / static_cast<double>(n);
  }

  const Simulation& s_;
};

}  // namespace barchan::stress
