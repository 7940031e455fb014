#include "neighbours/pair_list.hpp"

#include <array>

#include "simd/vec.hpp"

namespace barchan {

namespace {
constexpr int lanes = simd::native_width<float>;
using Floats = simd::Vec<float, lanes>;
using Indices = simd::Vec<std::int32_t, lanes>;

// Positions of the search are rounded to float; the radius is widened by more than that rounding.
constexpr double rounding_allowance = 1.0e-5;
}  // namespace

template <int Dim>
void PairList::build_chunks(const CellGrid& grid_a, std::size_t size_a, const CellGrid& grid_b, bool same,
                            double radius, std::uint32_t dummy) {
  const auto reach = static_cast<float>(radius * (1.0 + rounding_allowance));
  const Floats reach_squared(reach * reach);
  const auto count = static_cast<std::int64_t>(chunks_.size());
#pragma omp parallel for schedule(dynamic, 1)
  for (std::int64_t number = 0; number < count; ++number) {
    Chunk& c = chunks_[static_cast<std::size_t>(number)];
    const std::size_t first = static_cast<std::size_t>(number) * chunk, last = std::min(first + chunk, size_a);
    if (c.begin.size() != last - first + 1) c.begin.resize(last - first + 1);
    if (c.index.empty()) c.index.resize(chunk * 8);
    std::uint32_t used = 0;
    c.entries = 0;
    for (std::size_t k = first; k < last; ++k) {
      c.begin[k - first] = used;
      std::array<float, 3> x{};
      for (int d = 0; d < Dim; ++d) x[static_cast<std::size_t>(d)] = grid_a.search_position(d)[k];
      const auto self = same ? static_cast<std::uint32_t>(k) : dummy;
      std::uint32_t row_end = used;
      grid_b.candidates(x, reach, [&](std::uint32_t begin, std::uint32_t end) {
        const std::size_t room = row_end + (end - begin) + 2 * lanes + padding;
        if (c.index.size() < room) c.index.resize(room + room / 2);
        std::uint32_t* out = c.index.data();
        for (std::uint32_t j = begin; j < end; j += lanes) {
          Floats r2(0.0f);
          for (int d = 0; d < Dim; ++d) {
            const Floats dx = Floats(x[static_cast<std::size_t>(d)]) - Floats::load(grid_b.search_position(d) + j);
            r2 = simd::fma(dx, dx, r2);
          }
          const auto near = (r2 < reach_squared) & simd::Mask<float, lanes>::first(static_cast<int>(end - j));
          const Indices index = Indices(static_cast<std::int32_t>(j)) + Indices::iota();
          row_end += static_cast<std::uint32_t>(simd::compress_store(out + row_end, near, index));
        }
      });
      std::uint32_t* out = c.index.data();
      if (same) {  // take the particle itself out
        for (std::uint32_t q = used; q < row_end; ++q)
          if (out[q] == self) {
            for (std::uint32_t s = q + 1; s < row_end; ++s) out[s - 1] = out[s];
            --row_end;
            break;
          }
      }
      c.entries += row_end - used;
      while (row_end % padding != 0) out[row_end++] = dummy;
      used = row_end;
    }
    c.begin[last - first] = used;
    // Head room, so that later lists of about this size allocate nothing.
    if (c.index.capacity() < used + used / 4 + 64) c.index.reserve(used + used / 2 + 64);
  }
}

void PairList::build(const CellGrid& grid_a, std::size_t size_a, const CellGrid& grid_b, bool same, double radius,
                     std::uint32_t dummy, int dimensions) {
  const std::size_t needed = (size_a + chunk - 1) / chunk;
  if (chunks_.size() != needed) chunks_.resize(needed);
  if (dimensions == 2) build_chunks<2>(grid_a, size_a, grid_b, same, radius, dummy);
  else build_chunks<3>(grid_a, size_a, grid_b, same, radius, dummy);
}

std::uint64_t PairList::entries() const {
  std::uint64_t total = 0;
  for (const auto& c : chunks_) total += c.entries;
  return total;
}

std::size_t PairList::bytes() const {
  std::size_t total = 0;
  for (const auto& c : chunks_) total += c.index.capacity() * 4 + c.begin.capacity() * 4;
  return total;
}

}  // namespace barchan
