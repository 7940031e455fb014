// Wind and grains exchange momentum now and then: until the next exchange a grain keeps the drag of the last one.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "state/particles.hpp"

namespace barchan {

/// The name of that repeat in the schedule.
inline constexpr const char* wind_exchanges = "exchanges of wind and grains";

/// Whether `elapsed` (s) since the last exchange is as long as the interval (s).
inline bool exchange_is_due(double elapsed, double interval) { return elapsed >= interval * (1.0 - 1e-9); }

/// s, the whole steps of dt (s) that the interval (s) fits into.
inline double time_to_next_exchange(double interval, double dt) {
  return dt * std::max(1.0, std::ceil(interval / dt * (1.0 - 1e-9)));
}

/// Adds the drag that the particles keep to their acceleration.
inline void add_kept_drag(PhaseParticles& p) {
  const auto n = static_cast<std::int64_t>(p.size());
  for (int d = 0; d < p.dimensions(); ++d) {
    double* a = p.column(Field::acceleration, d);
    const double* drag = p.column(Field::drag_acceleration, d);
#pragma omp parallel for simd schedule(static)
    for (std::int64_t k = 0; k < n; ++k) a[k] += drag[k];
  }
}

}  // namespace barchan
