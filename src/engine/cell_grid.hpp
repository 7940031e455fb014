// Cells of one phase: particles sorted by cell, periodic images as particles of their own.
//
// A padded grid of cells covers the domain and `halo` cells beyond it on every side. Cells divide a periodic side
// exactly, so a halo cell there holds the shifted images of one interior cell, in the same order. Interior cells are
// walked in strips `strip` cells wide, which keeps the neighbours of a particle near in memory in large scenes.
// After sort() the particles of a cell are contiguous, in the order of their ids; images follow behind the last
// particle. So the order of the storage, of the lists and of every sum follows from places and ids alone.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "base/aligned.hpp"
#include "base/ranks.hpp"
#include "engine/division.hpp"
#include "engine/shared_cells.hpp"
#include "state/particles.hpp"

namespace barchan {

/// Where particles may be, and which sides are periodic.
struct Bounds {
  int dimensions = 2;
  Vec3 low{}, high{};  // m; periodic sides: the period
  std::array<bool, 3> periodic{false, false, false};
};

/// Blocks of the domain, each wider than any search: particles within reach stand in the same or adjacent blocks. The
/// cells of every grid divide them.
struct Blocks {
  std::array<std::size_t, 3> count{1, 1, 1};
  std::array<double, 3> side{1, 1, 1};  // m
  std::size_t size() const { return count[0] * count[1] * count[2]; }
};

/// Particles begin .. end-1 stand in (cells centred in) one block.
struct BlockRun {
  std::uint32_t begin, end, block;
};

class CellGrid {
 public:
  static constexpr int strip = 16;                        // cells
  static constexpr std::size_t most_cells = 0xffff0000u;  // cells are numbered in 32 bits

  /// `reach` (m): the largest search radius over this phase's particles, skin included. `cell` (m): the least cell
  /// size, unless a block is smaller. `most`: cells become larger than that until they are no more than this, so that
  /// an empty domain costs no memory.
  CellGrid(const Bounds& bounds, double cell, double reach, const Blocks& blocks, std::size_t most = most_cells);

  /// Wraps positions into the periodic domain, sorts the phase by cell and makes the images. Positions outside the
  /// bounds of a non-periodic side are put into the outermost cells. Allocates nothing once warm. On several ranks
  /// particles change their rank; divided by the number of particles, cells do where a rank has too many.
  void sort(PhaseParticles& particles, Division division = Division::particles);

  /// The runs of a block, as sorted last, side by side.
  std::span<const BlockRun> runs(std::size_t block) const {
    return {runs_by_block_.data() + first_run_[block], first_run_[block + 1] - first_run_[block]};
  }

  std::size_t cells() const { return begin_.size(); }
  std::size_t images() const { return images_.size(); }
  /// Of a grid that is not shared: how many particles were sorted.
  std::size_t particles() const { return walk_.empty() ? 0 : end_[walk_.back()]; }
  const std::vector<Image>& image_list() const { return images_; }
  const std::array<double, 3>& period() const { return period_; }

  /// Single-precision positions less low(), particles then images, as the search reads them.
  const float* search_position(int axis) const { return search_[static_cast<std::size_t>(axis)].data(); }

  /// Number of the padded cell of a search position.
  std::size_t cell_of(const std::array<float, 3>& x) const {
    std::size_t cell = 0;
    for (std::size_t d = dimensions_; d-- > 0;)
      cell = cell * count_[d] + static_cast<std::size_t>(cell_coordinate(x[d], d));
    return cell;
  }
  /// Number of the cell of a particle as sorted last.
  std::uint32_t cell_of_particle(std::size_t k) const {
    std::size_t cell = 0;
    for (std::size_t d = dimensions_; d-- > 0;) {
      int c = cell_coordinate(search_[d][k], d);
      if (bounds_.periodic[d]) c = std::clamp(c, halo_[d], static_cast<int>(count_[d]) - halo_[d] - 1);
      cell = cell * count_[d] + static_cast<std::size_t>(c);
    }
    return static_cast<std::uint32_t>(cell);
  }

  /// Calls f(begin, end) for runs of candidates (particles, then images) that cover all balls of radius `radius` about
  /// points of the box from `low` to `high`.
  template <class F>
  void candidates(const std::array<float, 3>& low, const std::array<float, 3>& high, float radius, F&& f) const {
    std::array<int, 3> first{0, 0, 0}, last{0, 0, 0};
    for (std::size_t d = 0; d < dimensions_; ++d) {
      first[d] = cell_coordinate(low[d] - radius, d);
      last[d] = cell_coordinate(high[d] + radius, d);
    }
    std::uint32_t begin = 0, end = 0;
    for (int z = first[2]; z <= last[2]; ++z) {
      const float dz = dimensions_ == 3 ? gap(z, 2, low[2], high[2]) : 0.0f;
      for (int y = first[1]; y <= last[1]; ++y) {
        // The ball's breadth in this row of cells (in two dimensions no gain).
        if (dimensions_ == 3) {
          const float dy = gap(y, 1, low[1], high[1]), left = radius * radius - dy * dy - dz * dz;
          if (left <= 0.0f) continue;
          const float breadth = std::sqrt(left);
          first[0] = cell_coordinate(low[0] - breadth, 0);
          last[0] = cell_coordinate(high[0] + breadth, 0);
        }
        const std::size_t row = (static_cast<std::size_t>(z) * count_[1] + static_cast<std::size_t>(y)) * count_[0];
        // Cells of a row are contiguous up to the end of their strip.
        for (int c = first[0]; c <= last[0];) {
          const int stop = std::min(last[0], strip_last_[static_cast<std::size_t>(c)]);
          const std::uint32_t b = begin_[row + static_cast<std::size_t>(c)],
                              e = end_[row + static_cast<std::size_t>(stop)];
          c = stop + 1;
          if (b == e) continue;
          if (b == end) {
            end = e;
          } else {
            if (begin != end) f(begin, end);
            begin = b;
            end = e;
          }
        }
      }
    }
    if (begin != end) f(begin, end);
  }

  // Of a run on several ranks (engine/cell_ranks.cpp). All ranks call these together.

  /// Whether this rank has cells of its own and ghosts in the others; image_list() then knows no sources.
  bool is_shared() const { return shared_ != nullptr; }
  /// The first sort, of the particles that every rank has made: keeps those of the cells of this rank alone. Ghosts are
  /// missing.
  void sort_and_share(PhaseParticles& particles);
  /// The first sort, of particles of which each rank has made some: brings them to the ranks in whose cells they are.
  /// Ghosts are missing.
  void sort_pieces(PhaseParticles& particles);
  /// Before a sort of a shared grid: cuts the walk so that each rank has about the same sum of weights, and brings the
  /// particles to their new ranks. `weights`: of the particles of this rank, by their places.
  void divide(PhaseParticles& particles, const std::vector<std::int64_t>& weights);
  /// Null: not shared.
  const CellOwners* owners() const { return shared_.get(); }
  /// Makes ghosts in the marked cells, those beyond periodic sides among them.
  void take_ghosts(const std::vector<char>& needed);
  /// Sends an item of `width` bytes for every ghost that other ranks have of this one's particles: pack(image, item)
  /// makes it, place(number of the image, item) takes what has come.
  template <class Pack, class Place>
  void fill_ghosts(std::size_t width, Pack&& pack, Place&& place) const;
  /// On several ranks: the places of the sources of the ghosts (m), by axis. `particles`: of the grid.
  void take_places(const PhaseParticles& particles, std::array<std::vector<double>, 3>& ghosts) const;
  /// The way back: pack(number of the image, item) of this rank's ghosts, place(source, item) where they come from.
  template <class Pack, class Place>
  void return_ghosts(std::size_t width, Pack&& pack, Place&& place) const;
  /// From now on archive() saves what a checkpoint of one process holds: each rank its own particles as rows, and the
  /// first rank all else (engine/cell_checkpoint.cpp).
  void gather();
  void forget_gathered() { whole_.reset(); }

  // What decides who owns what (engine/cell_owners.cpp). A run on several ranks and a plan of one ask the same.

  /// Cuts the walk between rows of strips so that each rank has about the same number of the particles as sorted last.
  /// The grid is not shared.
  CellOwners divided(std::size_t ranks) const;
  /// The same for about equal sums of the weights that the rows of strips have, in the order of the walk.
  CellOwners divided(const std::vector<std::int64_t>& weights, std::size_t ranks) const;
  /// Where the rows of strips begin in the walk, and its end.
  std::vector<std::uint32_t> rows_of_strips() const;
  /// Particles of each rank. The grid is not shared.
  std::vector<std::size_t> particles_by_rank(const CellOwners& owners) const;
  /// The rank that owns the cell of a search position; of one beyond periodic sides that of the cell it repeats.
  std::int32_t rank_of(const std::array<float, 3>& x, const CellOwners& owners) const;
  /// Marks, by padded cell, the cells that a search of this radius (m) looks into about the particles that `rank` has
  /// of `about` by its owners.
  void mark(const CellGrid& about, const CellOwners& owners, std::int32_t rank, float reach,
            std::vector<char>& needed) const;
  /// The same about those particles of a phase, whole on every rank, whose row is the rank's by `owners`.
  void mark(const CellGrid& about, const std::vector<std::int32_t>& owners, std::int32_t rank, float reach,
            std::vector<char>& needed) const;
  /// f(block, rank, cell) for each walked cell, rank by rank.
  template <class F>
  void each_block(const CellOwners& owners, F&& f) const {
    for (std::size_t r = 0; r < owners.ranks(); ++r)
      for (std::size_t w = owners.first[r]; w < owners.first[r + 1]; ++w)
        f(std::size_t{walk_block_[w]}, static_cast<std::int32_t>(r), walk_[w]);
  }
  /// f(cell, source, owner) for each marked cell whose particles are ghosts of the rank: those of the cell `source`,
  /// which is its own where the cell repeats it beyond a periodic side.
  template <class F>
  void each_ghost_cell(const CellOwners& owners, std::int32_t rank, const std::vector<char>& needed, F&& f) const {
    for (std::size_t c = 0; c < begin_.size(); ++c) {
      if (needed[c] == 0 || owners.owner[c] == rank) continue;
      const auto cell = static_cast<std::uint32_t>(c);
      const std::uint32_t source = owners.owner[c] >= 0 ? cell : halo_cells_[halo_number(cell)].source;
      f(cell, source, owners.owner[source]);
    }
  }
  /// Particles in a cell, as sorted last.
  std::size_t count(std::uint32_t cell) const { return end_[cell] - begin_[cell]; }
  /// The cell of each particle as sorted last, in their order. The grid is not shared.
  std::vector<std::uint32_t> cells_of_particles() const;

  std::size_t bytes() const;
  /// Of it, of what is of all cells of the domain, on every rank.
  std::size_t bytes_of_cells() const;

  /// Where the particles stood when they were sorted last, so that lists can be made anew as they were.
  void archive(Archive& a);
  /// Loads of what one process had, or all ranks together, the cells, and of the phase the particles in the cells of
  /// this rank, whatever ranks there were. PhaseParticles::archive() has found them. Ghosts are missing.
  void load_share(Archive& a, PhaseParticles& particles);

 private:
  /// A cell beyond a periodic side.
  struct HaloCell {
    std::uint32_t cell, source;
    std::array<std::int8_t, 3> shift;
  };

  /// Cell of a position relative to low() in the padded grid, clamped to it.
  int cell_coordinate(float x, std::size_t axis) const {
    const float c = x * inverse_cell_[axis] + static_cast<float>(halo_[axis]);
    const auto last = static_cast<float>(count_[axis] - 1);
    const float inside = c > 0.0f ? c : 0.0f;  // NaN too
    return static_cast<int>(inside < last ? inside : last);
  }
  /// Distance along an axis from a cell to the interval low .. high, a little less for rounding. The outermost cells
  /// hold all that lies beyond them.
  float gap(int cell, std::size_t axis, float low, float high) const {
    if (cell == 0 || cell == static_cast<int>(count_[axis]) - 1) return 0.0f;
    const float side = side_[axis], begin = static_cast<float>(cell - halo_[axis]) * side;
    return std::max(std::max(begin - high, low - (begin + side)) - 1.0e-3f * side, 0.0f);
  }
  double divide(double cell, double reach, const Blocks& blocks);
  void order_interior(const Blocks& blocks);
  void make_room(std::size_t particles);
  void count_cells(PhaseParticles& particles);
  void find_order(const PhaseParticles& particles);
  std::array<double*, 3> positions_of(PhaseParticles& particles) const;
  std::uint32_t find_cell(const std::array<double*, 3>& x, std::size_t k) const;
  std::array<std::size_t, 2> take_own_cells();
  void find_halo();
  void find_cells(PhaseParticles& particles);
  void place_cells();
  void fill_cells(const std::vector<std::int64_t>& id);
  void make_runs();
  void make_images(const PhaseParticles& particles);
  void fit_search(std::size_t particles, std::size_t room, std::size_t used);
  // of a run on several ranks
  template <class Of>
  std::vector<std::int64_t> by_row(Of&& of_cell) const;
  std::vector<std::int64_t> particles_by_row() const;
  void own_by_first(CellOwners& owners) const;
  void migrate(PhaseParticles& particles, Division division);
  void move_to_owners(PhaseParticles& particles);
  void fill_places(PhaseParticles& particles, const std::vector<std::uint32_t>& leavers, std::size_t kept);
  void balance();
  void make_own_images(const PhaseParticles& particles);
  void mark_box(const std::array<float, 3>& low, const std::array<float, 3>& high, std::vector<char>& needed) const;
  std::size_t halo_number(std::uint32_t cell) const;
  SharedCells::Question ask_owners(const std::vector<char>& needed);
  std::size_t place_ghosts(const SharedCells::Question& question);
  const std::vector<std::uint32_t>& cells_at_border(float reach) const;
  void bring_search_positions(const SharedCells::Question& question, std::size_t n);
  void answer(const std::vector<std::uint32_t>& asked, const std::vector<std::size_t>& asked_counts);
  std::array<std::size_t, 2> own_walk() const;
  void save_whole(Archive& a);
  void place_whole(const std::vector<std::uint32_t>& by_cell, SharedCells::Whole& whole) const;

  std::size_t dimensions_;
  Bounds bounds_;
  std::array<double, 3> period_{};
  std::array<int, 3> halo_{0, 0, 0};
  std::array<std::size_t, 3> count_{1, 1, 1};  // cells of the padded grid
  std::array<float, 3> inverse_cell_{}, side_{};
  std::vector<std::uint32_t> begin_, end_;  // by padded cell
  std::vector<int> strip_last_;             // by x of a padded cell: the last one of its strip
  std::vector<std::uint32_t> walk_;         // interior cells in the order of the sort
  std::vector<std::uint32_t> walk_block_;   // block of each walked cell
  std::vector<HaloCell> halo_cells_;
  std::vector<BlockRun> runs_, runs_by_block_;
  std::vector<std::uint32_t> first_run_;  // by block
  std::vector<std::uint32_t> cell_of_, order_;
  std::vector<Image> images_;
  std::array<AlignedVector<float>, 3> search_;
  std::unique_ptr<SharedCells> shared_;  // null: all cells are this process' own
  std::optional<SharedCells::Whole> whole_;
};

template <class Pack, class Place>
void CellGrid::fill_ghosts(std::size_t width, Pack&& pack, Place&& place) const {
  SharedCells& s = *shared_;
  const SharedCells::OwnImages& own = s.own_images;
  const std::size_t away = s.sends.size() - own.count, come = s.slots.size() - own.count;
  if (s.out.size() < away * width) s.out.resize(away * width);
  if (s.in.size() < s.slots.size() * width) s.in.resize(s.slots.size() * width);
  const auto behind = [](std::size_t k, std::size_t first, std::size_t count) { return k < first ? k : k + count; };
#pragma omp parallel for schedule(static)
  for (std::int64_t k = 0; k < static_cast<std::int64_t>(away); ++k) {
    const auto i = static_cast<std::size_t>(k);
    pack(s.sends[behind(i, own.sends, own.count)], s.out.data() + i * width);
  }
  // While they are on their way: images of this rank's own particles.
  const auto fill_own = [&] {
    std::byte* const items = s.in.data() + come * width;
#pragma omp parallel for schedule(static)
    for (std::int64_t k = 0; k < static_cast<std::int64_t>(own.count); ++k) {
      const auto i = static_cast<std::size_t>(k);
      pack(s.sends[own.sends + i], items + i * width);
      place(std::size_t{s.slots[own.slots + i]}, items + i * width);
    }
  };
  ranks::active()->exchange_beside(s.out.data(), s.away_counts, s.in.data(), s.come_counts, width, fill_own);
#pragma omp parallel for schedule(static)
  for (std::int64_t k = 0; k < static_cast<std::int64_t>(come); ++k) {
    const auto i = static_cast<std::size_t>(k);
    place(std::size_t{s.slots[behind(i, own.slots, own.count)]}, s.in.data() + i * width);
  }
}

template <class Pack, class Place>
void CellGrid::return_ghosts(std::size_t width, Pack&& pack, Place&& place) const {
  SharedCells& s = *shared_;
  if (s.out.size() < s.sends.size() * width) s.out.resize(s.sends.size() * width);
  if (s.in.size() < s.slots.size() * width) s.in.resize(s.slots.size() * width);
  for (std::size_t k = 0; k < s.slots.size(); ++k) pack(std::size_t{s.slots[k]}, s.in.data() + k * width);
  ranks::active()->exchange(s.in.data(), s.receive_counts, s.out.data(), s.send_counts, width);
  for (std::size_t k = 0; k < s.sends.size(); ++k) place(std::size_t{s.sends[k].source}, s.out.data() + k * width);
}

}  // namespace barchan
