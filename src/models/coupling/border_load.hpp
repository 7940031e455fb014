// What a fluid of the consistent scheme does to rigid bodies: its stress, summed over their borders.
#pragma once

#include "models/bodies/border_points.hpp"
#include "models/bodies/contact_surface.hpp"
#include "models/fluid/fluid_rates.hpp"
#include "models/workspace.hpp"

namespace barchan {

/// The rates of the consistent scheme are not sums of forces of pairs, so that nothing that its particles lose is the
/// force on a body. The force is -p n + mu du/dn over the pieces of the border (the velocity u in the body's own motion
/// vanishes at the border and is free of divergence, so that its friction has no other part). Pressure and du/dn at a
/// piece come from weighted least squares over the fluid about it (docs/method.md).
class BorderLoad : public Model {
 public:
  /// For the phase `solid` and its fluid of the consistent scheme.
  BorderLoad(const Scene& scene, const Layout& layout, const PlanEntry& entry);
  void begin(State& state, const std::vector<ParticleBlock>& blocks) override;
  void attach(Workspace& w) override;
  void schedule(Schedule& s) override;

 private:
  struct Piece {
    Vec3 arm, normal;     // along the body's own axes: m, from its place, and out of it
    Vec3 from_anchor;     // m, from the nearest particle of the body
    double content;       // m (2D) or m2
    std::size_t anchor;   // this particle: id from the phase's first
  };
  /// What the fluid does at a piece.
  struct Stress {
    bool wet;
    double pressure;  // Pa
    Vec3 friction;    // Pa
  };
  struct Border {
    std::vector<Piece> pieces;
    std::vector<ContactSurface> surfaces;  // none: the plane of each piece is the border about it
  };
  void load();
  template <int Dim>
  void find_stress(const RigidBody& body, const Border& border);
  void sum(RigidBody& body, const Border& border) const;

  const Scene& scene_;
  const Layout& layout_;
  std::size_t fluid_, solid_, first_body_ = 0;
  double spacing_, radius_, viscosity_, slack_ = 0.0;  // m, m, Pa s, m
  std::vector<Border> borders_;                        // by body
  std::vector<Stress> stress_;                         // by piece, of the body that is looked at
  Workspace* w_ = nullptr;
};

}  // namespace barchan
