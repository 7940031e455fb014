#include "models/fluid/energy_books.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/errors.hpp"
#include "engine/means.hpp"
#include "engine/phase_sums.hpp"
#include "engine/reproducible_sum.hpp"
#include "scene/couplings.hpp"

namespace barchan {

namespace {

/// The columns of history.csv, NAME_taken_by_...; in the order of EnergyBooks::Name.
constexpr std::array<const char*, EnergyBooks::count> names{
    "viscosity",    "artificial_viscosity", "surface_friction", "density_diffusion", "shifting", "loose_fluid",
    "torn_surface", "kept_density",         "pressure_sums",    "held_at_walls",     "forcing",  "open_sides"};
/// Whose work the terms of the acceleration are (the order of take_pushes), and those of the density's rate.
constexpr std::array pushed{EnergyBooks::pressure_sums,    EnergyBooks::viscosity, EnergyBooks::artificial_viscosity,
                            EnergyBooks::surface_friction, EnergyBooks::shifting,  EnergyBooks::forcing};
constexpr std::array squeezed{EnergyBooks::pressure_sums, EnergyBooks::density_diffusion, EnergyBooks::shifting,
                              EnergyBooks::loose_fluid, EnergyBooks::kept_density};

/// Columns of vectors, those that are there.
struct Columns {
  std::array<const double*, 3> of{};
  std::size_t dimensions;
  Columns(const PhaseParticles& p, Field field) : dimensions(static_cast<std::size_t>(p.dimensions())) {
    for (std::size_t d = 0; d < dimensions && p.has(field); ++d) of[d] = p.column(field, static_cast<int>(d));
  }
  Vec3 operator[](std::size_t k) const {
    Vec3 x{};
    for (std::size_t d = 0; d < dimensions; ++d) x[d] = of[d][k];
    return x;
  }
};

/// f = (p - p_0)/rho^2 and its first two derivatives.
std::array<double, 3> slopes(const PressureLaw& law, double rho) {
  const double stiffness = law.sound_speed * law.sound_speed, r = rho / law.reference_density;
  const bool linear = law.exponent == 1.0;
  const double p = law(rho) - law.background, first = linear ? stiffness : stiffness * std::pow(r, law.exponent - 1.0),
               second = linear ? 0.0 : first * (law.exponent - 1.0) / rho, v = 1.0 / rho;
  return {p * v * v, (first - 2.0 * p * v) * v * v, (second - 4.0 * first * v + 6.0 * p * v * v) * v * v};
}

}  // namespace

double compression_energy(const PressureLaw& law, double density) {
  const double strain = density / law.reference_density - 1.0, c2 = law.sound_speed * law.sound_speed;
  const double inverse = strain / (1.0 + strain);  // 1 - rho0/rho
  if (law.exponent == 1.0) return c2 * (std::log1p(strain) - inverse);
  const double power = law.exponent - 1.0;
  return c2 / law.exponent * (std::expm1(power * std::log1p(strain)) / power - inverse);
}

void check_energy_budget(const Scene& scene, std::size_t fluid, const Layout& layout) {
  const Phase& phase = scene.phases[fluid];
  const PlanPhase& plan = layout.phases[fluid];
  if (!phase.fluid().energy_budget) return;
  const auto refuse = [&](const std::string& what) {
    throw SceneError(scene.file + ": phases." + plan.name +
                     ".energy-budget: the books of the energy are not there yet " + what +
                     "; expected no such key, or one laminar fluid among walls at rest");
  };
  if (plan.eddies) refuse("for a fluid with turbulence, rough walls or walls with a shear-stress");
  if (!plan.flow_ends.empty()) refuse("for a fluid with an [[inflow]] or [[outflow]]");
  for (std::size_t k = 0; k < scene.phases.size(); ++k) {
    if (k == fluid || !entry_between(scene, phase, scene.phases[k])) continue;
    const PlanPhase& other = layout.phases[k];
    const std::string name = "\"" + other.name + "\"";
    if (other.flows()) refuse("next to another fluid (" + name + ")");
    if (other.moves()) refuse("next to a phase of kind \"" + other.kind + "\" (" + name + ")");
    if (other.travels()) refuse("next to a wall that a [[motion]] moves (" + name + ")");
    if (other.gives_energy()) refuse("next to a wall whose surface slides (" + name + ")");
    if (scene.phases[k].wall().law != WallLaw::adami) refuse("next to a wall with law = \"repulsive\" (" + name + ")");
  }
}

EnergyBooks::EnergyBooks(Fluid fluid, PhaseParticles& particles) : fluid_(std::move(fluid)), particles_(&particles) {}

/// Room for the particles of now: on several ranks their number comes and goes.
void EnergyBooks::fit() {
  const std::size_t n = particles_->size();
  if (terms_.size() >= n) return;
  parts_.fit(n, particles_->dimensions());
  for (auto* column : {&terms_, &slopes_[0], &slopes_[1], &slopes_[2]}) column->resize(n);
  if (tears()) density_.resize(n);
  if (!fluid_.may_take[held_at_walls]) return;
  for (std::size_t d = 0; d < static_cast<std::size_t>(particles_->dimensions()); ++d)
    for (auto* column : {&place_[d], &speed_[d]}) column->resize(n);
}

/// The sum of f(k) over all particles, of all ranks; the same on any number of threads.
template <class F>
double EnergyBooks::total(F&& f) {
  const auto n = static_cast<std::int64_t>(particles_->size());
  double* terms = terms_.data();
#pragma omp parallel for schedule(static)
  for (std::int64_t k = 0; k < n; ++k) terms[k] = f(static_cast<std::size_t>(k));
  return reproducible_total(terms, particles_->size());
}

double EnergyBooks::whole_energy() {
  const Columns x(*particles_, Field::position), v(*particles_, Field::velocity);
  const double* rho = std::as_const(*particles_).column(Field::density);
  return particles_->mass() * total([&](std::size_t k) {
           const Vec3 speed = v[k];
           return 0.5 * dot(speed, speed) - dot(fluid_.weight, x[k]) + compression_energy(fluid_.law, rho[k]);
         });
}

void EnergyBooks::begin_step(double dt) {
  fit();  // the particles may be those of a checkpoint
  Numbers& b = numbers_;
  const double half = 0.5 * dt;
  for (std::size_t i = 0; i < pushes; ++i) b.taken[pushed[i]] -= half * (b.power[i] + 0.5 * half * b.square[i]);
  for (std::size_t j = 0; j < squeezes; ++j)
    b.taken[squeezed[j]] -= dt * (b.work[j][0] + dt * (b.work[j][1] + dt * b.work[j][2]));
  b.taken[shifting] += dt * b.sinking;
}

void EnergyBooks::drifted() {
  if (!tears()) return;
  std::copy_n(std::as_const(*particles_).column(Field::density), particles_->size(), density_.data());
}

void EnergyBooks::released() {
  if (tears()) {
    const double* rho = std::as_const(*particles_).column(Field::density);
    numbers_.taken[torn_surface] += particles_->mass() * total([&](std::size_t k) {
                                      return rho[k] == density_[k] ? 0.0
                                                                   : compression_energy(fluid_.law, density_[k]) -
                                                                         compression_energy(fluid_.law, rho[k]);
                                    });
  }
  if (!fluid_.may_take[held_at_walls]) return;
  for (int d = 0; d < particles_->dimensions(); ++d) {
    const auto c = static_cast<std::size_t>(d);
    std::copy_n(std::as_const(*particles_).column(Field::position, d), particles_->size(), place_[c].data());
    std::copy_n(std::as_const(*particles_).column(Field::velocity, d), particles_->size(), speed_[c].data());
  }
}

void EnergyBooks::held() {
  if (fluid_.may_take[held_at_walls]) {
    const Columns x(*particles_, Field::position), v(*particles_, Field::velocity);
    numbers_.taken[held_at_walls] +=
        particles_->mass() * total([&](std::size_t k) {
          double lost = 0.0;
          for (std::size_t d = 0; d < x.dimensions; ++d) {
            const double before = speed_[d][k], now = v.of[d][k];
            lost += 0.5 * (before - now) * (before + now) + fluid_.weight[d] * (x.of[d][k] - place_[d][k]);
          }
          return lost;
        });
  }
  if (!leaves()) return;
  number_before_ = count_of(*particles_);
  energy_before_ = whole_energy();
}

void EnergyBooks::find_left() {
  fit();
  if (leaves() && number_before_ > count_of(*particles_)) numbers_.taken[open_sides] += energy_before_ - whole_energy();
  number_before_ = 0;
}

/// One term of the acceleration. `term(k)`: of particle k (m/s2).
template <class Term>
void EnergyBooks::take_push(std::size_t push, double kick, Term&& term) {
  Numbers& b = numbers_;
  b.power[push] = b.square[push] = 0.0;
  if (!fluid_.may_take[pushed[push]]) return;
  const Columns v(*particles_, Field::velocity), a(*particles_, Field::acceleration);
  const double m = particles_->mass();
  b.power[push] = m * total([&](std::size_t k) { return dot(term(k), v[k] + kick * a[k]); });
  b.square[push] = m * total([&](std::size_t k) { return dot(term(k), a[k]); });
  b.taken[pushed[push]] -= kick * (b.power[push] - 0.5 * kick * b.square[push]);
}

void EnergyBooks::take_pushes(double kick) {
  const Columns a(*particles_, Field::acceleration);
  const std::size_t dimensions = a.dimensions;
  const auto of = [dimensions](const auto& columns, std::size_t k, double share) {
    Vec3 x{};
    for (std::size_t d = 0; d < dimensions; ++d) x[d] = share * columns[d][k];
    return x;
  };
  const double plain = fluid_.viscosity, both = fluid_.viscosity + fluid_.artificial;
  const auto share = [&](std::size_t k, double part) {
    return parts_.viscosity[k] > 0.0 ? part / parts_.viscosity[k] : 0.0;
  };
  take_push(0, kick, [&](std::size_t k) { return of(parts_.pressure, k, 1.0); });
  take_push(1, kick,
            [&](std::size_t k) { return of(parts_.friction, k, share(k, plain)) + of(parts_.stress, k, 1.0); });
  take_push(2, kick, [&](std::size_t k) { return of(parts_.friction, k, share(k, fluid_.artificial)); });
  take_push(3, kick,
            [&](std::size_t k) { return of(parts_.friction, k, 1.0 - share(k, both)) + of(parts_.turning, k, 1.0); });
  take_push(4, kick, [&](std::size_t k) { return of(parts_.carried, k, 1.0); });
  take_push(5, kick, [&](std::size_t k) {
    Vec3 rest = a[k] - fluid_.weight;
    for (std::size_t d = 0; d < dimensions; ++d)
      rest[d] -= parts_.pressure[d][k] + parts_.friction[d][k] + parts_.stress[d][k] + parts_.turning[d][k] +
                 parts_.carried[d][k];
    return rest;
  });
}

/// One term of the density's rate. `rate(k)`: of particle k (kg/m3/s).
template <class Rate>
void EnergyBooks::take_squeeze(std::size_t squeeze, Rate&& rate) {
  auto& work = numbers_.work[squeeze];
  work = {};
  if (!fluid_.may_take[squeezed[squeeze]]) return;
  const double* whole = std::as_const(*particles_).column(Field::density_rate);
  const double m = particles_->mass();
  work[0] = m * total([&](std::size_t k) { return rate(k) * slopes_[0][k]; });
  work[1] = m / 2.0 * total([&](std::size_t k) { return rate(k) * whole[k] * slopes_[1][k]; });
  work[2] = m / 6.0 * total([&](std::size_t k) { return rate(k) * whole[k] * whole[k] * slopes_[2][k]; });
}

void EnergyBooks::take_squeezes() {
  const double *rho = std::as_const(*particles_).column(Field::density),
               *whole = std::as_const(*particles_).column(Field::density_rate);
  const auto n = static_cast<std::int64_t>(particles_->size());
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < n; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const std::array<double, 3> s = slopes(fluid_.law, rho[k]);
    for (std::size_t c = 0; c < 3; ++c) slopes_[c][k] = s[c];
  }
  const PartColumns& p = parts_;
  take_squeeze(0, [&](std::size_t k) { return p.squeezed[k]; });
  take_squeeze(1, [&](std::size_t k) { return p.diffused[k]; });
  take_squeeze(2, [&](std::size_t k) { return p.moved[k]; });
  take_squeeze(3, [&](std::size_t k) { return p.renewed[k]; });
  take_squeeze(4, [&](std::size_t k) { return whole[k] - p.squeezed[k] - p.diffused[k] - p.moved[k] - p.renewed[k]; });
}

void EnergyBooks::take(double kick, bool start) {
  take_pushes(kick);
  take_squeezes();
  const Columns shift(*particles_, Field::shift_velocity);
  numbers_.sinking = fluid_.may_take[shifting]
                         ? particles_->mass() * total([&](std::size_t k) { return dot(fluid_.weight, shift[k]); })
                         : 0.0;
  if (start) numbers_.start = whole_energy();
}

void EnergyBooks::history(HistoryRow& row) const {
  const PhaseParticles& p = *particles_;
  const Columns x(p, Field::position), v(p, Field::velocity);
  const double* rho = p.column(Field::density);
  const double kinetic = 0.5 * p.mass() * reproducible_sum(p.size(), [&](std::size_t k) { return dot(v[k], v[k]); });
  const double potential =
      -p.mass() * reproducible_sum(p.size(), [&](std::size_t k) { return dot(fluid_.weight, x[k]); });
  const double compression =
      p.mass() * reproducible_sum(p.size(), [&](std::size_t k) { return compression_energy(fluid_.law, rho[k]); });
  row.add(fluid_.name + "_potential_energy [J]", potential);
  row.add(fluid_.name + "_compression_energy [J]", compression);
  double unexplained = numbers_.start - kinetic - potential - compression;
  for (std::size_t i = 0; i < count; ++i) {
    unexplained -= numbers_.taken[i];
    if (fluid_.may_take[i]) row.add(fluid_.name + "_taken_by_" + names[i] + " [J]", numbers_.taken[i]);
  }
  row.add(fluid_.name + "_taken_unexplained [J]", unexplained);
}

}  // namespace barchan
