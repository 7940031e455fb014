#include "models/grains/sphere_bodies.hpp"

#include <algorithm>
#include <cmath>

#include "base/errors.hpp"
#include "models/grains/spheres.hpp"
#include "output/numbers.hpp"
#include "scene/located.hpp"

namespace barchan {

namespace {

using One = simd::Vec<double, 1>;
constexpr std::size_t block = 256;  // spheres whose loads on bodies are summed together: the order of every sum

/// 1/kg, by metre of depth in 2D: how much a force at the arm (m) along a direction changes the velocity there.
double inverse_mass(const RigidBody& body, const OwnAxes& axes, const Vec3& arm, const Vec3& direction) {
  if (body.hold == RigidBody::Hold::driven) return 0.0;
  const Vec3 lever = axes.to_own(cross(arm, direction));
  double inverse = body.hold == RigidBody::Hold::free ? 1.0 / body.mass : 0.0;
  if (body.dimensions == 2) return inverse + lever[2] * lever[2] / body.inertia[2];
  for (std::size_t d = 0; d < 3; ++d) inverse += lever[d] * lever[d] / body.inertia[d];
  return inverse;
}

/// The largest inverse mass that a body can have at its border.
double lightest(const RigidBody& body, double reach) {
  if (body.hold == RigidBody::Hold::driven) return 0.0;
  const double least =
      body.dimensions == 2 ? body.inertia[2] : std::min({body.inertia[0], body.inertia[1], body.inertia[2]});
  return (body.hold == RigidBody::Hold::free ? 1.0 / body.mass : 0.0) + reach * reach / least;
}

}  // namespace

void describe_spheres_on_bodies(const Scene& scene, const Interaction& pair, const Layout& layout, PlanEntry& e) {
  describe_sphere_contact(scene, pair, layout, e);
  e.pairs = Pairs::spheres_and_outlines;
  e.meaning = "spheres and outlines: touching decides";
}

void SphereBodies::begin(const Layout& layout, State& state) {
  memory_.resize(layout.phases.size());
  remembers_.assign(layout.phases.size(), 0);
  for (const PlanEntry& e : layout.entries) {
    if (!e.own_steps() || !e.by_outlines()) continue;
    const std::size_t grains = layout.phases[e.a].own_steps() ? e.a : e.b;
    if (remembers_[grains] != 0 || !layout.phases[e.partner(grains)].moves()) continue;
    memory_[grains] = state.phases[grains].add_own<SolidTouches>("bodies that it touches");
    remembers_[grains] = 1;
  }
}

void SphereBodies::attach(const Scene& scene, const Layout& layout, const SphereLaws& laws, State& state) {
  layout_ = &layout;
  state_ = &state;
  const std::size_t n = layout.phases.size();
  for (std::size_t d = 0; d < 3; ++d)
    period_[d] = layout.bounds.periodic[d] ? layout.bounds.high[d] - layout.bounds.low[d] : 0.0;
  double least = 1e300, widest = 0.0;  // kg, m
  for (std::size_t k = 0; k < n; ++k) {
    if (remembers_[k] == 0) continue;
    const auto size = scene.phases[k].diameter();
    const double share = size ? size->least_share() : 1.0;
    least = std::min(least, layout.phases[k].mass * layout.slab * share * share * share);
    widest = std::max(widest, layout.phases[k].largest_size);
  }
  for (std::size_t b = 0; b < state.bodies.size(); ++b) {
    const std::size_t phase = state.bodies[b].phase;
    const bool touches = std::any_of(layout.entries.begin(), layout.entries.end(), [&](const PlanEntry& e) {
      return e.own_steps() && e.by_outlines() && e.has(phase);
    });
    if (!touches) continue;
    const auto& own = layout.phases[phase].rigid_bodies;
    std::size_t first = b;
    while (first > 0 && state.bodies[first - 1].phase == phase) --first;
    const RigidBody& start = own[b - first];
    const double spacing = layout.phases[phase].spacing;
    bodies_.emplace_back(b, phase, b - first,
                         BodyBorder(start, scene, spacing, start.reach + spacing, widest + spacing));
    Body& body = bodies_.back();
    body.name = layout.phases[phase].name + (own.size() > 1 ? "_" + std::to_string(b - first + 1) : "");
    for (std::size_t d = 0; d < static_cast<std::size_t>(layout.dimensions); ++d)
      if (period_[d] > 0.0 && 2.0 * body.border.reach() + widest > period_[d])
        throw SceneError(located(scene, "domain.size") + ": a body of \"" + layout.phases[phase].name +
                         "\" is wider than the periodic domain, so that spheres could touch it on both sides; expected "
                         "a longer one");
    if (const double inverse = lightest(start, body.border.reach()) / layout.slab; inverse * least > 1.0)
      throw SceneError(located(scene, "phases." + layout.phases[phase].name + ".density") +
                       ": a place of a body of \"" + layout.phases[phase].name + "\" gives way like a mass of " +
                       brief(1.0 / inverse) + " kg, less than the lightest sphere that touches it (" + brief(least) +
                       " kg): the steps of contacts follow from the spheres; expected a heavier body");
    axes_.emplace_back(start);
    const auto surface = SolidSurface::of(scene.fills[start.fill].shape, scene, spacing, widest + spacing);
    if (!surface) throw std::logic_error("spheres touch a body without a surface");
    solids_.add_surface(solids_.add_solid(), *surface);
  }
  solids_.prepare(period_);
  laws_.assign(n * bodies_.size(), SphereSearch::none);
  for (std::size_t k = 0; k < n; ++k)
    for (std::size_t b = 0; b < bodies_.size(); ++b)
      if (remembers_[k] != 0) laws_[k * bodies_.size() + b] = laws.table()[k * n + bodies_[b].phase];
}

/// What contacts ask of a body, once a step.
void SphereBodies::see(Body& body) {
  const RigidBody& now = state_of(body);
  OwnAxes& axes = axes_[static_cast<std::size_t>(&body - bodies_.data())];
  axes = OwnAxes(now);
  solids_.move(static_cast<std::uint32_t>(&body - bodies_.data()), layout_->phases[body.phase].rigid_bodies[body.own],
               now);
  body.place = now.now.place;
  body.velocity = now.now.velocity;
  body.rate = axes.to_space(own_angular_velocity(now));
}

/// The force of the last step acts for a time (s).
void SphereBodies::kick(Body& body, double time) {
  RigidBody& now = state_of(body);
  const OwnAxes axes(now);
  const auto power = [&] {
    return dot(body.force, now.now.velocity) + dot(axes.to_own(body.torque), own_angular_velocity(now));
  };
  const double before = power();
  if (now.hold == RigidBody::Hold::free) now.now.velocity = now.now.velocity + time / now.mass * body.force;
  if (now.hold != RigidBody::Hold::driven) now.now.spin = now.now.spin + time * axes.to_own(body.torque);
  now.now.touch_work += 0.5 * time * (before + power());
  body.impulse = body.impulse + time * body.force;
  body.turn = body.turn + time * body.torque;
}

void SphereBodies::begin_steps(double step, double each) {
  step_ = step;
  for (Body& body : bodies_) {
    if (!at_begin_) go_back(body, step);
    body.impulse = body.turn = Vec3{};
    kick(body, 0.5 * each);
  }
  at_begin_ = !(each > 0.0);
  std::fill(far_.begin(), far_.end(), 0.0);
  go_on(each);
}

/// What RigidPhase did in the step of the scene is taken back.
void SphereBodies::go_back(Body& body, double step) {
  RigidBody& now = state_of(body);
  body.end = now.now;
  const Vec3 rate = OwnAxes(now).to_space(own_angular_velocity(now));
  now.now.place = now.now.place - step * (now.hold == RigidBody::Hold::pinned ? Vec3{} : now.now.velocity);
  if (now.hold == RigidBody::Hold::driven) turn_by(now, rate, -step);
  else turn_freely(now, -step);
}

void SphereBodies::go_on(double each) {
  for (Body& body : bodies_) {
    RigidBody& now = state_of(body);
    if (now.hold != RigidBody::Hold::pinned) now.now.place = now.now.place + each * now.now.velocity;
    if (now.hold == RigidBody::Hold::driven) {
      const Vec3 rate = OwnAxes(now).to_space(own_angular_velocity(now));
      turn_by(now, rate, each);
      now.now.spin = spin_of(now, OwnAxes(now).to_own(rate));
    } else {
      turn_freely(now, each);
    }
    see(body);
  }
}

/// Where a driven body goes does not depend on the number of steps.
void SphereBodies::end_steps() {
  for (Body& body : bodies_) {
    RigidBody& now = state_of(body);
    if (now.hold == RigidBody::Hold::driven) {
      const double work = now.now.touch_work;
      now.now = body.end;
      now.now.touch_work = work;
    }
    if (step_ > 0.0) {
      body.mean_force.add({}, step_, body.impulse);
      body.mean_torque.add({}, step_, body.turn);
    }
  }
}

void SphereBodies::touch(const Present& s, const SphereStep& step) {
  const std::size_t stride = layout_->dimensions == 2 ? 4 : 8, blocks = s.moving / block + 1;
  if (forces_.size() < s.moving * stride) forces_.resize(s.moving * stride);
  if (far_.size() != s.moving * bodies_.size()) far_.assign(s.moving * bodies_.size(), 0.0);
  if (tallies_.size() < blocks) {
    tallies_.resize(blocks);
    loads_.resize(blocks * bodies_.size());
    near_.resize(blocks * bodies_.size());
  }
  layout_->dimensions == 2 ? touch_all<2>(s, step) : touch_all<3>(s, step);
  Tally all;
  for (Body& body : bodies_) body.force = body.torque = Vec3{};
  for (std::size_t q = 0; q < blocks; ++q) {
    all.lost += tallies_[q].lost;
    all.stored += tallies_[q].stored;
    all.contacts += tallies_[q].contacts;
    all.deepest = std::max(all.deepest, tallies_[q].deepest);
    for (std::size_t b = 0; b < bodies_.size(); ++b)
      for (std::size_t d = 0; d < 3; ++d) {
        bodies_[b].force[d] += loads_[q * bodies_.size() + b][d] / layout_->slab;
        bodies_[b].torque[d] += loads_[q * bodies_.size() + b][3 + d] / layout_->slab;
      }
  }
  lost_ = all.lost;
  stored_ = all.stored;
  contacts_ = all.contacts;
  deepest_ = all.deepest;
  for (Body& body : bodies_) kick(body, s.half * s.dt);
}

template <int Dim>
void SphereBodies::touch_all(const Present& s, const SphereStep& step) {
  const auto blocks = static_cast<std::int64_t>(s.moving / block + 1);
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < blocks; ++i) {
    const auto q = static_cast<std::size_t>(i);
    std::array<double, 6>* const loads = loads_.data() + q * bodies_.size();
    std::uint16_t* const near = near_.data() + q * bodies_.size();
    std::fill_n(loads, bodies_.size(), std::array<double, 6>{});
    tallies_[q] = {};
    for (const Part& part : s.parts) {
      const std::size_t begin = std::max(part.first, q * block),
                        end = std::min(part.first + part.count, (q + 1) * block);
      for (std::size_t k = begin; k < end; ++k) touch_one<Dim>(s, step, part, k, tallies_[q], loads, near);
    }
  }
}

/// m, a place of a sphere from the place of the body, in the image next to it.
Vec3 SphereBodies::arm_of(const Body& body, const Vec3& at) const {
  Vec3 arm = at - body.place;
  for (std::size_t d = 0; d < static_cast<std::size_t>(layout_->dimensions); ++d)
    if (period_[d] > 0.0) arm[d] -= period_[d] * std::round(arm[d] / period_[d]);
  return arm;
}

/// The contacts of a sphere with all bodies. `near`: room for the numbers of the bodies.
template <int Dim>
void SphereBodies::touch_one(const Present& s, const SphereStep& step, const Part& part, std::size_t sphere,
                             Tally& tally, std::array<double, 6>* loads, std::uint16_t* near) {
  using R = SphereRecord<Dim>;
  constexpr std::size_t stride = Dim == 2 ? 4 : 8;
  std::fill_n(forces_.data() + sphere * stride, stride, 0.0);
  if (remembers_[part.phase] == 0) return;
  const double* r = s.records + sphere * R::size;
  const double radius = r[R::radius];
  Vec3 at{}, v{};
  for (std::size_t d = 0; d < Dim; ++d) {
    at[d] = r[d];
    v[d] = r[R::velocity + d];
  }
  const std::uint32_t* const laws = laws_.data() + part.phase * bodies_.size();
  std::size_t count = 0;
  double reach = 0.0;
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    if (laws[b] == SphereSearch::none) continue;
    const Body& body = bodies_[b];
    double& far = far_[sphere * bodies_.size() + b];
    const double way = s.dt * (norm(v) + norm(body.velocity) + norm(body.rate) * (body.border.reach() + radius));
    far -= way;
    if (far > way) continue;  // a contact sets in up to a step before the touch
    const Vec3 arm = arm_of(body, at);
    const double out = norm(arm) - body.border.reach() - radius;
    const auto gap = out > way ? std::nullopt : body.border.gap(axes_[b], arm);
    far = out > way ? out : gap ? gap->distance - radius : 0.0;
    if (!gap || !(far < way)) continue;
    if (std::isinf(gap->distance)) tally.deepest = std::max(tally.deepest, 1.0);
    near[count++] = static_cast<std::uint16_t>(b);
    reach = std::max(reach, radius + way);
  }
  SolidTouches& touches = state_->phases[part.phase].own(memory_[part.phase])[sphere - part.first];
  if (count == 0 && touches.of[0].with == 0) return;
  std::array<SolidSurfaces::Contact, SolidTouches::most> found;
  const std::size_t contacts = solids_.touch(at, radius, reach, {near, count}, found, 0);
  const SolidTouches before = touches;
  touches = {};
  std::array<bool, SolidTouches::most> goes_on{};
  std::size_t n = 0;
  for (std::size_t c = 0; c < contacts && !std::isinf(found[c].distance); ++c) {
    const std::size_t b = found[c].surface;
    const Body& body = bodies_[b];
    Meeting m{sphere, b, laws[b], radius, {found[c].distance, found[c].normal}, {}, v, {}};
    m.foot = arm_of(body, at) - m.gap.distance * m.gap.normal;
    m.carried = body.velocity + cross(body.rate, m.foot);
    if (!(radius - m.gap.distance > -s.dt * std::abs(dot(v - m.carried, m.gap.normal)))) continue;
    SolidTouch& touch = touches.of[n++];
    const std::size_t old = before.find(m.gap.normal, goes_on);
    if (old < SolidTouches::most) {
      goes_on[old] = true;
      touch = before.of[old];
    }
    with_parts(step.laws[m.law], step.has,
               [&](const auto& parts) { meet<Dim>(parts, step.contacts, s, m, touch, tally, loads[b]); });
  }
  // What the springs across the normal of the others held is lost.
  for (std::size_t k = 0; k < SolidTouches::most && before.of[k].with != 0; ++k)
    if (!goes_on[k])
      with_parts(step.laws[laws[before.of[k].with - 1]], step.has, [&](const auto& law) {
        using Law = std::decay_t<decltype(law)>;
        for (std::size_t q = 0; q < Law::template springs<Dim>; ++q)
          tally.lost += law.left_behind() * before.of[k].memory[q] * before.of[k].memory[q];
      });
}

/// The forces of a contact; the body gets what the sphere loses, with the moment about its place.
template <int Dim, class Law>
void SphereBodies::meet(const Law& law, const StepOfContacts& dt, const Present& s, const Meeting& m, SolidTouch& touch,
                        Tally& tally, std::array<double, 6>& load) {
  using R = SphereRecord<Dim>;
  constexpr std::size_t dim = Dim, first_spin = Dim == 2 ? 2 : 0, numbers = Law::template numbers<dim>;
  const Body& body = bodies_[m.body];
  const double *r = s.records + m.sphere * R::size, overlap = m.radius - m.gap.distance;
  TouchingSpheres<One, dim> pair;
  for (std::size_t d = 0; d < dim; ++d) {
    pair.normal[d] = One(m.gap.normal[d]);
    pair.velocity[d] = One(m.velocity[d] - m.carried[d]);
  }
  for (std::size_t d = 0; d < R::spins; ++d) {
    pair.spin_a[d] = One(r[R::spin + d]);
    pair.spin_b[d] = One(body.rate[first_spin + d]);
  }
  pair.overlap = One(overlap);
  pair.lever_a = One(m.gap.distance);
  pair.lever_b = One(0.0);
  pair.reduced_radius = One(m.radius);
  pair.inverse_mass = One(s.passive[m.sphere * passive_size + passive_mass] +
                          inverse_mass(state_of(body), axes_[m.body], m.foot, m.gap.normal) / layout_->slab);
  pair.reduced_mass = One(1.0) / pair.inverse_mass;
  std::array<One, numbers> slip;
  for (std::size_t k = 0; k < numbers; ++k) slip[k] = One(touch.memory[k]);
  const auto f = Law::touch(typename Law::template Constants<One>(law, dt), pair, slip);
  touch.with = static_cast<std::int64_t>(m.body) + 1;
  touch.distance = m.gap.distance;
  for (std::size_t d = 0; d < 3; ++d) touch.normal[d] = m.gap.normal[d];
  for (std::size_t k = 0; k < numbers; ++k) touch.memory[k] = slip[k].v;
  Vec3 force{}, turn{};
  double* const to = forces_.data() + m.sphere * (Dim == 2 ? 4 : 8);
  for (std::size_t d = 0; d < dim; ++d) to[d] += force[d] = f.force[d].v;
  for (std::size_t d = 0; d < R::spins; ++d) {
    to[(Dim == 2 ? 2 : 4) + d] += f.torque_a[d].v;
    turn[first_spin + d] = f.torque_b[d].v;
  }
  const Vec3 torque = turn - cross(m.foot, force);
  for (std::size_t d = 0; d < 3; ++d) {
    load[d] -= force[d];
    load[3 + d] += torque[d];
  }
  tally.lost += f.lost.v;
  tally.stored += f.stored.v;
  tally.deepest = std::max(tally.deepest, 0.5 * overlap / m.radius);
  tally.contacts += 1.0;
}

void SphereBodies::history(HistoryRow& row) const {
  for (const Body& body : bodies_) {
    const Vec3 force = body.mean_force.value(), torque = body.mean_torque.value();
    const std::string name = body.name + "_spheres";
    for (std::size_t d = 0; d < static_cast<std::size_t>(layout_->dimensions); ++d)
      row.add(name + "_force_" + "xyz"[d] + " [N]", force[d]);
    if (layout_->dimensions == 2) row.add(name + "_torque [N m]", torque[2]);
    for (std::size_t d = 0; d < 3 && layout_->dimensions == 3; ++d)
      row.add(name + "_torque_" + "xyz"[d] + " [N m]", torque[d]);
  }
}

void SphereBodies::begin_row() {
  for (Body& body : bodies_) {
    body.mean_force.begin_row();
    body.mean_torque.begin_row();
  }
}

void SphereBodies::archive(Archive& a) {
  for (Body& body : bodies_) {
    a.number("force of spheres on " + body.name, body.force);
    a.number("torque of spheres on " + body.name, body.torque);
    body.mean_force.archive(a, "mean force of spheres on " + body.name);
    body.mean_torque.archive(a, "mean torque of spheres on " + body.name);
  }
}

}  // namespace barchan
