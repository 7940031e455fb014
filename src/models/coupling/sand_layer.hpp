// Grains finer than the air's particles in a turbulent wind over sand: the entry of a fluid and of spheres with a law
// of drag by name, in two dimensions.
//
// A grain feels the mean wind about its place (air_grid.hpp). Nearer than `reach` spacings to the ground the particles
// of the air do not resolve the wind. There, along each spacing of the ground, the wind is one-dimensional
// (models/column/air_column.hpp): it has the speed of the air's particles on its top, passes between the grains of the
// bed, and loses what the grains take. The stress on its top is what the ground takes from the air's particles, in
// place of the logarithmic law of a roughness: grains that fly make the ground rougher by themselves.
#pragma once

#include <memory>
#include <vector>

#include "models/column/air_column.hpp"
#include "models/coupling/air_grid.hpp"
#include "models/workspace.hpp"

namespace barchan {

class SandLayer : public Model {
 public:
  /// `entry`: of law drag.
  SandLayer(const Scene& scene, const Layout& layout, const PlanEntry& entry);
  void attach(Workspace& w) override;
  void schedule(Schedule& s) override;
  void history(HistoryRow& row) const override;
  void archive(Archive& a) override;

 private:
  static constexpr double reach = 1.5;       // spacings of the air
  static constexpr double deep = 6.0;        // diameters: grains below feel no wind
  static constexpr double cells = 4.0;       // a diameter
  static constexpr double fine = 10.0;       // diameters over the ground with such cells
  static constexpr double interval = 0.004;  // of sqrt(d/g), between two exchanges: 20 us for 0.25 mm
  static constexpr std::size_t heights = 8;  // of the ground, known a spacing of the air

  /// The ground under a place: its height (m, as a coordinate), and the direction along it.
  struct Ground {
    double height, along_x, along_y;
  };
  Ground ground(double x) const;
  std::size_t column_at(double x) const;

  void act();
  void exchange(double kept, double meant);
  void find_steady_wind();
  void find_near();
  void feel();
  void spread();
  void blow(double dt);
  void give_stress();
  double top_speed(std::size_t column) const;
  AirProfile& profile(std::size_t column) const { return w_->state.air[place_ + column]; }

  const Scene& scene_;
  const Layout& layout_;
  std::size_t fluid_, grains_, place_ = 0;
  DragLaw law_;
  std::string name_;
  double density_, viscosity_, diameter_, top_, width_ = 0.0;  // kg/m3, m2/s, m, m, m
  double interval_, hold_ = 0.0;                               // s
  Workspace* w_ = nullptr;
  AirGrid grid_;
  std::vector<double> ground_;  // m, over the bottom of the domain
  std::vector<AirColumn> layers_;
  std::vector<AirColumn::Spread> spreads_;
  std::vector<AirColumn::Load> loads_;
  /// A grain in a layer, where it will be in the middle of the time to the next exchange.
  struct Near {
    std::size_t grain, column;
    double height, radius, wind;  // m over the ground, m, m/s
    Ground ground;
  };
  std::vector<Near> near_;           // grains in the layers
  std::vector<std::size_t> flying_;  // grains over them
  std::vector<double> rate_;         // 1/s, of each grain
};

}  // namespace barchan
