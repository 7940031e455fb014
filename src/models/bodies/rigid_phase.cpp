#include "models/bodies/rigid_phase.hpp"

#include <algorithm>
#include <cmath>

#include "engine/phase_sums.hpp"
#include "output/numbers.hpp"

namespace barchan {

namespace {

constexpr double largest_turn = 0.1;   // rad a step: turn_freely() then keeps the energy within 1e-8
constexpr double largest_way = 0.2;    // spacings a step, of any particle of a body
constexpr double out_of_scale = 10.0;  // of the largest speed of the scene: a body that fast is a fault

/// s; 1e300 where the body is at rest.
double step_of(const RigidBody& body, double spacing) {
  const double turns = norm(own_angular_velocity(body)), speed = norm(body.now.velocity) + turns * body.reach;
  double step = 1e300;
  if (turns > 0.0) step = largest_turn / turns;
  if (speed > 0.0) step = std::min(step, largest_way * spacing / speed);
  return step;
}

/// Of vectors; `sum`: of numbers.
template <class Sum, class F>
Vec3 vector_sum(Sum&& sum, F&& f) {
  Vec3 total{};
  for (std::size_t d = 0; d < 3; ++d) total[d] = sum([&](std::size_t k) { return f(k)[d]; });
  return total;
}

PhaseRules rigid_rules(const PlanPhase& p, double largest_speed, const std::string& step_key) {
  PhaseRules r;
  r.way = 0.5 * p.spacing;
  r.signal_speed = largest_speed > 0.0 ? out_of_scale * largest_speed : 1e300;
  r.idle = 0.0;
  // That outlines stop at walls is what RigidContact looks at.
  r.one = "particle of a rigid body";
  r.remedy = [key = "phases." + p.name + ".stiffness", step_key](Fault fault, double, double bound) {
    switch (fault) {
      case Fault::passed_wall: return "raise " + key + " or time.largest-speed";
      case Fault::density: return std::string("is impossible");
      case Fault::too_fast:
        return "ten times the largest speed of the scene, from which the stiffness of contacts follows (the bound is " +
               brief(bound) + " m/s): raise time.largest-speed";
      case Fault::too_far: return "lower " + step_key;
      default: return key;
    }
  };
  return r;
}

}  // namespace

void declare_rigid(const Scene&, std::size_t number, Layout& layout) { layout.phases[number].mover = Mover::rigid; }

void describe_rigid(const Scene& scene, const std::vector<ParticleBlock>& blocks, std::size_t number, Layout& layout,
                    std::vector<std::string>&) {
  PlanPhase& p = layout.phases[number];
  p.fields = {Field::position, Field::velocity, Field::acceleration};
  p.rigid_bodies = rigid_bodies(scene, blocks[number], number, layout);
  p.rules = rigid_rules(p, layout.largest_speed, scene.time.fixed_step ? "time.step" : "time.safety");
}

RigidHold::RigidHold(const Motion& motion)
    : velocity(compile(motion.velocity)),
      rate(compile(motion.angular_velocity.value_or(AxialExpression{}).about)),
      torque(compile(motion.torque.value_or(AxialExpression{}).about)),
      friction(motion.friction) {}

RigidPhase::RigidPhase(const Scene& scene, const Layout& layout, std::size_t number)
    : scene_(scene),
      layout_(layout),
      plan_(layout.phases[number]),
      number_(number),
      forces_(scene, plan_.name),
      limit_{"motion " + plan_.name, 1e300, "a tenth of a radian, a fifth of a spacing"} {
  for (const Motion& motion : scene.motions) holds_.emplace_back(motion);
  touches_spheres_ = std::any_of(layout.entries.begin(), layout.entries.end(),
                                 [&](const PlanEntry& e) { return e.has(number) && e.own_steps(); });
  felt_ = forces_.any() || std::any_of(layout.entries.begin(), layout.entries.end(),
                                       [&](const PlanEntry& e) { return e.has(number) && !e.by_outlines(); });
}

void RigidPhase::begin(State& state, const std::vector<ParticleBlock>& blocks) {
  first_body_ = state.bodies.size();
  const std::vector<Vec3>& x = blocks[number_].position;
  PhaseParticles& p = state.phases[number_];
  arm_ = p.add_own<Vec3>("arm");
  body_of_ = p.add_own<std::uint32_t>("body");
  for (const RigidBody& body : plan_.rigid_bodies) {
    const OwnAxes axes(body);
    for (std::size_t k = 0; k < body.count; ++k) {
      p.own(arm_)[body.first + k] = axes.to_own(x[body.first + k] - body.now.place);
      p.own(body_of_)[body.first + k] = static_cast<std::uint32_t>(state.bodies.size() - first_body_);
    }
    const Vec3 mean = 1.0 / static_cast<double>(body.count) *
                      vector_sum([&](auto&& f) { return reproducible_sum(body.count, f, nullptr); },
                                 [&](std::size_t k) { return p.own(arm_)[body.first + k]; });
    levers_.push_back(body.centre - mean);
    mass_shares_.push_back(body.mass / (p.mass() * static_cast<double>(body.count)));
    state.bodies.push_back(body);
  }
}

void RigidPhase::attach(Workspace& w) {
  w_ = &w;
  carriers_.reserve(bodies());
  old_rates_.resize(bodies());
  mean_force_.resize(bodies());
  mean_torque_.resize(bodies());
  w.particles(number_).keep_places();
  for (std::size_t k = 0; k < bodies(); ++k) drive(body(k), w.state.time);
  carry_velocities();
}

void RigidPhase::schedule(Schedule& s) {
  using enum Field;
  s.add({stage::kick_and_drift, plan_.name, {{plan_.name, {position}, {position, velocity}}}, [this] {
           kick_and_drift();
         }});
  if (touches_spheres_)  // which moved its bodies after that
    s.add({stage::walls, plan_.name, {{plan_.name, {position}, {position, velocity}}}, [this] {
             carry_places();
             carry_velocities();
           }});
  s.add({stage::rigid_loads, plan_.name, {{plan_.name, {position}, {acceleration}}}, [this] { clear_loads(); }});
  const RecordTouch told{{}, {}, plan_.heats ? RecordSet{Record::carried} : RecordSet{}};
  s.add({stage::rigid, plan_.name, {{plan_.name, {position, acceleration}, {acceleration}, told}}, [this] {
           sum_loads();
         }});
  s.add({stage::kick, plan_.name, {{plan_.name, {}, {velocity}}}, [this] { finish_kick(); }});
}

void RigidPhase::limits(std::vector<StepLimit>& limits) const {
  double step = layout_.largest_speed > 0.0 ? largest_way * plan_.spacing / layout_.largest_speed : 1e300;
  for (const RigidBody& body : plan_.rigid_bodies) step = std::min(step, step_of(body, plan_.spacing));
  if (step < 1e300)
    limits.push_back({"rigid " + plan_.name, scene_.time.safety * step,
                      "a fifth of a spacing at the largest speed, a tenth of a radian at the start"});
}

const StepLimit* RigidPhase::moving_limit() {
  limit_.value = 1e300;
  for (std::size_t k = 0; k < bodies(); ++k)
    limit_.value = std::min(limit_.value, scene_.time.safety * step_of(body(k), plan_.spacing));
  return &limit_;
}

namespace {

/// W, of what touches the body.
double touch_power(const RigidBody& body) {
  return dot(body.now.touch_force, body.now.velocity) +
         dot(OwnAxes(body).to_own(body.now.touch_torque), own_angular_velocity(body));
}

Vec3 value(const std::array<Formula, 3>& f, double time) { return {f[0]({}, time), f[1]({}, time), f[2]({}, time)}; }

}  // namespace

/// Velocities change evenly while forces act, so that the mean power is exact. Driven bodies keep theirs.
void RigidPhase::kick(RigidBody& body, double time) {
  const double before = touch_power(body);
  if (body.hold == RigidBody::Hold::free) body.now.velocity = body.now.velocity + time / body.mass * body.now.force;
  if (body.hold != RigidBody::Hold::driven)
    body.now.spin = body.now.spin + time * OwnAxes(body).to_own(body.now.torque);
  body.now.touch_work += 0.5 * time * (before + touch_power(body));
}

/// Gives a driven body the velocities of its motion at a time (s).
void RigidPhase::drive(RigidBody& body, double time) const {
  if (body.hold != RigidBody::Hold::driven) return;
  const RigidHold& hold = holds_[body.motion];
  body.now.velocity = value(hold.velocity, time);
  body.now.spin = spin_of(body, OwnAxes(body).to_own(value(hold.rate, time)));
}

/// What a driven body gains in the next step: m/s2 of its place, and 1/s2.
std::array<Vec3, 2> RigidPhase::driven(const RigidBody& body) const {
  const RigidHold& hold = holds_[body.motion];
  const double now = w_->state.time, per_step = 1.0 / w_->state.dt;
  const auto gain = [&](const std::array<Formula, 3>& f) {
    return per_step * (value(f, now + w_->state.dt) - value(f, now));
  };
  return {gain(hold.velocity), gain(hold.rate)};
}

/// Half a kick, and a step of the way; driven bodies go with their velocities in the middle of the step.
void RigidPhase::kick_and_drift() {
  const double dt = w_->state.dt;
  for (std::size_t k = 0; k < bodies(); ++k) {
    RigidBody& b = body(k);
    kick(b, 0.5 * dt);
    drive(b, w_->state.time + 0.5 * dt);
    if (b.hold != RigidBody::Hold::pinned) b.now.place = b.now.place + dt * b.now.velocity;
    if (b.hold == RigidBody::Hold::driven) {
      const Vec3 rate = OwnAxes(b).to_space(own_angular_velocity(b));
      turn_by(b, rate, dt);
      b.now.spin = spin_of(b, OwnAxes(b).to_own(rate));
    } else {
      turn_freely(b, dt);
    }
  }
  carry_places();
  carry_velocities();
}

void RigidPhase::clear_loads() {
  PhaseParticles& p = w_->particles(number_);
  for (int d = 0; d < layout_.dimensions; ++d) std::fill_n(p.column(Field::acceleration, d), p.size(), 0.0);
  for (std::size_t k = 0; k < bodies(); ++k) body(k).now.touch_force = body(k).now.touch_torque = Vec3{};
  if (forces_.any()) add_forcings(p);
}

/// A [[forcing]] accelerates the mass of a body, which is not that of its particles and need not have its centre where
/// their mean is: they are points at which the force is looked up.
void RigidPhase::add_forcings(PhaseParticles& p) {
  forces_.add(p, w_->state.time, true);
  const std::uint32_t* const body_of = p.own(body_of_);
  for (int d = 0; d < layout_.dimensions; ++d) {
    double* const a = p.column(Field::acceleration, d);
    for (std::size_t k = 0; k < p.size(); ++k) a[k] *= mass_shares_[body_of[k]];
  }
  for (std::size_t b = 0; b < bodies(); ++b) {
    const std::uint32_t* const place_of = p.places() + body(b).first;
    const Vec3 force = p.mass() * vector_sum([&](auto&& f) { return sum_of(p, body(b).count, f); },
                                             [&](std::size_t k) {
                                               Vec3 a{};
                                               for (int d = 0; d < layout_.dimensions; ++d)
                                                 a[static_cast<std::size_t>(d)] =
                                                     p.column(Field::acceleration, d)[place_of[k]];
                                               return a;
                                             });
    body(b).now.touch_torque = cross(OwnAxes(body(b)).to_space(levers_[b]), force);
  }
}

/// The forces on its particles.
void RigidPhase::add_particles(std::size_t number) {
  RigidBody& body = this->body(number);
  const PhaseParticles& p = w_->particles(number_);
  const OwnAxes axes(body);
  const Vec3* const arm = p.own(arm_);
  const auto force_on = [&](std::size_t place) {
    Vec3 f{};
    for (int d = 0; d < layout_.dimensions; ++d)
      f[static_cast<std::size_t>(d)] = p.mass() * p.column(Field::acceleration, d)[place];
    return f;
  };
  const std::uint32_t* const place_of = p.places() + body.first;
  for (std::size_t d = 0; d < 3; ++d) {
    body.now.touch_force[d] += sum_of(p, body.count, [&](std::size_t k) { return force_on(place_of[k])[d]; });
    body.now.touch_torque[d] += sum_of(
        p, body.count, [&](std::size_t k) { return cross(axes.to_space(arm[place_of[k]]), force_on(place_of[k]))[d]; });
  }
}

/// Torque of the motion that holds a body which turns freely about a place. Friction stops it within a step, and
/// holds it against as much as it can.
void RigidPhase::hold_torque(RigidBody& body) {
  if (body.hold != RigidBody::Hold::pinned) return;
  const RigidHold& hold = holds_[body.motion];
  body.now.torque = body.now.torque + value(hold.torque, w_->state.time);
  if (!(hold.friction > 0.0)) return;
  const Vec3 stopping = -1.0 / w_->state.dt * OwnAxes(body).to_space(body.now.spin) - body.now.torque;
  const double needed = norm(stopping);
  body.now.torque = body.now.torque + (needed > hold.friction ? hold.friction / needed : 1.0) * stopping;
}

/// Forces and torques on the bodies, and the accelerations of their particles.
void RigidPhase::sum_loads() {
  const Vec3& gravity = scene_.domain.gravity;
  for (std::size_t k = 0; k < bodies(); ++k) {
    RigidBody& b = body(k);
    if (felt_) add_particles(k);
    const Vec3 weight = b.mass * gravity;
    b.now.force = b.now.touch_force + weight;
    b.now.torque = b.now.touch_torque;
    if (b.hold == RigidBody::Hold::pinned) b.now.torque = b.now.torque + cross(OwnAxes(b).to_space(b.centre), weight);
    if (layout_.dimensions == 2) b.now.torque[0] = b.now.torque[1] = 0.0;
    hold_torque(b);
  }
  carry_accelerations();
  if (plan_.heats) layout_.dimensions == 2 ? inform_fluids<2>() : inform_fluids<3>();
}

void RigidPhase::end_step(RigidBody& body) const {
  drive(body, w_->state.time);
  kick(body, w_->kick_time);
}

/// What touches a body, for the means of rows.
void RigidPhase::sum_up(std::size_t k) {
  const RigidMotion& now = body(k).now;
  if (w_->state.steps == 0) {
    mean_force_[k].start(now.touch_force);
    return mean_torque_[k].start(now.touch_torque);
  }
  mean_force_[k].add(now.touch_force, w_->state.dt);
  mean_torque_[k].add(now.touch_torque, w_->state.dt);
}

void RigidPhase::finish_kick() {
  for (std::size_t k = 0; k < bodies(); ++k) {
    end_step(body(k));
    sum_up(k);
  }
  carry_velocities();
}

}  // namespace barchan
