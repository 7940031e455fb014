// A fluid phase: its tasks in a step, and the numbers that it keeps from step to step.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "engine/hold_inside.hpp"
#include "engine/integrate.hpp"
#include "engine/means.hpp"
#include "engine/pressure_law.hpp"
#include "models/drive.hpp"
#include "models/fluid/energy.hpp"
#include "models/fluid/energy_books.hpp"
#include "models/fluid/held_boxes.hpp"
#include "models/fluid/interface_distance.hpp"
#include "models/fluid/moving_boxes.hpp"
#include "models/fluid/relief.hpp"
#include "models/fluid/surface.hpp"
#include "models/fluid/turbulence.hpp"
#include "models/fluid/two_equations.hpp"
#include "models/fluid/voids.hpp"
#include "models/forces.hpp"
#include "models/workspace.hpp"

namespace barchan {

/// What other phases ask of a fluid while they describe themselves.
void declare_fluid(const Scene& scene, std::size_t number, Layout& layout);
/// What the plan has to know of a fluid before anything else: mass, sound speed, fields, whether it is shut in.
/// Throws SceneError when no sound speed can be chosen. `warnings`: what the scene may mean otherwise.
void describe_fluid(const Scene& scene, const std::vector<ParticleBlock>& blocks, std::size_t number, Layout& layout,
                    std::vector<std::string>& warnings);

/// Throws SceneError where a fluid's two equations of turbulence cannot be.
void check_k_omega(const Scene& scene, std::size_t fluid, const Layout& layout);

/// An entry of two fluids, or of a fluid with itself.
void describe_fluids(const Scene& scene, const Interaction& pair, const Layout& layout, PlanEntry& e);
/// What makes the sums of a fluid exact to first order; empty: nothing does.
std::string correction_of(const Scene& scene, std::size_t fluid);

class FluidPhase : public Model {
 public:
  FluidPhase(const Scene& scene, const Layout& layout, std::size_t number);

  void begin(State& state, const std::vector<ParticleBlock>& blocks) override;
  void attach(Workspace& w) override;
  void schedule(Schedule& s) override;
  void limits(std::vector<StepLimit>& limits) const override;
  const StepLimit* moving_limit() override;
  int phase() const override { return static_cast<int>(number_); }
  void history(HistoryRow& row) const override;
  void begin_row() override;
  void report(Warnings& warnings) const override;
  void derive() override;
  void archive(Archive& a) override;

 private:
  void kick_and_drift();
  void find_eddies();
  void find_interface();
  void fit_interface();
  void rate();
  void find_surface();
  void hold();
  void open_books();
  void schedule_books(Schedule& s);
  void bind_entries();
  void look_for_voids();
  void bind_interface(const PlanEntry& e, FluidNeighbour& n);
  void bind_eddies();
  void bind_k_omega();
  void step_k_omega();
  bool derives_shear_rate() const { return !has_k_omega() && is_output(scene_, Field::shear_rate); }
  bool derives_gradient() const { return derives_shear_rate() || is_output(scene_, Field::velocity_gradient); }
  bool has_k_omega() const { return keys_.turbulence == Turbulence::k_omega; }
  void bind_friction(EddyNeighbour& e, std::size_t other, Sides& sides, bool& particles);
  Relief relief() const;
  double largest_speed() const;

  const Scene& scene_;
  const Layout& layout_;
  const Phase& phase_;
  const FluidKeys& keys_;  // of phase_
  const PlanPhase& plan_;
  std::size_t number_;
  Workspace* w_ = nullptr;
  PhaseParticles* particles_ = nullptr;

  PressureLaw pressure_;
  std::vector<FluidNeighbour> neighbours_;  // its entry with itself first
  std::vector<FluidNeighbour> fluids_;      // of these, what the energy asks for: fluids, and solids
  std::vector<SolidNeighbour> solids_;
  FluidParameters parameters_{};
  Forces forces_;
  Sides held_;                              // the domain's sides that a wall closes
  Relief relief_;                           // curved ground
  std::unique_ptr<SurfaceFinder> surface_;  // null: no free surface
  LooseParticles loose_;                    // of a fluid that fills its space, consistent scheme
  VoidFinder voids_;
  std::vector<VoidFinder::Seen> seen_;
  BulkHold hold_;
  std::optional<Drive> drive_;          // where something drives it along x
  std::unique_ptr<EnergyBooks> books_;  // null: the scene asks for none
  bool keeps_inside_ = false;
  HeldShapes held_shapes_;
  std::vector<MovingBox> moving_boxes_;  // the same of walls that move

  std::vector<PairEntry<InterfaceSide>> sides_of_interface_;  // empty: it meets no other fluid
  InterfaceDistance interface_distance_;
  std::vector<PairEntry<InterfacePlane>> interface_planes_;  // the same pairs
  std::vector<const EddyRecords*> distances_of_;             // of their second phases
  InterfacePlanes planes_;

  // with eddies
  std::vector<EddyNeighbour> eddy_neighbours_;
  EddyParameters eddies_;
  std::vector<GroundDistance::Ground> ground_phases_;
  std::unique_ptr<GroundDistance> ground_;
  std::vector<KOmegaNeighbour> k_omega_neighbours_;
  KOmegaParameters k_omega_;
  double largest_viscosity_ = 0;  // m2/s
  StepLimit viscous_limit_;
};

/// The viscosity of a pair of particles of two phases, at least one of which is a fluid (Pa s): the fluid's own, with
/// the artificial one; of two fluids the harmonic mean.
double pair_viscosity(const Scene& scene, const Layout& layout, std::size_t a, std::size_t b);

/// That of the entry of a fluid (Pa s), as its sums take it. The plain sum of a second derivative, sum V F r_x^2, is on
/// rows the entry's gradient_sum (0.980 with a radius of 2.1 spacings): over it, so that a shear on rows has its
/// stress. The corrected sums need none.
double viscosity_of_sums(const Scene& scene, const Layout& layout, const PlanEntry& e);

/// Whether an entry of two fluids of the consistent scheme has an interface: their densities or viscosities differ.
/// Phases of one fluid that have spacings of their own have none.
bool has_interface(const Scene& scene, const Layout& layout, const PlanEntry& e);

/// The share of no slip that a solid keeps (ExtensionRule::rub). A heavy free surface has friction that no fluid has
/// (least_viscosity, fluid_surface.hpp). It acts within the fluid alone: along a wall the fluid rubs with its own
/// viscosity. 1 beside every other fluid, and where its own viscosity is not the smaller one. The layout must know
/// which fluids have a free surface.
double wall_rub(const Scene& scene, const Layout& layout, std::size_t solid);

/// Whether a fluid has the treatment of a calm heavy surface (docs/method.md): a laminar fluid of the consistent scheme
/// with weight and a free surface.
bool calmed(const Scene& scene, const Layout& layout, std::size_t fluid);
/// The equation of state of a fluid phase.
PressureLaw pressure_law(const Scene& scene, const Layout& layout, std::size_t fluid);

/// The pressure of the start where fills ask for the hydrostatic one, by phase and particle (Pa); empty for a phase
/// whose fills do not. A fluid under another fluid with which it has an entry carries its weight.
std::vector<double> pressure_at_rest(const Scene& scene, const Layout& layout, const std::vector<ParticleBlock>& blocks,
                                     std::size_t fluid);

}  // namespace barchan
