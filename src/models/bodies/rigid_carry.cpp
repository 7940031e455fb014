// What the particles of rigid bodies get from them, and what history.csv tells of the bodies.
#include <cmath>

#include "models/bodies/rigid_phase.hpp"

namespace barchan {

namespace {

/// m/s2 of its place and 1/s2, of a body that its loads move.
std::array<Vec3, 2> accelerations(const RigidBody& body) {
  const Vec3 linear = body.hold == RigidBody::Hold::free ? 1.0 / body.mass * body.now.force : Vec3{};
  if (body.dimensions == 2) return {linear, Vec3{0, 0, body.now.torque[2] / body.inertia[2]}};
  const OwnAxes axes(body);
  Vec3 turning = axes.to_own(body.now.torque) - cross(own_angular_velocity(body), body.now.spin);
  for (std::size_t d = 0; d < 3; ++d) turning[d] /= body.inertia[d];
  return {linear, axes.to_space(turning)};
}

}  // namespace

RigidPhase::Carrier::Carrier(const RigidBody& body)
    : axes(body), place(body.now.place), velocity(body.now.velocity), rate(axes.to_space(own_angular_velocity(body))) {}

void RigidPhase::renew_carriers() {
  carriers_.clear();
  for (std::size_t k = 0; k < bodies(); ++k) carriers_.emplace_back(body(k));
}

/// Places of the particles; along periodic axes the nearest images to where they are.
void RigidPhase::carry_places() {
  PhaseParticles& p = w_->particles(number_);
  renew_carriers();
  const Bounds& bounds = layout_.bounds;
  std::array<double*, 3> x{};
  std::array<double, 3> period{};
  for (std::size_t d = 0; d < static_cast<std::size_t>(layout_.dimensions); ++d) {
    x[d] = p.column(Field::position, static_cast<int>(d));
    if (bounds.periodic[d]) period[d] = bounds.high[d] - bounds.low[d];
  }
  const Vec3* const arm = p.own(arm_);
  const std::uint32_t* const body_of = p.own(body_of_);
  const auto n = static_cast<std::int64_t>(p.size());
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < n; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const Carrier& c = carriers_[body_of[k]];
    const Vec3 at = c.place + c.axes.to_space(arm[k]);
    for (std::size_t d = 0; d < static_cast<std::size_t>(layout_.dimensions); ++d) {
      const double turns = period[d] > 0.0 ? std::round((at[d] - x[d][k]) / period[d]) : 0.0;
      x[d][k] = at[d] - turns * period[d];
    }
  }
}

void RigidPhase::carry_velocities() {
  PhaseParticles& p = w_->particles(number_);
  renew_carriers();
  std::array<double*, 3> v{};
  for (int d = 0; d < layout_.dimensions; ++d) v[static_cast<std::size_t>(d)] = p.column(Field::velocity, d);
  const Vec3* const arm = p.own(arm_);
  const std::uint32_t* const body_of = p.own(body_of_);
  const auto n = static_cast<std::int64_t>(p.size());
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < n; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const Carrier& c = carriers_[body_of[k]];
    const Vec3 speed = c.velocity + cross(c.rate, c.axes.to_space(arm[k]));
    for (std::size_t d = 0; d < static_cast<std::size_t>(layout_.dimensions); ++d) v[d][k] = speed[d];
  }
}

void RigidPhase::carry_accelerations() {
  PhaseParticles& p = w_->particles(number_);
  renew_carriers();
  for (std::size_t k = 0; k < bodies(); ++k) {
    const auto gain = body(k).hold == RigidBody::Hold::driven ? driven(body(k)) : accelerations(body(k));
    carriers_[k].acceleration = gain[0];
    carriers_[k].turning = gain[1];
  }
  std::array<double*, 3> a{};
  for (int d = 0; d < layout_.dimensions; ++d) a[static_cast<std::size_t>(d)] = p.column(Field::acceleration, d);
  const Vec3* const arm = p.own(arm_);
  const std::uint32_t* const body_of = p.own(body_of_);
  const auto n = static_cast<std::int64_t>(p.size());
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < n; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const Carrier& c = carriers_[body_of[k]];
    const Vec3 r = c.axes.to_space(arm[k]);
    const Vec3 total = c.acceleration + cross(c.turning, r) + cross(c.rate, cross(c.rate, r));
    for (std::size_t d = 0; d < static_cast<std::size_t>(layout_.dimensions); ++d) a[d][k] = total[d];
  }
}

/// Velocities at the end of the step, for the fluids' energy: carried records.
template <int Dim>
void RigidPhase::inform_fluids() {
  using R = CarriedRecord<Dim>;
  constexpr std::size_t axes = Dim == 2 ? 1 : 3, first = Dim == 2 ? 2 : 0;
  const PhaseParticles& p = w_->particles(number_);
  RecordArray& records = w_->to_write(number_, Record::carried);
  renew_carriers();
  for (std::size_t k = 0; k < bodies(); ++k) old_rates_[k] = carriers_[k].rate;
  carriers_.clear();
  for (std::size_t k = 0; k < bodies(); ++k) {
    RigidBody ends = body(k);
    end_step(ends);
    carriers_.emplace_back(ends);
  }
  std::array<const double*, Dim> x{};
  for (std::size_t d = 0; d < Dim; ++d) x[d] = p.column(Field::position, static_cast<int>(d));
  const Vec3* const arm = p.own(arm_);
  const std::uint32_t* const body_of = p.own(body_of_);
  const auto n = static_cast<std::int64_t>(p.size());
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < n; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const Carrier& c = carriers_[body_of[k]];
    const Vec3 turning = cross(c.rate, c.axes.to_space(arm[k]));
    double* r = records[k];
    for (std::size_t d = 0; d < Dim; ++d) {
      r[R::position + d] = x[d][k];
      r[R::velocity + d] = c.velocity[d] + turning[d];
      r[R::turning + d] = turning[d];
    }
    for (std::size_t d = 0; d < axes; ++d) {
      r[R::rate + d] = c.rate[first + d];
      r[R::old_rate + d] = old_rates_[body_of[k]][first + d];
    }
  }
}
template void RigidPhase::inform_fluids<2>();
template void RigidPhase::inform_fluids<3>();

void RigidPhase::history(HistoryRow& row) const {
  const bool flat = layout_.dimensions == 2;
  const auto vector = [&](const std::string& name, const Vec3& v, const char* unit) {
    for (std::size_t d = 0; d < static_cast<std::size_t>(layout_.dimensions); ++d)
      row.add(name + "_" + "xyz"[d] + " [" + unit + "]", v[d]);
  };
  const auto axial = [&](const std::string& name, const Vec3& v, const char* unit) {
    if (flat) row.add(name + " [" + unit + "]", v[2]);
    else vector(name, v, unit);
  };
  for (std::size_t k = 0; k < bodies(); ++k) {
    const RigidBody& b = body(k);
    const OwnAxes axes(b);
    const std::string name = plan_.name + (bodies() > 1 ? "_" + std::to_string(k + 1) : "");
    const Vec3 arm = axes.to_space(b.centre), rate = axes.to_space(own_angular_velocity(b));
    vector(name, b.now.place + arm, "m");
    vector(name + "_velocity", b.now.velocity + cross(rate, arm), "m/s");
    if (flat) row.add(name + "_angle [rad]", b.now.angle);
    else
      for (std::size_t c = 0; c < 4; ++c) row.add(name + "_turn_" + std::to_string(c), b.now.turn[c]);
    axial(name + "_angular_velocity", rate, "1/s");
    axial(name + "_angular_momentum", axes.to_space(b.now.spin), "kg m2/s");
    vector(name + "_force", mean_force_[k].value(), "N");
    axial(name + "_torque", mean_torque_[k].value(), "N m");
    row.add(name + "_work [J]", b.now.touch_work);
  }
}

void RigidPhase::begin_row() {
  for (std::size_t k = 0; k < bodies(); ++k) {
    mean_force_[k].begin_row();
    mean_torque_[k].begin_row();
  }
}

void RigidPhase::archive(Archive& a) {
  for (std::size_t k = 0; k < bodies(); ++k) {
    mean_force_[k].archive(a, "force on " + plan_.name);
    mean_torque_[k].archive(a, "torque on " + plan_.name);
  }
}

}  // namespace barchan
