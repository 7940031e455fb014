// The neighbours of one phase's particles among another's, for one entry of the matrix.
//
// A full list: a pair of two particles of one phase stands in both their rows. Rows are padded to whole SIMD vectors
// with the index of a dummy record that contributes nothing, so pair loops have no tails and no masks. Rows are kept
// in chunks of `chunk` particles, each in its own buffer: threads build chunks independently and the result does not
// depend on how many there are.
#pragma once

#include <cstdint>
#include <vector>

#include "base/aligned.hpp"
#include "engine/cell_grid.hpp"
#include "simd/vec.hpp"

namespace barchan {

class PairList {
 public:
  static constexpr std::size_t chunk = 512;  // particles
  /// A neighbour is listed as `stride` times its index: where its record begins in an array of records of that size.
  static constexpr std::uint32_t stride = 8;
  /// The largest index that can be listed in 32 bits: 2^29 - 1.
  static constexpr std::size_t last_index = 0xffffffffu / stride;

  /// The index of the dummy record behind `particles` and `images`. Throws SceneError when a list cannot hold it.
  static std::uint32_t dummy_index(std::size_t particles, std::size_t images);

  /// The rows of `chunk` particles.
  struct Chunk {
    AlignedVector<std::uint32_t> index;
    std::vector<std::uint32_t> begin;
    std::uint64_t entries = 0;
  };
  struct Row {
    const std::uint32_t* begin;
    const std::uint32_t* end;
  };

  /// What a list is of: for each of `size_a` particles of `grid_a`, the particles and images of `grid_b` within
  /// `radius` (m), itself left out when `same` says that both are one phase. `dummy`: the index that pads rows.
  struct Search {
    const CellGrid* grid_a;
    std::size_t size_a;
    const CellGrid* grid_b;
    bool same;
    double radius;
    std::uint32_t dummy;
    int dimensions;
    const std::int32_t* ranks = nullptr;  // by particle of `a`: whose row it is; others have no row. Null: all have one
    std::int32_t own_rank = 0;
  };

  /// Makes room for the rows of `size_a` particles, padded to multiples of `padding`, a power of two; returns the
  /// number of their chunks. The list is whole when build_chunk has been called for each, by any thread, in any order.
  std::size_t prepare(std::size_t size_a, std::size_t padding);
  void build_chunk(const Search& search, std::size_t number);
  /// To be called by all threads before their first chunk: on a busy machine one may get that many steps later.
  static void make_scratch(int dimensions);

  Row row(std::size_t k) const {
    const auto& c = chunks_[k / chunk];
    const std::size_t r = k % chunk;
    return {c.index.data() + c.begin[r], c.index.data() + c.begin[r + 1]};
  }
  std::size_t padding() const { return padding_; }
  std::uint64_t entries() const;  ///< listed neighbours (those in the skin too, padding not)
  std::uint64_t padded_entries() const;
  std::size_t bytes() const;

 private:
  std::vector<Chunk> chunks_;
  std::size_t padding_ = simd::width_in_use<double>();
};

BARCHAN_PER_INSTRUCTION_SET(search_chunk,
                            /// The search of PairList::build_chunk.
                            void search_chunk(PairList::Chunk& rows, const PairList::Search& what, std::size_t number,
                                              std::size_t padding);)
BARCHAN_PER_INSTRUCTION_SET(make_search_scratch,
                            /// That of PairList::make_scratch.
                            void make_search_scratch(int dimensions);)

}  // namespace barchan
