#include "models/forces.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/exchange.hpp"
#include "engine/phase_sums.hpp"
namespace barchan {

namespace {

Vec3 place_of(const PhaseParticles& p, std::size_t k) {
  Vec3 x{};
  for (int d = 0; d < p.dimensions(); ++d) x[static_cast<std::size_t>(d)] = p.column(Field::position, d)[k];
  return x;
}

bool holds(const std::optional<BoxShape>& box, const Vec3& x, int dimensions) {
  for (std::size_t d = 0; box && d < static_cast<std::size_t>(dimensions); ++d)
    if (!(x[d] >= box->min[d] && x[d] < box->max[d])) return false;
  return true;
}

}  // namespace

std::array<Formula, 3> compile(const VectorExpression& e) { return {Formula(e[0]), Formula(e[1]), Formula(e[2])}; }

Forces::Forces(const Scene& scene, const std::string& phase) {
  for (const auto& f : scene.forcings) {
    if (f.phase != phase || f.hold != Hold::none) continue;
    if (f.relaxes()) zones_.push_back({compile(f.velocity), Formula(f.rate), f.box});
    else forces_.push_back({compile(f.acceleration), f.box});
  }
}

Vec3 Forces::uniform() const {
  Vec3 sum{0, 0, 0};
  for (const Force& force : forces_)
    for (std::size_t d = 0; d < 3; ++d)
      if (force.acceleration[d].is_constant() && !force.box) sum[d] += force.acceleration[d].constant();
  return sum;
}

bool Forces::varies() const {
  return !zones_.empty() || std::any_of(forces_.begin(), forces_.end(), [](const Force& force) {
    return force.box || std::any_of(force.acceleration.begin(), force.acceleration.end(),
                                    [](const Formula& f) { return !f.is_constant(); });
  });
}

void Forces::add(PhaseParticles& p, double time, bool numbers) const {
  for (const Force& force : forces_)
    for (int d = 0; d < p.dimensions(); ++d) {
      const Formula& formula = force.acceleration[static_cast<std::size_t>(d)];
      if (formula.is_constant() && !numbers && !force.box) continue;
      double* a = p.column(Field::acceleration, d);
      for (std::size_t k = 0; k < p.size(); ++k) {
        const Vec3 x = place_of(p, k);
        if (holds(force.box, x, p.dimensions())) a[k] += formula.is_constant() ? formula.constant() : formula(x, time);
      }
    }
}

Vec3 Forces::at(const Vec3& x, double time, int dimensions) const {
  Vec3 sum{};
  for (const Force& force : forces_)
    for (std::size_t d = 0; d < static_cast<std::size_t>(dimensions); ++d)
      if (holds(force.box, x, dimensions)) sum[d] += force.acceleration[d](x, time);
  return sum;
}

Vec3 Forces::varying(const Vec3& x, double time, int dimensions) const {
  Vec3 sum{};
  for (const Force& force : forces_) {
    if (!holds(force.box, x, dimensions)) continue;
    for (std::size_t d = 0; d < static_cast<std::size_t>(dimensions); ++d)
      if (force.box || !force.acceleration[d].is_constant()) sum[d] += force.acceleration[d](x, time);
  }
  return sum;
}

double Forces::stiffness(const Vec3& x, double time, int dimensions, double apart) const {
  const auto n = static_cast<std::size_t>(dimensions);
  std::array<Vec3, 3> slope{};  // by axis
  for (const Force& force : forces_) {
    if (!holds(force.box, x, dimensions)) continue;
    for (std::size_t d = 0; d < n; ++d) {
      const Formula& formula = force.acceleration[d];
      if (formula.is_constant()) continue;
      const double here = formula(x, time);
      for (std::size_t axis = 0; axis < n; ++axis) {
        Vec3 there = x;
        there[axis] += apart;
        slope[axis][d] += (formula(there, time) - here) / apart;
      }
    }
  }
  double sum = 0.0;
  for (const Vec3& s : slope) sum += dot(s, s);
  return std::sqrt(sum);
}

namespace {

/// Rate of a zone at a place (1/s); what is not finite goes on to the watch.
double rate_of(const Formula& rate, const Vec3& x, double time, double dt) {
  return std::clamp(rate.not_negative(x, time), 0.0, dt > 0.0 ? 0.5 / dt : 0.0);
}

}  // namespace

void Forces::relax(PhaseParticles& p, double time, double dt) const {
  const PhaseParticles& seen = p;
  for (const Zone& zone : zones_)
    for (std::size_t k = 0; k < p.size(); ++k) {
      const Vec3 x = place_of(seen, k);
      if (!holds(zone.box, x, p.dimensions())) continue;
      const double rate = rate_of(zone.rate, x, time, dt);
      if (rate <= 0.0) continue;
      for (int d = 0; d < p.dimensions(); ++d)
        p.column(Field::acceleration, d)[k] +=
            rate * (zone.velocity[static_cast<std::size_t>(d)](x, time) - seen.column(Field::velocity, d)[k]);
    }
}

Vec3 Forces::sum(const PhaseParticles& p, double time, double dt) const {
  Vec3 total = static_cast<double>(count_of(p)) * uniform();
  if (!varies()) return total;
  Exchange().in_turn(total, [&] { add_varying(total, p, time, dt); });
  return total;
}

/// Of the forces that differ from place to place, particle by particle.
void Forces::add_varying(Vec3& total, const PhaseParticles& p, double time, double dt) const {
  for (std::size_t k = 0; k < p.size(); ++k) {
    const Vec3 x = place_of(p, k);
    for (std::size_t d = 0; d < static_cast<std::size_t>(p.dimensions()); ++d) {
      for (const Force& force : forces_)
        if ((force.box || !force.acceleration[d].is_constant()) && holds(force.box, x, p.dimensions()))
          total[d] += force.acceleration[d](x, time);
      for (const Zone& zone : zones_)
        if (holds(zone.box, x, p.dimensions()))
          total[d] += rate_of(zone.rate, x, time, dt) *
                      (zone.velocity[d](x, time) - p.column(Field::velocity, static_cast<int>(d))[k]);
    }
  }
}

}  // namespace barchan
