#include "models/bodies/angular_momentum.hpp"

#include "engine/phase_sums.hpp"

namespace barchan {

namespace {

double sum_over(const PhaseParticles* const* phases, std::size_t count, auto&& term) {
  double sum = 0.0;
  for (std::size_t k = 0; k < count; ++k) {
    const PhaseParticles& p = *phases[k];
    sum += sum_of(p, [&](std::size_t i) { return p.mass_of(i) * term(p, i); });
  }
  return sum;
}

Vec3 vector_of(const PhaseParticles& p, Field field, std::size_t i) {
  Vec3 v{};
  for (int d = 0; d < p.dimensions(); ++d) v[static_cast<std::size_t>(d)] = p.column(field, d)[i];
  return v;
}

/// `centre`, `velocity` (m, m/s): of the common centre of mass.
void add_body(Turning& t, const RigidBody& body, const Vec3& centre, const Vec3& velocity) {
  const Vec3 arm = centre_of(body) - centre, speed = centre_velocity(body) - velocity,
             turning = turning_about_centre(body), rate = OwnAxes(body).to_space(own_angular_velocity(body));
  // The sum of m r^2 about its place: half of the sum of the three moments.
  const double about_place =
      body.dimensions == 2 ? body.inertia[2] : 0.5 * (body.inertia[0] + body.inertia[1] + body.inertia[2]);
  t.momentum = t.momentum + turning + body.mass * cross(arm, speed);
  t.inertia += about_place - body.mass * dot(body.centre, body.centre) + body.mass * dot(arm, arm);
  t.energy += 0.5 * dot(rate, turning) + 0.5 * body.mass * dot(speed, speed);
}

}  // namespace

Turning turning_of(const PhaseParticles* const* phases, std::size_t count, const std::vector<RigidBody>& bodies) {
  Turning t;
  double mass = sum_over(phases, count, [](const PhaseParticles&, std::size_t) { return 1.0; });
  for (const RigidBody& body : bodies) mass += body.mass;
  if (!(mass > 0.0)) return t;
  const int dimensions = count > 0 ? phases[0]->dimensions() : bodies.front().dimensions;
  Vec3 centre{}, velocity{};
  for (std::size_t d = 0; d < static_cast<std::size_t>(dimensions); ++d) {
    const auto first_moment = [&](Field field) {
      return sum_over(phases, count,
                      [&](const PhaseParticles& p, std::size_t i) { return p.column(field, static_cast<int>(d))[i]; });
    };
    centre[d] = first_moment(Field::position);
    velocity[d] = first_moment(Field::velocity);
    for (const RigidBody& body : bodies) {
      centre[d] += body.mass * centre_of(body)[d];
      velocity[d] += body.mass * centre_velocity(body)[d];
    }
    centre[d] /= mass;
    velocity[d] /= mass;
  }
  const auto arm = [&](const PhaseParticles& p, std::size_t i) { return vector_of(p, Field::position, i) - centre; };
  const auto speed = [&](const PhaseParticles& p, std::size_t i) {
    return vector_of(p, Field::velocity, i) - velocity;
  };
  for (std::size_t c = dimensions == 2 ? 2 : 0; c < 3; ++c)
    t.momentum[c] = sum_over(phases, count,
                             [&](const PhaseParticles& p, std::size_t i) { return cross(arm(p, i), speed(p, i))[c]; });
  t.inertia =
      sum_over(phases, count, [&](const PhaseParticles& p, std::size_t i) { return dot(arm(p, i), arm(p, i)); });
  t.energy = 0.5 * sum_over(phases, count,
                            [&](const PhaseParticles& p, std::size_t i) { return dot(speed(p, i), speed(p, i)); });
  for (const RigidBody& body : bodies) add_body(t, body, centre, velocity);
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
