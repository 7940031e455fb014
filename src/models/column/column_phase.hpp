// A phase of air without particles: one profile of the wind by height, and the drag of the grains that feel it.
//
// Grains and air exchange momentum at intervals that are short beside all times of a grain in flight. Between two
// exchanges a grain keeps its drag, an exact mean over the interval for a constant wind; then the air loses exactly
// what the grains got.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "laws/drag_coefficients.hpp"
#include "models/column/air_column.hpp"
#include "models/coupling/gusts.hpp"
#include "models/workspace.hpp"
#include "scene/formula.hpp"

namespace barchan {

void declare_column(const Scene& scene, std::size_t number, Layout& layout);
void describe_column(const Scene& scene, const std::vector<ParticleBlock>& blocks, std::size_t number, Layout& layout,
                     std::vector<std::string>& warnings);

/// An entry of a column with grains: drag in a wind by height.
void describe_grains_in_column(const Scene& scene, const Interaction& pair, const Layout& layout, PlanEntry& e);

class ColumnPhase : public Model {
 public:
  ColumnPhase(const Scene& scene, const Layout& layout, std::size_t number);
  void attach(Workspace& w) override;
  void schedule(Schedule& s) override;
  int phase() const override { return static_cast<int>(number_); }
  void history(HistoryRow& row) const override;
  void report(Warnings& warnings) const override;
  void archive(Archive& a) override;

 private:
  /// A phase of grains that feels the wind.
  struct Feeling {
    std::size_t phase;
    DragLaw law;
    double density;   // kg/m3, of the grains
    double diameter;  // m, mean
    bool own_steps;   // moved by models/grains/spheres.hpp: a step's drag acts in the whole of the next one
    double lift;      // of a grain on the bed over its drag (models/coupling/sand_layer.hpp)
    bool magnus;      // the force on those that turn (laws/turning_sphere.hpp)
    std::optional<Gusts> gusts;
    std::vector<double> rate, wind;  // of each grain: 1/s, drag by difference of speed; m/s, the air about it
  };
  AirProfile& profile() const { return w_->state.air[place_]; }
  void make_profile();
  void find_steady_wind();
  bool exchange_is_due();
  void exchange();
  void act();
  void feel();
  template <int Dim, class DragOf>
  void feel(Feeling& grains, const DragOf& excess);
  void average_load();
  void follow_wind();
  void spread_rates();
  void spread_drag(bool so_far, std::vector<double>& sums);
  void find_voidage();
  double wind(double y, double radius) const;
  double rotation(double y, double radius) const;
  double lift_of(double y, double radius, double wind, double blows, double along) const;
  double top_stress(double time) const;
  double momentum() const;
  double impulse_time(const Feeling& grains) const;
  double time_ahead(const Feeling& grains) const;

  const Scene& scene_;
  const Layout& layout_;
  const ColumnKeys& keys_;
  std::size_t number_, place_ = 0;    // of the phase; of the profile in the state
  double diameter_ = 0.0;             // m, of the largest phase
  double density_, area_, interval_;  // kg/m3; m2 (2D: of a metre of depth); s, between exchanges
  double hold_ = 0.0;                 // s, for which the next drag is kept
  Formula friction_velocity_;
  std::vector<Feeling> feeling_;
  bool crowded_ = false;  // some law reads the voidage
  Workspace* w_ = nullptr;
  std::unique_ptr<AirColumn> air_;
  std::unique_ptr<AirColumn::Spread> spread_;
  std::unique_ptr<AirColumn::Load> load_;
  std::vector<double> solid_;  // by cell: part of the volume
};

}  // namespace barchan
