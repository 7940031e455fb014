// A wall that a [[motion]] carries as a rigid whole: a piston, a gate, a drum, a belt.
#pragma once

#include <optional>
#include <vector>

#include "models/bodies/contact_surface.hpp"
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
  /// Where its surface is nearest to a particle: the normal at the start, and how deep the particle is (m), 0: unknown.
  struct Face {
    Vec3 normal;
    double depth;
  };
  void find_faces(PhaseParticles& p, const std::vector<Vec3>& places);
  bool on_a_side(const Vec3& x) const;
  std::optional<Face> face_next_to(const ContactSurface& surface, const Vec3& x, const Vec3& side) const;
  void go();
  void tell();
  void tell_fluids();

  const Scene& scene_;
  const Layout& layout_;
  std::size_t number_, phase_ = 0;
  std::optional<WallMotion> motion_;
  OwnColumn<Vec3> arm_;   // m, at the start, from the place about which it turns
  OwnColumn<Face> face_;  // of walls that a fluid feels
  double reach_ = 0.0;    // m, of the fluids' kernels
  double softly_ = 0.0;   // s, in which a fluid can follow a jump of the velocity
  Workspace* w_ = nullptr;
};

}  // namespace barchan
