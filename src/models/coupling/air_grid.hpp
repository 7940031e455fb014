// Particles of air on a grid: their mean velocity at a place, and forces at a place given back to them. Both use the
// same weights, linear along each axis in a cell of one spacing, so that what a place gives the particles get, to
// rounding: with M = sum m_a w_a of a node,
//   u_node = sum m_a w_a u_a / M,   a_a = sum w_a F_node / M,   sum m_a a_a = sum F_node.
#pragma once

#include <array>
#include <type_traits>
#include <vector>

#include "engine/cell_grid.hpp"
#include "laws/grains_in_eddies.hpp"
#include "state/particles.hpp"

namespace barchan {

class AirGrid {
 public:
  /// Cells of about `spacing` (m) over the domain.
  AirGrid(const Bounds& bounds, double spacing);

  /// Takes masses and velocities of the particles; forces are zero again, or those that are kept.
  void gather(const PhaseParticles& air);
  /// The forces that were pushed since gather() are kept: each gather() begins with them, until forget() was called.
  void keep_forces() { kept_ = force_; }
  void forget() { kept_.clear(); }
  void archive(Archive& a) { a.array("kept forces on the air", kept_); }
  /// Mean velocity (m/s) about a place; zero where no air is.
  Vec3 velocity(const Vec3& x) const;
  /// kg/m3 (2D: kg/m2 a metre of depth), of the particles about a place.
  double density(const Vec3& x) const;
  /// A force (N; 2D: per metre of depth) on the air about a place. What finds no air is lost: lost().
  void push(const Vec3& x, const Vec3& force);
  const Vec3& lost() const { return lost_; }
  /// A grain of this mass (kg) about a place, with this drag by difference of speed (1/s), for give_grains().
  void put(const Vec3& x, double mass, double rate);
  /// Writes the accelerations of the particles by these forces (m/s2) into their field drag_acceleration.
  void give(PhaseParticles& air) const;
  /// Writes the grains about the particles that were put since gather().
  void give_grains(const PhaseParticles& air, GrainsInEddies* of) const;

 private:
  struct Corner {
    std::size_t node;
    double weight;
  };
  /// Of a cell.
  template <std::size_t Dim>
  std::array<Corner, std::size_t{1} << Dim> corners(const Vec3& x) const;
  /// Calls f with the number of dimensions as a constant.
  template <class F>
  auto by_dimension(F&& f) const {
    if (dimensions_ == 2) return f(std::integral_constant<std::size_t, 2>{});
    return f(std::integral_constant<std::size_t, 3>{});
  }

  Bounds bounds_;
  std::size_t dimensions_;
  std::array<std::size_t, 3> cells_{1, 1, 1}, nodes_{1, 1, 1};
  Vec3 width_{};
  std::vector<double> mass_;
  std::vector<Vec3> velocity_, force_, kept_;  // kept_: empty, or by node
  std::vector<std::array<double, 2>> grains_;  // by node, of those put: mass times rate (kg/s), mass (kg); or empty
  Vec3 lost_{};
};

}  // namespace barchan
