#include "models/walls/contact_line.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "kernels/kernel.hpp"
#include "models/fluid/fluid_phase.hpp"
#include "models/fluid/fluid_stress.hpp"
#include "models/fluid/surface_neighbours.hpp"

namespace barchan {

/// The entries of calm heavy fluids with a wall.
static std::vector<const PlanEntry*> entries_of(const Scene& scene, const Layout& layout, std::size_t wall) {
  std::vector<const PlanEntry*> entries;
  for (const PlanEntry& e : layout.entries)
    if (e.extends && e.other == wall && calmed(scene, layout, e.fluid)) entries.push_back(&e);
  return entries;
}

ContactLine::ContactLine(Workspace& w, std::size_t wall, std::span<const ExtensionSource> sources,
                         const ExtensionRule& rule)
    : w_(w), rule_(rule), spacing_(w.layout.phases[wall].spacing) {
  for (const PlanEntry* e : entries_of(w.scene, w.layout, wall)) {
    const auto source = std::find_if(sources.begin(), sources.end(),
                                     [&](const ExtensionSource& s) { return s.list == &w.list(e->direction(wall)); });
    fluids_.push_back({e->fluid, &*source, surface_wholeness(w.scene.phases[e->fluid].fluid().scheme)});
  }
}

void add_contact_touches(const Scene& scene, const Layout& layout, std::size_t wall, Touches& touches) {
  using enum Field;
  for (const PlanEntry* e : entries_of(scene, layout, wall))
    touches.push_back({layout.phases[e->fluid].name, {position, wholeness, surface_normal}, {}});
}

/// Sums of velocity and pressure over the fluid about a wall's particle, and how they vary with the way up t (m).
template <int Dim>
struct ContactLine::Rising {
  static constexpr std::size_t dim = Dim, values = dim + 1;
  double weight = 0.0, way = 0.0, square = 0.0;
  std::array<double, values> sum{}, sloped{};  // velocity, then pressure

  void add(double w, double t, const std::array<double, values>& q) {
    weight += w;
    way += w * t;
    square += w * t * t;
    for (std::size_t c = 0; c < values; ++c) {
      sum[c] += w * q[c];
      sloped[c] += w * t * q[c];
    }
  }
  /// What lines through the values have at t = 0 over their means. `least`: of the variance of t (m2).
  std::array<double, values> over_mean(double least) const {
    std::array<double, values> more{};
    if (!(weight > 0.0)) return more;
    const double mean = way / weight, by = -mean / (std::max(square / weight - mean * mean, least) * weight);
    for (std::size_t c = 0; c < values; ++c) more[c] = by * (sloped[c] - mean * sum[c]);
    return more;
  }
};

/// g - a_w of a wall's particle, with what [[forcing]] adds (m/s2): what the extension of the pressure follows.
template <std::size_t Dim>
std::array<double, Dim> ContactLine::pull(const PhaseParticles& wall, std::span<const double> forced,
                                          std::size_t k) const {
  const Field own = wall.has(Field::surface_velocity) ? Field::surface_acceleration : Field::acceleration;
  std::array<double, Dim> pull;
  for (std::size_t d = 0; d < Dim; ++d) {
    pull[d] = w_.scene.domain.gravity[d];
    if (rule_.accelerates) pull[d] -= wall.column(own, static_cast<int>(d))[k];
    if (!forced.empty()) pull[d] += forced[k * Dim + d];
  }
  return pull;
}

template <int Dim, class Surface>
void ContactLine::raise(const PhaseParticles& wall, std::span<const double> forced, double* record, const Fluid& fluid,
                        const Surface& surface, std::size_t k, double share) {
  constexpr std::size_t dim = Dim;
  using R = MotionRecord<Dim>;
  using Vector = std::array<double, dim>;
  if (rule_.lets_go && !(record[R::pressure] > 0.0)) return;
  const ExtensionSource& source = *fluid.source;
  const Vector pulled = pull<dim>(wall, forced, k);
  Vector at, normal, up;
  double across = 0.0, size = 0.0;
  for (std::size_t d = 0; d < dim; ++d) {
    at[d] = wall.column(Field::position, static_cast<int>(d))[k];
    normal[d] = wall.column(Field::wall_normal, static_cast<int>(d))[k];
    across += w_.scene.domain.gravity[d] * normal[d];
  }
  for (std::size_t d = 0; d < dim; ++d) {
    up[d] = across * normal[d] - w_.scene.domain.gravity[d];
    size += up[d] * up[d];
  }
  for (double& u : up) u /= std::sqrt(size);
  Rising<Dim> rising;
  with_kernel<double>(source.kernel, source.radius, Dim, [&](const auto& kernel) {
    const auto all = [](std::size_t) { return true; };
    surface.each(source.list->row(k), at, source.radius * source.radius, all, [&](std::size_t b, const Vector& r) {
      const double* other = (*source.records)[b];
      const double p = other[R::pressure];
      std::array<double, dim + 1> values;
      double square = 0.0, way = 0.0, fall = 0.0;
      for (std::size_t d = 0; d < dim; ++d) {
        square += r[d] * r[d];
        way -= r[d] * up[d];
        fall += r[d] * pulled[d];
        values[d] = other[R::velocity + d];
      }
      values[dim] = p + (source.density + (p - source.compression.rest) * source.compression.per_c2) * fall;
      rising.add(kernel.value(std::sqrt(square)) * other[R::volume], way, values);
    });
  });
  const auto more = rising.over_mean(least_spread * spacing_ * spacing_);
  const double slips = share * (rule_.slip == Slip::no_slip ? std::max(1.0 - rule_.rub, 0.0) : 1.0);
  double out = 0.0;
  for (std::size_t d = 0; d < dim; ++d) out += more[d] * normal[d];
  for (std::size_t d = 0; d < dim; ++d) record[R::velocity + d] += slips * (more[d] - out * normal[d]);
  record[R::pressure] += share * more[dim];
}

template <int Dim>
void ContactLine::end_in(const PhaseParticles& wall, std::span<const double> forced, RecordArray& records,
                         const Fluid& fluid) {
  constexpr std::size_t dim = Dim, volume = MotionRecord<Dim>::volume;
  using Vector = std::array<double, dim>;
  const SurfaceNeighbours<dim> surface(w_.particles(fluid.phase), w_.neighbours.grid(fluid.phase), ghosts_);
  const double* depth = wall.column(Field::wall_depth);
  std::array<const double*, dim> x{}, facing{};
  Vector down{};
  const double gravity = norm(w_.scene.domain.gravity), radius = fluid.source->radius;
  for (std::size_t d = 0; d < dim; ++d) {
    x[d] = wall.column(Field::position, static_cast<int>(d));
    facing[d] = wall.column(Field::wall_normal, static_cast<int>(d));
    down[d] = w_.scene.domain.gravity[d] / gravity;
  }
  const auto count = static_cast<std::int64_t>(wall.size());
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < count; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const PairList::Row row = fluid.source->list->row(k);
    if (row.begin == row.end || !(depth[k] > 0.0)) continue;
    Vector at, face;
    double tilt = 0.0;
    for (std::size_t d = 0; d < dim; ++d) {
      at[d] = x[d][k];
      face[d] = facing[d][k];
      tilt += face[d] * down[d];
    }
    if (std::abs(tilt) > level_to) continue;  // no level surface ends at a floor
    Vector aside;                             // the level part of the normal, of length 1
    for (std::size_t d = 0; d < dim; ++d) aside[d] = (face[d] - tilt * down[d]) / std::sqrt(1.0 - tilt * tilt);
    double sum = 0.0, height = 0.0, level = 0.0;
    const auto at_surface = [&](std::size_t a) { return surface.wholeness(a) < fluid.threshold; };
    surface.each(row, at, radius * radius, at_surface, [&](std::size_t a, const Vector& r) {
      double square = 0.0, size = 0.0, across = 0.0, along = 0.0, fall = 0.0;
      for (std::size_t d = 0; d < dim; ++d) {
        square += r[d] * r[d];
        size += surface.normal(a, d) * surface.normal(a, d);
        across += surface.normal(a, d) * aside[d];
        fall += surface.normal(a, d) * down[d];
      }
      if (!(size > 0.0)) return;
      for (std::size_t d = 0; d < dim; ++d) along -= r[d] * (surface.normal(a, d) - across * aside[d]);
      const double near = 1.0 - std::sqrt(square) / radius, weight = near * near, per_size = weight / std::sqrt(size);
      sum += weight;
      height += along * per_size;
      level += fall * per_size;
    });
    if (!(sum > 0.0)) continue;
    const double share = smooth_share((level / sum - level_from) / (level_to - level_from));
    const double above = height / sum / spacing_ - 0.5;
    const double cut = share * smooth_share(0.5 * (above / contact_width + 1.0));
    if (share > 0.0 && cut < 1.0) raise<Dim>(wall, forced, records[k], fluid, surface, k, share);
    records[k][volume] *= 1.0 - cut;
  }
}

void ContactLine::end(const PhaseParticles& wall, std::span<const double> forced, RecordArray& records) {
  for (const Fluid& fluid : fluids_)
    wall.dimensions() == 2 ? end_in<2>(wall, forced, records, fluid) : end_in<3>(wall, forced, records, fluid);
}

}  // namespace barchan
