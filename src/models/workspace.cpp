#include "models/workspace.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/integrate.hpp"
#include "models/bodies/artificial_stress.hpp"
#include "models/bodies/updated_lagrangian.hpp"

namespace barchan {

const std::array<const char*, stage::count> stage::names{"kick and drift",
                                                         "grain contacts",
                                                         "elastic packing",
                                                         "elastic strain",
                                                         "wall motion",
                                                         "neighbours",
                                                         "pack",
                                                         "eddies",
                                                         "extension into walls",
                                                         "extension into solids",
                                                         "fluid rates",
                                                         "free surface",
                                                         "wall repulsion",
                                                         "elastic forces",
                                                         "weight of grains",
                                                         "loads on rigid bodies",
                                                         "contacts",
                                                         "reaction on solids",
                                                         "drag",
                                                         "rigid bodies",
                                                         "driven and measured sets",
                                                         "bulk speed",
                                                         "fluid energy",
                                                         "kick",
                                                         "watch"};

double Layout::particles() const {
  double n = 0;
  for (const auto& p : phases) n += static_cast<double>(p.count);
  return n;
}

namespace {

template <int Dim>
std::array<const double*, Dim> columns(const PhaseParticles& p, Field field) {
  std::array<const double*, Dim> c{};
  for (int d = 0; d < Dim; ++d) c[static_cast<std::size_t>(d)] = p.column(field, d);
  return c;
}

template <int Dim>
void pack_motion(const PhaseParticles& p, RecordArray& records, const Workspace::Packing& how, double volume) {
  using R = MotionRecord<Dim>;
  const auto n = static_cast<std::int64_t>(p.size());
  const auto x = columns<Dim>(p, Field::position), v = columns<Dim>(p, Field::velocity);
  const double* pressure = how.pressure ? p.column(Field::pressure) : nullptr;
  const double* rho = how.pressure && !how.fixed_volume ? p.column(Field::density) : nullptr;
  const double mass = p.mass();
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < n; ++i) {
    const auto k = static_cast<std::size_t>(i);
    double* r = records[k];
    for (std::size_t d = 0; d < Dim; ++d) {
      r[R::position + d] = x[d][k];
      r[R::velocity + d] = v[d][k];
    }
    r[R::pressure] = pressure ? pressure[k] : 0.0;
    r[R::volume] = rho ? mass / rho[k] : volume;
  }
}

/// The same in mixed precision, with the images.
template <int Dim>
void pack_compact(const PhaseParticles& p, CompactRecords& records, const CellGrid& grid, bool fixed_volume,
                  double volume) {
  const auto n = static_cast<std::int64_t>(p.size());
  const auto x = columns<Dim>(p, Field::position), v = columns<Dim>(p, Field::velocity);
  const double* pressure = p.column(Field::pressure);
  const double* rho = fixed_volume ? nullptr : p.column(Field::density);
  const double mass = p.mass();
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < n; ++i) {
    const auto k = static_cast<std::size_t>(i);
    std::array<double, Dim> at, speed;
    for (std::size_t d = 0; d < Dim; ++d) {
      at[d] = x[d][k];
      speed[d] = v[d][k];
    }
    records.write<Dim>(k, at, speed, pressure[k], rho ? mass / rho[k] : volume);
  }
  records.fill_images<Dim>(grid, x);
}

/// Velocities at the end of the step, `kick` (s) after those of now; nothing turns.
template <int Dim>
void pack_carried(const PhaseParticles& p, RecordArray& records, double kick) {
  using R = CarriedRecord<Dim>;
  const auto n = static_cast<std::int64_t>(p.size());
  const auto x = columns<Dim>(p, Field::position), v = columns<Dim>(p, Field::velocity);
  std::array<const double*, Dim> a{};
  if (kick > 0.0) a = columns<Dim>(p, Field::acceleration);
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < n; ++i) {
    const auto k = static_cast<std::size_t>(i);
    double* r = records[k];
    std::fill_n(r, R::size, 0.0);
    for (std::size_t d = 0; d < Dim; ++d) {
      r[R::position + d] = x[d][k];
      r[R::velocity + d] = v[d][k] + (a[d] ? kick * a[d][k] : 0.0);
    }
  }
}

/// A solid that a fluid asks how it moves, and whose own model does not tell.
bool must_be_told(const PlanPhase& p) { return p.heats && !p.tells_motion; }

std::vector<double> spacings(const Layout& layout) {
  std::vector<double> all;
  for (const auto& p : layout.phases) all.push_back(p.spacing);
  return all;
}

}  // namespace

Workspace::Workspace(const Scene& scene_, const Layout& layout_, State& state_)
    : scene(scene_),
      layout(layout_),
      state(state_),
      neighbours(layout_.bounds, layout_.directions, layout_.skin, spacings(layout_),
                 scene_.precision == Precision::mixed ? simd::width_in_use<float>() : simd::width_in_use<double>(),
                 static_cast<std::size_t>(layout_.particles())),
      packing(layout_.phases.size()) {
  neighbours.adapt_skin();
  const std::size_t phases = layout.phases.size();
  const int size = layout.dimensions == 2 ? MotionRecord<2>::size : MotionRecord<3>::size;
  const int carried_size = layout.dimensions == 2 ? CarriedRecord<2>::size : CarriedRecord<3>::size;
  const bool mixed = scene.precision == Precision::mixed;
  // Records in double are read by: every law but the fluid's own in mixed precision, and by tasks that call
  // need_motion.
  std::vector<bool> seen(phases, false), read(phases, !mixed);
  for (const auto& e : layout.entries) {
    if (e.extends) seen[e.other] = true;
    if (!e.compact_only) read[e.a] = read[e.b] = true;
  }
  eddies.resize(phases);
  ground_stress.resize(phases);
  for (std::size_t k = 0; k < phases; ++k) {
    motion.emplace_back(read[k] ? size : 0);
    extended.emplace_back(seen[k] ? size : 0);
    stress.emplace_back(0);
    artificial.emplace_back(0);
    carried.emplace_back(layout.phases[k].heats ? carried_size : 0);
    compact.push_back(mixed && (layout.phases[k].flows || seen[k]) ? std::make_unique<CompactRecords>(layout.bounds)
                                                                   : nullptr);
  }
}

void Workspace::need_motion(std::size_t phase) {
  if (motion[phase].stride() == 0)
    motion[phase] = RecordArray(layout.dimensions == 2 ? MotionRecord<2>::size : MotionRecord<3>::size);
}

void Workspace::fit_records() {
  for (std::size_t k = 0; k < state.phases.size(); ++k) {
    if (!neighbours.has_grid(k)) continue;
    const std::size_t n = state.phases[k].size(), images = neighbours.grid(k).images();
    for (RecordArray* r : {&motion[k], &extended[k], &stress[k], &carried[k], &artificial[k]})
      if (r->stride() > 0) r->resize(n, images);
    if (compact[k]) compact[k]->resize(n, images);
    if (layout.phases[k].eddies) eddies[k].resize(n, images);
  }
}

std::size_t Workspace::bytes() const {
  std::size_t total = neighbours.bytes();
  for (const auto& p : state.phases) total += p.bytes();
  for (const auto* set : {&motion, &extended, &stress, &carried, &artificial})
    for (const auto& r : *set) total += r.bytes();
  return total;
}

void Workspace::archive(Archive& a) {
  neighbours.archive(a, state.phases);
  if (!a.loads()) return;
  fit_records();
  must_search = false;
  changes_of_lists = 0;
  for (const auto& p : state.phases) changes_of_lists += p.changes();
}

/// Phases that no list needs have no cells: they begin in the order of their ids.
void CommonWork::attach(Workspace& w) {
  w_ = &w;
  for (std::size_t k = 0; k < w.state.phases.size(); ++k)
    if (!w.neighbours.has_grid(k)) w.particles(k).sort_by_id();
}

void CommonWork::schedule(Schedule& s) {
  using enum Field;
  Touches sorted, carried;
  for (const auto& p : layout_.phases) {
    sorted.push_back(p.all_fields());
    if (must_be_told(p)) carried.push_back({p.name, {position, velocity, acceleration}, {}});
  }
  s.add({stage::neighbours, "all", sorted, [this] { find_neighbours(); }});
  s.add({stage::pack, "all", layout_.of_all({position, velocity, density, pressure, stress}, {}), [this] { pack(); }});
  if (!carried.empty()) s.add({stage::energy, "all", carried, [this] { carry(); }});
  s.add({stage::kick, "all", layout_.of_all({acceleration}, {velocity}), [this] { kick(); }});
}

void CommonWork::find_neighbours() {
  const auto beside = [this] {
    for (const auto& call : w_->when_sorted) call();
  };
  if (layout_.directions.empty()) return;
  long changes = 0;
  for (const auto& p : w_->state.phases) changes += p.changes();
  const bool others = w_->must_search || changes != w_->changes_of_lists;  // particles than the lists are of
  const bool sorted = w_->neighbours.update(w_->state.phases, others, beside);
  w_->changes_of_lists = changes;
  w_->must_search = false;
  if (sorted) w_->fit_records();
}

void CommonWork::pack() {
  const bool flat = layout_.dimensions == 2;
  for (std::size_t k = 0; k < w_->state.phases.size(); ++k) {
    if (!w_->neighbours.has_grid(k)) continue;
    const double volume = std::pow(layout_.phases[k].spacing, layout_.dimensions);
    const PhaseParticles& p = w_->particles(k);
    const CellGrid& grid = w_->neighbours.grid(k);
    const Workspace::Packing& how = w_->packing[k];
    if (layout_.phases[k].flows && w_->compact[k])
      flat ? pack_compact<2>(p, *w_->compact[k], grid, how.fixed_volume, volume)
           : pack_compact<3>(p, *w_->compact[k], grid, how.fixed_volume, volume);
    for (RecordArray* records : {&w_->motion[k], &w_->extended[k]}) {
      if (records->stride() == 0) continue;
      flat ? pack_motion<2>(p, *records, how, volume) : pack_motion<3>(p, *records, how, volume);
      records->fill_images(grid, layout_.dimensions);
    }
    if (w_->stress[k].stride() > 0) {
      pack_stress(p, w_->stress[k]);
      w_->stress[k].fill_images(grid, layout_.dimensions);
    }
    if (w_->artificial[k].stride() > 0) {
      pack_artificial_stress(p, w_->scene.phases[k].elastic().artificial_stress, w_->artificial[k]);
      w_->artificial[k].fill_images(grid, 0);
    }
  }
}

void CommonWork::carry() {
  const bool flat = layout_.dimensions == 2;
  for (std::size_t k = 0; k < w_->state.phases.size(); ++k) {
    if (!must_be_told(layout_.phases[k])) continue;
    const PhaseParticles& p = w_->particles(k);
    flat ? pack_carried<2>(p, w_->carried[k], kick_of(k)) : pack_carried<3>(p, w_->carried[k], kick_of(k));
    w_->carried[k].fill_images(w_->neighbours.grid(k), layout_.dimensions);
  }
}

double CommonWork::kick_of(std::size_t phase) const { return layout_.phases[phase].kicked ? w_->kick_time : 0.0; }

void CommonWork::kick() {
  double largest = 0.0;
  for (std::size_t k = 0; k < w_->state.phases.size(); ++k)
    if (layout_.phases[k].moves) { largest = std::max(largest, barchan::kick(w_->particles(k), kick_of(k))); }
  w_->state.largest_acceleration = largest;
}

}  // namespace barchan
