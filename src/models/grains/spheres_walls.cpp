// Walls of spheres: by their surfaces where the shapes have some, else as spheres; those that stay, and those that a
// [[motion]] carries, step of contacts by step.
#include <algorithm>
#include <cmath>

#include "models/grains/spheres.hpp"
#include "models/walls/wall_motion.hpp"
#include "start/ball_surfaces.hpp"

namespace barchan {

/// Fills whose shapes have surfaces are these. Of the others particles inside the domain are spheres; those behind a
/// side of it are the side. A wall that travels is no side: all of its particles are spheres.
void Spheres::add_wall(std::size_t phase, const ParticleBlock& block) {
  const PlanPhase& plan = layout_.phases[phase];
  const Bounds& bounds = layout_.bounds;
  const std::size_t before = fixed_kind_.size();
  std::vector<bool> by_surface(block.position.size(), false);
  for (std::size_t k = 0; k < block.parts.size(); ++k) {
    const Fill& fill = scene_.fills[block.parts[k].fill];
    if (!touched_by_surface(scene_, scene_.phases[phase], fill.shape)) continue;
    solid_walls_.add(scene_, layout_, phase, fill, laws_.reach());
    const std::size_t end = k + 1 < block.parts.size() ? block.parts[k + 1].first : block.position.size();
    std::fill(by_surface.begin() + static_cast<std::ptrdiff_t>(block.parts[k].first),
              by_surface.begin() + static_cast<std::ptrdiff_t>(end), true);
  }
  for (std::size_t i = 0; i < block.position.size(); ++i) {
    if (by_surface[i]) continue;
    const Vec3& x = block.position[i];
    bool inside = true;
    for (std::size_t d = 0; d < static_cast<std::size_t>(layout_.dimensions); ++d)
      inside = inside && (bounds.periodic[d] || (x[d] >= bounds.low[d] && x[d] <= bounds.high[d]));
    if (!inside && !plan.travels()) continue;
    const double radius = block.radius.empty() ? 0.5 * plan.spacing : block.radius[i];
    fixed_.insert(fixed_.end(), {x[0], x[1], x[2], radius});
    fixed_kind_.push_back(static_cast<std::uint8_t>(phase));
  }
  if (plan.travels() && fixed_kind_.size() > before)
    walls_.push_back({phase, before, fixed_kind_.size() - before, nullptr});
}

void Spheres::bind_walls() {
  for (SphereWall& wall : walls_) wall.motion = w_->wall_motions[wall.phase];
}

/// The spheres of a wall where they are a time (s) after the step of the scene began, with the velocities of half a
/// step of contacts before, as those of the grains are.
template <int Dim>
void Spheres::carry_wall(const SphereWall& wall, double elapsed) {
  using R = SphereRecord<Dim>;
  const WallMotion& motion = *wall.motion;
  const RigidBody pose = motion.within_step(elapsed);
  const OwnAxes axes(pose);
  const double middle = w_->state.time + elapsed - 0.5 * each_;
  const Vec3 velocity = motion.velocity(middle), rate = motion.rate(middle);
  double farthest2 = 0.0, fastest2 = 0.0;
  const auto n = static_cast<std::int64_t>(wall.count);
  double* const records = records_[now_].data();
  const double *const start = fixed_.data(), *const listed = strays_.places();
#pragma omp parallel for schedule(static) reduction(max : farthest2, fastest2)
  for (std::int64_t i = 0; i < n; ++i) {
    const std::size_t k = wall.first + static_cast<std::size_t>(i), sphere = moving_ + k;
    const double* const x = start + 4 * k;
    const Vec3 arm = axes.to_space(motion.arm({x[0], x[1], x[2]})), at = pose.now.place + arm,
               speed = velocity + cross(rate, arm);
    double* const r = records + sphere * R::size;
    double way2 = 0.0;
    for (std::size_t d = 0; d < Dim; ++d) {
      r[d] = at[d];
      r[R::velocity + d] = speed[d];
      way2 += std::pow(at[d] + each_ * speed[d] - listed[sphere * Dim + d], 2);
    }
    for (std::size_t d = 0; d < R::spins; ++d) r[R::spin + d] = rate[Dim == 2 ? 2 : d];
    farthest2 = std::max(farthest2, way2);
    fastest2 = std::max(fastest2, dot(speed, speed));
  }
  step_.fastest_wall = std::max(step_.fastest_wall, std::sqrt(fastest2));
  const double allowance = strays_.allowance();
  walls_left_ = walls_left_ || !(farthest2 < SphereChunk::used_up * allowance * allowance);
}

/// Walls that travel, before the step of contacts that ends `elapsed` (s) after the step of the scene began.
void Spheres::carry_walls(double elapsed) {
  step_.fastest_wall = 0.0;
  for (const SphereWall& wall : walls_)
    layout_.dimensions == 2 ? carry_wall<2>(wall, elapsed) : carry_wall<3>(wall, elapsed);
  if (!solid_walls_.any()) return;
  solid_walls_.carry(w_->state.time, elapsed, each_);
  walls_left_ = walls_left_ || solid_walls_.left(strays_.allowance(), each_);
}

}  // namespace barchan
