#include "models/drive.hpp"

#include <algorithm>
#include <cmath>

#include "engine/phase_sums.hpp"
#include "models/grains/saltation_layer.hpp"
#include "output/numbers.hpp"
#include "scene/couplings.hpp"

namespace barchan {

namespace {

/// A stress (Pa) as a friction velocity (m/s) of its sign.
double friction_velocity_of(double stress, double density) {
  return std::copysign(std::sqrt(std::abs(stress) / density), stress);
}

/// The largest |u*| of the logarithmic profiles with which fills of this phase begin; 0: none has one.
double of_profile(const Scene& scene, const Phase& fluid) {
  double u = 0.0;
  for (const Fill& fill : scene.fills)
    if (fill.phase == fluid.name && fill.log_profile) u = std::max(u, std::abs(fill.log_profile->friction_velocity));
  return u;
}

constexpr double most_pull = 1.5;  // times what a scene says

}  // namespace

void WindowMean::add(double length, double now, double dt, double value) {
  const auto present = static_cast<long>(std::floor((now - 0.5 * dt) / length));
  if (present != window) begin();
  window = present;
  add(dt, value);
}

void WindowMean::begin() {
  last = sum;
  last_time = time;
  sum = time = 0.0;
}

double warning_interval(const Scene& scene) { return scene.time.end / 10.0; }

bool Drive::exists(const Scene& scene, const Phase& fluid) {
  if (!scene.domain.periodic[0]) return false;
  const bool forced = std::any_of(scene.forcings.begin(), scene.forcings.end(), [&](const Forcing& f) {
    const Expression& along = f.acceleration[0];
    return f.phase == fluid.name && (f.hold != Hold::none || f.relaxes() || along.is_formula() || along.value != 0.0);
  });
  return forced || scene.domain.gravity[0] != 0.0 || wall_pull(scene, fluid) != 0.0;
}

Drive::Drive(const Scene& scene, const Phase& fluid)
    : name_(fluid.name),
      density_(fluid.density),
      area_(ground_area(scene)),
      gravity_(scene.domain.gravity[0]),
      walls_(wall_pull(scene, fluid)),
      tenth_(warning_interval(scene)) {
  const double u = of_profile(scene, fluid);
  said_ = std::max(density_ * u * u, std::abs(walls_));
  for (const Forcing& f : scene.forcings) {
    if (f.phase != fluid.name) continue;
    holds_speed_ = holds_speed_ || f.hold == Hold::bulk_speed;
    if (f.holds_force()) held_.emplace(f.friction_velocity);
  }
}

double Drive::missing(double time, double mass) const {
  const double u = (*held_)({}, time);
  return mass > 0.0 ? (density_ * u * std::abs(u) - walls_) * area_ / mass : 0.0;
}

void Drive::remember(const State& state, double held) {
  if (state.steps == 0) return;  // nothing has moved yet
  in_row_.add(state.dt, held);
  in_tenth_.add(tenth_, state.time, state.dt, held);
}

/// Without a step since the row before, the mean of that row stays.
void Drive::begin_row() {
  if (in_row_.time > 0.0) in_row_.begin();
}

double Drive::pull(double mass, double given, double held) const {
  return walls_ + mass * (gravity_ + given + held) / area_;
}

void Drive::history(HistoryRow& row, const PhaseParticles& p, double given, double held) const {
  const auto count = static_cast<double>(count_of(p));
  const double mass = p.mass() * count;
  add_pull(row, name_, pull(mass, count > 0.0 ? given / count : 0.0, in_row_.mean(held)), density_);
}

void Drive::report(double mass, Warnings& warnings) const {
  if (!holds_speed_ || !in_tenth_.any() || !(said_ > 0.0)) return;
  const double pulls = pull(mass, 0.0, in_tenth_.recent(tenth_));
  if (!(std::abs(pulls) > most_pull * said_)) return;
  warnings.add("pull on " + name_,
               "\"" + name_ + "\" was pulled with " + brief(pulls) +
                   " Pa, a mean over the last tenth of the run, as a wind of u* = " +
                   brief(std::abs(friction_velocity_of(pulls, density_))) +
                   " m/s is: " + brief(std::abs(pulls) / said_) + " times the " + brief(said_) +
                   " Pa (u* = " + brief(friction_velocity_of(said_, density_)) +
                   " m/s) that its logarithmic profile or the shear-stress of its walls says; expected at most " +
                   brief(most_pull) + " times: under hold = \"bulk-speed\" u* is a result; hold = \"stress\" keeps it");
}

void Drive::archive(Archive& a) {
  a.number(name_ + ": hold since the last row", in_row_);
  a.number(name_ + ": hold in a tenth of the run", in_tenth_);
}

std::function<double(double time)> stated_friction_velocity(const Scene& scene, const Phase& fluid) {
  for (const Forcing& f : scene.forcings)
    if (f.phase == fluid.name && f.holds_force())
      return [u = f.friction_velocity](double time) { return std::abs(Formula(u)({}, time)); };
  double u = of_profile(scene, fluid);
  for (const Inflow& inflow : scene.inflows)
    if (!(u > 0.0) && inflow.phase == fluid.name && inflow.log_profile)
      u = std::abs(inflow.log_profile->friction_velocity);
  if (!(u > 0.0)) u = std::sqrt(std::abs(wall_pull(scene, fluid)) / fluid.density);
  return [u](double) { return u; };
}

double largest_friction_velocity(const Scene& scene, const Expression& friction_velocity) {
  const Formula u(friction_velocity);
  double largest = 0.0;
  for (int k = 0; k <= 64; ++k) largest = std::max(largest, std::abs(u({}, scene.time.end * k / 64.0)));
  return largest;
}

void add_pull(HistoryRow& row, const std::string& name, double pull, double density) {
  row.add(name + "_pull [Pa]", pull);
  row.add(name + "_equivalent_friction_velocity [m/s]", friction_velocity_of(pull, density));
}

}  // namespace barchan
