#include "engine/pair_list.hpp"

#include <array>

#include "simd/vec.hpp"

namespace barchan::BARCHAN_TARGET {

namespace {
using Chunk = PairList::Chunk;
constexpr std::size_t chunk = PairList::chunk;
constexpr std::uint32_t stride = PairList::stride;
constexpr int lanes = simd::native_width<float>;
using Floats = simd::Vec<float, lanes>;
using Indices = simd::Vec<std::int32_t, lanes>;

// Positions of the search are rounded to float; the radius is widened by more than that rounding.
constexpr double rounding_allowance = 1.0e-5;
}  // namespace

/// Candidates of a few particles that stand close together: positions and indices, copied side by side once for all of
/// them, padded to whole vectors with places out of reach.
template <int Dim>
class Candidates {
 public:
  void gather(const CellGrid& grid, const std::array<float, 3>& low, const std::array<float, 3>& high, float reach) {
    std::size_t n = 0;
    std::array<const float*, Dim> from;
    for (std::size_t d = 0; d < Dim; ++d) from[d] = grid.search_position(static_cast<int>(d));
    const Indices steps = Indices::iota() * Indices(static_cast<std::int32_t>(PairList::stride));
    grid.candidates(low, high, reach, [&](std::uint32_t begin, std::uint32_t end) {
      const std::size_t count = end - begin, room = n + count + 2 * lanes;
      if (index_.size() < room) {
        index_.resize(2 * room);
        for (auto& x : position_) x.resize(2 * room);
      }
      std::int32_t* indices = index_.data() + n;
      std::array<float*, Dim> to;
      for (std::size_t d = 0; d < Dim; ++d) to[d] = position_[d].data() + n;
      for (std::size_t j = 0; j < count; j += lanes) {
        const auto first = static_cast<std::int32_t>(PairList::stride * (begin + static_cast<std::uint32_t>(j)));
        (Indices(first) + steps).store(indices + j);
        for (std::size_t d = 0; d < Dim; ++d) Floats::load(from[d] + begin + j).store(to[d] + j);
      }
      n += count;
    });
    size_ = n;
    for (std::size_t k = n; k % lanes != 0; ++k) position_[0][k] = far_away;
  }
  /// Writes the indices of candidates within reach of x except `self`; returns the end. May write one vector beyond it.
  BARCHAN_SIMD_INLINE std::uint32_t* near(const std::array<float, 3>& x, Floats reach_squared, std::int32_t self,
                                          std::uint32_t* out) const {
    std::array<Floats, Dim> own;
    for (std::size_t d = 0; d < Dim; ++d) own[d] = Floats(x[d]);
    const Indices me(self);
    const std::int32_t* indices = index_.data();
    std::array<const float*, Dim> x_b;
    for (std::size_t d = 0; d < Dim; ++d) x_b[d] = position_[d].data();
    const std::size_t size = size_;
    for (std::size_t k = 0; k < size; k += lanes) {
      const Indices index = Indices::load(indices + k);
      Floats r2(0.0f);
      for (std::size_t d = 0; d < Dim; ++d) {
        const Floats dx = own[d] - Floats::load(x_b[d] + k);
        r2 = simd::fma(dx, dx, r2);
      }
      const auto other = simd::bit_cast_mask<float>(index != me);
      out += simd::compress_store(out, (r2 < reach_squared) & other, index);
    }
    return out;
  }
  std::size_t size() const { return size_; }

 private:
  static constexpr float far_away = 1e18f;
  std::size_t size_ = 0;
  AlignedVector<std::int32_t> index_ = AlignedVector<std::int32_t>(1024);
  std::array<AlignedVector<float>, Dim> position_ = filled();
  static std::array<AlignedVector<float>, Dim> filled() {
    std::array<AlignedVector<float>, Dim> p;
    for (auto& x : p) x.resize(1024);
    return p;
  }
};

/// One object for each thread, made at its first call.
template <int Dim>
Candidates<Dim>& own_candidates() {
  thread_local Candidates<Dim> candidates;
  return candidates;
}

template <int Dim>
void search_rows(Chunk& c, const PairList::Search& search, std::size_t number, std::size_t padding) {
  const CellGrid& grid_a = *search.grid_a;
  const auto reach = static_cast<float>(search.radius * (1.0 + rounding_allowance));
  const Floats reach_squared(reach * reach);
  const auto place = [&](std::size_t k) {
    std::array<float, 3> x{};
    for (std::size_t d = 0; d < Dim; ++d) x[d] = grid_a.search_position(static_cast<int>(d))[k];
    return x;
  };
  Candidates<Dim>& candidates = own_candidates<Dim>();
  const std::size_t first = number * chunk, last = std::min(first + chunk, search.size_a);
  if (c.begin.size() != last - first + 1) c.begin.resize(last - first + 1);
  if (c.index.empty()) c.index.resize(chunk * 8);
  std::uint32_t used = 0;
  c.entries = 0;
  for (std::size_t group = first; group < last;) {
    // Particles of one cell share their candidates.
    auto low = place(group), high = low;
    const auto cell = grid_a.cell_of(low);
    std::size_t end = group + 1;
    if (search.ranks && search.ranks[group] != search.own_rank) {
      c.begin[group - first] = used;
      group = end;
      continue;
    }
    for (; end < last && (!search.ranks || search.ranks[end] == search.own_rank); ++end) {
      const auto x = place(end);
      if (grid_a.cell_of(x) != cell) break;
      for (std::size_t d = 0; d < Dim; ++d) {
        low[d] = std::min(low[d], x[d]);
        high[d] = std::max(high[d], x[d]);
      }
    }
    candidates.gather(*search.grid_b, low, high, reach);
    const std::size_t room = used + (end - group) * (candidates.size() + 2 * lanes + padding);
    if (c.index.size() < room) c.index.resize(room + room / 2);
    std::uint32_t* out = c.index.data();
    for (; group < end; ++group) {
      c.begin[group - first] = used;
      const auto self =
          static_cast<std::int32_t>(stride * (search.same ? static_cast<std::uint32_t>(group) : search.dummy));
      const std::uint32_t* row_end = candidates.near(place(group), reach_squared, self, out + used);
      auto q = static_cast<std::uint32_t>(row_end - out);
      c.entries += q - used;
      while ((q & (padding - 1)) != 0) out[q++] = stride * search.dummy;
      used = q;
    }
  }
  c.begin[last - first] = used;
  // Head room, so that later lists of about this size allocate nothing.
  if (c.index.capacity() < used + used / 4 + 64) c.index.reserve(used + used / 2 + 64);
}

void search_chunk(PairList::Chunk& rows, const PairList::Search& what, std::size_t number, std::size_t padding) {
  if (what.dimensions == 2) search_rows<2>(rows, what, number, padding);
  else search_rows<3>(rows, what, number, padding);
}

void make_search_scratch(int dimensions) {
  if (dimensions == 2) own_candidates<2>();
  else own_candidates<3>();
}

}  // namespace barchan::BARCHAN_TARGET
