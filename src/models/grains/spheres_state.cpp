// What a run tells of its spheres and measures of them, and what a checkpoint keeps.
#include <algorithm>
#include <cmath>

#include "engine/exchange.hpp"
#include "engine/phase_sums.hpp"
#include "models/grains/sphere_forces.hpp"
#include "models/grains/spheres.hpp"
#include "output/numbers.hpp"
#include "scene/contact_words.hpp"

namespace barchan {

void Spheres::history(HistoryRow& row) const {
  double turning = 0.0;
  for (const Part& part : parts_) {
    const PhaseParticles& p = w_->particles(part.phase);
    if (!p.has(Field::angular_velocity)) continue;
    const double* radius = p.has(Field::radius) ? p.column(Field::radius) : nullptr;
    turning += sum_of(p, [&](std::size_t k) {
      const double r = radius ? radius[k] : part.mean_radius;
      double w2 = 0.0;
      for (int d = 0; d < p.components(Field::angular_velocity); ++d)
        w2 += std::pow(p.column(Field::angular_velocity, d)[k], 2);
      return 0.2 * p.mass_of(k) * r * r * w2;
    });
  }
  const double depth = layout_.slab;  // energies are by metre of depth in 2D
  row.add("contacts", contacts_);
  row.add("contacts_deepest", deepest_);
  row.add("contacts_stored_energy [J]", (sleep_.on() ? energy_of_sleepers() : stored_) / depth);
  row.add("contacts_lost_energy [J]", lost_ / depth);
  row.add("rotation_energy [J]", turning);
  if (sleep_.on()) row.add("asleep", static_cast<double>(sleep_.sleeping()));
  bodies_.history(row);
}

/// J, with what contacts store that are evaluated.
double Spheres::energy_of_sleepers() const {
  SphereStep now = step_;
  now.records = records_[now_].data();
  now.dt = each_;
  now.contacts = StepOfContacts{each_};
  std::vector<double> of(chunks_.size(), 0.0);
  std::size_t c = shares_.first_chunk();
  for (const SphereChunk& chunk : own_chunks()) of[c++] = energy_at_rest(now, chunk);
  if (shares_.on()) Exchange().gather_in_place(of.data(), shares_.chunks_of_ranks(), sizeof(double));
  double stored = stored_;
  for (const double energy : of) stored += energy;
  return stored;
}

std::optional<std::string> Spheres::trouble() const {
  if (deepest_ <= most_sphere_overlap) return std::nullopt;
  return "two grains overlap by " + brief(100.0 * deepest_) + " % of their mean diameter (the bound is " +
         brief(100.0 * most_sphere_overlap) +
         " %): contacts are too soft for what presses them, or fills overlap; raise " + sphere_stiffness_keys(", ") +
         " or time.largest-speed, or lower largest-overlap" +
         (scene_.time.fixed_step && *scene_.time.fixed_step > laws_.step()
              ? "; time.step is longer than " + brief(laws_.step()) +
                    " s, what contacts bear: lower it, or leave it out"
              : "");
}

std::uint64_t Spheres::pairs(const PlanEntry& entry) const {
  const std::uint32_t law = laws_.table()[entry.a * layout_.phases.size() + entry.b];
  if (!entry.own_steps() || law == SphereSearch::none) return 0;
  const auto far = static_cast<std::uint32_t>(all());
  std::uint64_t n = 0;
  for (const SphereChunk& chunk : own_chunks()) {
    for (const auto& group : chunk.groups)
      for (std::size_t k = group.first * SphereChunk::batch; group.law == law && k < group.end * SphereChunk::batch;
           ++k)
        n += chunk.a[k] == far || (chunk.live_of(k / SphereChunk::batch) >> k % SphereChunk::batch & 1u) == 0 ? 0u
             : group.weight == 1.0 && chunk.b[k] < moving_                                                    ? 2u
                                                                                                              : 1u;
    n += static_cast<std::uint64_t>(
        std::count_if(chunk.sides.begin(), chunk.sides.end(), [&](const auto& at) { return at.law == law; }));
    n += static_cast<std::uint64_t>(std::count_if(chunk.walls.begin(), chunk.walls.end(), [&](const auto& at) {
      return solid_walls_.may_touch(at, chunk.phase, law);
    }));
  }
  // Who asks adds up the ranks where one of the phases is no whole one.
  if (!layout_.is_whole(entry.a) || !layout_.is_whole(entry.b))
    return shares_.on() || Exchange::is_first_process() ? n : 0;
  return shares_.on() ? Exchange().total(n) : n;
}

std::vector<RestingContact> Spheres::resting_contacts(std::size_t phase) const {
  for (const Part& part : parts_)
    if (part.phase == phase) {
      const SphereSet s{layout_.dimensions,     records_[now_].data(), moving_, all(),
                        listed_numbers_.data(), kinds_.data(),         nullptr, nullptr};
      return contacts_at_rest(step_, s, chunks_, part.first, part.count);
    }
  return {};
}

/// The laws whose forces on walls meters ask for.
void Spheres::watch_walls() {
  for (const auto& push : w_->sphere_pushes)
    watched_.push_back({laws_.table()[push.wall * layout_.phases.size() + push.grains], push.about});
  pushing_.assign(watched_.size(), {});
  step_.watched = watched_;
}

/// The present forces on walls act for a time (s).
void Spheres::sum_pushes(double time) {
  for (std::size_t k = 0; k < watched_.size(); ++k)
    for (std::size_t d = 0; d < 3; ++d) {
      w_->sphere_pushes[k].impulse[d] += time * pushing_[k][d];
      w_->sphere_pushes[k].turn[d] += time * pushing_[k][3 + d];
    }
}

/// Particles may have been made or removed since the last step of contacts: the lists are of those before.
void Spheres::archive(Archive& a) {
  for (Part& part : parts_) {
    const long changes = w_->particles(part.phase).changes();
    long late = changes - part.changes;
    a.number("spheres of a phase", part.count);
    a.number("changes to take over", late);
    part.changes = changes - late;
  }
  a.array("ids of spheres", ids_);
  if (a.loads()) {
    moving_ = 0;
    for (Part& part : parts_) {
      part.first = moving_;
      moving_ += part.count;
    }
    make_room();
  }
  a.number("must search", must_search_);
  a.number("slack", slack_);
  a.number("steps of the pairs", kept_);
  a.number("searches", searches_);
  a.number("searches since sorting", since_sort_);
  a.number("lost energy", lost_);
  a.number("stored energy", stored_);
  a.number("deepest", deepest_);
  a.number("contacts", contacts_);
  a.number("set of records", now_);
  if (!watched_.empty()) a.array("forces on walls", pushing_);
  bodies_.archive(a);
  solid_walls_.archive(a);
  a.array("records of spheres", records_[now_]);
  a.array("numbers of spheres", listed_numbers_);
  a.number("others sleep", others_sleep_);
  strays_.archive(a);
  rest_.archive(a);
  cells_loaded_ = cells_loaded_ || a.loads();
  sleep_.archive(a);
  if (a.loads()) {
    numbers_ = listed_numbers_;
    loaded_ = sleep_.on();
    if (loaded_) sleep_.mark(numbers_.data());
  }
  for (SphereChunk& chunk : chunks_) archive_chunk(a, chunk);
  a.number("length of a step of contacts", each_);
  if (!a.loads()) return;
  drop_other_chunks();
  shares_.find(chunks_);
  copy_radii();
}

void Spheres::archive_chunk(Archive& a, SphereChunk& chunk) {
  a.array("groups", chunk.groups);
  a.array("first of pairs", chunk.a);
  a.array("second of pairs", chunk.b);
  chunk.ContactBatches::archive(a);
  a.array("at sides", chunk.sides);
  a.array("at walls", chunk.walls);
  if (!sleep_.on()) return;
  a.number("all awake", chunk.all_awake);
  a.array("evaluated pairs", chunk.live);
  a.number("any evaluated", chunk.any_live);
  a.number("contacts at rest", chunk.resting);
  a.array("awake", chunk.awake);
  a.array("border", chunk.border);
}

}  // namespace barchan
