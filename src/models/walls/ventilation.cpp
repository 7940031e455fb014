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
  if (layout.phases[wall].travels()) return entries;
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
void Ventilation::let_go_at(const PhaseParticles& wall, double* record, const Fluid& fluid, const Surface& surface,
                            std::size_t k) const {
  constexpr std::size_t dim = Dim;
  using R = MotionRecord<Dim>;
  using Vector = std::array<double, dim>;
  const ExtensionSource& source = *fluid.source;
  const double depth = wall.column(Field::wall_depth)[k];
  Vector at;
  ExtendedState<dim> state{};
  double across = 0.0;  // g.n
  for (std::size_t d = 0; d < dim; ++d) {
    const int axis = static_cast<int>(d);
    at[d] = wall.column(Field::position, axis)[k];
    state.wall[d] = wall.column(Field::velocity, axis)[k];
    state.normal[d] = wall.column(Field::wall_normal, axis)[k];
    across += w_.scene.domain.gravity[d] * state.normal[d];
  }
  bool near = false;
  double pressure = 0.0, nearest = source.radius * source.radius;
  with_kernel<double>(source.kernel, source.radius, Dim, [&](const auto& kernel) {
    const auto all = [](std::size_t) { return true; };
    surface.each(source.list->row(k), at, source.radius * source.radius, all, [&](std::size_t b, const Vector& r) {
      const double* other = (*source.records)[b];
      double square = 0.0, way = depth, gap = 0.0;
      for (std::size_t d = 0; d < dim; ++d) {
        square += r[d] * r[d];
        way += r[d] * state.normal[d];
        gap += (r[d] + depth * state.normal[d]) * (r[d] + depth * state.normal[d]);
        near = near || surface.normal(b, d) != 0.0;
      }
      const double weight = kernel.value(std::sqrt(square)) * other[R::volume];
      state.weight += weight;
      pressure += weight * (other[R::pressure] + source.density * across * way);
      for (std::size_t d = 0; d < dim; ++d) state.mean[d] += weight * other[R::velocity + d];
      nearest = std::min(nearest, gap);
    });
  });
  if (!near || !(state.weight > 0.0) || !(pressure < 0.0)) return;
  double square = 0.0, out = 0.0;  // u.u, u.n
  Vector v;
  for (std::size_t d = 0; d < dim; ++d) {
    state.mean[d] /= state.weight;
    v[d] = record[R::velocity + d];
    const double u = state.mean[d] - state.wall[d];
    square += u * u;
    out += u * state.normal[d];
  }
  const bool leaves = out > leaving_sine * std::sqrt(square),
             fast = 0.5 * source.density * square >= -pressure / state.weight;
  if (!leaves && (fast || out < 0.0)) return;
  state.let_go(record[R::pressure], v);
  for (std::size_t d = 0; d < dim; ++d) record[R::velocity + d] = v[d];
  const double gap = std::sqrt(nearest) / w_.layout.phases[fluid.phase].spacing;
  if (leaves && fast) record[R::volume] = 0.0;
  else if (depth > 0.0) record[R::volume] *= 1.0 - smooth_share((gap - gap_from) / (gap_to - gap_from));
}

template <int Dim>
void Ventilation::let_go_in(const PhaseParticles& wall, RecordArray& records, const Fluid& fluid) {
  using R = MotionRecord<Dim>;
  const SurfaceNeighbours<Dim> surface(w_.particles(fluid.phase), w_.neighbours.grid(fluid.phase), ghosts_);
  const auto count = static_cast<std::int64_t>(wall.size());
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < count; ++i) {
    const auto k = static_cast<std::size_t>(i);
    if (records[k][R::pressure] < 0.0) let_go_at<Dim>(wall, records[k], fluid, surface, k);
  }
}

void Ventilation::let_go(const PhaseParticles& wall, RecordArray& records) {
  for (const Fluid& fluid : fluids_)
    wall.dimensions() == 2 ? let_go_in<2>(wall, records, fluid) : let_go_in<3>(wall, records, fluid);
}

}  // namespace barchan
