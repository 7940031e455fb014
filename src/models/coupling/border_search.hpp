// The particles of a fluid about a place that moves with a body.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "models/workspace.hpp"

namespace barchan {

/// Two unit vectors across a normal; in 2D the first one.
inline std::array<Vec3, 2> along_border(const Vec3& normal, int dimensions) {
  if (dimensions == 2) return {Vec3{-normal[1], normal[0], 0.0}, Vec3{}};
  const Vec3 other = std::abs(normal[0]) < 0.6 ? Vec3{1, 0, 0} : Vec3{0, 1, 0}, first = cross(normal, other);
  const Vec3 along = 1.0 / norm(first) * first;
  return {along, cross(normal, along)};
}

/// Calls f(particle of the fluid, place in its image) for all that may be within `radius` (m) of a place that stands
/// `beside` (m) the particle at the place `anchor` of the solid. Only particles are looked at, not the images of the
/// grid: these reach no farther than the lists. `slack` (m): the largest skin of the lists.
template <int Dim, class F>
void each_near(const Workspace& w, std::size_t fluid, std::size_t solid, std::size_t anchor, const Vec3& beside,
               double radius, double slack, F&& f) {
  const Bounds& bounds = w.layout.bounds;
  const PhaseParticles& body = w.state.phases[solid];
  const CellGrid &grid = w.neighbours.grid(fluid), &own = w.neighbours.grid(solid);
  const std::size_t n = w.state.phases[fluid].size();
  const double reach = radius + slack;
  const auto periodic = [&](std::size_t d) { return d < Dim && bounds.periodic[d]; };
  const auto search = [&](const std::array<int, 3>& turns) {
    Vec3 at{};
    std::array<float, 3> sorted{};  // where it was when the particles were sorted, less the domain's lower corner
    for (std::size_t d = 0; d < Dim; ++d) {
      const double period = bounds.high[d] - bounds.low[d], turned = turns[d] * period + beside[d];
      at[d] = body.column(Field::position, static_cast<int>(d))[anchor] + turned;
      sorted[d] = own.search_position(static_cast<int>(d))[anchor] + static_cast<float>(turned);
      if (periodic(d) && !(sorted[d] > -reach && sorted[d] < period + reach)) return;
    }
    grid.candidates(sorted, sorted, static_cast<float>(reach), [&](std::uint32_t begin, std::uint32_t end) {
      for (std::size_t b = begin; b < std::min<std::size_t>(end, n); ++b) f(b, at);
    });
  };
  std::array<int, 3> ways{};
  for (std::size_t d = 0; d < 3; ++d) ways[d] = periodic(d) ? 1 : 0;
  for (int k = -ways[2]; k <= ways[2]; ++k)
    for (int j = -ways[1]; j <= ways[1]; ++j)
      for (int i = -ways[0]; i <= ways[0]; ++i) search({i, j, k});
}

}  // namespace barchan
