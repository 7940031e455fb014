#include "models/bodies/rigid_contact.hpp"

#include <algorithm>
#include <cmath>

#include "base/errors.hpp"
#include "output/numbers.hpp"
#include "scene/located.hpp"
#include "scene/side_names.hpp"

namespace barchan {

namespace {

constexpr double deepest_overlap = 0.5;  // spacings

/// 1/kg: how much a force at the arm (m, from the body's place) along a direction changes the velocity there along it.
double inverse_mass(const RigidBody& body, const OwnAxes& axes, const Vec3& arm, const Vec3& direction) {
  if (body.hold == RigidBody::Hold::driven) return 0.0;
  const Vec3 lever = axes.to_own(cross(arm, direction));
  double inverse = body.hold == RigidBody::Hold::free ? 1.0 / body.mass : 0.0;
  if (body.dimensions == 2) return inverse + lever[2] * lever[2] / body.inertia[2];
  for (std::size_t d = 0; d < 3; ++d) inverse += lever[d] * lever[d] / body.inertia[d];
  return inverse;
}

Vec3 velocity_at(const RigidBody& body, const OwnAxes& axes, const Vec3& arm) {
  return body.now.velocity + cross(axes.to_space(own_angular_velocity(body)), arm);
}

bool is_round(const ContactSurface& surface) { return surface.form() == ContactSurface::Form::round; }

/// m, from a place to the farthest of the surfaces that have probes.
double reach_of(const std::vector<ContactSurface>& surfaces, const Vec3& place) {
  double reach = 0.0;
  for (const ContactSurface& surface : surfaces)
    for (const TouchPoint& probe : surface.probes()) reach = std::max(reach, norm(probe.at - place) + probe.radius);
  return reach;
}

}  // namespace

double contact_stiffness(const Scene& scene, const Layout& layout, std::size_t phase) {
  const RigidKeys& keys = scene.phases[phase].rigid();
  const PlanPhase& p = layout.phases[phase];
  double heaviest = 0.0;
  for (const RigidBody& body : p.rigid_bodies) heaviest = std::max(heaviest, body.mass);
  // K d^2 = M v^2
  return keys.stiffness.value_or(
      heaviest *
      std::pow(layout.largest_speed / (keys.largest_overlap.value_or(RigidKeys::dry_overlap) * p.spacing), 2));
}

void describe_rigid_contact(const Scene&, const Interaction&, const Layout& layout, PlanEntry& e) {
  e.law = "contact";
  e.meaning = "bodies: touching decides";
  e.radius = layout.touching_distance(e);
  e.pairs = Pairs::outlines;
}

RigidContact::RigidContact(const Scene& scene, const Layout& layout, const PlanEntry& entry)
    : scene_(scene), layout_(layout), entry_(entry), room_(room_of_water()) {
  double stiffness = 1e300;
  for (const std::size_t k : {entry.a, entry.b}) {
    if (!layout.phases[k].moves()) continue;
    const RigidKeys& keys = scene.phases[k].rigid();
    const bool softer = room_ > 0.0 && !keys.stiffness && !keys.largest_overlap;
    const double ratio = softer ? RigidKeys::dry_overlap / RigidKeys::wet_overlap : 1.0;
    const double own = contact_stiffness(scene, layout, k);
    stiffness = std::min(stiffness, own * ratio * ratio);
  }
  if (!(stiffness > 0.0))
    throw SceneError(located(scene, "interactions." + entry.name) +
                     ": nothing in the scene moves or weighs, from which the stiffness of the contact could follow; "
                     "expected time.largest-speed, or stiffness of both phases");
  law_ = {stiffness, entry.given.restitution.value_or(1.0), entry.given.friction.value_or(0.0)};
}

void RigidContact::schedule(Schedule& s) {
  s.add({stage::kick_and_drift, entry_.name, {}, [this] { taken_ += 0.5 * w_->state.dt * power_; }});
  s.add({stage::contacts, entry_.name, {}, [this] { touch(); }});
  s.add({stage::kick, entry_.name, {}, [this] {
           power_ = power();
           taken_ += w_->kick_time * power_;
         }});
}

void RigidContact::attach(Workspace& w) {
  w_ = &w;
  // Probes reach into polygons by their radius.
  double widest = 0.0;
  for (const std::size_t k : {entry_.a, entry_.b})
    for (const Fill& fill : scene_.fills)
      if (fill.phase == layout_.phases[k].name)
        for (const ContactSurface& surface : surfaces_of(fill.shape, scene_, layout_.phases[k].spacing))
          for (const TouchPoint& probe : surface.probes()) widest = std::max(widest, probe.radius);
  const double reach = widest + std::max({layout_.phases[entry_.a].spacing, layout_.phases[entry_.b].spacing, room_});
  const auto add = [&](std::size_t phase, std::vector<Side>& sides) {
    if (layout_.phases[phase].moves()) add_bodies(phase, reach, sides);
    else add_wall(phase, reach, sides);
  };
  add(entry_.a, a_);
  if (entry_.a != entry_.b) add(entry_.b, b_);
  for (std::size_t i = 0; i < a_.size(); ++i)
    for (std::size_t j = entry_.a == entry_.b ? i + 1 : 0; j < (entry_.a == entry_.b ? a_ : b_).size(); ++j)
      refuse_wide(a_[i], (entry_.a == entry_.b ? a_ : b_)[j]);
  apart_.assign(a_.size() * (entry_.a == entry_.b ? a_ : b_).size(), 0.0);
}

/// A spacing of the fluid that both touch: particles of it cannot be closer to both.
double RigidContact::room_of_water() const {
  double room = 0.0;
  const auto wets = [&](std::size_t fluid, std::size_t phase) {
    return std::any_of(layout_.entries.begin(), layout_.entries.end(), [&](const PlanEntry& e) {
      return e.continues_fluid && e.has(fluid) && e.has(phase) && fluid != phase;
    });
  };
  for (std::size_t k = 0; k < layout_.phases.size(); ++k)
    if (layout_.phases[k].flows() && wets(k, entry_.a) && wets(k, entry_.b))
      room = std::max(room, layout_.phases[k].spacing);
  return room;
}

void RigidContact::add_bodies(std::size_t phase, double reach, std::vector<Side>& sides) {
  for (std::size_t k = 0; k < w_->state.bodies.size(); ++k) {
    const RigidBody& body = w_->state.bodies[k];
    if (body.phase != phase) continue;
    auto surfaces = surfaces_of(scene_.fills[body.fill].shape, scene_, layout_.phases[phase].spacing);
    for (ContactSurface& surface : surfaces) surface.prepare(reach, layout_.phases[phase].spacing);
    const double farthest = reach_of(surfaces, body.first_place);
    sides.push_back({k, false, std::move(surfaces), farthest, OwnAxes(body), OwnAxes(body)});
  }
}

void RigidContact::add_wall(std::size_t phase, double reach, std::vector<Side>& sides) {
  const SideNames& names = side_names(scene_.domain);
  const auto add = [&](const ContactSurface& surface) {
    RigidBody still;
    still.dimensions = layout_.dimensions;
    still.hold = RigidBody::Hold::driven;
    still.inertia = {1, 1, 1};  // of no use: it never turns
    const auto& probes = surface.probes();
    for (const TouchPoint& probe : probes)
      still.first_place = still.first_place + 1.0 / static_cast<double>(probes.size()) * probe.at;
    still.now.place = still.first_place;
    const double farthest = probes.empty() ? 1e300 : reach_of({surface}, still.first_place);
    still_.push_back(still);
    sides.push_back({still_.size() - 1, true, {surface}, farthest, OwnAxes(still), OwnAxes(still)});
  };
  for (const Fill& fill : scene_.fills) {
    if (fill.phase != layout_.phases[phase].name) continue;
    for (ContactSurface& surface : surfaces_of(fill.shape, scene_, layout_.phases[phase].spacing)) {
      surface.prepare(reach, layout_.phases[phase].spacing);
      add(surface);
    }
    const auto* planes = std::get_if<SidesShape>(&fill.shape);
    for (std::size_t axis = 0; planes && axis < static_cast<std::size_t>(layout_.dimensions); ++axis)
      for (const bool high : {false, true}) {
        if (std::find(planes->sides.begin(), planes->sides.end(), names[axis][high]) == planes->sides.end()) continue;
        Vec3 outwards{}, at{};
        outwards[axis] = high ? -1.0 : 1.0;
        at[axis] = high ? layout_.bounds.high[axis] : layout_.bounds.low[axis];
        add(ContactSurface::plane(at, outwards));
      }
  }
}

void RigidContact::refuse_wide(const Side& a, const Side& b) {
  for (std::size_t d = 0; d < static_cast<std::size_t>(layout_.dimensions); ++d)
    if (layout_.bounds.periodic[d] && std::max(a.reach, b.reach) < 1e300 &&
        a.reach + b.reach > 0.5 * (layout_.bounds.high[d] - layout_.bounds.low[d]))
      throw SceneError(located(scene_, "domain.size") +
                       ": two that touch by their outlines are together wider than the periodic domain, so that they "
                       "could touch on both sides; expected a longer one");
}

double RigidContact::largest_inverse_mass(std::size_t phase) const {
  double largest = 0.0;
  for (const RigidBody& body : layout_.phases[phase].rigid_bodies) {
    if (body.hold == RigidBody::Hold::driven) continue;
    const auto surfaces = surfaces_of(scene_.fills[body.fill].shape, scene_, layout_.phases[phase].spacing);
    const bool round = std::all_of(surfaces.begin(), surfaces.end(), is_round);
    double inverse = body.hold == RigidBody::Hold::free ? 1.0 / body.mass : 0.0, least = body.inertia[2];
    if (body.dimensions == 3) least = std::min({body.inertia[0], body.inertia[1], body.inertia[2]});
    // A push on a round body goes through its centre.
    if (!round || body.hold != RigidBody::Hold::free)
      inverse += std::pow(reach_of(surfaces, body.first_place), 2) / least;
    largest = std::max(largest, inverse);
  }
  return largest;
}

void RigidContact::limits(std::vector<StepLimit>& limits) const {
  const double inverse = largest_inverse_mass(entry_.a) + largest_inverse_mass(entry_.b);
  if (inverse > 0.0)
    limits.push_back({"contact " + entry_.name,
                      scene_.time.safety * StepConstants::restitution / std::sqrt(law_.stiffness * inverse),
                      "0.1 sqrt(m/K): keeps the restitution"});
}

void RigidContact::touch() {
  overlap_ = 0.0;
  for (std::vector<Side>* sides : {&a_, &b_})
    for (Side& side : *sides) {
      side.now = OwnAxes(body_of(side));
      side.force = side.torque = Vec3{};
    }
  std::vector<Side>& others = entry_.a == entry_.b ? a_ : b_;
  for (std::size_t i = 0; i < a_.size(); ++i)
    for (std::size_t j = entry_.a == entry_.b ? i + 1 : 0; j < others.size(); ++j)
      touch(a_[i], others[j], apart_[i * others.size() + j]);
}

/// Of the forces of this step with the velocities of now.
double RigidContact::power() {
  double given = 0.0;
  for (const std::vector<Side>* sides : {&a_, &b_})
    for (const Side& side : *sides) {
      const RigidBody& body = body_of(side);
      given += dot(side.force, body.now.velocity) + dot(side.now.to_own(side.torque), own_angular_velocity(body));
    }
  return -given;
}

/// What must be added to places of a so that it lies in the image next to b.
Vec3 RigidContact::image_between(const RigidBody& a, const RigidBody& b) const {
  Vec3 image{};
  for (std::size_t d = 0; d < static_cast<std::size_t>(layout_.dimensions); ++d) {
    const double period = layout_.bounds.high[d] - layout_.bounds.low[d];
    if (layout_.bounds.periodic[d]) image[d] = -period * std::round((a.now.place[d] - b.now.place[d]) / period);
  }
  return image;
}

/// `apart` (m): where their contact begins, as far apart as they have been, at most the room of a fluid.
void RigidContact::touch(Side& a, Side& b, double& apart) {
  const RigidBody &first = body_of(a), &second = body_of(b);
  const bool planes = !(std::max(a.reach, b.reach) < 1e300);
  const Vec3 image = planes ? Vec3{} : image_between(first, second);
  double gap = room_;
  if (planes || !(norm(first.now.place + image - second.now.place) > a.reach + b.reach + room_))
    for (const ContactSurface& of_a : a.surfaces)
      for (const ContactSurface& of_b : b.surfaces) {
        // A round body touches with the place that is nearest to the other; all others with their corners.
        if (is_round(of_a) || !is_round(of_b)) gap = std::min(gap, touch(a, of_a, b, of_b, image, apart));
        if (!is_round(of_a)) gap = std::min(gap, touch(b, of_b, a, of_a, -1.0 * image, apart));
      }
  apart = std::max(apart, gap);
}

/// The probes of a on the surface of b. Returns the least distance between them (m).
double RigidContact::touch(Side& a, const ContactSurface& of_a, Side& b, const ContactSurface& on_b, const Vec3& image,
                           double apart) {
  const RigidBody &first = body_of(a), &second = body_of(b);
  double least = 1e300;
  for (const TouchPoint& probe : of_a.probes()) {
    const Vec3 x = first.now.place + image + a.now.to_space(a.first.to_own(probe.at - first.first_place));
    const Vec3 from_b = x - second.now.place;
    if (b.reach < 1e300 && dot(from_b, from_b) > std::pow(b.reach + probe.radius + room_, 2)) continue;
    const auto gap = on_b.gap(second.first_place + b.first.to_space(b.now.to_own(from_b)));
    if (!gap) continue;
    const double inside = probe.radius - gap->distance, overlap = inside + apart;
    if (inside > probe.deepest) continue;
    least = std::min(least, -inside);
    if (!(overlap > 0.0)) continue;
    overlap_ = std::max(overlap_, overlap);
    if (!std::isfinite(overlap)) continue;  // trouble() tells
    const Vec3 normal = b.now.to_space(b.first.to_own(gap->normal));
    push(a, b, x - (probe.radius - 0.5 * inside) * normal, image, overlap, normal);
  }
  return least;
}

/// Forces at the place `at` (m); `normal` points at a, whose places lie `image` away.
void RigidContact::push(Side& of_a, Side& of_b, const Vec3& at, const Vec3& image, double overlap, const Vec3& normal) {
  const RigidBody &a = body_of(of_a), &b = body_of(of_b);
  const Vec3 arm_a = at - image - a.now.place, arm_b = at - b.now.place;
  const Vec3 v = velocity_at(a, of_a.now, arm_a) - velocity_at(b, of_b.now, arm_b);
  const double dt = w_->state.dt, speed = dot(v, normal);
  const auto inverse = [&](const Vec3& direction) {
    return inverse_mass(a, of_a.now, arm_a, direction) + inverse_mass(b, of_b.now, arm_b, direction);
  };
  const double pressed = law_.push(overlap, speed, inverse(normal), dt);
  Vec3 force = pressed * normal;
  const Vec3 along = v - speed * normal;
  if (const double sliding = norm(along); law_.friction > 0.0 && sliding > 0.0)
    force = force - law_.grip(pressed, sliding, inverse(1.0 / sliding * along), dt) * along;
  load(of_a, arm_a, force);
  load(of_b, arm_b, -1.0 * force);
}

void RigidContact::load(Side& side, const Vec3& arm, const Vec3& force) {
  RigidBody& body = body_of(side);
  const Vec3 torque = cross(arm, force);
  body.now.touch_force = body.now.touch_force + force;
  body.now.touch_torque = body.now.touch_torque + torque;
  side.force = side.force + force;
  side.torque = side.torque + torque;
}

void RigidContact::history(HistoryRow& row) const {
  row.add(layout_.phases[entry_.a].name + "_" + layout_.phases[entry_.b].name + "_overlap [m]", overlap_);
  row.add(layout_.phases[entry_.a].name + "_" + layout_.phases[entry_.b].name + "_taken_energy [J]", taken_);
}

void RigidContact::archive(Archive& a) {
  a.number("overlap of " + entry_.name, overlap_);
  if (room_ > 0.0) a.values("distances of " + entry_.name, apart_.data(), apart_.size());
  a.number("power of " + entry_.name, power_);
  a.number("energy of " + entry_.name, taken_);
}

std::optional<std::string> RigidContact::trouble() const {
  const double spacing = std::min(layout_.phases[entry_.a].spacing, layout_.phases[entry_.b].spacing);
  const double bound = std::max(deepest_overlap * spacing, room_);
  if (!(overlap_ > bound)) return std::nullopt;
  const std::string& name = layout_.phases[layout_.phases[entry_.a].moves() ? entry_.a : entry_.b].name;
  return "the outlines of " + entry_.name + " overlap by " + brief(overlap_) + " m (bound " + brief(bound) + " m" +
         (room_ > 0.0 ? ", a spacing of the fluid between included" : "") +
         "); the contact could not keep them apart, or the fills overlap: raise phases." + name +
         ".stiffness or time.largest-speed, or move the fills apart";
}

}  // namespace barchan
