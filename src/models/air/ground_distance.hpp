// The distance to the ground: closed sides of the domain, walls within it, grains at rest.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/cell_grid.hpp"
#include "engine/integrate.hpp"

namespace barchan {

/// What eddies are kept small by. Sides are planes, fitted walls a cloud of small pieces of their surface. Everything
/// else is a cloud of particles one spacing thick: at every search for neighbours, the nearest of them is propagated
/// from cell to cell (Danielsson 1980), so that a fluid particle, wherever it is, compares the candidates of its own
/// and the adjacent cells only.
class GroundDistance {
 public:
  /// `sides`: the planes that count. `spacing`: of the cells and the particles.
  GroundDistance(const Bounds& bounds, const Sides& sides, double spacing, bool has_particles);

  /// Takes the ground's particles anew: walls within the domain, and grains that at least three others surround (those
  /// in flight are no ground). Allocates only to grow.
  void refresh(std::span<const PhaseParticles* const> phases);

  /// Distance to the nearest surface, at least 0 and at most the domain's diagonal.
  double distance(const Vec3& x) const;

  /// The ground as it was taken last.
  void archive(Archive& a);

 private:
  std::size_t cell_of(const Vec3& x, std::array<int, 3>& at) const;
  double squared(const Vec3& x, std::int32_t seed) const;
  double from_seed(const Vec3& x, std::size_t seed) const;
  void propagate();

  Bounds bounds_;
  Sides sides_;
  double spacing_, diagonal_ = 0.0;
  std::array<int, 3> count_{1, 1, 1};
  std::array<double, 3> side_{1, 1, 1};
  std::vector<std::int32_t> nearest_;  // by cell: number of a seed, -1: none
  std::vector<std::uint8_t> crowd_;    // by cell: particles in it
  std::vector<Vec3> seeds_;
  std::vector<Vec3>
      normals_;            // by seed: of the surface that it lies on; zero: of a particle, whose surface is not known
  bool surfaces_ = false;  // some seed has a normal
};

}  // namespace barchan
