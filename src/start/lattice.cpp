#include "start/lattice.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "scene/couplings.hpp"
#include "scene/side_names.hpp"

namespace barchan {
namespace {

const double row_pitch = std::sqrt(3.0) / 2.0;    // of a close-packed layer, in spacings
const double layer_pitch = std::sqrt(2.0 / 3.0);  // between close-packed layers, in spacings
constexpr double round_off = 1e-9;                // in spacings

/// Whole numbers k with lower <= anchor + k pitch < upper, round-off apart: [first, end).
struct Range {
  long first, end;
  std::size_t size() const { return static_cast<std::size_t>(std::max(end - first, 0l)); }
};
Range range(double anchor, double pitch, double lower, double upper, double spacing) {
  const double slack = round_off * spacing / pitch;
  return {static_cast<long>(std::ceil((lower - anchor) / pitch - slack)),
          static_cast<long>(std::ceil((upper - anchor) / pitch - slack))};
}

bool odd(long k) { return k % 2 != 0; }

}  // namespace

std::vector<Vec3> lattice(Packing packing, int dimensions, double spacing, const Vec3& anchor, const Vec3& lower,
                          const Vec3& upper, const ranks::Share& share) {
  const bool close = packing == Packing::hexagonal;
  const bool solid = dimensions == 3;
  const double pitch_y = spacing * (!close ? 1.0 : solid ? layer_pitch : row_pitch);
  const double pitch_z = spacing * (close ? row_pitch : 1.0);
  const auto each_row = [&](auto&& row) {  // row(shift of its places along x, their numbers, y, z)
    const Range layers = range(anchor[1], pitch_y, lower[1], upper[1], spacing);
    for (long j = layers.first; j < layers.end; ++j) {
      const double y = anchor[1] + static_cast<double>(j) * pitch_y;
      const double z_shift = close && solid && odd(j) ? pitch_z / 3.0 : 0.0;
      const Range rows = solid ? range(anchor[2] + z_shift, pitch_z, lower[2], upper[2], spacing) : Range{0, 1};
      for (long k = rows.first; k < rows.end; ++k) {
        const double z = solid ? anchor[2] + z_shift + static_cast<double>(k) * pitch_z : 0.0;
        const double x_shift = close && odd(solid ? j + k : j) ? 0.5 * spacing : 0.0;
        row(x_shift, range(anchor[0] + x_shift, spacing, lower[0], upper[0], spacing), y, z);
      }
    }
  };
  std::size_t all = 0, before = 0;
  if (share.count > 1) each_row([&](double, const Range& r, double, double) { all += r.size(); });
  const std::size_t begin = share.begin(all), end = share.count > 1 ? share.end(all) : static_cast<std::size_t>(-1);
  std::vector<Vec3> places;
  places.reserve(share.count > 1 ? end - begin : 0);
  each_row([&](double x_shift, const Range& r, double y, double z) {
    const std::size_t first = std::clamp(begin, before, before + r.size()) - before,
                      last = std::clamp(end, before, before + r.size()) - before;
    for (long i = r.first + static_cast<long>(first); i < r.first + static_cast<long>(last); ++i)
      places.push_back({anchor[0] + x_shift + static_cast<double>(i) * spacing, y, z});
    before += r.size();
  });
  return places;
}

double period_of(Packing packing, int dimensions, std::size_t axis, double spacing) {
  if (packing != Packing::hexagonal || axis == 0) return spacing;
  if (dimensions == 2 || axis == 2) return 2.0 * row_pitch * spacing;
  return 2.0 * layer_pitch * spacing;
}

bool hangs_on_origin(const Shape& shape) {
  return std::holds_alternative<BoxShape>(shape) || std::holds_alternative<PolygonShape>(shape) ||
         std::holds_alternative<SurfaceShape>(shape) || std::holds_alternative<FormulaShape>(shape) ||
         std::holds_alternative<SidesShape>(shape) || std::holds_alternative<BedShape>(shape) ||
         std::holds_alternative<RemainderShape>(shape);
}

std::string misfit_of_period(const Scene& scene, std::size_t axis) {
  // Spheres of their own diameter stretch their lattice (shapes.cpp).
  const auto stretches = [&](const Fill& fill) {
    const Phase* phase = find_phase(scene, fill.phase);
    return phase && phase->diameter();
  };
  const auto misfit = [&](double period, const char* whole) -> std::string {
    const double size = scene.domain.size[axis];
    const double count = size / period;
    if (std::round(count) >= 1.0 && std::abs(count - std::round(count)) <= 1e-9 * count) return "";
    const double below = std::floor(count) * period, above = std::ceil(count) * period;
    char text[256], nearest[64];
    if (below > 0.0) std::snprintf(nearest, sizeof nearest, "%.15g or %.15g m", below, above);
    else std::snprintf(nearest, sizeof nearest, "%.15g m", above);
    std::snprintf(text, sizeof text,
                  "%.15g m along the periodic axis %c is not a whole number of %s (%.15g m); expected %s", size,
                  static_cast<char>('x' + axis), whole, period, nearest);
    return text;
  };
  // Square lattices first: a size that they fit is the shorter list.
  for (const bool staggered : {false, true})
    for (const Fill& fill : scene.fills) {
      if (!hangs_on_origin(fill.shape) || fill.packing == Packing::random || stretches(fill)) continue;
      const double dx = spacing_of(scene, fill);
      if (staggered != (fill.packing == Packing::hexagonal)) continue;
      std::string text = staggered && axis != 0 ? misfit(period_of(Packing::hexagonal, scene.dimensions, axis, dx),
                                                         "staggered double rows")
                                                : misfit(dx, "spacings");
      if (!text.empty()) return text;
    }
  return "";
}

int cells_along(const Scene& scene, std::size_t axis, double spacing) {
  return std::max(1, static_cast<int>(std::lround(scene.domain.size[axis] / spacing)));
}

std::vector<Vec3> rows_outside(const Scene& scene, const SidesShape& sides, double spacing) {
  struct Axis {
    int cells = 1, first = 0, end = 1;  // cells of the domain; range with the layers outside
    bool below = false, above = false;  // which of its two sides are asked for
  };
  std::array<Axis, 3> axes;
  const auto asked = [&](const char* name) {
    return std::find(sides.sides.begin(), sides.sides.end(), name) != sides.sides.end();
  };
  const SideNames& names = side_names(scene.domain);
  for (std::size_t axis = 0; axis < static_cast<std::size_t>(scene.dimensions); ++axis) {
    const int layers = scene.domain.periodic[axis] ? 0 : sides.layers;
    const int cells = cells_along(scene, axis, spacing);
    axes[axis] = {cells, -layers, cells + layers, asked(names[axis][0]), asked(names[axis][1])};
  }
  const auto coordinate = [&](std::size_t axis, int i) {
    const double dx = spacing, low = scene.domain.origin[axis];
    const int cells = axes[axis].cells;
    if (i < cells) return low + (i + 0.5) * dx;
    return low + scene.domain.size[axis] + (i - cells + 0.5) * dx;
  };
  const auto behind = [&](std::size_t axis, int i) {
    return (axes[axis].below && i < 0) || (axes[axis].above && i >= axes[axis].cells);
  };
  std::vector<Vec3> places;
  for (int j = axes[1].first; j < axes[1].end; ++j)
    for (int k = axes[2].first; k < axes[2].end; ++k)
      for (int i = axes[0].first; i < axes[0].end; ++i)
        if (behind(0, i) || behind(1, j) || (scene.dimensions == 3 && behind(2, k)))
          places.push_back({coordinate(0, i), coordinate(1, j), scene.dimensions == 3 ? coordinate(2, k) : 0.0});
  return places;
}

}  // namespace barchan
