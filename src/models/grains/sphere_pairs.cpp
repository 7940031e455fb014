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

Span about(const SphereCells& cells, double x, std::size_t axis) {
  const std::size_t c = cells.coordinate(x, axis), n = cells.count[axis];
  if (cells.period[axis] > 0.0) return {n < 3 ? 0 : (c + n - 1) % n, std::min<std::size_t>(3, n)};
  const std::size_t low = c > 0 ? c - 1 : 0;
  return {low, std::min(c + 2, n) - low};
}

template <int Dim>
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
      const auto own_place = static_cast<std::uint32_t>(k);
      found.push_back(
          {first ? own_place : j, first ? j : own_place, law * 4 + (inside || fixed ? 0u : 2u) + (near ? 0u : 1u)});
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
    const Span sx = about(cells, r[0], 0), sy = about(cells, r[1], 1), sz = Dim == 3 ? about(cells, r[2], 2) : Span{};
    for (std::size_t dz = 0; dz < sz.many; ++dz)
      for (std::size_t dy = 0; dy < sy.many; ++dy) {
        const std::size_t row =
            ((sz.low + dz) % cells.count[2] * cells.count[1] + (sy.low + dy) % cells.count[1]) * cells.count[0];
        const std::size_t end = sx.low + sx.many, inside = std::min(end, cells.count[0]);
        look(cells.begin[row + sx.low], cells.begin[row + inside]);
        if (end > inside) look(cells.begin[row], cells.begin[row + end - inside]);
      }
  }
}

}  // namespace

void find_sphere_pairs(const SphereCells& cells, const SphereSet& spheres, double slack, const SphereChunk& chunk,
                       std::vector<FoundPair>& found) {
  if (spheres.dimensions == 2) pairs<2>(cells, spheres, slack, chunk, found);
  else pairs<3>(cells, spheres, slack, chunk, found);
}

}  // namespace barchan::BARCHAN_TARGET
