#include "models/fluid/turbulence.hpp"

#include <algorithm>
#include <cmath>

namespace barchan {

bool over_rough_walls(std::span<const EddyNeighbour> neighbours) {
  bool rough = false;
  for (const EddyNeighbour& e : neighbours) {
    const bool is_rough = e.friction == Friction::rough;
    const bool no_ground =
        e.friction == Friction::fluid || e.friction == Friction::slip || e.friction == Friction::driven;
    if (!(is_rough || no_ground) || e.given) return false;
    rough = rough || is_rough;
  }
  return rough;
}

double pack_eddies(PhaseParticles& fluid, EddyRecords& records, const GroundDistance& ground, const EddyParameters& e) {
  double *distance = fluid.column(Field::ground_distance), *nu_t = fluid.column(Field::eddy_viscosity);
  std::array<const double*, 3> x{}, v{};
  for (int d = 0; d < fluid.dimensions(); ++d) {
    x[static_cast<std::size_t>(d)] = fluid.column(Field::position, d);
    v[static_cast<std::size_t>(d)] = fluid.column(Field::velocity, d);
  }
  const auto n = static_cast<std::int64_t>(fluid.size());
  double largest = 0.0;
#pragma omp parallel for schedule(static) reduction(max : largest)
  for (std::int64_t i = 0; i < n; ++i) {
    const auto k = static_cast<std::size_t>(i);
    Vec3 place{};
    double speed2 = 0.0;
    for (std::size_t d = 0; d < static_cast<std::size_t>(fluid.dimensions()); ++d) {
      place[d] = x[d][k];
      speed2 += v[d][k] * v[d][k];
    }
    const double at = ground.distance(place), nu = e.viscosity + nu_t[k];
    distance[k] = at;
    largest = std::max(largest, nu);
    records.root[k] = std::sqrt(e.density * nu);
    records.touch[k] = e.density * e.viscosity;
    if (e.roughness > 0.0 && at < e.grain_reach)
      records.touch[k] += rough_viscosity(e.density, at, e.roughness, e.spacing, std::sqrt(speed2));
  }
  return largest;
}

}  // namespace barchan
