#include "models/grains/sphere_rest.hpp"

#include <algorithm>
#include <cmath>

#include "models/grains/solid_walls.hpp"

namespace barchan {

namespace {

constexpr double same_place = 0.05;  // of the sum of radii: so near are the place of a contact's other and a sphere

/// A pair of a list, or a sphere at a side, as contacts see it.
struct Meeting {
  std::uint32_t a = 0, b = 0;  // numbers; b: `side` where it is one
  Vec3 branch{};               // m, from a to b
  double reach = 0.0;          // m, sum of the radii
  double tangential = 0.0;     // N/m, stiffness
  double lever = 0.0;          // m, reduced radius: of the rolling resistance
  static constexpr std::uint32_t side = 0xffffffffu;

  Vec3 normal() const { return -1.0 / std::max(norm(branch), 1e-300) * branch; }  // from b to a
};

double tangential_stiffness(const AnySphereContact& any, double overlap, double reduced_radius) {
  return std::visit([&](const auto& law) { return law.slip_stiffness(reduced_radius, std::max(overlap, 0.0)); }, any);
}

Meeting of_pair(const SphereStep& step, const SphereSet& s, std::uint32_t a, std::uint32_t b,
                const SphereChunk::Group& group) {
  const auto dimensions = static_cast<std::size_t>(s.dimensions);
  const std::size_t stride = s.dimensions == 2 ? SphereRecord<2>::size : SphereRecord<3>::size,
                    radius = s.dimensions == 2 ? SphereRecord<2>::radius : SphereRecord<3>::radius;
  const double *of_a = s.records + a * stride, *of_b = s.records + b * stride;
  Meeting m;
  m.a = s.numbers[a];
  m.b = s.numbers[b];
  for (std::size_t d = 0; d < dimensions; ++d) {
    m.branch[d] = -pair_image::apart(of_a[d] - of_b[d], step.period[d], group.image, d);
  }
  m.reach = of_a[radius] + of_b[radius];
  m.lever = of_a[radius] * of_b[radius] / m.reach;
  m.tangential = tangential_stiffness(step.laws[group.law], m.reach - norm(m.branch), m.lever);
  return m;
}

Meeting of_side(const SphereStep& step, const SphereSet& s, const SphereChunk::AtSide& at) {
  const std::size_t stride = s.dimensions == 2 ? SphereRecord<2>::size : SphereRecord<3>::size;
  const double* r = s.records + at.sphere * stride;
  Meeting m;
  m.a = s.numbers[at.sphere];
  m.b = Meeting::side;
  m.branch[at.axis] = at.place - r[at.axis];
  m.reach = m.lever = r[s.dimensions == 2 ? SphereRecord<2>::radius : SphereRecord<3>::radius];
  m.tangential = tangential_stiffness(step.laws[at.law], m.reach - norm(m.branch), m.lever);
  return m;
}

Meeting of_wall(const SphereStep& step, const SphereSet& s, std::uint32_t sphere, const SolidTouch& touch) {
  const std::size_t stride = s.dimensions == 2 ? SphereRecord<2>::size : SphereRecord<3>::size;
  Meeting m;
  m.a = s.numbers[sphere];
  m.b = Meeting::side;
  for (std::size_t d = 0; d < 3; ++d) m.branch[d] = -touch.distance * touch.normal[d];
  m.reach = m.lever =
      s.records[sphere * stride + (s.dimensions == 2 ? SphereRecord<2>::radius : SphereRecord<3>::radius)];
  m.tangential =
      tangential_stiffness(step.laws[static_cast<std::size_t>(touch.with - 1)], m.reach - touch.distance, m.lever);
  return m;
}

/// What a sphere that stands still touches of walls, without memory.
SolidTouches touches_of_walls(const SphereStep& step, const SphereSet& s, const SphereChunk& chunk,
                              const SphereChunk::AtWalls& at) {
  const std::size_t stride = s.dimensions == 2 ? SphereRecord<2>::size : SphereRecord<3>::size;
  const double* r = s.records + at.sphere * stride;
  std::array<SolidWalls::Contact, SolidWalls::most> found;
  const std::size_t count = step.walls->touch({r[0], r[1], s.dimensions == 2 ? 0.0 : r[2]}, {},
                                              r[s.dimensions == 2 ? SphereRecord<2>::radius : SphereRecord<3>::radius],
                                              0.0, chunk.phase, at, nullptr, found);
  SolidTouches touches;
  for (std::size_t c = 0; c < count; ++c) {
    touches.of[c].with = static_cast<std::int64_t>(found[c].law) + 1;
    touches.of[c].distance = found[c].distance;
    for (std::size_t d = 0; d < 3; ++d) touches.of[c].normal[d] = found[c].normal[d];
  }
  return touches;
}

/// Calls f(meeting, memory, distance of its numbers, place) for all pairs of a chunk, then for all its spheres at
/// sides; `place`: that of the pair, or among the sides.
template <class Chunk, class F>
void each_meeting(const SphereStep& step, const SphereSet& s, Chunk& chunk, F&& f) {
  constexpr std::size_t batch = SphereChunk::batch;
  for (const auto& group : chunk.groups)
    for (std::size_t at = group.first * batch; at < group.end * batch; ++at)
      if (chunk.a[at] < s.all)
        f(of_pair(step, s, chunk.a[at], chunk.b[at], group), chunk.of_pair(at, step.numbers), batch, at);
  for (std::size_t k = 0; k < chunk.sides.size(); ++k)
    f(of_side(step, s, chunk.sides[k]), chunk.sides[k].memory, std::size_t{1}, k);
}

/// The slips that carry the force and the torque on a (laws/coulomb_friction.hpp, laws/rolling_resistance.hpp).
void set_slips(const SphereStep& step, const Meeting& m, Vec3 force, Vec3 torque, double* memory, std::size_t apart) {
  if (!(m.tangential > 0.0)) return;
  const Vec3 n = m.normal();
  const double inverse = -1.0 / m.tangential, rolling = inverse / m.lever;
  if (step.dimensions == 2) {
    memory[0] = inverse * (force[1] * n[0] - force[0] * n[1]);
    if (step.has.rolls) memory[apart] = rolling * torque[2];
    return;
  }
  for (std::size_t d = 0; d < 3; ++d) {
    memory[d * apart] = inverse * force[d];
    if (step.has.rolls) memory[(3 + d) * apart] = rolling * torque[d];
  }
}

RestingContact contact_of(const SphereStep& step, const Meeting& m, std::uint64_t sphere, const double* memory,
                          std::size_t apart) {
  RestingContact c{sphere, m.branch, {}, {}};
  const Vec3 n = m.normal();
  const double k = -m.tangential, rolling = k * m.lever;
  if (step.dimensions == 2) {
    c.force = {-k * memory[0] * n[1], k * memory[0] * n[0], 0.0};
    if (step.has.rolls) c.torque[2] = rolling * memory[apart];
    return c;
  }
  for (std::size_t d = 0; d < 3; ++d) {
    c.force[d] = k * memory[d * apart];
    if (step.has.rolls) c.torque[d] = rolling * memory[(3 + d) * apart];
  }
  return c;
}

}  // namespace

void SphereRest::add(std::size_t first, const std::vector<RestingContact>& contacts) {
  for (RestingContact contact : contacts) {
    contact.sphere += first;
    contacts_.push_back(contact);
  }
}

void SphereRest::renumber(const std::vector<std::uint32_t>& to) {
  for (RestingContact& c : contacts_) c.sphere = to[c.sphere];
  std::erase_if(contacts_, [](const RestingContact& c) { return c.sphere == ContactMemory::gone; });
}

void SphereRest::recall(const SphereStep& step, const SphereSet& s, std::span<SphereChunk> chunks) {
  if (contacts_.empty()) return;
  std::stable_sort(contacts_.begin(), contacts_.end(),
                   [](const auto& a, const auto& b) { return a.sphere < b.sphere; });
  // The contact of a sphere with what stands at `branch` from it.
  const auto find = [&](std::uint32_t number, const Vec3& branch, double reach) -> const RestingContact* {
    const auto before = [](const RestingContact& c, std::uint32_t sphere) { return c.sphere < sphere; };
    auto c = std::lower_bound(contacts_.begin(), contacts_.end(), number, before);
    for (; c != contacts_.end() && c->sphere == number; ++c)
      if (norm(c->branch - branch) < same_place * reach) return &*c;
    return nullptr;
  };
  for (SphereChunk& chunk : chunks) {
    each_meeting(step, s, chunk, [&](const Meeting& m, double* memory, std::size_t apart, std::size_t at) {
      if (!step.has.rubs) return;
      const RestingContact* own = find(m.a, m.branch, m.reach);
      if (own) set_slips(step, m, own->force, own->torque, memory, apart);
      else if (m.b != Meeting::side && (own = find(m.b, -1.0 * m.branch, m.reach)))
        set_slips(step, m, -1.0 * own->force, -1.0 * own->torque, memory, apart);
      if (!own) return;
      if (m.b == Meeting::side) chunk.sides[at].touches = 1;
      else chunk.set_touching(at);
    });
    for (const SphereChunk::AtWalls& at : chunk.walls) {
      if (!step.has.rubs) break;
      const SolidTouches touches = touches_of_walls(step, s, chunk, at);
      SolidTouches& kept = step.columns[chunk.phase].walls[at.sphere - step.columns[chunk.phase].first];
      std::size_t n = 0;
      for (const SolidTouch& touch : touches.of) {
        if (touch.with == 0) break;
        const Meeting m = of_wall(step, s, at.sphere, touch);
        const RestingContact* own = find(m.a, m.branch, m.reach);
        if (!own) continue;
        kept.of[n] = touch;
        set_slips(step, m, own->force, own->torque, kept.of[n++].memory, 1);
      }
    }
  }
  contacts_.clear();
}

std::vector<RestingContact> contacts_at_rest(const SphereStep& step, const SphereSet& s,
                                             const std::vector<SphereChunk>& chunks, std::size_t first,
                                             std::size_t count) {
  std::vector<RestingContact> contacts;
  for (const SphereChunk& chunk : chunks)
    each_meeting(step, s, chunk, [&](const Meeting& m, const double* memory, std::size_t apart, std::size_t at) {
      const bool side = m.b == Meeting::side;
      const bool touches = side ? chunk.sides[at].touches != 0 : chunk.touching(at);
      // Both chunks of a pair have it: that of the first tells.
      const bool own = side || (chunk.a[at] >= chunk.begin && chunk.a[at] < chunk.end);
      if (!touches || !own || !step.has.rubs || m.a < first || m.a >= first + count) return;
      contacts.push_back(contact_of(step, m, m.a - first, memory, apart));
    });
  for (const SphereChunk& chunk : chunks)
    for (const SphereChunk::AtWalls& at : chunk.walls)
      for (const SolidTouch& touch : step.columns[chunk.phase].walls[at.sphere - step.columns[chunk.phase].first].of) {
        if (touch.with == 0 || !step.has.rubs) break;
        const Meeting m = of_wall(step, s, at.sphere, touch);
        if (m.a >= first && m.a < first + count) contacts.push_back(contact_of(step, m, m.a - first, touch.memory, 1));
      }
  return contacts;
}

}  // namespace barchan
