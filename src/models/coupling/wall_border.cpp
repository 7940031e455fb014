#include "models/coupling/wall_border.hpp"

#include "models/bodies/border_points.hpp"
#include "models/bodies/elastic_border.hpp"

namespace barchan {

WallBorder::WallBorder(const Scene& scene, const Layout& layout, const PlanEntry& entry, const ParticleBlock& block)
    : wall_(entry.other), fluid_(border_fluid(scene, layout, entry)), slack_(widest_skin(layout)) {
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

WallBorder::Load WallBorder::load(const Workspace& w, const Vec3& about) const {
  Load sum;
  const PhaseParticles& wall = w.state.phases[wall_];
  for (const Piece& piece : pieces_) {
    const BorderPlace at{wall.places()[piece.anchor], piece.beside, piece.normal, {}, {}};
    const BorderStress s = w.layout.dimensions == 2 ? border_stress<2>(w, fluid_, wall_, at, slack_)
                                                    : border_stress<3>(w, fluid_, wall_, at, slack_);
    const Vec3 push = piece.content * (s.friction - s.pressure * piece.normal);
    sum.force = sum.force + push;
    sum.torque = sum.torque + cross(piece.at - about, push);
  }
  return sum;
}

}  // namespace barchan
