#include "models/workspace.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>

#include "engine/exchange.hpp"
#include "engine/integrate.hpp"
#include "models/bodies/artificial_stress.hpp"
#include "models/bodies/updated_lagrangian.hpp"
#include "scene/formula.hpp"

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

bool is_output(const Scene& scene, Field field) {
  const auto& names = scene.output.fields;
  return std::find(names.begin(), names.end(), info(field).name) != names.end();
}

void PlanPhase::derive_for_output(const Scene& scene, std::initializer_list<Field> of,
                                  void (*derive)(PhaseParticles&)) {
  const std::size_t before = fields.size();
  std::copy_if(of.begin(), of.end(), std::back_inserter(fields), [&](Field f) { return is_output(scene, f); });
  if (fields.size() > before) derivations.push_back(derive);
}

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
bool must_be_told(const PlanPhase& p) { return p.heats && !p.tells_motion(); }

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
  const bool mixed = scene.precision == Precision::mixed;
  // Records in double are read by: every law but the fluid's own in mixed precision, and by tasks that call
  // need.
  std::vector<bool> seen(phases, false), read(phases, !mixed);
  for (const auto& e : layout.entries) {
    if (e.extends) seen[e.other] = true;
    if (!e.continues_fluid || e.extends) read[e.a] = read[e.b] = true;
  }
  ground_stress.resize(phases);
  grains_in_eddies.resize(phases);
  wall_motions.resize(phases, nullptr);
  for (std::size_t k = 0; k < phases; ++k) {
    const PlanPhase& p = layout.phases[k];
    if (Exchange::may_be() && layout.is_whole(k)) state.phases[k].be_whole();
    records_.push_back(std::make_unique<PhaseRecords>(p.name, layout.dimensions));
    if (read[k]) need(k, Record::motion);
    if (seen[k]) need(k, Record::extended);
    if (p.heats) need(k, Record::carried);
    if (p.eddies) need(k, Record::eddies);
    if (p.flows() && scene.phases[k].fluid().turbulence == Turbulence::k_omega) need(k, Record::turbulence);
    if (mixed && (p.flows() || seen[k])) records_[k]->make_compact(layout.bounds);
  }
}

RecordArray& Workspace::to_write(std::size_t phase, Record record) {
#ifndef NDEBUG
  AccessGuard::check_write(layout.phases[phase].name, record);
#endif
  return records_[phase]->array(record);
}

CompactRecords* Workspace::compact_to_write(std::size_t phase) {
  CompactRecords* const records = records_[phase]->compact();
#ifndef NDEBUG
  if (records) AccessGuard::check_write(layout.phases[phase].name, Record::compact);
#endif
  return records;
}

EddyRecords& Workspace::eddies_to_write(std::size_t phase) {
#ifndef NDEBUG
  AccessGuard::check_write(layout.phases[phase].name, Record::eddies);
#endif
  return records_[phase]->eddies();
}

void Workspace::fill_images(std::size_t phase, Record record) {
  if (neighbours.has_grid(phase)) records_[phase]->fill_images(record, state.phases[phase], neighbours.grid(phase));
}

void Workspace::fit_records() {
  for (std::size_t k = 0; k < state.phases.size(); ++k)
    if (neighbours.has_grid(k)) records_[k]->fit(state.phases[k].size(), neighbours.grid(k).images());
}

std::size_t Workspace::bytes() const {
  std::size_t total = neighbours.bytes();
  for (const auto& p : state.phases) total += p.bytes();
  for (const auto& r : records_) total += r->bytes();
  return total;
}

void Workspace::archive(Archive& a, bool whole) {
  neighbours.archive(a, state.phases, whole);
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
    if (must_be_told(p))
      carried.push_back(
          {p.name, {position, velocity, acceleration}, {}, {.own = {}, .ghosts = {}, .writes = {Record::carried}}});
  }
  s.add({stage::neighbours, "all", sorted, [this] { find_neighbours(); }});
  Touches packed = layout_.of_all({position, velocity, density, pressure, stress}, {});
  for (Touch& t : packed)
    t.records.writes = {Record::motion, Record::compact, Record::extended, Record::stress, Record::artificial};
  s.add({stage::pack, "all", packed, [this] { pack(); }});
  if (!carried.empty()) s.add({stage::energy, "all", carried, [this] { carry(); }});
  s.add({stage::kick, "all", layout_.of_all({acceleration}, {velocity}), [this] { kick(); }});
}

void CommonWork::find_neighbours() {
  const auto beside = [this] {
    for (const auto& call : w_->when_sorted) call();
  };
  if (layout_.directions.empty()) return Exchange::share_out();
  long changes = 0;
  for (const auto& p : w_->state.phases) changes += p.changes();
  const bool others = w_->must_search || changes != w_->changes_of_lists;  // particles than the lists are of
  const bool shared = Exchange::may_be();  // then who is called may ask other ranks: not beside the search
  const bool sorted = shared ? w_->neighbours.update(w_->state.phases, others)
                             : w_->neighbours.update(w_->state.phases, others, beside);
  w_->changes_of_lists = changes;
  w_->must_search = false;
  if (sorted) w_->fit_records();
  if (sorted && shared) beside();
}

void CommonWork::pack() {
  for (std::size_t k = 0; k < w_->state.phases.size(); ++k) {
    if (!w_->neighbours.has_grid(k)) continue;
    const double volume = std::pow(layout_.phases[k].spacing, layout_.dimensions);
    const PhaseParticles& p = w_->particles(k);
    const MotionPacking& how = w_->packing[k];
    if (layout_.phases[k].flows() && w_->compact(k)) pack_compact(p, *w_->compact_to_write(k), how, volume);
    for (const Record record : {Record::motion, Record::extended})
      if (w_->has(k, record)) pack_motion(p, w_->to_write(k, record), how, volume);
    if (w_->has(k, Record::stress)) pack_stress(p, w_->to_write(k, Record::stress));
    if (w_->has(k, Record::artificial))
      pack_artificial_stress(p, w_->scene.phases[k].elastic().artificial_stress, w_->to_write(k, Record::artificial));
  }
}

void CommonWork::derive() {
  for (std::size_t k = 0; k < layout_.phases.size(); ++k)
    for (const auto derive_fields : layout_.phases[k].derivations) derive_fields(w_->particles(k));
}

void CommonWork::carry() {
  const bool flat = layout_.dimensions == 2;
  for (std::size_t k = 0; k < w_->state.phases.size(); ++k) {
    if (!must_be_told(layout_.phases[k])) continue;
    const PhaseParticles& p = w_->particles(k);
    RecordArray& records = w_->to_write(k, Record::carried);
    flat ? pack_carried<2>(p, records, kick_of(k)) : pack_carried<3>(p, records, kick_of(k));
  }
}

double CommonWork::kick_of(std::size_t phase) const { return layout_.phases[phase].kicked() ? w_->kick_time : 0.0; }

void CommonWork::kick() {
  double largest = 0.0;
  for (std::size_t k = 0; k < w_->state.phases.size(); ++k)
    if (layout_.phases[k].moves()) { largest = std::max(largest, barchan::kick(w_->particles(k), kick_of(k))); }
  const Exchange among;
  if (among.is_shared() && (!std::isfinite(largest) || formula_fault()))
    largest = std::numeric_limits<double>::infinity();  // NaN has no order, and all ranks must know
  if (among.is_shared()) {
    found_.assign(1, largest);
    for (const double* value : w_->largest_of_ranks) found_.push_back(*value);
    among.reduce(found_.data(), found_.size(), Exchange::Take::largest);
    largest = found_.front();
    for (std::size_t k = 0; k < w_->largest_of_ranks.size(); ++k) *w_->largest_of_ranks[k] = found_[k + 1];
  }
  w_->state.largest_acceleration = largest;
}

}  // namespace barchan
