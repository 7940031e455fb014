// The zone beyond a side of the domain through which a fluid enters or leaves. Its particles are particles of the
// fluid; what differs is what moves them.
//
// Inflow: all of the zone has the velocity that the scene gives and the pressure of the domain behind the side, drawn
//   out along a line. Sound that comes to the side goes on: the zone carries p' along with the velocity p'/(rho c)
//   outwards, p' less its mean over `memory_in_lengths` passages of sound through the domain. So the incoming
//   characteristic p - rho c u_n is at rest (Poinsot & Lele 1992; Negi, Ramachandran & Haftu 2020), and the mean
//   pressure is that of the flow.
//   With a layer the side has first an absorbing layer as that of an outflow, and all this lies behind it. With
//   fluctuations synthetic turbulence is added to the velocity (inflow_fluctuations.hpp).
// Outflow: an absorbing layer, in which the fluid moves by its own forces and sound fades away: with p' = p - <p>,
//     drho/dt -= s p'/c^2,   du_n/dt -= s w,   s = 3 A c d^2/L^3
//   d from the side, L the layer, A = 6, w = p'/(rho c) bounded by twice u_n' = u_n - <u_n> and by zero. Of sound that
//   goes outwards exp(-A) is left, and the layer sends none back by itself. <p>, <u_n> are means over
//   `memory_in_layers` passages of sound through the layer; vortices and shear, which have little p', pass. Behind the
//   layer the last rows have the pressure of the scene and the velocity of the layer's end, by lanes: outwards, or
//   inwards where the flow turns.
//
// Lanes (flow_lanes.hpp) are filled from behind: where the last particle of a lane has moved inwards by a row, a new
// one stands a row behind it. Rows are so far apart that the mass in the lane has the density of the zone's pressure.
// What has passed the end of the zone is removed. Both happen each time that the fastest flow has gone half a spacing,
// so that lists of neighbours live as long as elsewhere.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "engine/pressure_law.hpp"
#include "models/fluid/flow_lanes.hpp"
#include "models/fluid/inflow_fluctuations.hpp"
#include "models/model.hpp"
#include "scene/formula.hpp"

namespace barchan {

/// Whether what the scene gives to a fluid, at any of its open sides or by a forcing, is a formula of t.
bool flow_changes(const Scene& scene, const Phase& fluid);

class FlowZone : public Model {
 public:
  static constexpr double absorbed = 6.0;            // A
  static constexpr double memory_in_layers = 20.0;   // of <p> of an outflow, in L/c
  static constexpr double memory_in_lengths = 10.0;  // of an inflow, in lengths of the domain over c
  static constexpr double unlike = 0.02;             // of c: an inflow that differs so much from the fluid at the start
  static constexpr double squeezed = 0.03;           // of the density, at most, to change the speed of all
  static constexpr double seen = 3.0, end_seen = 2.0;  // spacings inside from which an inflow, an outflow learns
  static constexpr double settling = 10.0;             // dx/c, in which the end follows the layer's velocity
  static constexpr double room = 0.7;                  // spacings between a new particle and others

  FlowZone(const Scene& scene, const Layout& layout, std::size_t fluid, const FlowEnd& end);
  void begin(State& state, const std::vector<ParticleBlock>& blocks) override;
  void attach(Workspace& w) override;
  void schedule(Schedule& s) override;
  /// NAME_SIDE_in, NAME_SIDE_out [kg] (kg/m in 2D): what passed the side so far.
  void history(HistoryRow& row) const override;
  void report(Warnings& warnings) const override;
  void archive(Archive& a) override;

 private:
  /// Where a particle is, kept by particle.
  enum Where : std::uint8_t { away, near, beyond };
  /// What a zone knows of a lane, from step to step.
  struct Lane {
    std::array<double, 3> velocity{};    // m/s, of the end of an outflow
    double pressure = 0.0, slope = 0.0;  // Pa, mean at the side; Pa/m, its slope inwards
    double given = 0.0, behind = 0.0;    // m/s outwards, or Pa: what the side has, and the scene's value less it
    double push = 0.0;                   // m/s2, outwards: how an inflow changes
    double velocity_now = 0.0;           // m/s, outwards, where `now` was measured
    double now = 0.0, depth = 0.0;       // Pa, at the side, less what sound changes on the way; m, from where
    double outermost = 0.0;              // m, of its last particle beyond the side
  };
  struct Mean {
    double pressure = 0.0, velocity = 0.0;  // Pa; m/s, along the axis
  };
  struct Gathered {
    std::int64_t count = 0;
    std::array<LaneSum, 3> velocity{};        // in c
    LaneSum pressure, depth, depth2, sloped;  // in rho c^2; in spacings
  };

  bool starts_otherwise(const PhaseParticles& p) const;
  double outwards() const { return end_.upper() ? 1.0 : -1.0; }
  void renew();
  void sort_out();
  void gather();
  void gather_ranks();
  void turn(Lane& lane, double given, double most);
  static void begin_with(Lane& lane, double given, double fluid);
  void turn_inflow();
  void turn_outflow();
  void learn_inflow(double mean_share);
  void learn_outflow(double share, double gained);
  void learn_layer();
  double depth_of_cell(std::size_t cell) const;
  Vec3 periods() const;
  void learn_common();
  double share_of(double memory) const;
  void remember_pressures(double dt);
  double mean_behind(const Lane& lane, double behind) const;
  double row_spacing(std::size_t lane, double d) const;
  void remove_and_create();
  void make_at(const Vec3& x);
  bool has_room(const Vec3& x) const;
  void prescribe();
  void prescribe_inflow(PhaseParticles& p, std::size_t k, const Vec3& x, std::size_t lane, double d);
  void prescribe_outflow(PhaseParticles& p, std::size_t k, const Vec3& x, std::size_t lane);
  void set_pressure(PhaseParticles& p, std::size_t k, double pressure);
  void absorb();
  double earlier(std::size_t lane, double ago) const;
  std::size_t cell_of(std::size_t lane, double d) const;
  Vec3 place_of(const PhaseParticles& p, std::size_t k) const;

  const Scene& scene_;
  const PlanPhase& plan_;
  const Bounds domain_;
  std::size_t fluid_;
  FlowEnd end_;
  PressureLaw law_;
  std::string name_;                       // "air_left"
  double c_, rho_, dx_, reach_;            // m/s, kg/m3, m, m: how far inside it looks
  double whole_ = 0.0;                     // m, along the flow: the domain and the layers at both ends
  double changes_ = 0.0;                   // 1: the speed of all of the fluid changes
  std::optional<GivenVelocity> velocity_;  // of an inflow
  std::optional<EnteringFluctuations> fluctuations_;
  Formula pressure_;  // of an outflow
  OwnColumn<std::uint8_t> where_;
  Workspace* w_ = nullptr;

  FlowLanes lanes_;
  std::vector<Lane> lane_;
  struct Common {
    double pressure = 0.0, slope = 0.0, velocity = 0.0;  // Pa at the side, Pa/m outwards, m/s
  } common_;                                             // of the whole layer now, in a flow that changes
  std::vector<Mean> means_;                              // of the layer, by lane and spacing beyond the side
  std::vector<double> past_, past_times_;  // Pa, s: an inflow's pressures of earlier steps, a row of lanes each
  std::int64_t newest_ = 0;                // row of past_
  double entered_ = 0.0, left_ = 0.0;      // kg
  double gone_ = 0.0;                      // spacings that the fastest flow went since lanes were filled
  double started_ = 0.0;                   // 1: lanes have values
  double late_ = 0.0;                      // s, in which the side was behind the scene

  std::vector<std::uint32_t> members_;  // places of those near or beyond
  std::vector<Gathered> sums_;
  std::vector<std::array<LaneSum, 2>> layer_sums_;  // pressure in rho c^2, velocity along the axis in c
  std::vector<std::int32_t> layer_counts_;
  // Of a step, until all ranks have added theirs.
  std::array<std::int64_t, 2> passed_{};  // particles that came in past the side, and went out
  double fastest_ = 0.0;                  // m/s, of those beyond the side
  std::vector<std::int64_t> counts_of_all_, sums_of_all_;
  std::vector<double> largest_of_all_;
};

}  // namespace barchan
