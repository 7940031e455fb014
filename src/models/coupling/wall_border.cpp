#include "models/coupling/wall_border.hpp"

#include "engine/exchange.hpp"
#include "models/bodies/border_points.hpp"
#include "models/bodies/elastic_border.hpp"

namespace barchan {

WallBorder::WallBorder(const Scene& scene, const Layout& layout, const PlanEntry& entry, const ParticleBlock& block)
    : wall_(entry.other), fluid_(border_fluid(scene, layout, entry)) {
  neighbours_.emplace(layout, fluid_.phase, fluid_.radius);
  const double width = piece_width(layout.dimensions) * fluid_.spacing;
  for (const ParticleBlock::Part& part : block.parts) {
    const auto points = free_border(scene, part.fill, width);
    if (points.empty()) {
      pieces_.clear();
      return;
    }
    for (const BorderPoint& point : points) {
      Piece piece{point.at, point.normal, point.content, part.first, {}};
      for (std::size_t k = 0; k < block.position.size(); ++k)
        if (norm(block.position[k] - point.at) < norm(block.position[piece.anchor] - point.at)) piece.anchor = k;
      piece.beside = point.at - block.position[piece.anchor];
      pieces_.push_back(piece);
    }
  }
}

/// On several ranks a particle of the wall is one rank's.
void WallBorder::find_places(const Workspace& w) {
  struct Found {
    std::size_t piece;
    PiecePlace place;
  };
  std::vector<Found> found;
  const std::uint32_t* const places = w.state.phases[wall_].places();
  for (std::size_t q = 0; q < pieces_.size(); ++q)
    if (const std::uint32_t at = places[pieces_[q].anchor]; at != PhaseParticles::elsewhere)
      found.push_back({q, piece_place(w, wall_, at, pieces_[q].beside)});
  Exchange().join(found);
  places_.resize(pieces_.size());
  for (const Found& one : found) places_[one.piece] = one.place;
}

WallBorder::Load WallBorder::load(const Workspace& w, const Vec3& about) {
  if (places_.empty()) find_places(w);
  neighbours_->look_from(w, places_);
  const Vec3& gravity = w.scene.domain.gravity;
  stress_.resize(pieces_.size());
  for (std::size_t q = 0; q < pieces_.size(); ++q) {
    if (!neighbours_->is_own(q)) continue;
    const BorderMotion border{pieces_[q].normal, {}, {}};
    stress_[q] = border_stress(w.layout.dimensions, gravity, fluid_, neighbours_->of(q), border);
  }
  neighbours_->share(stress_);
  Load sum;
  for (std::size_t q = 0; q < pieces_.size(); ++q) {
    const Piece& piece = pieces_[q];
    const Vec3 push = piece.content * (stress_[q].friction - stress_[q].pressure * piece.normal);
    sum.force = sum.force + push;
    sum.torque = sum.torque + cross(piece.at - about, push);
  }
  return sum;
}

}  // namespace barchan
