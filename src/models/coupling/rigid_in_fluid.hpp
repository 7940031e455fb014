// Rigid bodies in fluids: their surface, which the fluid's velocity is continued from, and the part of the torque that
// the forces on their particles do not have (laws/turning_friction.hpp). Forces: models/coupling/solid_in_fluid.hpp.
#pragma once

#include <span>
#include <vector>

#include "models/fluid/fluid_rates.hpp"
#include "models/workspace.hpp"

namespace barchan {

class RigidInFluid : public Model {
 public:
  /// For the phase `solid` and all its coupling entries.
  RigidInFluid(const Scene& scene, const Layout& layout, std::size_t solid);
  void begin(State& state, const std::vector<ParticleBlock>& blocks) override;
  void attach(Workspace& w) override;
  void schedule(Schedule& s) override;
  void limits(std::vector<StepLimit>& limits) const override;

 private:
  void find_surface(const RigidBody& body, const std::vector<Vec3>& x, PhaseParticles& p);
  void move_surface();
  void turn();

  const Scene& scene_;
  const Layout& layout_;
  std::size_t solid_, first_body_ = 0, bodies_ = 0;
  double reach_ = 0.0;  // m, of its entries with fluids
  bool of_pairs_ =
      false;  // a fluid of the plain scheme feels it: forces of pairs, which answer its acceleration at once
  /// A particle of a body, along the body's own axes.
  struct OfBody {
    Vec3 arm;      // m, from the body's place
    Vec3 normal;   // of the nearest place of the surface, into the fluid; zero where it is not known
    double depth;  // m, to that place
  };
  OwnColumn<OfBody> of_body_;
  std::vector<double> following_;     // by body: share of a change of its acceleration that the pressure follows
  std::vector<FluidNeighbour> felt_;  // by fluid
  /// What turning_friction makes of the sums of a particle, by place.
  std::vector<Vec3> areas_, couples_;
  std::vector<Vec3> rates_;  // 1/s, by place
  Workspace* w_ = nullptr;
};

/// Mass of the fluid about a rigid body that answers its acceleration at once, over the body's mass, or of inertias if
/// that is more; 0 of a driven body. The pressure at the surface answers with the force of the fluid between the
/// particles on both sides of it: about a row of particles round the body. Only layout and blocks are needed.
double answering_share(const RigidBody& body, const Scene& scene, const Layout& layout);

/// Of the particles of rigid bodies, 2 V_b times the sums of laws/turning_friction.hpp: `area` 2 V_b sum mu V_a F r
/// (N s/m), and `couple` -V_b sum mu V_a F r x (v_ba - w x r) with the angular velocity w of each (N m).
BARCHAN_PER_INSTRUCTION_SET(turning_friction,
                            void turning_friction(const RecordArray& own, std::span<const FluidNeighbour> fluids,
                                                  std::span<const Vec3> rate, std::span<Vec3> area,
                                                  std::span<Vec3> couple, int dimensions);)

}  // namespace barchan
