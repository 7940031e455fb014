#include "models/grains/saltation_layer.hpp"

#include <algorithm>
#include <cmath>

namespace barchan {

double mean_diameter(const Layout& layout, std::size_t phase) { return layout.phases[phase].size(); }

double ground_area(const Scene& scene) {
  return scene.domain.size[0] * (scene.dimensions == 3 ? scene.domain.size[2] : 1.0);
}

const AirProfile* air_around(const Layout& layout, const State& state, std::size_t grains) {
  for (const PlanEntry& e : layout.entries)
    for (const AirProfile& air : state.air)
      if (e.wind_by_height && e.has(grains) && e.partner(grains) == air.phase) return &air;
  return nullptr;
}

double air_stress(const AirProfile& air, double y) {
  if (!(y > air.face.front())) return air.stress.front();
  if (!(y < air.face.back())) return air.stress.back();
  const auto above = static_cast<std::size_t>(std::upper_bound(air.face.begin(), air.face.end(), y) - air.face.begin());
  const double share = (y - air.face[above - 1]) / (air.face[above] - air.face[above - 1]);
  return air.stress[above - 1] + share * (air.stress[above] - air.stress[above - 1]);
}

namespace {

std::size_t number_of(const Layout& layout, const std::string& name) {
  std::size_t k = 0;
  while (k + 1 < layout.phases.size() && layout.phases[k].name != name) ++k;
  return k;
}

}  // namespace

SaltationHistory::SaltationHistory(const Scene& scene, const Layout& layout, const SaltationLayer& layer)
    : scene_(scene),
      layer_(layer),
      phase_(number_of(layout, layer.phase)),
      diameter_(mean_diameter(layout, phase_)),
      area_(ground_area(scene)),
      bed_(scene.domain.origin[1], scene.domain.origin[1] + scene.domain.size[1], diameter_) {}

void SaltationHistory::history(HistoryRow& row) const {
  const PhaseParticles& p = w_->particles(phase_);
  const double bed = bed_(p), least = bed + layer_.flight * diameter_, g = std::abs(scene_.domain.gravity[1]);
  const double *y = p.column(Field::position, 1), *vx = p.column(Field::velocity, 0),
               *vy = p.column(Field::velocity, 1);
  double flux = 0.0, flying = 0.0, mass = 0.0, speed = 0.0, rising = 0.0, apex = 0.0;
  for (std::size_t k = 0; k < p.size(); ++k) {
    const double m = p.mass_of(k);
    flux += m * vx[k];
    if (y[k] < least) continue;
    flying += 1.0;
    mass += m;
    speed += m * vx[k];
    if (vy[k] > 0.0 && g > 0.0) {
      rising += 1.0;
      apex += y[k] - bed + vy[k] * vy[k] / (2.0 * g);
    }
  }
  const std::string& n = layer_.name;
  row.add(n + "_bed [m]", bed);
  row.add(n + "_flux [kg/m/s]", flux / area_);
  row.add(n + "_in_flight", flying);
  row.add(n + "_flight_mass [kg/m2]", mass / area_);
  row.add(n + "_flight_speed [m/s]", mass > 0.0 ? speed / mass : 0.0);
  row.add(n + "_apex [m]", rising > 0.0 ? apex / rising : 0.0);
  if (const AirProfile* air = air_around(w_->layout, w_->state, phase_)) {
    const double stress = air_stress(*air, bed), density = scene_.phases[air->phase].density;
    row.add(n + "_bed_friction_velocity [m/s]", std::copysign(std::sqrt(std::abs(stress) / density), stress));
  }
}

}  // namespace barchan
