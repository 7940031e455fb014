#include "models/coupling/rigid_in_fluid.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/phase_sums.hpp"
#include "models/bodies/contact_surface.hpp"
#include "models/fluid/fluid_phase.hpp"

namespace barchan {

namespace {

using std::numbers::pi;

constexpr double light = 1.5;  // m_s/m that an acoustic step bears

}  // namespace

RigidInFluid::RigidInFluid(const Scene& scene, const Layout& layout, std::size_t solid)
    : scene_(scene), layout_(layout), solid_(solid) {
  for (const auto& e : layout.entries) {
    if (!e.extends || e.other != solid) continue;
    reach_ = std::max(reach_, e.radius);
    of_pairs_ = of_pairs_ || !e.corrected;
  }
}

void RigidInFluid::begin(State& state, const std::vector<ParticleBlock>& blocks) {
  bodies_ = layout_.phases[solid_].rigid_bodies.size();
  const auto first = std::find_if(state.bodies.begin(), state.bodies.end(),
                                  [&](const RigidBody& body) { return body.phase == solid_; });
  first_body_ = static_cast<std::size_t>(first - state.bodies.begin());
  of_body_ = state.phases[solid_].add_own<OfBody>("surface");
  for (std::size_t k = 0; k < bodies_; ++k) {
    const RigidBody& body = state.bodies[first_body_ + k];
    find_surface(body, blocks[solid_].position, state.phases[solid_]);
    following_.push_back(of_pairs_ ? 1.0 / (1.0 + 2.0 * answering_share(body, scene_, layout_)) : 1.0);
  }
}

double answering_share(const RigidBody& body, const Scene& scene, const Layout& layout) {
  if (body.hold == RigidBody::Hold::driven) return 0.0;
  double density = 0.0;  // kg/m3
  for (const auto& e : layout.entries)
    if (e.extends && e.other == body.phase) density = std::max(density, scene.phases[e.fluid].density);
  // A row round the disc or ball that holds the body, and not more than the body's volume.
  const double reach = body.reach, round = layout.dimensions == 2 ? 2.0 * pi * reach : 4.0 * pi * reach * reach;
  const double row =
      density * std::min(round * layout.phases[body.phase].spacing, body.mass / scene.phases[body.phase].density);
  const double least =
      layout.dimensions == 2 ? body.inertia[2] : *std::min_element(body.inertia.begin(), body.inertia.end());
  const double turning = 0.5 * row * reach * reach / least;  // as row/mass, of a disc
  return body.hold == RigidBody::Hold::pinned ? turning : std::max(turning, row / body.mass);
}

/// Light bodies: the fluid's answer comes a step late, and follows at a pace that m_s/m sets. Measured with discs of 2
/// and 10 spacings and 0.01 to 0.3 of the fluid's density: they hold with 2 m/m_s of the acoustic step.
void RigidInFluid::limits(std::vector<StepLimit>& limits) const {
  double share = 0.0, acoustic = 1e300;
  for (const RigidBody& body : layout_.phases[solid_].rigid_bodies)
    share = std::max(share, answering_share(body, scene_, layout_));
  for (const auto& e : layout_.entries)
    if (e.extends && e.other == solid_) {
      const PlanPhase& fluid = layout_.phases[e.fluid];
      acoustic = std::min(
          acoustic, StepConstants::acoustic * fluid.smoothing_length / (fluid.sound_speed + layout_.largest_speed));
    }
  if (share > light)
    limits.push_back({"light " + layout_.phases[solid_].name, scene_.time.safety * acoustic * light / share,
                      "0.6 h/(c + u) m/m_s: the body is lighter than the fluid next to it, m_s"});
}

/// Depth and normal of the particles that the fluid can reach, from the outline of the body's fill.
void RigidInFluid::find_surface(const RigidBody& body, const std::vector<Vec3>& x, PhaseParticles& p) {
  const double spacing = layout_.phases[solid_].spacing;
  auto surfaces = surfaces_of(scene_.fills[body.fill].shape, scene_, spacing);
  for (ContactSurface& surface : surfaces) surface.prepare(reach_ + spacing, spacing);
  const OwnAxes axes(body);
  for (std::size_t k = body.first; k < body.first + body.count; ++k) {
    OfBody particle{axes.to_own(x[k] - body.now.place), {}, 0.0};
    for (const ContactSurface& surface : surfaces) {
      const auto gap = surface.gap(x[k]);
      if (!gap || !(gap->distance < 0.0) || -gap->distance > reach_) continue;
      if (particle.depth > 0.0 && -gap->distance > particle.depth) continue;
      particle.depth = -gap->distance;
      particle.normal = axes.to_own(gap->normal);
    }
    p.column(Field::wall_depth)[k] = particle.depth;
    p.own(of_body_)[k] = particle;
  }
}

void RigidInFluid::attach(Workspace& w) {
  w_ = &w;
  for (const auto& e : layout_.entries)
    if (e.extends && e.other == solid_ && !e.corrected)
      felt_.push_back({&w.list(e.direction(solid_)), &w.records(e.fluid, Record::motion), e.kernel, e.radius,
                       viscosity_of_sums(scene_, layout_, e), false});
  const std::size_t n = w.particles(solid_).size();
  rates_.resize(n);
  areas_.resize(n);
  couples_.resize(n);
  w.particles(solid_).keep_places();
}

void RigidInFluid::schedule(Schedule& s) {
  using enum Field;
  const std::string name = layout_.phases[solid_].name;
  s.add({stage::extend_solids,
         name + ", surface",
         {{name, {acceleration}, {wall_normal, surface_velocity, surface_acceleration}}},
         [this] { move_surface(); }});
  Touches felt{{name, {position, velocity}, {}, {{Record::extended}, {}, {}}}};
  for (const auto& e : layout_.entries)
    if (e.extends && e.other == solid_)
      felt.push_back({layout_.phases[e.fluid].name, {}, {}, {{}, {Record::motion}, {}}});
  s.add({stage::reaction, name + ", torque", felt, [this] { turn(); }});
}

/// Normals and velocities of the nearest places of the surface, and the accelerations that the pressure follows.
void RigidInFluid::move_surface() {
  PhaseParticles& p = w_->particles(solid_);
  for (std::size_t b = 0; b < bodies_; ++b) {
    const RigidBody& body = w_->state.bodies[first_body_ + b];
    const OwnAxes axes(body);
    const Vec3 rate = axes.to_space(own_angular_velocity(body));
    for (std::size_t id = body.first; id < body.first + body.count; ++id) {
      const std::size_t k = p.places()[id];
      const OfBody& particle = p.own(of_body_)[k];
      const Vec3 normal = axes.to_space(particle.normal);
      const Vec3 speed = body.now.velocity + cross(rate, axes.to_space(particle.arm) + particle.depth * normal);
      rates_[k] = rate;
      for (int d = 0; d < layout_.dimensions; ++d) {
        p.column(Field::wall_normal, d)[k] = normal[static_cast<std::size_t>(d)];
        p.column(Field::surface_velocity, d)[k] = speed[static_cast<std::size_t>(d)];
        double& followed = p.column(Field::surface_acceleration, d)[k];
        followed += following_[b] * (p.column(Field::acceleration, d)[k] - followed);
      }
    }
  }
}

/// Adds to the torques on the bodies.
void RigidInFluid::turn() {
  if (felt_.empty()) return;
  turning_friction(w_->records(solid_, Record::extended), felt_, rates_, areas_, couples_, layout_.dimensions);
  w_->share_values(solid_, areas_);
  w_->share_values(solid_, couples_);
  const PhaseParticles& p = w_->particles(solid_);
  for (std::size_t b = 0; b < bodies_; ++b) {
    RigidBody& body = w_->state.bodies[first_body_ + b];
    const OwnAxes axes(body);
    const Vec3 rate = axes.to_space(own_angular_velocity(body));
    for (std::size_t d = layout_.dimensions == 2 ? 2 : 0; d < 3; ++d)
      body.now.touch_torque[d] += sum_of(p, body.count, [&](std::size_t q) {
        const std::size_t k = p.places()[body.first + q];
        return couples_[k][d] - cross(axes.to_space(p.own(of_body_)[k].arm), cross(rate, areas_[k]))[d];
      });
  }
}

}  // namespace barchan
