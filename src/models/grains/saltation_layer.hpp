// What history.csv tells of sand in flight, where a scene has [[saltation]]. It only reads the state.
#pragma once

#include "models/grains/bed_height.hpp"
#include "models/workspace.hpp"

namespace barchan {

class SaltationHistory : public Model {
 public:
  SaltationHistory(const Scene& scene, const Layout& layout, const SaltationLayer& layer);
  void attach(Workspace& w) override { w_ = &w; }
  void schedule(Schedule&) override {}
  void history(HistoryRow& row) const override;

 private:
  const Scene& scene_;
  const SaltationLayer& layer_;
  std::size_t phase_;
  double diameter_, area_;  // m; m2, of the ground (2D: of a metre of depth)
  mutable BedHeight bed_;   // its memory only
  Workspace* w_ = nullptr;
};

/// Mean diameter of the grains of a phase; the spacing of those that are no spheres (m).
double mean_diameter(const Layout& layout, std::size_t phase);
/// Area of the ground (m2), in 2D of a metre of depth.
double ground_area(const Scene& scene);
/// The air without particles in which a phase of grains flies; null: none.
const AirProfile* air_around(const Layout& layout, const State& state, std::size_t grains);
/// Shear stress of the air at a height (Pa), between the faces.
double air_stress(const AirProfile& air, double y);

}  // namespace barchan
