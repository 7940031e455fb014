#include "plan/memory_need.hpp"

#include <algorithm>
#include <cmath>

#include "base/errors.hpp"
#include "base/memory.hpp"
#include "engine/exchange.hpp"
#include "engine/records.hpp"
#include "scene/couplings.hpp"
#include "scene/located.hpp"

namespace barchan {

namespace {

constexpr double wide = sizeof(double), narrow = sizeof(float), index = sizeof(std::uint32_t),
                 id = sizeof(std::int64_t);

/// Images of a full periodic domain for each of its particles: those within the reach of the sides.
double images_a_particle(const Plan& plan, std::size_t phase) {
  double reach = 0.0, grown = 1.0;
  for (const auto& d : plan.directions)
    if (d.a == phase || d.b == phase) reach = std::max(reach, d.radius);
  reach *= 1.5 * (1.0 + plan.skin);  // whole cells
  for (std::size_t d = 0; d < static_cast<std::size_t>(plan.dimensions); ++d)
    if (plan.bounds.periodic[d]) grown *= 1.0 + 2.0 * reach / (plan.bounds.high[d] - plan.bounds.low[d]);
  return grown - 1.0;
}

double columns(const Plan& plan, const PlanPhase& phase) {
  double n = 0;
  for (const Field f : phase.fields) n += components(info(f).rank, plan.dimensions);
  return n;
}

/// Cells of a phase's grid, as engine/neighbours.cpp divides the domain.
double cells(const Plan& plan, std::size_t phase) {
  double longest = 0.0, count = 1.0;
  for (const auto& d : plan.directions)
    if (d.a == phase || d.b == phase) longest = std::max(longest, d.radius);
  if (longest == 0.0) return 0.0;
  const double cell = std::max(0.5 * longest * (1.0 + plan.skin), 1.2 * plan.phases[phase].spacing);
  for (std::size_t d = 0; d < static_cast<std::size_t>(plan.dimensions); ++d)
    count *= (plan.bounds.high[d] - plan.bounds.low[d]) / cell + (plan.bounds.periodic[d] ? 8.0 : 2.0);
  const double most = std::max(static_cast<double>(Neighbours::cells_a_particle) * plan.particles(),
                               static_cast<double>(Neighbours::least_cells));
  return std::min(count, most);
}

double lists(const Plan& plan) {
  double bytes = 0.0;
  for (const auto& e : plan.entries)
    for (const int direction : {e.forward, e.backward}) {
      if (direction < 0) continue;
      const auto& from = plan.phases[plan.directions[static_cast<std::size_t>(direction)].a];
      const auto& to = plan.phases[plan.directions[static_cast<std::size_t>(direction)].b];
      const double around = (e.consistency.neighbours + 1) * std::pow(1.0 + plan.skin, plan.dimensions) + 4.0;
      // Particles with neighbours of another phase stand on one side of the border: half of a neighbourhood.
      const double full = e.a == e.b ? around : std::min(around / 2.0, 4.0 + 4.0 * static_cast<double>(to.count));
      const double looking = static_cast<double>(from.count);
      bytes += looking * index * (1.0 + (e.a == e.b ? full : full * 0.1));
    }
  return bytes;
}

/// What the contacts of a sphere take, as models/grains/sphere_search.cpp reserves it: its records and their copy, its
/// pairs with the numbers that they remember, and the search.
double contacts_of_a_sphere(int dimensions) {
  const bool flat = dimensions == 2;
  const double pairs = flat ? 6 : 11, remembered = flat ? 2 : 6, record = flat ? 8 : 12, passive = 4, cells = 8;
  const double kept_pair = 2 * index + 6 * wide;
  return (2 * record + passive) * wide + pairs * (2 * index + remembered * wide) + 0.5 * pairs * kept_pair +
         cells * index + 4 * wide + 4 * index;
}

}  // namespace

double MemoryNeed::bytes() const {
  double total = 0;
  for (const auto& [name, part] : parts) total += part;
  return total;
}

MemoryNeed memory_need(const Scene& scene, const Plan& plan, bool retreats) {
  double fields = 0, records = 0, grids = 0, frames = 0, past = 0, start = 0, kept = 0, contacts = 0;
  const double dimensions = plan.dimensions;
  const bool pulled = has_artificial_stress(scene);
  const double written = 3 + 3 + 3 + 2 * static_cast<double>(scene.output.fields.size()) + 2;  // numbers of a particle
  for (std::size_t k = 0; k < plan.phases.size(); ++k) {
    const PlanPhase& p = plan.phases[k];
    const double n = static_cast<double>(p.count), all = n * (1.0 + images_a_particle(plan, k));
    const double own = n * (columns(plan, p) * wide + id);
    fields += own + n * (wide + id);  // and what a sort writes into
    const double motion = plan.dimensions == 2 ? MotionRecord<2>::size : MotionRecord<3>::size,
                 stress = plan.dimensions == 2 ? StressRecord<2>::size : StressRecord<3>::size,
                 carried = plan.dimensions == 2 ? CarriedRecord<2>::size : CarriedRecord<3>::size;
    records +=
        all * wide *
        (motion * (plan.is_extended(k) ? 2.0 : 1.0) + (p.heats ? carried : 0.0) +
         (p.deforms() && !is_total(scene.phases[k]) ? stress + (pulled ? ArtificialStressRecord::size : 0) : 0.0) +
         (p.eddies ? 4.0 : 0.0));
    if (p.flows() && scene.phases[k].fluid().energy_budget)  // models/fluid/energy_books.hpp
      records += n * wide * (5.0 * dimensions + 10.0);
    if (p.deforms() && is_total(scene.phases[k])) {  // models/bodies/reference_body.hpp: constants and sums of a
                                                     // particle; the search before
      const double numbers = dimensions == 2 ? 11.0 : 24.0, gradient = dimensions == 2 ? 5.0 : 10.0;
      const double number = scene.precision == Precision::mixed ? index : wide;
      records += n * (numbers * number + (gradient + dimensions) * wide + index);
      for (const auto& e : plan.entries)
        if (e.pairs == Pairs::first_shape && e.a == k) start += n * 40.0 * (1.0 + e.consistency.neighbours);
      for (const auto& e : plan.entries)  // models/bodies/self_contact.hpp
        if (e.self_contact && e.a == k) records += n * (2.0 * wide + index * (dimensions == 2 ? 25.0 : 93.0));
    }
    if (std::any_of(scene.interactions.begin(), scene.interactions.end(), [&](const Interaction& i) {
          return i.surfaces && (i.a == scene.phases[k].name || i.b == scene.phases[k].name);
        }))  // models/bodies/body_surface.hpp
      records += all * wide * (dimensions == 2 ? SurfaceRecord<2>::size : SurfaceRecord<3>::size);
    const double search = all * dimensions * narrow * 1.125 + (all - n) * sizeof(Image);
    grids += cells(plan, k) * 4.0 * index + search + 2.0 * n * index;
    past += own + cells(plan, k) * 2.0 * index + search;
    frames += n * (written * wide + id + 3.0 * index);
    start += n * 2.0 * sizeof(Vec3);
    if (p.sphere_records) contacts += n * contacts_of_a_sphere(plan.dimensions);
    if (p.moves()) kept += n * ((2.0 * dimensions + 2.0) * wide + id);
  }
  MemoryNeed need;
  need.parts = {{"fields", fields},  {"records", records},      {"cells", grids}, {"pair lists", lists(plan)},
                {"a frame", frames}, {"last good state", kept}, {"start", start}, {"program", 4e7}};
  need.parts.emplace_back("contacts of spheres", contacts);
  if (retreats) need.parts.emplace_back("states to go back to", static_cast<double>(most_states) * past);
  return need;
}

void check_memory(const Scene& scene, const MemoryNeed& need) {
  const AvailableMemory there = available_memory();
  const double bytes = need.bytes() * Exchange::share_of_machine();
  if (bytes <= there.bytes) return;
  throw SceneError(located(scene, "spacing") + ": the run needs about " + memory_text(bytes) + " of memory, " +
                   there.of + " leaves " + memory_text(there.bytes) +
                   "; expected a larger spacing, a smaller domain, --retreats 0, or more memory (barchan plan shows "
                   "what needs it)");
}

std::string to_text(const MemoryNeed& need) {
  std::string text;
  for (const auto& [name, bytes] : need.parts)
    if (bytes >= 1e6) text += (text.empty() ? "" : ", ") + name + " " + memory_text(bytes);
  return "memory  " + std::string(need.measured ? "" : "at most ") + memory_text(need.bytes()) + " (" + text + ")\n";
}

}  // namespace barchan
