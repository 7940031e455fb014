#include "simulation/budget.hpp"

#include <algorithm>
#include <cmath>

#include "engine/exchange.hpp"
#include "output/numbers.hpp"

namespace barchan {

namespace {

/// Of the sound speed: at this speed and below the weight of a fluid whose particles spread a little (its centre of
/// mass rises) is of the size of its kinetic energy.
constexpr double slow = 0.005;

double energy_at(double speed, double mass) { return 0.5 * mass * speed * speed; }

/// Whether something drives a phase and its work is no term of the energy.
bool drives_uncounted(const Scene& scene, const Plan& plan) {
  return std::any_of(scene.motions.begin(), scene.motions.end(), [&](const Motion& motion) {
    return std::none_of(plan.phases.begin(), plan.phases.end(),
                        [&](const PlanPhase& p) { return p.name == motion.phase && p.deforms(); });
  });
}

}  // namespace

Budget::Budget(const Scene& scene, const Plan& plan, const State& state) : gravity_(scene.domain.gravity) {
  bool walls = false, moving_walls = false;
  noiseless_ = true;
  for (std::size_t k = 0; k < plan.phases.size(); ++k) {
    const PlanPhase& p = plan.phases[k];
    if (p.moves())
      moving_.push_back(
          {k, p.flows() ? p.sound_speed : 0.0, p.flows() ? scene.phases[k].density : 0.0, p.weight_share});
    if (p.moves()) noiseless_ = noiseless_ && !p.flows() && !p.separate();
    sound_speed_ = std::max(sound_speed_, p.sound_speed);
    walls = walls || p.takes_momentum();
    moving_walls = moving_walls || p.gives_energy();
  }
  const bool blown =
      std::any_of(plan.entries.begin(), plan.entries.end(), [](const PlanEntry& e) { return e.wind_by_height; });
  const bool pushed = !scene.forcings.empty() || blown, forced = pushed || !scene.motions.empty();
  keeps_energy_ = !pushed && !moving_walls && !drives_uncounted(scene, plan);
  noiseless_ = noiseless_ && !moving_.empty();
  keeps_turning_ = noiseless_ && !walls && !forced && has_centre(plan);
  for (std::size_t d = 0; d < static_cast<std::size_t>(plan.dimensions); ++d) {
    keeps_momentum_[d] = !walls && !forced && gravity_[d] == 0.0;
    if (plan.bounds.periodic[d] && gravity_[d] != 0.0) keeps_energy_ = false;  // it falls for ever
  }
  start_ = sums(state);
}

Budget::Sums Budget::sums(const State& state) const {
  Sums s;
  for (const Moving& moving : moving_) {
    const PhaseParticles& p = state.phases[moving.phase];
    if (has_bodies(state, moving.phase)) continue;
    const Exchange among(p);
    const std::size_t n = p.size();
    s.mass += among.sum(n, [&](std::size_t i) { return p.mass_of(i); });
    for (int d = 0; d < p.dimensions(); ++d) {
      const auto c = static_cast<std::size_t>(d);
      const double *v = p.column(Field::velocity, d), *x = p.column(Field::position, d);
      s.momentum[c] += among.sum(n, [&](std::size_t i) { return p.mass_of(i) * v[i]; });
      s.kinetic += 0.5 * among.sum(n, [&](std::size_t i) { return p.mass_of(i) * v[i] * v[i]; });
      if (gravity_[c] != 0.0)
        s.potential -=
            moving.weight_share * gravity_[c] * among.sum(n, [&](std::size_t i) { return p.mass_of(i) * x[i]; });
    }
    if (moving.density > 0.0) {
      const double* rho = p.column(Field::density);
      s.stored += 0.5 * std::pow(moving.sound_speed, 2) * among.sum(n, [&](std::size_t i) {
        const double strain = rho[i] / moving.density - 1.0;
        return p.mass_of(i) * strain * strain;
      });
    }
  }
  for (const RigidBody& body : state.bodies) {
    const Vec3 momentum = body.mass * centre_velocity(body);
    s.mass += body.mass;
    for (std::size_t d = 0; d < 3; ++d) s.momentum[d] += momentum[d];
    s.kinetic += kinetic_energy(body);
    s.potential -= body.mass * dot(gravity_, centre_of(body));
  }
  if (keeps_turning_) {
    std::vector<const PhaseParticles*> bodies;
    for (const Moving& moving : moving_)
      if (!has_bodies(state, moving.phase)) bodies.push_back(&state.phases[moving.phase]);
    s.turning = turning_of(bodies.data(), bodies.size(), state.bodies);
  }
  for (const Departed& gone : state.departed) {
    s.potential += gone.kinetic + gone.potential + gone.stored;
    for (std::size_t d = 0; d < 3; ++d) s.momentum[d] += gone.momentum[d];
  }
  return s;
}

std::optional<double> Budget::momentum_drift(const State& state) const {
  const Sums now = sums(state);
  const double scale = std::sqrt(2.0 * now.mass * std::max(now.kinetic, start_.kinetic));  // mass times speed
  double most = -1.0;
  for (std::size_t d = 0; d < 3; ++d)
    if (keeps_momentum_[d]) most = std::max(most, std::abs(now.momentum[d] - start_.momentum[d]));
  if (most < 0.0 || !(scale > 0.0)) return std::nullopt;
  return most / scale;
}

std::optional<double> Budget::turning_drift(const State& state) const {
  if (!keeps_turning_) return std::nullopt;
  const Turning now = sums(state).turning;
  const double scale =
      std::sqrt(2.0 * std::max(now.inertia, start_.turning.inertia) * std::max(now.energy, start_.turning.energy));
  if (!(scale > 0.0)) return std::nullopt;
  return norm(now.momentum - start_.turning.momentum) / scale;
}

std::optional<double> Budget::energy_growth(const State& state, double held) const {
  const Sums now = sums(state);
  const double scale = std::max({now.kinetic, start_.kinetic, held}), quiet = noiseless_ ? idle_bodies : idle;
  if (!keeps_energy_ || !(scale > energy_at(quiet * sound_speed_, now.mass))) return std::nullopt;
  const double growth = now.mechanical() + held - start_.mechanical();
  if (noiseless_ || scale > energy_at(slow * sound_speed_, now.mass)) return growth / scale;
  // The noise of the pressure moves a fluid that rests. A slow motion counts where the scene begins with it.
  const bool fluids = std::all_of(moving_.begin(), moving_.end(), [](const Moving& m) { return m.density > 0.0; });
  if (!fluids || !(start_.kinetic > energy_at(idle * sound_speed_, now.mass))) return std::nullopt;
  return growth / start_.kinetic;
}

void Budget::report(const State& state, Warnings& warnings, double held) const {
  if (const auto drift = momentum_drift(state); drift && *drift > momentum_bound)
    warnings.add("momentum", "the momentum drifted by " + brief(100.0 * *drift) +
                                 " % of mass times speed, although nothing in the scene takes or gives any; expected "
                                 "at most " +
                                 brief(100.0 * momentum_bound) +
                                 " %: the results are not to be trusted "
                                 "in what depends on it; a smaller time.safety may help");
  if (const auto drift = turning_drift(state); drift && *drift > turning_bound)
    warnings.add("angular momentum",
                 "the angular momentum of the bodies about their centre drifted by " + brief(100.0 * *drift) +
                     " % of what their motion can have, although nothing in the scene turns them; expected at most " +
                     brief(100.0 * turning_bound) +
                     " %: updated Lagrangian bodies cannot turn; formulation = \"total-lagrangian\" can");
  const auto growth = energy_growth(state, held);
  if (!growth || *growth <= energy_bound) return;
  const bool fluids = std::any_of(moving_.begin(), moving_.end(), [](const Moving& m) { return m.density > 0.0; });
  const bool is_slow = start_.kinetic <= energy_at(slow * sound_speed_, start_.mass) || *growth > 1.0;
  if (!noiseless_ && fluids && is_slow) {
    // In per cent of so slow a motion, or of one in a small part of much water, it would be a large number, and say
    // nothing of the motion.
    const Sums now = sums(state);
    const double gained = now.mechanical() + held - start_.mechanical(), weight = start_.mass * norm(gravity_);
    return warnings.add(
        "energy",
        "the weight and the compression gained " + brief(gained) + " J" +
            (weight > 0.0 ? ", as if the centre of mass rose by " + brief(gained / weight) + " m" : std::string()) +
            ", although nothing in the scene gives it; the motion has " + brief(std::max(start_.kinetic, now.kinetic)) +
            " J: the particles of the fluid spread a little, and the budget of energy does "
            "not tell how well so slow a motion is kept; a smaller spacing makes it less");
  }
  std::string remedy = "a smaller time.safety may help";
  if (!noiseless_ && !fluids)
    remedy = "grains that overlap at the start push each other away: move the fills apart; else " + remedy;
  warnings.add("energy", "the energy of the motion, of the weight and of the " +
                             std::string(noiseless_ ? "strain"
                                         : fluids   ? "compression"
                                                    : "contacts") +
                             " together grew by " + brief(100.0 * *growth) + " % of the " +
                             (noiseless_ ? "larger of the energies of motion and strain" : "kinetic energy") +
                             ", although nothing in the scene gives it; expected at most " +
                             brief(100.0 * energy_bound) + " %: " + remedy);
}

void Budget::archive(Archive& a) { a.number("budget at the start", start_); }

}  // namespace barchan
