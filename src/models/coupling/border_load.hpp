// What a fluid of the consistent scheme does to rigid bodies: its stress, summed over their borders.
#pragma once

#include "models/bodies/body_border.hpp"
#include "models/coupling/border_neighbours.hpp"
#include "models/coupling/spray.hpp"
#include "models/workspace.hpp"

namespace barchan {

/// The rates of the consistent scheme are not sums of forces of pairs, so that nothing that its particles lose is the
/// force on a body. The force is the integral of -p n + mu du/dn over the border: the velocity u in the body's own
/// motion vanishes there and is free of divergence, so that its friction has no other part. Pressure and du/dn come
/// from weighted least squares over the fluid about each piece of the border (docs/method.md, Rigid bodies, In a
/// fluid). No pressure of that scheme keeps a particle off a border, so that particles which come too near are put
/// back.
class BorderLoad : public Model {
 public:
  /// For the phase `entry.other` and its fluid.
  BorderLoad(const Scene& scene, const Layout& layout, const PlanEntry& entry);
  void begin(State& state, const std::vector<ParticleBlock>& blocks) override;
  void attach(Workspace& w) override;
  void schedule(Schedule& s) override;

 private:
  /// What the fluid does at a piece.
  struct Stress {
    bool wet = false;
    double pressure = 0.0;  // Pa
    Vec3 friction{};        // Pa
  };
  /// The particle of the body that is nearest to a piece: what moves no farther from it than the skin of the lists
  /// since the particles were sorted, is found by the cells.
  struct Anchor {
    std::size_t particle;  // id from the phase's first
    Vec3 to_piece;         // m, along the body's own axes
  };
  struct Border {
    BodyBorder body;
    std::vector<Anchor> anchors;  // by piece
    std::size_t first;            // number of its first piece among those of all bodies
  };
  void hold();
  void load();
  void find_places();
  void spray();
  template <int Dim>
  void find_stress(const RigidBody& body, const Border& border);
  template <int Dim>
  Stress stress_at(const RigidBody& body, const OwnAxes& axes, const Border& border, std::size_t piece,
                   const std::vector<BorderNeighbour>& about) const;
  void sum(RigidBody& body, const Border& border) const;

  const Scene& scene_;
  const Layout& layout_;
  std::size_t fluid_, solid_, first_body_ = 0;
  bool free_surface_;                    // beyond which nothing presses
  double spacing_, radius_, viscosity_;  // m, m, Pa s
  BorderNeighbours neighbours_;
  std::vector<Border> borders_;     // by body
  std::vector<PiecePlace> places_;  // by piece of all bodies
  std::vector<Stress> stress_;
  Spray spray_;
  Workspace* w_ = nullptr;
};

}  // namespace barchan
