// The border of an elastic body that a fluid ends at: pieces of it that move with the body's particles.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "base/vec3.hpp"
#include "models/bodies/border_points.hpp"
#include "models/layout.hpp"
#include "start/generate.hpp"
#include "state/particles.hpp"

namespace barchan {

/// The pieces of the border of a fill (border_points) on which no other wall or body stands at the start.
std::vector<BorderPoint> free_border(const Scene& scene, std::size_t fill, double width);

/// Pieces of the borders of the fills of an elastic phase, made once of the first shape. A piece X_q follows from the
/// particles k about it by moving least squares of first order in the first shape (Lancaster & Salkauskas 1981):
///
///   x_q = sum N_k x_k,  v_q = sum N_k v_k,  F_q = sum x_k (x) G_k,  n_q A_q = cof(F_q) N_q A0_q,
///   grad v = sum v_k (x) G_k F_q^-1
///
/// with sum N_k = 1, sum N_k X_k = X_q, sum G_k = 0, sum X_k (x) G_k = 1: exact for affine motions. A force on a piece
/// goes to its particles with the same N_k, so that force, torque (of the first order) and the work v_q.f are kept.
class ElasticBorder {
 public:
  /// A piece as the particles stand now.
  struct Piece {
    Vec3 place{}, velocity{}, spin{};  // m, m/s, 1/s: half the curl of the velocity
    Vec3 normal{};                     // of unit length, out of the body
    Vec3 beside{};                     // m, from its anchor to it; the anchor may be an image
    double content = 0.0;              // m (2D) or m2
    std::size_t anchor = 0;            // its nearest particle, id from the phase's first
    /// Of the surface at a place r (m) from its middle, as if it turned without stretching.
    Vec3 velocity_at(const Vec3& r) const { return velocity + cross(spin, r); }
  };
  /// The nearest piece of a place.
  struct Near {
    std::size_t piece;
    Vec3 from;        // m, from its middle to the place
    double distance;  // m, along the piece's normal, negative inside
  };

  ElasticBorder() = default;
  /// Of the phase, whose fills all have a surface (has_surface of scene/couplings.hpp). `width` (m): of its pieces, at
  /// most; `reach` (m): as far as nearest() looks. Pieces on which another wall or body stands at the start are left
  /// out. Throws SceneError where too few particles stand about a piece.
  ElasticBorder(const Scene& scene, const Layout& layout, std::size_t phase, const ParticleBlock& block, double width,
                double reach);

  /// Brings the pieces to where the particles are; the phase keeps its places.
  void move(const PhaseParticles& body);
  const std::vector<Piece>& pieces() const { return pieces_; }
  /// The piece whose middle is nearest to a place or its periodic images, if it is within the reach.
  std::optional<Near> nearest(const Vec3& x) const;
  /// Whether nearest() can find anything there.
  bool may_reach(const Vec3& x) const;
  /// sum N_k y_k of what the particles have in columns, by place.
  template <class Columns>
  Vec3 mean(std::size_t piece, const std::uint32_t* places, const Columns& columns) const {
    Vec3 sum{};
    for (std::uint32_t k = begin_[piece]; k < begin_[piece + 1]; ++k)
      for (std::size_t d = 0; d < dimensions_; ++d) sum[d] += weights_[k].value * columns[d][places[weights_[k].id]];
    return sum;
  }
  /// Adds N_k f by particle (id from the phase's first).
  void spread(std::size_t piece, const Vec3& force, std::vector<Vec3>& to) const {
    for (std::uint32_t k = begin_[piece]; k < begin_[piece + 1]; ++k)
      to[weights_[k].id] = to[weights_[k].id] + weights_[k].value * force;
  }

 private:
  struct Weight {
    std::uint32_t id;
    double value;  // N
    Vec3 slope;    // G, 1/m
  };
  struct First {
    Vec3 normal;
    double content;
  };
  void add_piece(const Scene& scene, const ParticleBlock& block, const ParticleBlock::Part& part, std::size_t end,
                 const Vec3& at, const First& first);
  void sort_into_cells();
  std::size_t bucket_of(const std::array<std::int64_t, 3>& cell) const;
  Vec3 shortest(Vec3 x) const;

  std::size_t dimensions_ = 2;
  double spacing_ = 1.0, reach_ = 1.0;  // m
  Vec3 period_{};                       // m; 0: not periodic
  std::vector<Piece> pieces_;
  std::vector<First> first_;
  std::vector<std::uint32_t> begin_{0};  // of weights_, by piece
  std::vector<Weight> weights_;
  Vec3 low_{}, high_{};                                // m, the box of all pieces, wider by the reach
  std::vector<std::uint32_t> in_bucket_, bucket_end_;  // pieces by a hash of their cell, `reach` wide
};

}  // namespace barchan
