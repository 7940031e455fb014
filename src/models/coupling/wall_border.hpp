// The load of a fluid on the border of a wall that stays, from the fluid before it.
#pragma once

#include <optional>
#include <vector>

#include "models/coupling/border_stress.hpp"

namespace barchan {

/// For a wall whose fills all have a border (border_points), beside which a body is joined to it or moves: no control
/// volume stands about such a wall. Pieces on which another wall or body stands at the start are left out.
class WallBorder {
 public:
  WallBorder() = default;
  /// `entry`: that of the wall with a laminar fluid of the consistent scheme.
  WallBorder(const Scene& scene, const Layout& layout, const PlanEntry& entry, const ParticleBlock& block);

  bool there() const { return !pieces_.empty(); }
  /// N and N m (per metre of depth in 2D), the torque about a point.
  struct Load {
    Vec3 force{}, torque{};
  };
  Load load(const Workspace& w, const Vec3& about);

 private:
  void find_places(const Workspace& w);

  struct Piece {
    Vec3 at, normal;     // m
    double content;      // m (2D) or m2
    std::size_t anchor;  // the wall's nearest particle, id from the phase's first
    Vec3 beside;         // m
  };
  std::size_t wall_ = 0;
  BorderFluid fluid_{};
  std::vector<Piece> pieces_;
  std::vector<PiecePlace> places_;  // by piece; empty until the particles have been sorted: the wall stays
  std::optional<BorderNeighbours> neighbours_;
  std::vector<BorderStress> stress_;  // by piece
};

}  // namespace barchan
