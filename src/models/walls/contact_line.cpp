#include "models/walls/contact_line.hpp"

#include <array>
#include <cmath>

#include "laws/extension.hpp"
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

ContactLine::ContactLine(Workspace& w, std::size_t wall) : w_(w), spacing_(w.layout.phases[wall].spacing) {
  for (const PlanEntry* e : entries_of(w.scene, w.layout, wall))
    fluids_.push_back(
        {e->fluid, &w.list(e->direction(wall)), e->radius, surface_wholeness(w.scene.phases[e->fluid].fluid().scheme)});
}

void add_contact_touches(const Scene& scene, const Layout& layout, std::size_t wall, Touches& touches) {
  using enum Field;
  for (const PlanEntry* e : entries_of(scene, layout, wall))
    touches.push_back({layout.phases[e->fluid].name, {position, wholeness, surface_normal}, {}});
}

template <int Dim>
void ContactLine::cut_in(const PhaseParticles& wall, RecordArray& records, const Fluid& fluid) {
  constexpr std::size_t dim = Dim, volume = MotionRecord<Dim>::volume;
  using Vector = std::array<double, dim>;
  const SurfaceNeighbours<dim> surface(w_.particles(fluid.phase), w_.neighbours.grid(fluid.phase), ghosts_);
  const double* depth = wall.column(Field::wall_depth);
  std::array<const double*, dim> x{}, facing{};
  Vector down{};
  const double gravity = norm(w_.scene.domain.gravity);
  for (std::size_t d = 0; d < dim; ++d) {
    x[d] = wall.column(Field::position, static_cast<int>(d));
    facing[d] = wall.column(Field::wall_normal, static_cast<int>(d));
    down[d] = w_.scene.domain.gravity[d] / gravity;
  }
  const auto count = static_cast<std::int64_t>(wall.size());
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < count; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const PairList::Row row = fluid.list->row(k);
    if (row.begin == row.end || !(depth[k] > 0.0)) continue;
    Vector at, face;
    double tilt = 0.0;
    for (std::size_t d = 0; d < dim; ++d) {
      at[d] = x[d][k];
      face[d] = facing[d][k];
      tilt += face[d] * down[d];
    }
    if (std::abs(tilt) > level_to) continue;  // no level surface ends at a floor
    double sum = 0.0, height = 0.0, level = 0.0;
    const auto at_surface = [&](std::size_t a) { return surface.wholeness(a) < fluid.threshold; };
    surface.each(row, at, fluid.radius * fluid.radius, at_surface, [&](std::size_t a, const Vector& r) {
      double square = 0.0, size = 0.0, across = 0.0, along = 0.0, fall = 0.0;
      for (std::size_t d = 0; d < dim; ++d) {
        square += r[d] * r[d];
        size += surface.normal(a, d) * surface.normal(a, d);
        across += surface.normal(a, d) * face[d];
        fall += surface.normal(a, d) * down[d];
      }
      if (!(size > 0.0)) return;
      for (std::size_t d = 0; d < dim; ++d) along -= r[d] * (surface.normal(a, d) - across * face[d]);
      const double near = 1.0 - std::sqrt(square) / fluid.radius, weight = near * near,
                   per_size = weight / std::sqrt(size);
      sum += weight;
      height += along * per_size;
      level += fall * per_size;
    });
    if (!(sum > 0.0)) continue;
    const double above = height / sum / spacing_ - 0.5;
    records[k][volume] *= 1.0 - smooth_share((level / sum - level_from) / (level_to - level_from)) *
                                    smooth_share(0.5 * (above / contact_width + 1.0));
  }
}

void ContactLine::cut(const PhaseParticles& wall, RecordArray& records) {
  for (const Fluid& fluid : fluids_)
    wall.dimensions() == 2 ? cut_in<2>(wall, records, fluid) : cut_in<3>(wall, records, fluid);
}

}  // namespace barchan
