#include "engine/hold_inside.hpp"

#include <algorithm>
#include <cmath>

namespace barchan {

void hold_inside(PhaseParticles& phase, const Sides& sides) {
  const auto n = static_cast<std::int64_t>(phase.size());
  const double* rho = sides.margin_of_off > 0.0 ? phase.column(Field::density) : nullptr;
  const double most = Sides::off * sides.rest;
#pragma omp parallel
  for (int d = 0; d < phase.dimensions(); ++d) {
    const auto c = static_cast<std::size_t>(d);
    double *x = phase.column(Field::position, d), *v = phase.column(Field::velocity, d);
#pragma omp for simd schedule(static) nowait
    for (std::int64_t k = 0; k < n; ++k) {
      const double place = x[k], speed = v[k];
      const double margin = rho != nullptr && std::abs(rho[k] - sides.rest) > most ? sides.margin_of_off : sides.margin;
      const double low = sides.low[c] + margin, high = sides.high[c] - margin;
      v[k] = place < low ? std::max(speed, 0.0) : place > high ? std::min(speed, 0.0) : speed;
      x[k] = place < low ? low : place > high ? high : place;
    }
  }
}

}  // namespace barchan
