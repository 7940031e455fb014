// What instruments see of a run on several ranks: the particles about their places, on the first rank, in the order of
// one process.
#include <algorithm>
#include <cmath>

#include "measure/measurements.hpp"

namespace barchan {

namespace {

/// The room that an instrument looks into (m).
struct Room {
  Vec3 low{1e300, 1e300, 1e300}, high{-1e300, -1e300, -1e300};

  explicit Room(const Instrument& i) {
    if (i.points.empty()) {
      low = i.low;
      high = i.high;
      return;
    }
    const double reach = 1.001 * i.radius;
    for (const Vec3& x : i.points)
      for (std::size_t d = 0; d < 3; ++d) {
        low[d] = std::min(low[d], x[d] - reach);
        high[d] = std::max(high[d], x[d] + reach);
      }
  }

  /// Whether a place or an image of it is in it.
  bool holds(const PhaseParticles& p, std::size_t k, const Bounds& bounds) const {
    for (int axis = 0; axis < p.dimensions(); ++axis) {
      const auto d = static_cast<std::size_t>(axis);
      const double x = p.column(Field::position, axis)[k], period = bounds.high[d] - bounds.low[d];
      const auto inside = [&](double at) { return at >= low[d] && at <= high[d]; };
      if (!inside(x) && !(bounds.periodic[d] && (inside(x - period) || inside(x + period)))) return false;
    }
    return true;
  }
};

}  // namespace

/// Takes the particles that the instruments at hand look at.
void Measurements::gather(const State& state) {
  const FieldSet fields{Field::position, Field::velocity,        Field::density,
                        Field::pressure, Field::ground_distance, Field::radius};
  gathered_.clear();
  for (std::size_t phase = 0; phase < state.phases.size(); ++phase) {
    const PhaseParticles& p = state.phases[phase];
    std::vector<Room> rooms;
    bool wall = false;  // its velocity is asked for: that of its first particle
    for (const std::size_t k : due_) {
      const Instrument& i = instruments_[k];
      if (i.phase == phase) rooms.emplace_back(i);
      wall = wall || (i.kind == InstrumentKind::wall_shear && i.wall == phase);
    }
    gathered_.push_back(p.gathered(fields, [&](std::size_t k) {
      return (wall && k == 0) ||
             std::any_of(rooms.begin(), rooms.end(), [&](const Room& room) { return room.holds(p, k, bounds_); });
    }));
  }
  for (Searched& searched : lookups_) searched.step = -1;
}

}  // namespace barchan
