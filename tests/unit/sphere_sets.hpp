// Spheres for tests of their search: records, numbers and chunks as the model of the grains has them, and the pairs of
// a chunk as a set that does not depend on their order.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <map>
#include <utility>
#include <vector>

#include "models/grains/sphere_search.hpp"
#include "unit/particle_sets.hpp"

namespace barchan::sets {

/// One set of spheres: the moving ones first, `chunk_size` of them a chunk, then those that never move.
template <int Dim>
struct SphereCast {
  using R = SphereRecord<Dim>;
  static constexpr std::size_t numbers_of_a_pair = Dim == 2 ? 1 : 3;

  Bounds bounds;
  std::vector<double> records, places;
  std::vector<std::uint32_t> numbers;
  std::vector<std::uint8_t> kinds;
  std::vector<std::uint32_t> laws;  // by kind and kind
  std::vector<SphereChunk> chunks;
  std::size_t moving = 0, all = 0, number_of_kinds = 1;
  double reach = 0.0;  // m, the largest sum of radii

  /// Radii (m) between `least` and `most`; kinds go round among `number_of_kinds`; two of the last kind never touch.
  SphereCast(const Bounds& b, const std::vector<Vec3>& x, std::size_t fixed, double least, double most,
             std::size_t kinds_of_spheres, std::size_t chunk_size, Uniform& random)
      : bounds(b), moving(x.size() - fixed), all(x.size()), number_of_kinds(kinds_of_spheres) {
    records.assign((all + 2) * R::size, 0.0);
    for (std::size_t k = 0; k < all; ++k) {
      for (std::size_t d = 0; d < Dim; ++d) records[k * R::size + d] = x[k][d];
      records[k * R::size + R::radius] = random(least, most);
      kinds.push_back(static_cast<std::uint8_t>(k % number_of_kinds));
    }
    for (std::size_t k = all; k < all + 2; ++k)
      for (std::size_t d = 0; d < Dim; ++d) records[k * R::size + d] = 1e6 * static_cast<double>(k);
    kinds.insert(kinds.end(), 2, std::uint8_t{0});
    reach = 2.0 * most;
    for (std::uint32_t k = 0; k < all + 2; ++k) numbers.push_back(k);
    for (std::size_t k = moving; k > 1; --k)  // lasting numbers in another order than the places in memory
      std::swap(numbers[k - 1], numbers[static_cast<std::size_t>(random(0.0, static_cast<double>(k)))]);
    for (std::size_t p = 0; p < number_of_kinds; ++p)
      for (std::size_t q = 0; q < number_of_kinds; ++q)
        laws.push_back(number_of_kinds > 1 && p == q && p + 1 == number_of_kinds
                           ? SphereSearch::none
                           : static_cast<std::uint32_t>(std::min(p, q)));
    for (std::size_t k = 0; k < moving; k += chunk_size) {
      SphereChunk& chunk = chunks.emplace_back();
      chunk.begin = k;
      chunk.end = std::min(k + chunk_size, moving);
    }
    take_places();
  }

  /// Gives the spheres diameters of all orders of magnitude from `least` on (m): as many of each, up to the reach.
  void spread_sizes(double least, Uniform& random) {
    for (std::size_t k = 0; k < all; ++k)
      records[k * R::size + R::radius] = 0.5 * least * std::pow(reach / least, random(0.0, 1.0));
  }
  SphereSizes sizes() const {
    SphereSizes of(reach);
    for (std::size_t k = 0; k < all; ++k) of.add(radius(k), k < moving);
    return of;
  }

  void take_places() {
    places.resize(all * Dim);
    for (std::size_t k = 0; k < all; ++k)
      for (std::size_t d = 0; d < Dim; ++d) places[k * Dim + d] = records[k * R::size + d];
  }
  SphereSet set() const {
    SphereSet s;
    s.dimensions = Dim;
    s.records = records.data();
    s.moving = moving;
    s.all = all;
    s.numbers = numbers.data();
    s.kinds = kinds.data();
    s.places = places.data();
    return s;
  }
  double radius(std::size_t k) const { return records[k * R::size + R::radius]; }
  /// The distance (m) of two spheres, of their nearest images, from these coordinates (by sphere, all axes).
  double distance(const double* x, std::size_t stride, std::size_t i, std::size_t j) const {
    double r2 = 0.0;
    for (std::size_t d = 0; d < Dim; ++d) {
      double apart = x[i * stride + d] - x[j * stride + d];
      const double period = bounds.high[d] - bounds.low[d];
      if (bounds.periodic[d]) apart -= period * std::round(apart / period);
      r2 += apart * apart;
    }
    return std::sqrt(r2);
  }
  double distance(std::size_t i, std::size_t j) const { return distance(records.data(), R::size, i, j); }
  std::uint32_t law(std::size_t i, std::size_t j) const { return laws[kinds[i] * number_of_kinds + kinds[j]]; }
  std::size_t chunk_of(std::size_t k) const { return k / (chunks[0].end - chunks[0].begin); }

  /// What a list says of a pair.
  struct Listed {
    std::uint32_t law;
    double weight;
    friend bool operator==(const Listed&, const Listed&) = default;
    friend void PrintTo(const Listed& l, std::ostream* out) { *out << "law " << l.law << " weight " << l.weight; }
  };
  using Pairs =
      std::map<std::pair<std::uint32_t, std::uint32_t>, Listed>;  // by place in memory, the first of a pair first

  /// The pairs that a chunk lists. Fails where one stands in it twice, or where its padding is not the two far away.
  Pairs listed(const SphereChunk& chunk) const {
    Pairs found;
    for (const auto& group : chunk.groups)
      for (std::size_t at = group.first * SphereChunk::batch; at < group.end * SphereChunk::batch; ++at) {
        const std::uint32_t a = chunk.a[at], b = chunk.b[at];
        if (a == all && b == all + 1) continue;
        EXPECT_TRUE(a < all && b < all) << a << " " << b;
        EXPECT_TRUE(found.emplace(std::pair{a, b}, Listed{group.law, group.weight}).second)
            << "twice: " << a << " " << b;
      }
    return found;
  }
  /// The naive twin: looks at every sphere for each of a chunk. `near(i, j)`: whether the pair belongs into the list.
  template <class F>
  Pairs expected(std::size_t c, F&& near) const {
    Pairs pairs;
    for (std::size_t i = chunks[c].begin; i < chunks[c].end; ++i)
      for (std::size_t j = 0; j < all; ++j) {
        if (i == j || law(i, j) == SphereSearch::none || !near(i, j)) continue;
        const bool first = numbers[i] < numbers[j], alone = j >= moving || chunk_of(j) == c;
        const auto a = static_cast<std::uint32_t>(first ? i : j), b = static_cast<std::uint32_t>(first ? j : i);
        pairs.emplace(std::pair{a, b}, Listed{law(i, j), alone ? 1.0 : 0.5});
      }
    return pairs;
  }
};

}  // namespace barchan::sets
