#include "start/fitted.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "start/lattice.hpp"

namespace barchan {

std::array<double, 2> Terrain::slopes(double x, double z) const {
  return {(ground_.height(x + step_, z) - ground_.height(x - step_, z)) / (2.0 * step_),
          solid_ ? (ground_.height(x, z + step_) - ground_.height(x, z - step_)) / (2.0 * step_) : 0.0};
}

std::array<double, 3> Terrain::bend(double x, double z) const {
  const double reach = 4.0 * step_, most = 0.25 / reach;
  const auto left = slopes(x - reach, z), right = slopes(x + reach, z), here = slopes(x, z);
  std::array<double, 3> b{(right[0] - left[0]) / (2.0 * reach), 0.0, 0.0};
  if (solid_) {
    const auto back = slopes(x, z - reach), front = slopes(x, z + reach);
    b[1] = 0.5 * (right[1] - left[1] + front[0] - back[0]) / (2.0 * reach);
    b[2] = (front[1] - back[1]) / (2.0 * reach);
  }
  for (double& value : b)
    value = std::clamp(value / std::sqrt(1.0 + here[0] * here[0] + here[1] * here[1]), -most, most);
  return b;
}

/// Newton's steps on the tangent plane, damped where the ground is bent more sharply than the depth.
Vec3 Terrain::foot(const Vec3& x) const {
  Vec3 best{x[0], height(x[0], x[2]), x[2]}, at = best;
  for (int k = 0; k < 8; ++k) {
    const auto s = slopes(at[0], at[2]);
    const double rise = x[1] - at[1], scale = 1.0 / (1.0 + s[0] * s[0] + s[1] * s[1]);
    at[0] += scale * (x[0] - at[0] + rise * s[0]);
    at[2] += scale * (x[2] - at[2] + rise * s[1]);
    at[1] = height(at[0], at[2]);
    if (norm(x - at) < norm(x - best)) best = at;
  }
  return best;
}

namespace {

/// Calls f(x, z) for every column of the square lattice.
template <class F>
void each_column(const Scene& scene, double dx, F&& f) {
  const int columns = cells_along(scene, 0, dx), deep = scene.dimensions == 3 ? cells_along(scene, 2, dx) : 1;
  for (int k = 0; k < deep; ++k)
    for (int i = 0; i < columns; ++i)
      f(scene.domain.origin[0] + (i + 0.5) * dx, scene.dimensions == 3 ? scene.domain.origin[2] + (k + 0.5) * dx : 0.0);
}

}  // namespace

std::vector<Vec3> fitted_wall(const Scene& scene, const BedShape& bed, double spacing) {
  const Ground ground(bed, scene.domain);
  std::vector<Vec3> places;
  for (int row = bed.layers - 1; row >= 0; --row)
    each_column(scene, spacing, [&](double x, double z) {
      places.push_back({x, scene.domain.origin[1] + ground.height(x, z) - (row + 0.5) * spacing, z});
    });
  return places;
}

std::vector<Vec3> fitted_fluid(const Scene& scene, const BedShape& bed, double spacing) {
  const Ground ground(bed, scene.domain);
  std::vector<Vec3> places;
  each_column(scene, spacing, [&](double x, double z) {
    const double low = ground.height(x, z), room = scene.domain.size[1] - low;
    const long rows = std::lround(room / spacing);
    for (long row = 0; row < rows; ++row)
      places.push_back(
          {x, scene.domain.origin[1] + low + (static_cast<double>(row) + 0.5) * room / static_cast<double>(rows), z});
  });
  return places;
}

std::string misfit_of_ground(const Scene& scene, const BedShape& bed, double spacing) {
  const Terrain terrain(Ground(bed, scene.domain), scene.domain, spacing);
  const double low = scene.domain.origin[1], high = low + scene.domain.size[1];
  std::string problem;
  each_column(scene, spacing, [&](double x, double z) {
    if (!problem.empty()) return;
    const auto s = terrain.slopes(x, z);
    const double h = terrain.height(x, z), steep = std::hypot(s[0], s[1]);
    char text[160] = "";
    if (!std::isfinite(h) || h < low - 1e-9 * spacing || h > high)
      std::snprintf(text, sizeof text, "the ground at x = %.6g m is %.6g m high; expected the ground inside the domain",
                    x, h);
    else if (!(steep <= 1.0 + 1e-6))
      std::snprintf(text, sizeof text,
                    "the ground at x = %.6g m rises as 1 to %.3g; fitted rows take slopes up to 1 to 1", x,
                    1.0 / steep);
    problem = text;
  });
  return problem;
}

int fitted_bed(const Scene& scene, std::size_t fill) {
  for (std::size_t k = 0; k < fill && k < scene.fills.size(); ++k)
    if (scene.fills[k].packing == Packing::fitted && std::holds_alternative<BedShape>(scene.fills[k].shape))
      return static_cast<int>(k);
  return -1;
}

}  // namespace barchan
