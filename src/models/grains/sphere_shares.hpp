// The spheres of a run on several ranks. Every rank holds all of them, but the work of contacts is shared out: a rank
// has the lists of pairs of its chunks, which stand side by side, and makes their steps.
//
// A pair of spheres of two ranks stands in the lists of both, as in the lists of two chunks of one process, and both
// compute the same bits. So a rank needs the records of its own spheres and of those that meet them in a pair. All
// ranks find the same pairs: who tells whom what follows from the lists and is asked of nobody.
#pragma once

#include <algorithm>
#include <span>
#include <utility>
#include <vector>

#include "engine/exchange.hpp"
#include "models/grains/sphere_work.hpp"

namespace barchan {

class SphereShares {
 public:
  /// Divides the chunks, as equally as their number allows. Where they are fewer than the ranks, each rank has all.
  void divide(std::span<const SphereChunk> chunks, Exchange::Share own);
  /// Whether other ranks have chunks that this one has not.
  bool on() const { return chunks_.size() > 2; }
  bool has_chunk(std::size_t chunk) const { return chunk >= chunks_[own_] && chunk < chunks_[own_ + 1]; }
  bool has(std::size_t sphere) const { return sphere >= begin() && sphere < end(); }
  /// The own spheres that move.
  std::size_t begin() const { return spheres_[own_]; }
  std::size_t end() const { return spheres_[own_ + 1]; }
  template <class Chunk>
  std::span<Chunk> own(std::span<Chunk> all) const {
    return all.subspan(chunks_[own_], chunks_[own_ + 1] - chunks_[own_]);
  }
  /// Where the own chunks begin among all.
  std::size_t first_chunk() const { return chunks_[own_]; }
  /// How many chunks each rank has; which of the spheres from `first` to `end` (places in memory).
  std::vector<std::size_t> chunks_of_ranks() const;
  std::vector<std::size_t> spheres_of_ranks(std::size_t first, std::size_t end) const;
  /// The rank that has a sphere that moves.
  std::size_t rank_of(std::size_t sphere) const;

  /// From the lists of the own chunks: which pairs have a sphere of another rank.
  void find(std::span<const SphereChunk> chunks);
  /// The own chunk has got a pair of an own sphere and one of another rank.
  void meet(std::uint32_t own, std::uint32_t other, std::size_t chunk);
  /// Calls f with each own chunk that may have a pair with a sphere of another rank.
  template <class F>
  void each_chunk_with(std::uint32_t other, F&& f) const {
    const auto before = [](const Meeting& m, std::uint32_t sphere) { return m.other < sphere; };
    for (auto m = std::lower_bound(meetings_.begin(), meetings_.end(), other, before);
         m != meetings_.end() && m->other == other; ++m)
      f(std::size_t{m->chunk});
  }
  /// Calls f with each sphere of other ranks whose record is told.
  template <class F>
  void each_told(F&& f) const {
    for (const auto& spheres : hears_)
      for (const std::uint32_t k : spheres) f(std::size_t{k});
  }
  /// How many spheres each rank is told.
  std::vector<std::size_t> told() const;

  /// The records of spheres in pairs of two ranks go to those ranks: places, velocities, and spins where spheres turn.
  void tell(int dimensions, bool turn, double* records);
  /// Every rank gets the same of all spheres that move; `places_alone`: places only.
  void tell_all(int dimensions, bool turn, bool places_alone, double* records);
  /// Columns of spheres side by side become those of all ranks, in one message; `counts`: spheres of each rank.
  void gather_together(std::span<double* const> columns, const std::vector<std::size_t>& counts);
  /// Numbers that tell() sends of a sphere.
  static std::size_t width(int dimensions, bool turn) {
    const auto axes = static_cast<std::size_t>(dimensions);
    return 2 * axes + (!turn ? 0u : axes == 2 ? 1u : 3u);
  }

 private:
  struct Meeting {
    std::uint32_t other, chunk;
    bool operator==(const Meeting&) const = default;
    bool operator<(const Meeting& m) const { return std::pair(other, chunk) < std::pair(m.other, m.chunk); }
  };
  void count();

  std::size_t own_ = 0;                                         // this rank among those that share
  std::vector<std::size_t> chunks_{0, 0}, spheres_{0, 0};       // where those of each rank begin; one more
  std::vector<Meeting> meetings_;                               // in order
  std::vector<std::vector<std::uint32_t>> tells_, hears_;       // spheres by rank, in order
  std::vector<std::size_t> send_counts_, receive_counts_;       // by rank
  std::vector<std::pair<std::uint32_t, std::uint32_t>> found_;  // ranks and own spheres, of find()
  AlignedVector<double> sent_, come_;
};

}  // namespace barchan
