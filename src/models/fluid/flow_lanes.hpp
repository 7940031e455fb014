// The lanes of a zone beyond a side through which a fluid flows: one for each particle of a row of the zone at the
// start, and the particles nearest to it. Fluid that enters is made in lanes, and what a zone knows of the flow it
// knows by lanes.
#pragma once

#include <cstdint>
#include <vector>

#include "base/vec3.hpp"
#include "start/flow_ends.hpp"

namespace barchan {

class FlowLanes {
 public:
  FlowLanes() = default;
  /// `places`: of the particles of the outermost row of the zone. `spacing`: of the fluid (m). `periods`: m, of
  /// periodic axes, else 0.
  FlowLanes(std::vector<Vec3> places, std::size_t axis, double spacing, const Vec3& periods);

  std::size_t size() const { return places_.size(); }
  const Vec3& place(std::size_t lane) const { return places_[lane]; }
  /// The lane nearest to a place, by the distance across the flow; of two as near the first.
  std::size_t nearest(const Vec3& x) const;
  std::size_t bytes() const;

 private:
  double squared(const Vec3& x, std::size_t lane) const;
  std::array<long, 2> cell_of(const Vec3& x) const;

  std::vector<Vec3> places_;
  std::array<std::size_t, 2> across_{};  // the axes across the flow
  double cell_ = 1.0;                    // m
  Vec3 low_{}, periods_{};
  std::array<long, 2> count_{1, 1};
  std::vector<std::uint32_t> begin_, order_;  // lanes by cell
};

/// Sums over particles of values in units of their own, exact, so that their order does not matter.
struct LaneSum {
  static constexpr double unit = 1.0 / (1ll << 36);
  std::int64_t parts = 0;
  void add(double value) { parts += static_cast<std::int64_t>(value / unit); }
  double value() const { return static_cast<double>(parts) * unit; }
};

}  // namespace barchan
