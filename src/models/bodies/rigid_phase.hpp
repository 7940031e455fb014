// A phase of rigid bodies, one a [[fill]]: they move as wholes and carry their particles along (docs/method.md).
#pragma once

#include <memory>
#include <vector>

#include "models/bodies/rigid_start.hpp"
#include "models/forces.hpp"
#include "models/row_mean.hpp"
#include "models/workspace.hpp"

namespace barchan {

void declare_rigid(const Scene& scene, std::size_t number, Layout& layout);
void describe_rigid(const Scene& scene, const std::vector<ParticleBlock>& blocks, std::size_t number, Layout& layout,
                    std::vector<std::string>& warnings);

/// How a [[motion]] holds bodies: of driven ones the velocity of their places and the angular velocity; of those that
/// turn freely about a place the torque and the friction there.
struct RigidHold {
  RigidHold(const Motion& motion);
  std::array<Formula, 3> velocity, rate, torque;  // m/s, 1/s, N m
  double friction;                                // N m
};

class RigidPhase : public Model {
 public:
  RigidPhase(const Scene& scene, const Layout& layout, std::size_t number);
  void begin(State& state, const std::vector<ParticleBlock>& blocks) override;
  void attach(Workspace& w) override;
  void schedule(Schedule& s) override;
  void limits(std::vector<StepLimit>& limits) const override;
  const StepLimit* moving_limit() override;
  int phase() const override { return static_cast<int>(number_); }
  void history(HistoryRow& row) const override;
  void begin_row() override;
  void archive(Archive& a) override;

 private:
  void kick_and_drift();
  void clear_loads();
  void add_forcings(PhaseParticles& p);
  void sum_loads();
  void finish_kick();
  void sum_up(std::size_t number);
  static void kick(RigidBody& body, double time);
  void drive(RigidBody& body, double time) const;
  void end_step(RigidBody& body) const;
  std::array<Vec3, 2> driven(const RigidBody& body) const;
  void add_particles(std::size_t number);
  void hold_torque(RigidBody& body);
  /// A body as its particles see it, in space.
  struct Carrier {
    explicit Carrier(const RigidBody& body);
    OwnAxes axes;
    Vec3 place, velocity, rate;      // m, m/s, 1/s
    Vec3 acceleration{}, turning{};  // m/s2, 1/s2: where accelerations are carried
  };
  void renew_carriers();
  void carry_places();
  void carry_velocities();
  void carry_accelerations();
  template <int Dim>
  void inform_fluids();
  std::size_t bodies() const { return plan_.rigid_bodies.size(); }
  RigidBody& body(std::size_t k) const { return w_->state.bodies[first_body_ + k]; }

  const Scene& scene_;
  const Layout& layout_;
  const PlanPhase& plan_;
  std::size_t number_, first_body_ = 0;
  Forces forces_;
  bool touches_spheres_ = false;                   // in the steps of contacts (models/grains/sphere_bodies.hpp)
  bool felt_ = false;                              // particles feel something by themselves
  std::vector<Carrier> carriers_;                  // by body, of the task that runs
  std::vector<double> mass_shares_;                // by body: its mass over that of its particles
  std::vector<Vec3> levers_;                       // m, by body: its centre of mass from the mean of its particles
  std::vector<Vec3> old_rates_;                    // 1/s, by body, of the step before its kick
  std::vector<RigidHold> holds_;                   // by [[motion]]
  OwnColumn<Vec3> arm_;                            // m, from the body's place along its own axes
  OwnColumn<std::uint32_t> body_of_;               // number of the body, from the phase's first
  std::vector<RowMean> mean_force_, mean_torque_;  // N, N m, of what touches, by body
  StepLimit limit_;
  Workspace* w_ = nullptr;
};

}  // namespace barchan
