#include "models/walls/driven_wall.hpp"

#include <algorithm>
#include <cmath>

#include "models/walls/wall_normals.hpp"

namespace barchan {

DrivenWall::DrivenWall(const Scene& scene, const Layout& layout, std::size_t number)
    : scene_(scene), layout_(layout), number_(number) {
  for (std::size_t k = 0; k < layout.phases.size(); ++k)
    if (layout.phases[k].name == scene.motions[number].phase) phase_ = k;
  for (const auto& e : layout.entries) {
    if (!e.extends || e.other != phase_) continue;
    const PlanPhase& fluid = layout.phases[e.fluid];
    reach_ = std::max(reach_, e.radius);
    softly_ = std::max(softly_, fluid.smoothing_length / fluid.sound_speed);
  }
}

void DrivenWall::begin(State& state, const std::vector<ParticleBlock>& blocks) {
  const std::vector<Vec3>& places = blocks[phase_].position;
  Vec3 centre{};
  for (const Vec3& x : places) centre = centre + 1.0 / static_cast<double>(places.size()) * x;
  motion_.emplace(scene_.motions[number_], layout_.dimensions, centre);
  PhaseParticles& p = state.phases[phase_];
  arm_ = p.add_own<Vec3>("arm");
  for (std::size_t k = 0; k < places.size(); ++k) p.own(arm_)[k] = motion_->arm(places[k]);
  if (reach_ > 0.0) find_faces(p, places);
}

/// Where the outline of the wall's fill says nothing, the normal is that of the wall's own particles, and the depth is
/// unknown.
void DrivenWall::find_faces(PhaseParticles& p, const std::vector<Vec3>& places) {
  const auto dimensions = static_cast<std::size_t>(layout_.dimensions);
  std::vector<WallFace> faces = outline_faces(scene_, layout_, phase_, places, reach_);
  for (std::size_t k = 0; k < places.size(); ++k) {
    p.column(Field::wall_depth)[k] = faces[k].depth;
    for (std::size_t d = 0; d < dimensions; ++d)
      p.column(Field::wall_normal, static_cast<int>(d))[k] = faces[k].normal[d];
  }
  const WallPart alone{&p, 1.0};
  find_wall_normals(p, {&alone, 1}, layout_.bounds, layout_.phases[phase_].spacing);
  face_ = p.add_own<WallFace>("face");
  for (std::size_t k = 0; k < places.size(); ++k) {
    WallFace& face = p.own(face_)[k];
    face.depth = faces[k].depth;
    for (std::size_t d = 0; d < dimensions; ++d) face.normal[d] = p.column(Field::wall_normal, static_cast<int>(d))[k];
  }
}

void DrivenWall::attach(Workspace& w) {
  w_ = &w;
  w.wall_motions[phase_] = &*motion_;
}

void DrivenWall::schedule(Schedule& s) {
  using enum Field;
  const std::string& name = layout_.phases[phase_].name;
  s.add({stage::kick_and_drift, name + ", motion", {{name, {position}, {position}}}, [this] { go(); }});
  FieldSet writes{velocity};
  if (reach_ > 0.0) writes = writes | FieldSet{wall_normal, surface_velocity, surface_acceleration};
  s.add({stage::walls, name, {{name, {wall_depth}, writes}}, [this] { tell(); }});
}

/// Places at the end of the step; along periodic axes the nearest images to where the particles are.
void DrivenWall::go() {
  motion_->advance(w_->state.time, w_->state.dt);
  PhaseParticles& p = w_->particles(phase_);
  const Bounds& bounds = layout_.bounds;
  std::array<double*, 3> x{};
  std::array<double, 3> period{};
  for (std::size_t d = 0; d < static_cast<std::size_t>(layout_.dimensions); ++d) {
    x[d] = p.column(Field::position, static_cast<int>(d));
    if (bounds.periodic[d]) period[d] = bounds.high[d] - bounds.low[d];
  }
  const OwnAxes axes(motion_->now());
  const Vec3 place = motion_->now().now.place;
  const Vec3* const arm = p.own(arm_);
  const auto n = static_cast<std::int64_t>(p.size());
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < n; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const Vec3 at = place + axes.to_space(arm[k]);
    for (std::size_t d = 0; d < static_cast<std::size_t>(layout_.dimensions); ++d) {
      const double turns = period[d] > 0.0 ? std::round((at[d] - x[d][k]) / period[d]) : 0.0;
      x[d][k] = at[d] - turns * period[d];
    }
  }
}

/// Velocities at the end of the step, and what a fluid sees.
void DrivenWall::tell() {
  PhaseParticles& p = w_->particles(phase_);
  const OwnAxes axes(motion_->now());
  const Vec3 velocity = motion_->velocity(w_->state.time), rate = motion_->rate(w_->state.time);
  std::array<double*, 3> v{};
  for (int d = 0; d < layout_.dimensions; ++d) v[static_cast<std::size_t>(d)] = p.column(Field::velocity, d);
  const Vec3* const arm = p.own(arm_);
  const auto n = static_cast<std::int64_t>(p.size());
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < n; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const Vec3 speed = velocity + cross(rate, axes.to_space(arm[k]));
    for (std::size_t d = 0; d < static_cast<std::size_t>(layout_.dimensions); ++d) v[d][k] = speed[d];
  }
  if (reach_ > 0.0) inform_fluids();
}

/// Normals, the velocities of the nearest places of the surface in the middle of the step, as those of the fluid are,
/// and the accelerations. A jump of the velocity is spread over the time in which sound crosses h: the fluid cannot
/// follow it faster, and rho c U is the largest pressure that it makes.
void DrivenWall::inform_fluids() {
  PhaseParticles& p = w_->particles(phase_);
  const State& state = w_->state;
  const double middle = state.steps == 0 ? state.time : state.time - 0.5 * state.dt;
  const OwnAxes axes(motion_->now());
  const Vec3 velocity = motion_->velocity(middle), rate = motion_->rate(middle);
  const auto gain = motion_->gain(state.time, std::max(softly_, state.dt));
  std::array<double*, 3> normal{}, v{}, a{};
  for (int d = 0; d < layout_.dimensions; ++d) {
    const auto c = static_cast<std::size_t>(d);
    normal[c] = p.column(Field::wall_normal, d);
    v[c] = p.column(Field::surface_velocity, d);
    a[c] = p.column(Field::surface_acceleration, d);
  }
  const Vec3* const arm = p.own(arm_);
  const WallFace* const face = p.own(face_);
  const auto n = static_cast<std::int64_t>(p.size());
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < n; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const Vec3 r = axes.to_space(arm[k]), out = axes.to_space(face[k].normal);
    const Vec3 speed = velocity + cross(rate, r + face[k].depth * out);
    const Vec3 change = gain[0] + cross(gain[1], r) + cross(rate, cross(rate, r));
    for (std::size_t d = 0; d < static_cast<std::size_t>(layout_.dimensions); ++d) {
      normal[d][k] = out[d];
      v[d][k] = speed[d];
      a[d][k] = change[d];
    }
  }
}

void DrivenWall::history(HistoryRow& row) const {
  const RigidMotion& now = motion_->now().now;
  const std::string name = "motion_" + std::to_string(number_) + "_";
  for (std::size_t d = 0; d < static_cast<std::size_t>(layout_.dimensions); ++d)
    row.add(name + "xyz"[d] + " [m]", now.place[d]);
  if (!motion_->turns()) return;
  if (layout_.dimensions == 2) return row.add(name + "angle [rad]", now.angle);
  for (std::size_t c = 0; c < 4; ++c) row.add(name + "turn_" + std::to_string(c), now.turn[c]);
}

void DrivenWall::archive(Archive& a) { motion_->archive(a, "motion " + std::to_string(number_)); }

}  // namespace barchan
