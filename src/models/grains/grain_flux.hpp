// The flux of a phase of grains that a wind drives, in history.csv, and a warning where its mean is far above what was
// measured. It only reads the state.
#pragma once

#include <string>

#include "models/drive.hpp"
#include "models/workspace.hpp"

namespace barchan {

/// Saturated flux of sand (kg/m/s, by the metre of width) in a wind of friction velocity u (m/s); 0 below 0.171 m/s.
/// Creyssels et al. 2009, a wind tunnel: grains of 0.242 mm, u* from 0.24 to 0.56 m/s; the straight line over u*^2
/// through their points, Q = 0.167 kg s/m3 (u*^2 - (0.171 m/s)^2).
double creyssels_flux(double u);

class GrainFlux : public Model {
 public:
  /// `wind`: a phase that drives the grains, a fluid or a column.
  GrainFlux(const Scene& scene, const Layout& layout, std::size_t wind, std::size_t grains);
  void attach(Workspace& w) override { w_ = &w; }
  void schedule(Schedule& s) override;
  /// NAME_flux [kg/m/s]: sum m v_x over the area of the ground. Left out where a [[saltation]] of that name writes it.
  void history(HistoryRow& row) const override;
  void report(Warnings& warnings) const override;
  void archive(Archive& a) override;

  static constexpr double most_flux = 3.0;                     // times the measured one
  static constexpr long every = 16;                            // steps between two values of the mean
  static constexpr double finest = 1.5e-4, coarsest = 3.5e-4;  // m, grains for which the line is asked
  static constexpr double weakest = 0.24, strongest = 0.8;     // m/s, winds for which it is

 private:
  double flux() const;
  void sample();

  const Scene& scene_;
  const PlanPhase& wind_;
  std::size_t grains_;
  std::string column_;
  double area_, tenth_;  // m2, of the ground (2D: of a metre of depth); s
  bool measured_;        // such grains were measured
  WindowMean mean_;      // kg/m/s
  Workspace* w_ = nullptr;
};

/// The winds of a scene over its grains: one model for each phase of grains that a driven fluid or column moves.
void add_grain_fluxes(const Scene& scene, const Layout& layout, Models& models);

}  // namespace barchan
