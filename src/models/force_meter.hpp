// Force and torque on a wall, a body, or a part of one.
#pragma once

#include <vector>

#include "models/bodies/sets.hpp"
#include "models/coupling/wall_border.hpp"
#include "models/fluid/control_volume.hpp"
#include "models/fluid/fluid_rates.hpp"
#include "models/row_mean.hpp"

namespace barchan {

/// Of a wall: the sum over its pairs with fluid particles of the forces of the plain scheme, with the pressure and the
/// velocity that are continued into the wall (Adami et al. 2012); of a fluid of the consistent scheme over the sum of
/// the gradient on a lattice, which that scheme divides by too. Such pairs miss what a curved wall does by about dx/(2
/// R) (docs/method.md). So of a whole wall that is all that its fluids of that scheme touch, the force is what the
/// fluids lose: - sum m (dv/dt - g - forcing) over their particles. Of a wall that stays inside the domain, alone in a
/// laminar fluid of that scheme without a free surface or a [[forcing]], it is what a control volume about it loses
/// (models/fluid/control_volume.hpp). Of a whole wall beside an elastic body at whose border that fluid ends it is the
/// load on the wall's border (models/coupling/wall_border.hpp), torque too. Other torques are those of the pairs. Of
/// spheres: the impulse of their contacts over the steps within a step (models/grains/spheres.hpp). Of a body: mass
/// times acceleration of its particles, less gravity. The torque counts periodic images nearest to its point.
/// history.csv has the means since its last row.
class ForceOn : public Model {
 public:
  ForceOn(const Scene& scene, const Layout& layout, std::size_t number);
  void begin(State& state, const std::vector<ParticleBlock>& blocks) override;
  void attach(Workspace& w) override;
  void schedule(Schedule& s) override;
  void history(HistoryRow& row) const override;
  void begin_row() override;
  void archive(Archive& a) override;

 private:
  struct Felt {
    FluidNeighbour fluid;
    double share;  // of the sums
    std::size_t phase;
    Forces forces;
  };
  void measure();
  void measure_wall();
  void sum_up();
  void add_sums(double share, const Vec3& less);
  bool touches_nothing_else(std::size_t fluid) const;
  bool stands_alone(std::size_t number) const;
  void make_volume(const State& state);
  void measure_volume();
  void make_border(const std::vector<ParticleBlock>& blocks);
  bool bends_a_body(std::size_t fluid) const;

  const Scene& scene_;
  const Layout& layout_;
  const ForceMeter meter_;
  std::size_t number_, phase_;
  SetOfBody set_;
  bool stays_;                       // a wall: its fluids and spheres tell what acts on it, not its acceleration
  std::vector<Felt> fluids_;         // of a wall
  std::vector<std::size_t> pushes_;  // of a wall, by spheres: in Workspace::sphere_pushes
  bool balance_ = false;             // the force is what the fluids lose
  bool by_volume_ = false;           // ... what a control volume loses
  ControlVolume volume_;
  std::vector<ControlVolume::Share> shares_;
  WallBorder border_;        // there: the force is the load on it
  Vec3 force_{}, torque_{};  // N, N m (per metre of depth in 2D): of all but spheres, at the end of the step
  Vec3 impulse_{};           // N s: so far, of spheres that of their contacts, else by the trapezoids of the kicks
  Vec3 smooth_{};            // N: of all but spheres, at the end of the last step
  RowMean mean_force_, mean_torque_;
  Workspace* w_ = nullptr;
};

}  // namespace barchan
