// Particles of air on a grid, in two dimensions: their mean velocity at a place, and forces at a place given back to
// them. Both use the same weights, bilinear in each cell of one spacing, so that what a place gives the particles get,
// to rounding: with M = sum m_a w_a of a node,
//   u_node = sum m_a w_a u_a / M,   a_a = sum w_a F_node / M,   sum m_a a_a = sum F_node.
#pragma once

#include <array>
#include <vector>

#include "engine/cell_grid.hpp"
#include "state/particles.hpp"

namespace barchan {

class AirGrid {
 public:
  using Flat = std::array<double, 2>;

  /// Cells of about `spacing` (m) over the domain.
  AirGrid(const Bounds& bounds, double spacing);

  /// Takes masses and velocities of the particles; forces are zero again, or those that are kept.
  void gather(const PhaseParticles& air);
  /// The forces that were pushed since gather() are kept: each gather() begins with them, until forget() was called.
  void keep_forces() { kept_ = force_; }
  void forget() { kept_.clear(); }
  void archive(Archive& a) { a.array("kept forces on the air", kept_); }
  /// Mean velocity (m/s) about a place; zero where no air is.
  Flat velocity(const Flat& x) const;
  /// kg/m3 (2D: kg/m2 a metre of depth), of the particles about a place.
  double density(const Flat& x) const;
  /// A force (N per metre of depth) on the air about a place. What finds no air is lost: lost().
  void push(const Flat& x, const Flat& force);
  const Flat& lost() const { return lost_; }
  /// Writes the accelerations of the particles by these forces (m/s2) into their field drag_acceleration.
  void give(PhaseParticles& air) const;

 private:
  struct Corner {
    std::size_t node;
    double weight;
  };
  std::array<Corner, 4> corners(const Flat& x) const;

  Bounds bounds_;
  std::array<std::size_t, 2> cells_{}, nodes_{};
  Flat width_{};
  std::vector<double> mass_;
  std::vector<Flat> velocity_, force_, kept_;  // kept_: empty, or by node
  Flat lost_{};
};

}  // namespace barchan
