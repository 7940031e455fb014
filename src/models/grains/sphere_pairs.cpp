#include "models/grains/sphere_pairs.hpp"

#include <bit>

#include "engine/pair_loop.hpp"

namespace barchan::BARCHAN_TARGET {

namespace {

constexpr int width = std::min(Lanes::width, static_cast<int>(SphereCells::padding));
using V = simd::Vec<double, width>;

/// The cells about a place, along an axis: the first and how many.
struct Span {
  std::size_t low = 0, many = 1;
};

Span about(const SphereCells& cells, const SphereLevel& of, double x, std::size_t axis) {
  const std::size_t c = cells.coordinate(of, x, axis), n = of.count[axis];
  if (cells.period[axis] > 0.0) return {n < 3 ? 0 : (c + n - 1) % n, std::min<std::size_t>(3, n)};
  const std::size_t low = c > 0 ? c - 1 : 0;
  return {low, std::min(c + 2, n) - low};
}

template <int Dim, bool Images>
void pairs(const SphereCells& cells, const SphereSet& s, double slack, const SphereChunk& chunk,
           std::vector<FoundPair>& found) {
  using R = SphereRecord<Dim>;
  constexpr double magic = 6755399441055744.0;  // rounds to whole numbers
  found.clear();
  V period[Dim], turns[Dim];
  for (std::size_t d = 0; d < Dim; ++d) {
    period[d] = V(cells.period[d]);
    turns[d] = V(cells.period[d] > 0.0 ? 1.0 / cells.period[d] : 0.0);
  }
  for (std::size_t k = chunk.begin; k < chunk.end; ++k) {
    const double* r = s.records + k * R::size;
    const std::uint32_t number = s.numbers[k];
    const std::uint32_t* laws = cells.laws + s.kinds[k] * cells.kinds;
    const V own(r[R::radius]), gap(slack);
    V x[Dim];
    for (std::size_t d = 0; d < Dim; ++d) x[d] = V(r[d]);
    const auto add = [&](std::uint32_t j, bool near) {
      const std::uint32_t law = laws[s.kinds[j]];
      const bool inside = j >= chunk.begin && j < chunk.end;
      if (law == SphereCells::none || j == k || (inside && s.numbers[j] < number)) return;
      const bool first = number < s.numbers[j], fixed = j >= s.moving;
      const auto own_place = static_cast<std::uint32_t>(k), a = first ? own_place : j, b = first ? j : own_place;
      const std::uint32_t key = law * 4 + (inside || fixed ? 0u : 2u);
      if constexpr (!Images) {
        found.push_back({a, b, key + (near ? 0u : 1u), 0});
      } else {
        const double touch = r[R::radius] + s.records[j * R::size + R::radius];
        each_image<Dim>(s.records + a * R::size, s.records + b * R::size, cells.period, touch + slack,
                        [&](std::uint32_t image, double apart2) {
                          found.push_back({a, b, key + (apart2 < touch * touch ? 0u : 1u), image});
                        });
      }
    };
    const auto look = [&](std::uint32_t begin, std::uint32_t end) {
      for (std::uint32_t q = begin; q < end; q += width) {
        V r2(0.0);
        for (std::size_t d = 0; d < Dim; ++d) {
          V apart = x[d] - V::load(cells.sorted[d] + q);
          apart = fnma(fma(apart, turns[d], V(magic)) - V(magic), period[d], apart);
          r2 = fma(apart, apart, r2);
        }
        const V touch = own + V::load(cells.sorted[3] + q), reach = touch + gap;
        const std::uint32_t left = end - q < width ? (1u << (end - q)) - 1u : (1u << width) - 1u;
        const std::uint32_t near = to_bits(r2 < touch * touch);
        for (std::uint32_t bits = to_bits(r2 < reach * reach) & left; bits != 0; bits &= bits - 1) {
          const auto lane = static_cast<std::uint32_t>(std::countr_zero(bits));
          add(cells.order[q + lane], near >> lane & 1u);
        }
      }
    };
    const auto look_about = [&](const SphereLevel& of) {
      const Span sx = about(cells, of, r[0], 0), sy = about(cells, of, r[1], 1),
                 sz = Dim == 3 ? about(cells, of, r[2], 2) : Span{};
      for (std::size_t dz = 0; dz < sz.many; ++dz)
        for (std::size_t dy = 0; dy < sy.many; ++dy) {
          const std::size_t row =
              of.first + ((sz.low + dz) % of.count[2] * of.count[1] + (sy.low + dy) % of.count[1]) * of.count[0];
          const std::size_t end = sx.low + sx.many, inside = std::min(end, of.count[0]);
          look(cells.begin[row + sx.low], cells.begin[row + inside]);
          if (end > inside) look(cells.begin[row], cells.begin[row + end - inside]);
        }
    };
    const std::size_t level = cells.level_of(k);
    for (std::size_t m = 0; m <= level; ++m) look_about(cells.of_level[m]);
    for (std::size_t m = level + 1; m < cells.levels; ++m)
      cells.each_run<Dim>(cells.of_level[m], r, r[R::radius] + 0.5 * cells.of_level[m].largest + slack,
                          [&](std::size_t first, std::size_t end) { look(cells.begin[first], cells.begin[end]); });
  }
}

}  // namespace

void find_sphere_pairs(const SphereCells& cells, const SphereSet& spheres, double slack, const SphereChunk& chunk,
                       std::vector<FoundPair>& found) {
  const bool flat = spheres.dimensions == 2;
  if (spheres.images)
    flat ? pairs<2, true>(cells, spheres, slack, chunk, found) : pairs<3, true>(cells, spheres, slack, chunk, found);
  else
    flat ? pairs<2, false>(cells, spheres, slack, chunk, found) : pairs<3, false>(cells, spheres, slack, chunk, found);
}

}  // namespace barchan::BARCHAN_TARGET
