// Walls that spheres touch by the surfaces of their shapes (models/bodies/solid_surfaces.hpp): those that stay, and
// those that a [[motion]] carries.
#pragma once

#include <vector>

#include "models/grains/sphere_pairs.hpp"
#include "models/layout.hpp"
#include "models/walls/wall_motion.hpp"
#include "state/archive.hpp"

namespace barchan {

class SolidWalls {
 public:
  /// A sphere and a wall that touch.
  struct Contact {
    Vec3 normal;      // out of the wall
    double distance;  // m, of the sphere's centre; -infinity: too deep to tell
    std::uint32_t law;
    Vec3 foot;            // m, the place of the contact from the sphere's centre
    Vec3 velocity, rate;  // m/s there and 1/s, of the wall
  };
  static constexpr std::size_t most = SolidSurfaces::most;

  /// Adds the shape of a fill of the wall. `reach` (m): how far outside distances are wanted.
  void add(const Scene& scene, const Layout& layout, std::size_t phase, const Fill& fill, double reach);
  bool any() const { return surfaces_.size() > 0; }
  /// `laws`: of spheres, by phase and phase. Null motions: the wall stays.
  void attach(const Layout& layout, const std::vector<std::uint32_t>& laws,
              const std::vector<const WallMotion*>& motions);
  /// Whether spheres of the phase touch some wall.
  bool touched_by(std::size_t phase) const { return !of_phase_.empty() && !of_phase_[phase].empty(); }

  /// Walls that travel, `elapsed` (s) after the step of the scene began at `time` (s), with the velocities of half a
  /// step of contacts (s) before.
  void carry(double time, double elapsed, double step);
  /// Their places are those of the lists.
  void list();
  /// Whether some place of a wall is, after another step (s), farther than `allowance` (m) from where it was listed.
  bool left(double allowance, double step) const;
  void archive(Archive& a);

  /// Makes the list of a chunk: its spheres that are nearer than `slack` (m) to a wall.
  void find(const SphereSet& spheres, double slack, SphereChunk& chunk) const;
  /// The same of one sphere.
  void find_anew(const SphereSet& spheres, std::uint32_t sphere, double slack, SphereChunk& chunk) const;
  /// The contacts of a sphere at x with the velocity v that touch now or in the next `step` (s). `by_bodies`: what it
  /// touches besides, or null.
  std::size_t touch(const Vec3& x, const Vec3& v, double radius, double step, std::size_t phase,
                    const SphereChunk::AtWalls& at, const SolidTouches* by_bodies,
                    std::array<Contact, most>& found) const;
  /// Whether a sphere of the list may touch a wall under this law.
  bool may_touch(const SphereChunk::AtWalls& at, std::size_t phase, std::uint32_t law) const;
  /// m, of a place to the nearest wall that spheres of the phase touch; `reach` where none is nearer.
  double distance(const Vec3& x, std::size_t phase, double reach) const {
    return touched_by(phase) ? surfaces_.distance(x, reach, of_phase_[phase]) : reach;
  }

 private:
  struct Wall {
    std::size_t phase = 0;
    const WallMotion* motion = nullptr;
    RigidBody start;
    Vec3 low{1e300, 1e300, 1e300}, high{-1e300, -1e300, -1e300};  // m, at the start
    Vec3 place{}, velocity{}, rate{};                             // m, m/s, 1/s
    double fastest = 0.0;                                         // m/s, of its places
  };
  bool add_near(const SphereSet& spheres, std::uint32_t sphere, double slack, std::size_t phase,
                SphereChunk::AtWalls& at) const;
  std::span<const std::uint16_t> near_of(const SphereChunk::AtWalls& at, std::size_t phase) const;
  template <class F>
  void each_corner(const Wall& wall, F&& f) const;

  int dimensions_ = 2;
  SolidSurfaces surfaces_;
  std::vector<Wall> walls_;                           // by solid
  std::vector<std::vector<std::uint16_t>> of_phase_;  // by phase of spheres: surfaces that they touch
  std::vector<std::uint32_t> laws_;                   // by phase and solid
  std::vector<Vec3> listed_;                          // m, corners of walls that travel
};

}  // namespace barchan
