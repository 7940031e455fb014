// Contacts of a bed at rest: the slips that carry a given force and torque, and what is read from them again.
#include <gtest/gtest.h>

#include <cmath>
#include <type_traits>

#include "models/grains/sphere_rest.hpp"
#include "models/grains/sphere_search.hpp"
#include "unit/sphere_sets.hpp"

namespace barchan::sphere_rest_test {
namespace {

using sets::SphereCast;
using sets::Uniform;
using Law = std::remove_cv_t<std::remove_pointer_t<decltype(SphereStep::laws)>>;

constexpr double stiffness = 1000.0;                  // N/m
constexpr double tangential = 2.0 / 7.0 * stiffness;  // N/m, of a linear contact

/// Spheres in the bounds, searched, with a floor at the low end of the last axis; each contact has a rolling slip too.
template <int Dim>
struct Bed {
  static constexpr std::size_t spins = Dim == 2 ? 1 : 3, numbers = 2 * spins;
  SphereCast<Dim> cast;
  std::vector<Law> laws{std::variant_alternative_t<0, Law>{
      {stiffness}, NormalDashpot::of_restitution<LinearSpring>(0.7), {{}, 0.0}, {0.0}}};
  SphereStep step;

  Bed(const Bounds& bounds, const std::vector<Vec3>& x, double radius, std::size_t chunk_size, Uniform&& random)
      : cast(bounds, x, 0, radius, radius, 1, chunk_size, random) {
    SphereSearch search;
    constexpr std::uint16_t up = Dim - 1;
    search.prepare(bounds, cast.reach, 1, cast.laws, {{up, 1, bounds.low[up], 0}}, numbers);
    search.keep(0, cast.set().moving, cast.set().all, cast.chunks, cast.numbers.data());
    search.find(cast.set(), 0.05 * radius, cast.chunks);
    step.dimensions = Dim;
    step.records = cast.records.data();
    step.laws = laws.data();
    step.has = {true, true, true};
    step.numbers = numbers;
    for (std::size_t d = 0; d < Dim; ++d) step.period[d] = bounds.periodic[d] ? bounds.high[d] - bounds.low[d] : 0.0;
  }
  Vec3 place(std::size_t k) const {
    Vec3 x{};
    for (std::size_t d = 0; d < Dim; ++d) x[d] = cast.records[k * SphereRecord<Dim>::size + d];
    return x;
  }
  /// From sphere i to sphere j, or to its nearest image (m).
  Vec3 branch(std::size_t i, std::size_t j) const {
    Vec3 r = place(j) - place(i);
    for (std::size_t d = 0; d < Dim; ++d)
      if (step.period[d] > 0.0) r[d] -= step.period[d] * std::round(r[d] / step.period[d]);
    return r;
  }
  std::vector<RestingContact> all_contacts() const {
    return contacts_at_rest(step, cast.set(), cast.chunks, 0, cast.all);
  }
};

template <int Dim>
Bed<Dim> regular(std::size_t chunk_size = 8) {
  Uniform random(7);
  const Bounds bounds = sets::box(Dim, {5.0, 3.0, Dim == 3 ? 3.0 : 0.0}, {true, false, false});
  return Bed<Dim>(bounds, sets::lattice(bounds, 1.0, 0.0, random), 0.505, chunk_size, Uniform(8));
}

/// A force across the branch, and a torque about it that rolls.
RestingContact contact(std::uint64_t sphere, const Vec3& branch, int dimensions, Uniform& random) {
  RestingContact c{sphere, branch, {}, {}};
  const Vec3 n = 1.0 / norm(branch) * branch;
  const Vec3 any{random(-1, 1), random(-1, 1), dimensions == 3 ? random(-1, 1) : 0.0};
  c.force = any - dot(any, n) * n;
  if (dimensions == 2) c.torque = {0.0, 0.0, random(-1, 1)};
  else c.torque = cross(n, Vec3{random(-1, 1), random(-1, 1), random(-1, 1)});
  return c;
}

/// By hand: the slip is -F.t/k_t with t = (-n_y, n_x), the rolling slip -M/(k_t R*), R* = r/2.
TEST(SphereRest, GivesAPairTheSlipThatCarriesItsForce) {
  Bed<2> bed(sets::box(2, {4.0, 4.0, 0.0}, {false, false, false}), {{1.0, 2.0, 0.0}, {1.99, 2.0, 0.0}}, 0.5, 2,
             Uniform(1));
  const std::size_t other = bed.cast.numbers[0] == 0 ? 1 : 0, own = 1 - other;  // own: number 0
  const double n_x = own == 0 ? -1.0 : 1.0;                                     // from the other to the own
  SphereRest rest;
  rest.add(0, {{0, bed.branch(own, other), {0.0, 0.3, 0.0}, {0.0, 0.0, 0.02}}});
  rest.recall(bed.step, bed.cast.set(), bed.cast.chunks);
  const SphereChunk& chunk = bed.cast.chunks[0];
  ASSERT_EQ(chunk.touches.size(), 1u);
  EXPECT_EQ(chunk.touches[0], 1);
  EXPECT_NEAR(chunk.memory[0], -0.3 * n_x / tangential, 1e-15);
  EXPECT_NEAR(chunk.memory[SphereChunk::batch], -0.02 / (tangential * 0.25), 1e-15);
}

template <int Dim>
void give_and_take() {
  auto bed = regular<Dim>();
  Uniform random(13);
  // Every second pair of neighbours has a contact, known by the one or by the other of the two, and half of the floor.
  std::map<std::pair<std::uint32_t, std::uint32_t>, RestingContact> given;  // by number; as the lower number sees it
  std::vector<RestingContact> contacts;
  for (std::size_t i = 0; i < bed.cast.all; ++i)
    for (std::size_t j = 0; j < bed.cast.all; ++j) {
      const std::uint32_t a = bed.cast.numbers[i], b = bed.cast.numbers[j];
      if (a >= b || bed.cast.distance(i, j) > 1.01 || (a + b) % 2 != 0) continue;
      const RestingContact c = contact(a, bed.branch(i, j), Dim, random);
      given.emplace(std::pair{a, b}, c);
      const bool by_other = random(0, 1) < 0.5;
      contacts.push_back(by_other ? RestingContact{b, -1.0 * c.branch, -1.0 * c.force, -1.0 * c.torque} : c);
    }
  const std::size_t pairs = given.size();
  for (std::size_t i = 0; i < bed.cast.all; ++i)
    if (const double height = bed.place(i)[Dim - 1]; height < 0.6 && bed.cast.numbers[i] % 2 == 0) {
      Vec3 down{};
      down[Dim - 1] = -height;
      const RestingContact c = contact(bed.cast.numbers[i], down, Dim, random);
      given.emplace(std::pair{bed.cast.numbers[i], 0xffffffffu}, c);
      contacts.push_back(c);
    }
  ASSERT_GT(pairs, 10u);
  ASSERT_GT(given.size(), pairs);
  // Someone who is no longer there is left out.
  contacts.push_back({3, {0.2, 0.3, 0.0}, {1.0, 1.0, 0.0}, {}});
  SphereRest rest;
  rest.add(0, contacts);
  rest.recall(bed.step, bed.cast.set(), bed.cast.chunks);
  const auto taken = bed.all_contacts();
  EXPECT_EQ(taken.size(), given.size());
  for (const RestingContact& c : taken) {
    const auto same = std::find_if(given.begin(), given.end(), [&](const auto& g) {
      return g.second.sphere == c.sphere && norm(g.second.branch - c.branch) < 1e-12;
    });
    ASSERT_NE(same, given.end()) << "of sphere " << c.sphere;
    EXPECT_LT(norm(c.force - same->second.force), 1e-12);
    EXPECT_LT(norm(c.torque - same->second.torque), 1e-12);
    given.erase(same);
  }
  // It forgets what it gave: another search finds the memory with the pairs.
  auto fresh = regular<Dim>();
  rest.recall(fresh.step, fresh.cast.set(), fresh.cast.chunks);
  EXPECT_TRUE(fresh.all_contacts().empty());
}
TEST(SphereRest, WhatIsGivenIsReadAgainInAPlane) { give_and_take<2>(); }
TEST(SphereRest, WhatIsGivenIsReadAgainInSpace) { give_and_take<3>(); }

/// Two chunks that both have a pair have the same bits, and tell of it once.
TEST(SphereRest, BothChunksOfAPairHaveItsSlip) {
  auto bed = regular<2>(4);
  Uniform random(19);
  std::vector<RestingContact> contacts;
  std::size_t shared = 0;
  for (std::size_t i = 0; i < bed.cast.all; ++i)
    for (std::size_t j = 0; j < bed.cast.all; ++j)
      if (bed.cast.numbers[i] < bed.cast.numbers[j] && bed.cast.distance(i, j) < 1.01) {
        contacts.push_back(contact(bed.cast.numbers[i], bed.branch(i, j), 2, random));
        shared += bed.cast.chunk_of(i) != bed.cast.chunk_of(j);
      }
  SphereRest rest;
  rest.add(0, contacts);
  rest.recall(bed.step, bed.cast.set(), bed.cast.chunks);
  EXPECT_EQ(bed.all_contacts().size(), contacts.size());
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<double>> slips;
  for (const SphereChunk& chunk : bed.cast.chunks)
    for (std::size_t at = 0; at < chunk.a.size(); ++at)
      if (chunk.a[at] < bed.cast.all && bed.cast.distance(chunk.a[at], chunk.b[at]) < 1.01)
        slips[{chunk.a[at], chunk.b[at]}].push_back(
            chunk.memory[at / SphereChunk::batch * SphereChunk::batch * bed.numbers + at % SphereChunk::batch]);
  std::size_t twice = 0;
  for (const auto& [pair, slip] : slips) {
    twice += slip.size() == 2;
    for (const double s : slip) {
      EXPECT_EQ(s, slip[0]);
      EXPECT_NE(s, 0.0);
    }
  }
  EXPECT_EQ(twice, shared);
  EXPECT_GT(shared, 5u);
}

/// `first` and `count` choose the spheres of a phase; numbers are those within it.
TEST(SphereRest, TellsOfTheSpheresOfAPhase) {
  auto bed = regular<2>();
  Uniform random(23);
  std::vector<RestingContact> contacts;
  for (std::size_t i = 0; i < bed.cast.all; ++i)
    for (std::size_t j = 0; j < bed.cast.all; ++j)
      if (bed.cast.numbers[i] < bed.cast.numbers[j] && bed.cast.distance(i, j) < 1.01 && bed.cast.numbers[i] >= 5)
        contacts.push_back(contact(bed.cast.numbers[i] - 5, bed.branch(i, j), 2, random));
  SphereRest rest;
  rest.add(5, contacts);
  rest.recall(bed.step, bed.cast.set(), bed.cast.chunks);
  const auto own = contacts_at_rest(bed.step, bed.cast.set(), bed.cast.chunks, 5, 4);
  const auto expected = std::count_if(contacts.begin(), contacts.end(), [](const auto& c) { return c.sphere < 4; });
  EXPECT_GT(expected, 1);
  EXPECT_EQ(static_cast<std::ptrdiff_t>(own.size()), expected);
  for (const RestingContact& c : own) EXPECT_LT(c.sphere, 4u);
}

}  // namespace
}  // namespace barchan::sphere_rest_test
