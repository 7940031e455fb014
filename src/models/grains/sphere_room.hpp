// Room for spheres: what stands in the domain that a sphere of a phase must not overlap where it is made.
#pragma once

#include <string>
#include <vector>

#include "models/bodies/solid_surfaces.hpp"
#include "models/layout.hpp"
#include "models/walls/wall_motion.hpp"
#include "start/generate.hpp"
#include "state/state.hpp"

namespace barchan {

/// Whether particles of two phases touch in the steps of contacts of spheres.
bool touch_as_spheres(const Layout& layout, std::size_t a, std::size_t b);

/// Sides of the domain, walls and rigid bodies that spheres of a phase touch by their surfaces.
class SphereRoom {
 public:
  /// `reach` (m): as far as gaps are wanted.
  SphereRoom(const Scene& scene, const Layout& layout, std::size_t phase, double reach);
  /// Bodies and walls stand where they are now.
  void move(const State& state, const std::vector<const WallMotion*>& motions);

  struct Nearest {
    double gap = 0.0;      // m, from the place; negative inside
    std::size_t fill = 0;  // of the scene
  };
  /// What is nearest to a place; a gap of the reach: nothing is nearer.
  Nearest nearest(const Vec3& x) const;
  /// Whether the lower or the upper side of the domain along an axis holds the spheres.
  bool has_side(std::size_t axis, bool high) const;

 private:
  struct Side {
    std::size_t axis, fill;
    bool high;
    double place;  // m
  };
  struct Solid {
    std::size_t fill, phase;
    RigidBody start;
  };
  const Layout& layout_;
  double reach_;
  std::vector<Side> sides_;
  SolidSurfaces surfaces_;
  std::vector<Solid> solids_;  // each with one surface
};

/// Refuses spheres that overlap a wall, a body or each other at the start by more than contacts of a bed at rest do:
/// they would be shot off. Throws SceneError. `laws`: of spheres, by phase and phase.
void check_room_at_start(const Scene& scene, const Layout& layout, const std::vector<std::uint32_t>& laws,
                         const std::vector<ParticleBlock>& blocks);

}  // namespace barchan
