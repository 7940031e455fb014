#include "simulation/budget.hpp"

#include <algorithm>
#include <cmath>

#include "engine/reproducible_sum.hpp"
#include "output/numbers.hpp"

namespace barchan {

namespace {

bool moves(const WallKeys& wall) {
  return wall.shear_stress || std::any_of(wall.velocity.begin(), wall.velocity.end(),
                                          [](const Expression& e) { return e.is_formula() || e.value != 0.0; });
}

}  // namespace

Budget::Budget(const Scene& scene, const Plan& plan, const State& state) : gravity_(scene.domain.gravity) {
  bool walls = false, moving_walls = false;
  for (std::size_t k = 0; k < plan.phases.size(); ++k) {
    const PlanPhase& p = plan.phases[k];
    if (p.moves)
      moving_.push_back({k, p.flows ? p.sound_speed : 0.0, p.flows ? scene.phases[k].density : 0.0, p.weight_share});
    sound_speed_ = std::max(sound_speed_, plan.phases[k].sound_speed);
    if (const WallKeys* wall = scene.phases[k].if_wall()) {
      walls = true;
      moving_walls = moving_walls || moves(*wall);
    }
  }
  const bool blown = std::any_of(plan.entries.begin(), plan.entries.end(),
                                 [](const PlanEntry& e) { return e.kind == EntryKind::column; });  // it gives and takes
  const bool forced = !scene.forcings.empty() || !scene.motions.empty() || blown;
  keeps_energy_ = !forced && !moving_walls;
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
    const std::size_t n = p.size();
    s.mass += reproducible_sum(n, [&](std::size_t i) { return p.mass_of(i); });
    for (int d = 0; d < p.dimensions(); ++d) {
      const auto c = static_cast<std::size_t>(d);
      const double *v = p.column(Field::velocity, d), *x = p.column(Field::position, d);
      s.momentum[c] += reproducible_sum(n, [&](std::size_t i) { return p.mass_of(i) * v[i]; });
      s.kinetic += 0.5 * reproducible_sum(n, [&](std::size_t i) { return p.mass_of(i) * v[i] * v[i]; });
      if (gravity_[c] != 0.0)
        s.potential -=
            moving.weight_share * gravity_[c] * reproducible_sum(n, [&](std::size_t i) { return p.mass_of(i) * x[i]; });
    }
    if (moving.density > 0.0) {
      const double* rho = p.column(Field::density);
      s.stored += 0.5 * std::pow(moving.sound_speed, 2) * reproducible_sum(n, [&](std::size_t i) {
                    const double strain = rho[i] / moving.density - 1.0;
                    return p.mass_of(i) * strain * strain;
                  });
    }
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

std::optional<double> Budget::energy_growth(const State& state) const {
  const Sums now = sums(state);
  const double scale = std::max(now.kinetic, start_.kinetic);
  if (!keeps_energy_ || !(scale > 0.5 * now.mass * std::pow(idle * sound_speed_, 2))) return std::nullopt;
  return (now.mechanical() - start_.mechanical()) / scale;
}

void Budget::report(const State& state, Warnings& warnings) const {
  if (const auto drift = momentum_drift(state); drift && *drift > momentum_bound)
    warnings.add("momentum", "the momentum drifted by " + brief(100.0 * *drift) +
                                 " % of mass times speed, although nothing in the scene takes or gives any; expected "
                                 "at most " +
                                 brief(100.0 * momentum_bound) +
                                 " %: the results are not to be trusted "
                                 "in what depends on it; a smaller time.safety may help");
  if (const auto growth = energy_growth(state); growth && *growth > energy_bound)
    warnings.add("energy", "the energy of the motion, of the weight and of the compression together grew by " +
                               brief(100.0 * *growth) +
                               " % of the kinetic energy, although nothing in the scene drives it; expected at most " +
                               brief(100.0 * energy_bound) + " %: a smaller time.safety may help");
}

void Budget::archive(Archive& a) { a.number("budget at the start", start_); }

}  // namespace barchan
