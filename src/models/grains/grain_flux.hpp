// The flux of a phase of grains that a wind drives, in history.csv, and warnings: where its mean is far above what was
// measured, where it still grows at the outflow, where the ground takes more than the wind that the scene states. It
// only reads the state.
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

  static constexpr double most_flux = 3.0;    // times the measured one
  static constexpr double most_stress = 1.5;  // times rho u*^2 of the stated wind, on the ground
  static constexpr double grows = 1.1;        // the last quarter of an open ground over the third
  static constexpr double noise = 0.1;        // of the measured flux of the weakest wind: less does not count as growth
  static constexpr long every = 16;           // steps between two values of the mean
  static constexpr double finest = 1.5e-4, coarsest = 3.5e-4;  // m, grains for which the line is asked
  static constexpr double weakest = 0.24, strongest = 0.8;     // m/s, winds for which it is

 private:
  double flux(double from = -1e300, double to = 1e300) const;
  void sample();
  void report_growth(Warnings& warnings) const;
  void report_stress(Warnings& warnings) const;  // a held wind's: Drive's

  const Scene& scene_;
  const Layout& layout_;
  std::size_t wind_, grains_;
  std::string column_;
  double area_, tenth_;      // m2, of the ground (2D: of a metre of depth); s
  bool measured_;            // such grains were measured
  bool open_;                // grains leave along x: the flux may grow
  WindowMean mean_;          // kg/m/s
  WindowMean third_, last_;  // kg/m/s, of the quarters of an open ground along x
  WindowMean stress_;        // Pa, on the ground, of a wind with layers of its own
  Workspace* w_ = nullptr;
};

/// The winds of a scene over its grains: one model for each phase of grains that a driven fluid, a
/// column or a fluid with a stated friction velocity moves.
void add_grain_fluxes(const Scene& scene, const Layout& layout, Models& models);

}  // namespace barchan
