#include "models/walls/ventilation.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "kernels/kernel.hpp"
#include "models/fluid/surface_neighbours.hpp"

namespace barchan {

/// The entries of a wall at rest with fluids that have a free surface.
static std::vector<const PlanEntry*> entries_of(const Layout& layout, std::size_t wall) {
  std::vector<const PlanEntry*> entries;
  if (layout.phases[wall].travels) return entries;
  for (const PlanEntry& e : layout.entries)
    if (e.extends && e.other == wall && layout.phases[e.fluid].free_surface) entries.push_back(&e);
  return entries;
}

bool is_ventilated(const Layout& layout, std::size_t wall) { return !entries_of(layout, wall).empty(); }

void add_ventilation_touches(const Layout& layout, std::size_t wall, Touches& touches) {
  using enum Field;
  for (const PlanEntry* e : entries_of(layout, wall))
    touches.push_back({layout.phases[e->fluid].name, {position, wholeness, surface_normal}, {}});
}

Ventilation::Ventilation(Workspace& w, std::size_t wall, std::span<const ExtensionSource> sources) : w_(w) {
  for (const PlanEntry* e : entries_of(w.layout, wall)) {
    const auto source = std::find_if(sources.begin(), sources.end(),
                                     [&](const ExtensionSource& s) { return s.list == &w.list(e->direction(wall)); });
    fluids_.push_back({e->fluid, &*source});
  }
}

template <int Dim, class Surface>
bool Ventilation::air_enters(const PhaseParticles& wall, const double* record, const Fluid& fluid,
                             const Surface& surface, std::size_t k) const {
  constexpr std::size_t dim = Dim;
  using R = MotionRecord<Dim>;
  using Vector = std::array<double, dim>;
  const ExtensionSource& source = *fluid.source;
  Vector at, mean{};
  for (std::size_t d = 0; d < dim; ++d) at[d] = wall.column(Field::position, static_cast<int>(d))[k];
  bool near = false;
  double weights = 0.0;
  with_kernel<double>(source.kernel, source.radius, Dim, [&](const auto& kernel) {
    const auto all = [](std::size_t) { return true; };
    surface.each(source.list->row(k), at, source.radius * source.radius, all, [&](std::size_t b, const Vector& r) {
      const double* other = (*source.records)[b];
      double square = 0.0;
      for (std::size_t d = 0; d < dim; ++d) {
        square += r[d] * r[d];
        near = near || surface.normal(b, d) != 0.0;
      }
      const double weight = kernel.value(std::sqrt(square)) * other[R::volume];
      weights += weight;
      for (std::size_t d = 0; d < dim; ++d) mean[d] += weight * other[R::velocity + d];
    });
  });
  if (!near || !(weights > 0.0)) return false;
  double square = 0.0, out = 0.0, across = 0.0;  // u.u, u.n, g.n
  for (std::size_t d = 0; d < dim; ++d) {
    const int axis = static_cast<int>(d);
    const double u = mean[d] / weights - wall.column(Field::velocity, axis)[k],
                 normal = wall.column(Field::wall_normal, axis)[k];
    square += u * u;
    out += u * normal;
    across += w_.scene.domain.gravity[d] * normal;
  }
  const double suction = -record[R::pressure] - source.density * across * wall.column(Field::wall_depth)[k];
  return out > leaving_sine * std::sqrt(square) || (out >= 0.0 && suction > 0.5 * source.density * square);
}

template <int Dim>
void Ventilation::let_go_in(const PhaseParticles& wall, RecordArray& records, const Fluid& fluid) {
  using R = MotionRecord<Dim>;
  const SurfaceNeighbours<Dim> surface(w_.particles(fluid.phase), w_.neighbours.grid(fluid.phase), ghosts_);
  const auto count = static_cast<std::int64_t>(wall.size());
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < count; ++i) {
    const auto k = static_cast<std::size_t>(i);
    if (!(records[k][R::pressure] < 0.0)) continue;
    if (air_enters<Dim>(wall, records[k], fluid, surface, k)) records[k][R::volume] = 0.0;
  }
}

void Ventilation::let_go(const PhaseParticles& wall, RecordArray& records) {
  for (const Fluid& fluid : fluids_)
    wall.dimensions() == 2 ? let_go_in<2>(wall, records, fluid) : let_go_in<3>(wall, records, fluid);
}

}  // namespace barchan
