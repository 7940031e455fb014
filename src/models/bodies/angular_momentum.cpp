#include "models/bodies/angular_momentum.hpp"

#include "engine/reproducible_sum.hpp"

namespace barchan {

namespace {

double sum_over(const PhaseParticles* const* phases, std::size_t count, auto&& term) {
  double sum = 0.0;
  for (std::size_t k = 0; k < count; ++k) {
    const PhaseParticles& p = *phases[k];
    const ranks::Alone alone(p.is_whole());
    sum += reproducible_sum(p.size(), [&](std::size_t i) { return p.mass_of(i) * term(p, i); });
  }
  return sum;
}

Vec3 vector_of(const PhaseParticles& p, Field field, std::size_t i) {
  Vec3 v{};
  for (int d = 0; d < p.dimensions(); ++d) v[static_cast<std::size_t>(d)] = p.column(field, d)[i];
  return v;
}

}  // namespace

Turning turning_of(const PhaseParticles* const* phases, std::size_t count) {
  Turning t;
  const double mass = sum_over(phases, count, [](const PhaseParticles&, std::size_t) { return 1.0; });
  if (!(mass > 0.0)) return t;
  Vec3 centre{}, velocity{};
  for (int d = 0; d < phases[0]->dimensions(); ++d) {
    const auto mean = [&](Field field) {
      return sum_over(phases, count, [&](const PhaseParticles& p, std::size_t i) { return p.column(field, d)[i]; }) /
             mass;
    };
    centre[static_cast<std::size_t>(d)] = mean(Field::position);
    velocity[static_cast<std::size_t>(d)] = mean(Field::velocity);
  }
  const auto arm = [&](const PhaseParticles& p, std::size_t i) { return vector_of(p, Field::position, i) - centre; };
  const auto speed = [&](const PhaseParticles& p, std::size_t i) {
    return vector_of(p, Field::velocity, i) - velocity;
  };
  for (std::size_t c = phases[0]->dimensions() == 2 ? 2 : 0; c < 3; ++c)
    t.momentum[c] = sum_over(phases, count,
                             [&](const PhaseParticles& p, std::size_t i) { return cross(arm(p, i), speed(p, i))[c]; });
  t.inertia =
      sum_over(phases, count, [&](const PhaseParticles& p, std::size_t i) { return dot(arm(p, i), arm(p, i)); });
  t.energy = 0.5 * sum_over(phases, count,
                            [&](const PhaseParticles& p, std::size_t i) { return dot(speed(p, i), speed(p, i)); });
  return t;
}

bool has_centre(const Layout& layout) {
  for (std::size_t d = 0; d < static_cast<std::size_t>(layout.dimensions); ++d)
    if (layout.bounds.periodic[d]) return false;
  return true;
}

void add_angular_momentum(HistoryRow& row, const PhaseParticles& phase, const Layout& layout) {
  if (!has_centre(layout)) return;
  const PhaseParticles* one = &phase;
  const Turning t = turning_of(&one, 1);
  const std::string name = phase.name() + "_angular_momentum";
  if (layout.dimensions == 2) return row.add(name + " [kg m2/s]", t.momentum[2]);
  for (std::size_t c = 0; c < 3; ++c) row.add(name + "_" + "xyz"[c] + " [kg m2/s]", t.momentum[c]);
}

}  // namespace barchan
