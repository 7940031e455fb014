// A wall that a [[motion]] carries as a rigid whole: a piston, a gate, a drum, a belt.
#pragma once

#include <optional>
#include <vector>

#include "models/walls/wall_faces.hpp"
#include "models/walls/wall_motion.hpp"
#include "models/workspace.hpp"

namespace barchan {

/// Moves the particles of the wall. Wall extends the fluids into it, Spheres lets it touch grains; nothing acts on it.
class DrivenWall : public Model {
 public:
  /// `number`: of the [[motion]].
  DrivenWall(const Scene& scene, const Layout& layout, std::size_t number);
  void begin(State& state, const std::vector<ParticleBlock>& blocks) override;
  void attach(Workspace& w) override;
  void schedule(Schedule& s) override;
  void history(HistoryRow& row) const override;
  void archive(Archive& a) override;

 private:
  void find_faces(PhaseParticles& p, const std::vector<Vec3>& places);
  void go();
  void tell();
  void inform_fluids();

  const Scene& scene_;
  const Layout& layout_;
  std::size_t number_, phase_ = 0;
  std::optional<WallMotion> motion_;
  OwnColumn<Vec3> arm_;       // m, at the start, from the place about which it turns
  OwnColumn<WallFace> face_;  // of walls that a fluid feels
  double reach_ = 0.0;        // m, of the fluids' kernels
  double softly_ = 0.0;       // s, in which a fluid can follow a jump of the velocity
  Workspace* w_ = nullptr;
};

}  // namespace barchan
