// The distance to the ground: closed sides of the domain, walls within it, grains at rest.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/cell_grid.hpp"
#include "engine/hold_inside.hpp"

namespace barchan {

/// The surfaces that limit the size of eddies. Sides are planes, fitted walls a cloud of small pieces of their surface.
/// Everything else is a cloud of particles one spacing thick: at every search for neighbours, the nearest of them is
/// propagated from cell to cell (Danielsson 1980), so that a fluid particle, wherever it is, compares the candidates of
/// its own and the adjacent cells only.
class GroundDistance {
 public:
  /// A phase whose particles are ground.
  struct Ground {
    const PhaseParticles* particles = nullptr;
    double spacing = 0.0;  // m
    bool moves = false;    // its particles do, or a [[motion]] carries it
  };

  /// `sides`: the planes that count. `spacing` (m): of the cells, no smaller than that of any ground.
  GroundDistance(const Bounds& bounds, const Sides& sides, double spacing, bool has_particles);

  /// Takes the ground's particles anew: walls within the domain, and grains that at least three others surround (those
  /// in flight are no ground). If they are the same, their nearest ones are known. Allocates only to grow.
  void refresh(std::span<const Ground> phases);

  /// Distance to the nearest surface, at least 0 and at most the domain's diagonal.
  double distance(const Vec3& x) const;

  /// The ground as it was taken last.
  void archive(Archive& a);

 private:
  using Place = std::array<int, 3>;  // of a cell, by axis
  /// A particle that may be ground.
  struct Piece {
    Vec3 x, normal;  // x (m): of a wall whose surface is known on it
    double half;     // m, of the spacing
    bool loose;      // of grains: ground where others surround it
  };

  template <int Dim>
  void refresh(std::span<const Ground> phases);
  template <class F>
  void each_piece(const Ground& phase, F&& f) const;
  bool are_known(std::span<const Ground> phases);
  template <int Dim>
  double distance(const Vec3& x) const;
  template <int Dim>
  std::size_t cell_of(const Vec3& x, Place& at) const;
  template <int Dim>
  double squared(const Vec3& x, std::int32_t seed) const;
  double nearer(const Vec3& x, std::size_t seed, double least) const;
  std::size_t number(const Place& at) const;
  template <class F>
  void images(const Place& at, F&& f) const;
  void give(std::size_t cell, const Place& at, std::int32_t seed);
  template <int Dim>
  bool visit(std::size_t cell, const Place& at);
  template <int Dim>
  void propagate();
  /// One cell in each direction, as a number of cells.
  std::size_t margin() const { return static_cast<std::size_t>(stride_[0] + stride_[1] + stride_[2]); }

  Bounds bounds_;
  Sides sides_;
  double diagonal_ = 0.0;
  // Cells stand in an array with a halo one cell wide, which repeats the far side where that is periodic and is empty
  // elsewhere; an axis of a single cell has none.
  std::array<int, 3> count_{1, 1, 1}, halo_{0, 0, 0};
  std::array<std::ptrdiff_t, 3> stride_{1, 0, 0};
  std::array<double, 3> side_{1, 1, 1};
  std::vector<std::ptrdiff_t> around_;  // steps to a cell's neighbours and itself
  std::vector<std::int32_t> nearest_;   // by cell: number of a seed, -1: none
  std::vector<std::uint8_t> crowd_;     // by cell: particles in it
  std::vector<std::uint8_t> stale_;     // by cell, from margin() on: to be visited by the next sweep
  std::vector<Piece> of_ranks_;         // on several ranks: of all of them
  std::vector<Vec3> seeds_;
  std::vector<double> half_;  // by seed: half the spacing of its phase, m
  bool alike_ = true;         // all have the same
  std::vector<Vec3>
      normals_;            // by seed: of the surface that it lies on; zero: of a particle, whose surface is not known
  bool surfaces_ = false;  // some seed has a normal
  struct {
    std::vector<Vec3> seeds, normals;
    std::vector<double> half;
  } last_;  // of the last time, for comparison
};

}  // namespace barchan
