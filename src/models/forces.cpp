#include "models/forces.hpp"

#include <algorithm>

namespace barchan {

std::array<Formula, 3> compile(const VectorExpression& e) { return {Formula(e[0]), Formula(e[1]), Formula(e[2])}; }

Forces::Forces(const Scene& scene, const std::string& phase) {
  for (const auto& f : scene.forcings)
    if (f.phase == phase && !f.hold_bulk_speed) forces_.push_back(compile(f.acceleration));
}

Vec3 Forces::uniform() const {
  Vec3 sum{0, 0, 0};
  for (const auto& force : forces_)
    for (std::size_t d = 0; d < 3; ++d)
      if (force[d].is_constant()) sum[d] += force[d].constant();
  return sum;
}

bool Forces::varies() const {
  return std::any_of(forces_.begin(), forces_.end(), [](const auto& force) {
    return std::any_of(force.begin(), force.end(), [](const Formula& f) { return !f.is_constant(); });
  });
}

void Forces::add(PhaseParticles& p, double time, bool numbers) const {
  for (const auto& force : forces_)
    for (int d = 0; d < p.dimensions(); ++d) {
      const Formula& formula = force[static_cast<std::size_t>(d)];
      if (formula.is_constant() && !numbers) continue;
      double* a = p.column(Field::acceleration, d);
      for (std::size_t k = 0; k < p.size(); ++k) {
        Vec3 x{};
        for (int e = 0; e < p.dimensions(); ++e) x[static_cast<std::size_t>(e)] = p.column(Field::position, e)[k];
        a[k] += formula.is_constant() ? formula.constant() : formula(x, time);
      }
    }
}

}  // namespace barchan
