#include "models/grains/solid_walls.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace barchan {

void SolidWalls::add(const Scene& scene, const Layout& layout, std::size_t phase, const Fill& fill, double reach) {
  dimensions_ = layout.dimensions;
  auto surface = SolidSurface::of(fill.shape, scene, layout.phases[phase].spacing, reach);
  if (!surface) throw std::logic_error("a wall without a surface that spheres touch");
  if (walls_.empty() || walls_.back().phase != phase) {
    walls_.emplace_back().phase = phase;
    surfaces_.add_solid();
  }
  Wall& wall = walls_.back();
  for (std::size_t d = 0; d < static_cast<std::size_t>(dimensions_); ++d) {
    wall.low[d] = std::min(wall.low[d], surface->low()[d]);
    wall.high[d] = std::max(wall.high[d], surface->high()[d]);
  }
  surfaces_.add_surface(static_cast<std::uint32_t>(walls_.size() - 1), std::move(*surface));
}

void SolidWalls::attach(const Layout& layout, const std::vector<std::uint32_t>& laws,
                        const std::vector<const WallMotion*>& motions) {
  if (!any()) return;
  const std::size_t n = layout.phases.size();
  std::array<double, 3> period{};
  for (std::size_t d = 0; d < 3; ++d)
    period[d] = layout.bounds.periodic[d] ? layout.bounds.high[d] - layout.bounds.low[d] : 0.0;
  surfaces_.prepare(period);
  of_phase_.resize(n);
  laws_.assign(n * walls_.size(), SphereCells::none);
  for (std::size_t p = 0; p < n; ++p) {
    for (std::size_t k = 0; k < walls_.size(); ++k)
      if (layout.phases[p].own_steps()) laws_[p * walls_.size() + k] = laws[p * n + walls_[k].phase];
    for (std::size_t s = 0; s < surfaces_.size(); ++s)
      if (laws_[p * walls_.size() + surfaces_.solid_of(s)] != SphereCells::none)
        of_phase_[p].push_back(static_cast<std::uint16_t>(s));
  }
  for (Wall& wall : walls_) {
    wall.motion = motions[wall.phase];
    if (!wall.motion) continue;
    wall.start.dimensions = dimensions_;
    wall.start.first_place = wall.start.now.place = -1.0 * wall.motion->arm({0, 0, 0});
  }
  carry(0.0, 0.0, 0.0);
  list();
}

/// Calls f with each corner of the bounds of a wall, as it is at the start.
template <class F>
void SolidWalls::each_corner(const Wall& wall, F&& f) const {
  for (int corner = 0; corner < (dimensions_ == 2 ? 4 : 8); ++corner) {
    Vec3 x{};
    for (std::size_t d = 0; d < static_cast<std::size_t>(dimensions_); ++d)
      x[d] = (corner >> d & 1) != 0 ? wall.high[d] : wall.low[d];
    f(x);
  }
}

void SolidWalls::carry(double time, double elapsed, double step) {
  for (std::size_t k = 0; k < walls_.size(); ++k) {
    Wall& wall = walls_[k];
    if (!wall.motion) continue;
    RigidBody now = wall.start;
    now.now = wall.motion->within_step(elapsed).now;
    surfaces_.move(static_cast<std::uint32_t>(k), wall.start, now);
    const double middle = time + elapsed - 0.5 * step;
    wall.place = now.now.place;
    wall.velocity = wall.motion->velocity(middle);
    wall.rate = wall.motion->rate(middle);
    double reach = 0.0;
    each_corner(wall, [&](const Vec3& x) { reach = std::max(reach, norm(x - wall.start.first_place)); });
    wall.fastest = norm(wall.velocity) + norm(wall.rate) * reach;
  }
}

void SolidWalls::list() {
  listed_.clear();
  for (std::size_t k = 0; k < walls_.size(); ++k)
    if (walls_[k].motion)
      each_corner(walls_[k],
                  [&](const Vec3& x) { listed_.push_back(surfaces_.now(static_cast<std::uint32_t>(k), x)); });
}

/// A place of a rigid wall goes no farther than its corners.
bool SolidWalls::left(double allowance, double step) const {
  std::size_t at = 0;
  bool far = false;
  for (std::size_t k = 0; k < walls_.size(); ++k)
    if (const Wall& wall = walls_[k]; wall.motion)
      each_corner(wall, [&](const Vec3& x) {
        const Vec3 now = surfaces_.now(static_cast<std::uint32_t>(k), x),
                   next = now + step * (wall.velocity + cross(wall.rate, now - wall.place)), way = next - listed_[at++];
        far = far || !(dot(way, way) < SphereChunk::used_up * allowance * allowance);
      });
  return far;
}

void SolidWalls::archive(Archive& a) {
  if (!listed_.empty()) a.array("places of walls", listed_);
}

std::span<const std::uint16_t> SolidWalls::near_of(const SphereChunk::AtWalls& at, std::size_t phase) const {
  if (at.count > SphereChunk::AtWalls::most) return of_phase_[phase];
  return {at.near, at.count};
}

bool SolidWalls::add_near(const SphereSet& s, std::uint32_t sphere, double slack, std::size_t phase,
                          SphereChunk::AtWalls& at) const {
  const std::size_t stride = s.dimensions == 2 ? SphereRecord<2>::size : SphereRecord<3>::size,
                    radius = s.dimensions == 2 ? SphereRecord<2>::radius : SphereRecord<3>::radius;
  const double* r = s.records + sphere * stride;
  const Vec3 x{r[0], r[1], s.dimensions == 2 ? 0.0 : r[2]};
  at = {};
  at.sphere = sphere;
  for (const std::uint16_t k : of_phase_[phase]) {
    if (!surfaces_.may_be_near(k, x, r[radius] + slack)) continue;
    if (at.count < SphereChunk::AtWalls::most) at.near[at.count] = k;
    ++at.count;
    if (walls_[surfaces_.solid_of(k)].motion) at.moves = 1;
  }
  return at.count > 0;
}

void SolidWalls::find(const SphereSet& s, double slack, SphereChunk& chunk) const {
  chunk.walls.clear();
  if (!touched_by(chunk.phase)) return;
  SphereChunk::AtWalls at;
  for (std::size_t k = chunk.begin; k < chunk.end; ++k)
    if (add_near(s, static_cast<std::uint32_t>(k), slack, chunk.phase, at)) chunk.walls.push_back(at);
}

void SolidWalls::find_anew(const SphereSet& s, std::uint32_t sphere, double slack, SphereChunk& chunk) const {
  SphereChunk::AtWalls at;
  if (!touched_by(chunk.phase) || !add_near(s, sphere, slack, chunk.phase, at)) return;
  const auto there = std::find_if(chunk.walls.begin(), chunk.walls.end(),
                                  [&](const SphereChunk::AtWalls& one) { return one.sphere == sphere; });
  if (there == chunk.walls.end()) chunk.walls.push_back(at);
  else *there = at;
}

std::size_t SolidWalls::touch(const Vec3& x, const Vec3& v, double radius, double step, std::size_t phase,
                              const SphereChunk::AtWalls& at, const SolidTouches* by_bodies,
                              std::array<Contact, most>& found) const {
  std::array<SolidSurfaces::Contact, most + SolidTouches::most> all;
  std::size_t known = 0;
  for (; by_bodies && known < SolidTouches::most && by_bodies->of[known].with != 0; ++known) {
    const SolidTouch& touch = by_bodies->of[known];
    all[known] = {{touch.normal[0], touch.normal[1], touch.normal[2]}, touch.distance, 0, {}};
  }
  const auto near = near_of(at, phase);
  double fastest = norm(v);
  if (at.moves != 0)
    for (const Wall& wall : walls_) fastest = std::max(fastest, norm(v) + wall.fastest + norm(wall.rate) * radius);
  const std::size_t end =
      surfaces_.touch(x, radius, radius + step * fastest, near, std::span(all).first(known + most), known);
  std::size_t count = 0;
  for (std::size_t k = known; k < end; ++k) {
    const SolidSurfaces::Contact& one = all[k];
    const std::uint32_t solid = surfaces_.solid_of(one.surface);
    const Wall& wall = walls_[solid];
    Contact& c = found[count];
    c = {one.normal, one.distance, laws_[phase * walls_.size() + solid], one.foot, {}, {}};
    if (wall.motion) {
      c.velocity = wall.velocity + cross(wall.rate, surfaces_.arm(solid, x) + one.foot);
      c.rate = wall.rate;
    }
    if (radius - c.distance > -step * std::abs(dot(v - c.velocity, c.normal))) ++count;
  }
  return count;
}

bool SolidWalls::may_touch(const SphereChunk::AtWalls& at, std::size_t phase, std::uint32_t law) const {
  const auto near = near_of(at, phase);
  return std::any_of(near.begin(), near.end(),
                     [&](std::uint16_t k) { return laws_[phase * walls_.size() + surfaces_.solid_of(k)] == law; });
}

}  // namespace barchan
