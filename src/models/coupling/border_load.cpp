#include "models/coupling/border_load.hpp"

#include <omp.h>

#include <algorithm>
#include <cmath>

#include "base/errors.hpp"
#include "engine/hold_inside.hpp"
#include "models/coupling/border_fit.hpp"
#include "models/fluid/fluid_phase.hpp"
#include "scene/located.hpp"

namespace barchan {

namespace {

constexpr double flat_pieces = 0.5, solid_pieces = 0.7;  // spacings, in 2D and in 3D

}  // namespace

BorderLoad::BorderLoad(const Scene& scene, const Layout& layout, const PlanEntry& entry)
    : scene_(scene),
      layout_(layout),
      fluid_(entry.fluid),
      solid_(entry.other),
      free_surface_(layout.phases[fluid_].free_surface),
      spacing_(layout.phases[fluid_].spacing),
      radius_(border_fit_radius * spacing_),
      viscosity_(pair_viscosity(scene, layout, solid_, fluid_)),
      neighbours_(layout, fluid_, radius_) {}

void BorderLoad::begin(State& state, const std::vector<ParticleBlock>& blocks) {
  const std::vector<Vec3>& x = blocks[solid_].position;
  const double width = (layout_.dimensions == 2 ? flat_pieces : solid_pieces) * spacing_;
  const auto first = std::find_if(state.bodies.begin(), state.bodies.end(),
                                  [&](const RigidBody& body) { return body.phase == solid_; });
  first_body_ = static_cast<std::size_t>(first - state.bodies.begin());
  std::size_t pieces = 0;
  for (const RigidBody& body : layout_.phases[solid_].rigid_bodies) {
    Border border{BodyBorder(body, scene_, layout_.phases[solid_].spacing, width, radius_ + spacing_), {}, pieces};
    const OwnAxes axes(body);
    for (const BodyBorder::Piece& piece : border.body.pieces()) {
      const Vec3 at = body.first_place + axes.to_space(piece.arm);
      std::size_t nearest = body.first;
      for (std::size_t k = body.first; k < body.first + body.count; ++k)
        if (norm(x[k] - at) < norm(x[nearest] - at)) nearest = k;
      border.anchors.push_back({nearest, axes.to_own(at - x[nearest])});
    }
    pieces += border.anchors.size();
    borders_.push_back(std::move(border));
  }
  places_.resize(pieces);
  stress_.resize(pieces);
}

void BorderLoad::attach(Workspace& w) {
  w_ = &w;
  w.particles(solid_).keep_places();
}

void BorderLoad::schedule(Schedule& s) {
  using enum Field;
  const std::string &name = layout_.phases[solid_].name, &fluid = layout_.phases[fluid_].name;
  s.add({stage::walls,
         name + ", border",
         {{fluid, {position, velocity, density, wholeness}, {position, velocity}}},
         [this] { hold(); }});
  s.add({stage::reaction,
         name + ", border",
         {{name, {position}, {}}, {fluid, {position, velocity, pressure, acceleration, wholeness}, {}}},
         [this] { load(); }});
}

/// Puts particles back that came too near to a body, and stops their motion towards it.
void BorderLoad::hold() {
  PhaseParticles& fluid = w_->particles(fluid_);
  const double rest = scene_.phases[fluid_].density;
  const auto dimensions = static_cast<std::size_t>(layout_.dimensions);
  std::array<double*, 3> x{}, v{};
  Vec3 period{};
  for (std::size_t d = 0; d < dimensions; ++d) {
    x[d] = fluid.column(Field::position, static_cast<int>(d));
    v[d] = fluid.column(Field::velocity, static_cast<int>(d));
    if (layout_.bounds.periodic[d]) period[d] = layout_.bounds.high[d] - layout_.bounds.low[d];
  }
  const double* rho = fluid.column(Field::density);
  const double* const wholeness = free_surface_ ? fluid.column(Field::wholeness) : nullptr;
  const double dt = w_->state.dt;
  spray_.begin(static_cast<std::size_t>(omp_get_max_threads()));
  const auto n = static_cast<std::int64_t>(fluid.size());
  for (std::size_t b = 0; b < borders_.size(); ++b) {
    const RigidBody& body = w_->state.bodies[first_body_ + b];
    const BodyBorder& border = borders_[b].body;
    const OwnAxes axes(body);
    const Vec3 rate = axes.to_space(own_angular_velocity(body));
    const double farthest = border.reach() + border_room_of_off * spacing_;
#pragma omp parallel for schedule(static)
    for (std::int64_t i = 0; i < n; ++i) {
      const auto k = static_cast<std::size_t>(i);
      Vec3 arm{};
      for (std::size_t d = 0; d < dimensions; ++d) {
        arm[d] = x[d][k] - body.now.place[d];
        if (period[d] > 0.0) arm[d] -= period[d] * std::round(arm[d] / period[d]);
      }
      if (!(dot(arm, arm) < farthest * farthest)) continue;
      const auto gap = border.gap(axes, arm);
      const double room = room_at_border(rho[k], rest) * spacing_;
      if (!gap || gap->distance >= room || !std::isfinite(gap->distance)) continue;
      const Vec3 carried = body.now.velocity + cross(rate, arm);
      double into = 0.0;
      for (std::size_t d = 0; d < dimensions; ++d) into += (v[d][k] - carried[d]) * gap->normal[d];
      for (std::size_t d = 0; d < dimensions; ++d) {
        x[d][k] += (room - gap->distance) * gap->normal[d];
        v[d][k] -= std::min(into, 0.0) * gap->normal[d];
      }
      const double alone = wholeness ? 1.0 - Spray::share(wholeness[k]) : 0.0;
      if (into < 0.0 && dt > 0.0 && alone > 0.0)
        spray_.of_threads[static_cast<std::size_t>(omp_get_thread_num())].push_back(
            {static_cast<std::uint32_t>(b), 0, 1, 0, arm, alone * fluid.mass() / dt * into * gap->normal});
    }
  }
}

/// What spray does: the reaction to its acceleration across the border.
void BorderLoad::spray() {
  if (!free_surface_) return;
  const PhaseParticles& fluid = w_->particles(fluid_);
  const auto dimensions = static_cast<std::size_t>(layout_.dimensions);
  std::array<const double*, 3> x{}, a{};
  Vec3 period{};
  for (std::size_t d = 0; d < dimensions; ++d) {
    x[d] = fluid.column(Field::position, static_cast<int>(d));
    a[d] = fluid.column(Field::acceleration, static_cast<int>(d));
    if (layout_.bounds.periodic[d]) period[d] = layout_.bounds.high[d] - layout_.bounds.low[d];
  }
  const double* const wholeness = fluid.column(Field::wholeness);
  const Vec3& gravity = scene_.domain.gravity;
  const auto n = static_cast<std::int64_t>(fluid.size());
  spray_.make_room(static_cast<std::size_t>(omp_get_max_threads()));
  for (std::size_t b = 0; b < borders_.size(); ++b) {
    const RigidBody& body = w_->state.bodies[first_body_ + b];
    const BodyBorder& border = borders_[b].body;
    const OwnAxes axes(body);
    const double farthest = border.reach() + radius_;
#pragma omp parallel for schedule(static)
    for (std::int64_t i = 0; i < n; ++i) {
      const auto k = static_cast<std::size_t>(i);
      const double share = Spray::share(wholeness[k]);
      if (!(share < 1.0)) continue;
      Vec3 arm{}, push{};
      for (std::size_t d = 0; d < dimensions; ++d) {
        arm[d] = x[d][k] - body.now.place[d];
        if (period[d] > 0.0) arm[d] -= period[d] * std::round(arm[d] / period[d]);
        push[d] = a[d][k] - gravity[d];
      }
      if (!(dot(arm, arm) < farthest * farthest)) continue;
      const auto gap = border.gap(axes, arm);
      if (!gap || !(gap->distance < radius_)) continue;
      const double off = dot(push, gap->normal);
      if (off != 0.0)
        spray_.of_threads[static_cast<std::size_t>(omp_get_thread_num())].push_back(
            {static_cast<std::uint32_t>(b), 0, 0, 0, arm, -(1.0 - share) * fluid.mass() * off * gap->normal});
    }
  }
  spray_.gather();
  for (const Spray::Push& one : spray_.all) {
    auto& now = w_->state.bodies[first_body_ + one.body].now;
    now.touch_force = now.touch_force + one.force;
    now.touch_torque = now.touch_torque + cross(one.arm, one.force);
  }
}

void BorderLoad::load() {
  find_places();
  neighbours_.look_from(*w_, places_);
  for (std::size_t b = 0; b < borders_.size(); ++b) {
    const RigidBody& body = w_->state.bodies[first_body_ + b];
    layout_.dimensions == 2 ? find_stress<2>(body, borders_[b]) : find_stress<3>(body, borders_[b]);
  }
  neighbours_.share(stress_);
  for (std::size_t b = 0; b < borders_.size(); ++b) sum(w_->state.bodies[first_body_ + b], borders_[b]);
  spray();
}

void BorderLoad::find_places() {
  const std::uint32_t* const at = w_->particles(solid_).places();
  for (std::size_t b = 0; b < borders_.size(); ++b) {
    const OwnAxes axes(w_->state.bodies[first_body_ + b]);
    const std::vector<Anchor>& anchors = borders_[b].anchors;
    for (std::size_t q = 0; q < anchors.size(); ++q)
      places_[borders_[b].first + q] =
          piece_place(*w_, solid_, at[anchors[q].particle], axes.to_space(anchors[q].to_piece));
  }
}

template <int Dim>
void BorderLoad::find_stress(const RigidBody& body, const Border& border) {
  const OwnAxes axes(body);
  const auto count = static_cast<std::int64_t>(border.anchors.size());
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < count; ++i) {
    const auto q = static_cast<std::size_t>(i);
    const std::size_t number = border.first + q;
    if (neighbours_.is_own(number)) stress_[number] = stress_at<Dim>(body, axes, border, q, neighbours_.of(number));
  }
}

template <int Dim>
BorderLoad::Stress BorderLoad::stress_at(const RigidBody& body, const OwnAxes& axes, const Border& border,
                                         std::size_t number, const std::vector<BorderNeighbour>& about) const {
  using Vector = typename BorderSample<Dim>::Vector;
  const BodyBorder::Piece& piece = border.body.pieces()[number];
  const Vec3 arm = axes.to_space(piece.arm), normal = axes.to_space(piece.normal),
             rate = axes.to_space(own_angular_velocity(body));
  const auto along = along_border(normal, Dim);
  BorderSample<Dim> sample;
  double lowest = 0.0, weights = 0.0, counted = 0.0, nearest = radius_ * radius_;
  for (const BorderNeighbour& near : about) {
    const Vec3& r = near.from;
    const double share = 1.0 - dot(r, r) / (radius_ * radius_);
    if (!(share > 0.0)) continue;
    const auto gap = border.body.gap(axes, arm + r);
    if (!gap) continue;
    nearest = std::min(nearest, dot(r, r));
    weights += share * share;
    counted += share * share * near.share;
    if (!(near.share > 0.0)) continue;
    Vector scaled, u;
    const Vec3 carried = body.now.velocity + cross(rate, arm + r);
    for (std::size_t d = 0; d < Dim; ++d) {
      const auto c = static_cast<Eigen::Index>(d);
      scaled[c] = r[d] / spacing_;
      u[c] = near.velocity[d] - carried[d];
    }
    const double w = share * share * near.share;
    lowest = std::min(lowest, near.pressure);
    sample.press(scaled, w, near.pressure - scene_.phases[fluid_].density * dot(scene_.domain.gravity, r));
    if (!(gap->distance > 0.0) || !(dot(normal, r) > 0.0)) continue;
    Eigen::Matrix<double, Dim - 1, 1> beside;
    for (std::size_t d = 0; d + 1 < Dim; ++d) beside[static_cast<Eigen::Index>(d)] = dot(along[d], r) / spacing_;
    sample.rub(gap->distance / spacing_, beside, w, u);
  }
  if (!sample.any()) return {};
  Stress s{true, sample.pressure(), {}};
  if (free_surface_) s.pressure = std::max(s.pressure, lowest);
  const Vector rise = sample.rise();
  for (std::size_t d = 0; d < Dim; ++d) s.friction[d] = viscosity_ / spacing_ * rise[static_cast<Eigen::Index>(d)];
  s.friction = s.friction - dot(s.friction, normal) * normal;
  double whole = counted / weights;  // what is left is spray
  if (free_surface_) whole *= Spray::wet(std::sqrt(nearest) / spacing_);
  s.pressure *= whole;
  s.friction = whole * s.friction;
  return s;
}

/// Where no fluid is near, as between bodies that touch, the pressure is the mean of the others; beside a free surface
/// it is zero.
void BorderLoad::sum(RigidBody& body, const Border& border) const {
  const auto& pieces = border.body.pieces();
  const Stress* const stress = stress_.data() + border.first;
  double wet = 0.0, mean = 0.0;
  for (std::size_t q = 0; q < pieces.size(); ++q) {
    if (!stress[q].wet) continue;
    wet += pieces[q].content;
    mean += pieces[q].content * stress[q].pressure;
  }
  if (!(wet > 0.0)) return;
  mean = free_surface_ ? 0.0 : mean / wet;
  const OwnAxes axes(body);
  Vec3 force{}, torque{};
  for (std::size_t q = 0; q < pieces.size(); ++q) {
    if (!stress[q].wet) continue;
    const Vec3 normal = axes.to_space(pieces[q].normal),
               push = pieces[q].content * (stress[q].friction - (stress[q].pressure - mean) * normal);
    force = force + push;
    torque = torque + cross(axes.to_space(pieces[q].arm), push);
  }
  body.now.touch_force = body.now.touch_force + force;
  body.now.touch_torque = body.now.touch_torque + torque;
}

}  // namespace barchan
