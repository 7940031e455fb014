// The neighbours of all particles: grids of all phases and lists of all entries, made anew when a list may lack a pair.
#pragma once

#include <array>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "engine/cell_grid.hpp"
#include "engine/pair_list.hpp"
#include "engine/rank_halo.hpp"

namespace barchan {

/// One direction of an entry of the matrix: the particles of `a` look for those of `b`.
struct Direction {
  std::size_t a = 0, b = 0;  // phase numbers
  double radius = 0.0;       // m
};

class RankLoad;

class Neighbours {
 public:
  /// So many cells and blocks a particle, and no fewer than so many in all: more than any domain has that is a
  /// twentieth full.
  static constexpr std::size_t cells_a_particle = 16, least_cells = std::size_t{1} << 22;
  static constexpr std::size_t blocks_a_particle = 4, least_blocks = std::size_t{1} << 16;

  /// `spacings` (m): of the particles, by phase. `padding`: of the rows of all lists. `skin`: lists reach this fraction
  /// beyond an entry's radius, so that they stay valid while particles move. `particles`: of all phases; an empty
  /// domain has cells and blocks for so many and not for its size.
  Neighbours(const Bounds& bounds, std::vector<Direction> directions, double skin, const std::vector<double>& spacings,
             std::size_t padding = simd::width_in_use<double>(), std::size_t particles = CellGrid::most_cells);
  ~Neighbours();
  Neighbours(Neighbours&&) noexcept;
  Neighbours& operator=(Neighbours&&) noexcept;

  /// On several ranks: how cells are divided from the next sort on; at first by the number of particles.
  void divide_by(Division division) { division_ = division; }
  Division division() const { return division_; }
  /// What the steps cost this rank; who makes them says when they begin and end.
  RankLoad& load() { return *load_; }
  const RankLoad& load() const { return *load_; }

  /// From now on the skin follows the motion: as wide as makes searching and the pairs in it cheapest together, at most
  /// as wide as given. It depends on positions alone, like everything here.
  void adapt_skin() { adapts_ = true; }
  double skin() const { return skin_; }

  /// Sorts and searches if a pair may have come within reach since the last time, or if `force`. Returns whether it
  /// did; then particles have new places. The decision depends on positions alone. `beside` is called after a sort,
  /// once, by one thread, while the others search: for work that only reads the new places.
  bool update(std::vector<PhaseParticles>& particles, bool force, const std::function<void()>& beside = {});

  const PairList& list(std::size_t direction) const { return lists_[direction]; }
  const CellGrid& grid(std::size_t phase) const { return *grids_[phase]; }
  bool has_grid(std::size_t phase) const { return grids_[phase] != nullptr; }
  long rebuilds() const { return rebuilds_; }
  std::size_t bytes() const;

  /// The epoch of the lists. Loading searches again among the places of the last sort: the same lists.
  /// On several ranks `whole` says that it is that of all ranks together, as one process has it: to load it, each rank
  /// takes the cells and particles of its share; to save it, gather() has been called.
  void archive(Archive& a, std::vector<PhaseParticles>& particles, bool whole = false);
  void gather();
  void forget_gathered();
  /// On several ranks, of a phase that is whole on every one of them and looks for particles of one that is shared out:
  /// by particle, the rank that has its neighbours of all phases; its rows are empty on the others. Else empty.
  const std::vector<std::int32_t>& owners(std::size_t phase) const { return owners_[phase]; }

  // For a plan (engine/neighbour_owners.cpp), in a run of one process that has made lists.

  /// Who of so many ranks would own the cells of each phase, after a sort of what stands there now; none of a phase
  /// that is `whole` or has no cells.
  std::vector<std::optional<CellOwners>> divided(std::size_t ranks, const std::vector<bool>& whole) const;
  /// Divides those phases anew of which a rank has too many particles (CellOwners::imbalance).
  void rebalance(std::vector<std::optional<CellOwners>>& owners) const;
  /// By rank: particles and ghosts of a phase with owners.
  std::vector<RankHalo> halo_of(std::size_t phase, const std::vector<std::optional<CellOwners>>& owners) const;
  /// By the other rank: the blocks whose displacements a rank sends it in every step, and receives from it. A rank
  /// receives of the blocks in and beside those of its own cells: two particles that no list holds come within the
  /// radius in the same or adjacent blocks first, and the rank of either looks at both. `cells`: owners by phase; null:
  /// it is whole.
  std::map<std::int32_t, SharedBlocks> shared_blocks(const std::vector<const CellOwners*>& cells,
                                                     std::int32_t rank) const;

 private:
  /// Blocks are at least this many of the widest searches wide: narrow ones follow the shear of the flow closely, but
  /// in wide ones particles may go further before blocks that are not adjacent matter.
  static constexpr double block_width = 1.5;

  /// Displacements since the last sort: bounds of their components.
  struct Range {
    std::array<float, 3> low, high;
    void clear();
    void widen(const Range& other);
  };
  void choose_skin();
  static double apart(const Range& a, const Range& b);
  bool still_valid(const std::vector<PhaseParticles>& particles);
  template <std::size_t Dim>
  void measure(const PhaseParticles& particles, std::size_t phase);
  bool has_moved(std::size_t phase) const;
  double work_of(std::size_t phase, std::size_t particles) const;
  std::vector<std::int64_t> weights_of(std::size_t phase, std::size_t particles, double unit) const;
  void divide_anew(std::vector<PhaseParticles>& particles);
  void share(std::vector<PhaseParticles>& particles);
  void find_owners();
  std::vector<const CellOwners*> cell_owners() const;
  std::vector<std::vector<std::int32_t>> owners_of_whole(const std::vector<const CellOwners*>& cells) const;
  void mark(std::size_t b, std::int32_t rank, const std::vector<const CellOwners*>& cells,
            const std::vector<std::vector<std::int32_t>>& whole, std::vector<char>& needed) const;
  void take_ghosts();
  int places_beside(std::size_t axis, long at, std::array<long, 3>& out) const;
  std::size_t watched() const { return watched_.empty() ? blocks_.size() : watched_.size(); }
  std::size_t watched(std::size_t number) const { return watched_.empty() ? number : watched_[number]; }
  void mark_beside(std::size_t block, std::vector<char>& near) const;
  void find_watched();
  void widen_by_ranks(Range& all);
  void search(const std::vector<PhaseParticles>& particles, const std::function<void()>& beside);

  Bounds bounds_;
  std::vector<Direction> directions_;
  std::vector<std::unique_ptr<CellGrid>> grids_;  // null for a phase without entries
  std::vector<PairList> lists_;
  std::vector<std::vector<std::int32_t>> owners_;  // by phase
  std::vector<PairList::Search> searches_;         // by list, of the last update
  struct Chunk {
    std::size_t list, number;
  };
  std::vector<Chunk> chunks_;  // of all lists
  Blocks blocks_;
  std::vector<std::vector<Range>> ranges_;  // by phase, block
  std::vector<std::size_t> watched_;        // blocks of this rank's particles, and those it receives; none: all blocks
  // On several ranks: what is told in every step, for these pieces of the walks, and where it is told.
  std::map<std::int32_t, SharedBlocks> shared_blocks_;
  std::vector<std::vector<std::uint32_t>> shared_for_;
  std::vector<Range> sent_, received_;
  std::vector<std::size_t> send_counts_, receive_counts_;  // by rank
  std::size_t padding_;
  double skin_, widest_skin_, widest_ = 0.0;  // widest: search with the widest skin (m)
  bool adapts_ = false;
  Division division_ = Division::particles;
  std::unique_ptr<RankLoad> load_;
  long rebuilds_ = 0, kept_ = 0;  // kept: steps that the lists have lived
};

}  // namespace barchan
