// Which spheres may touch before the next search: pairs with a gap below the slack, each in the chunks of its spheres.
#pragma once

#include <array>
#include <span>

#include "engine/cell_grid.hpp"
#include "models/grains/sphere_pairs.hpp"

namespace barchan {

class SphereSearch {
 public:
  static constexpr std::uint32_t none = SphereCells::none;

  /// A side of the domain that holds spheres: of which kind the wall is.
  struct Side {
    std::uint16_t axis;
    std::int16_t sign;
    double place;
    std::uint8_t kind;
  };

  /// `reach` (m): the largest sum of radii; `laws`: by kind and kind, `none` where two do not touch.
  void prepare(const Bounds& bounds, double reach, std::size_t kinds, std::vector<std::uint32_t> laws,
               std::vector<Side> sides, std::size_t numbers_of_a_pair);
  /// Room for what packings of `all` spheres need, so that later searches seldom allocate. `sleep`: some may.
  void reserve(std::size_t all, std::span<SphereChunk> chunks, bool sleep);

  /// Before find(): takes the memory out of the pairs (ContactMemory::keep). `before`: numbers of the spheres when the
  /// chunks were filled last.
  void keep(std::size_t begin, std::size_t end, std::size_t all, std::span<const SphereChunk> chunks,
            const std::uint32_t* before) {
    memory_.keep(begin, end, all, chunks, before);
  }
  /// Between the two, on several ranks (ContactMemory::share).
  void share(const std::vector<std::uint32_t>& ranks) { memory_.share(ranks); }
  void join() { memory_.join(); }
  /// Between the two: spheres have other numbers, or are gone (ContactMemory::renumber).
  void renumber(const std::vector<std::uint32_t>& to, std::size_t all, std::vector<std::uint32_t>& left_alone) {
    memory_.renumber(to, all, left_alone);
  }
  /// Fills the chunks with the pairs nearer than `slack` (m), of those that sleep too, with the memory that was kept.
  /// Allocates only to grow.
  void find(const SphereSet& spheres, double slack, std::span<SphereChunk> chunks);

  /// Sorts all spheres by their places into cells as wide as a search with `slack` (m): find() does, and loading must.
  void sort(const SphereSet& spheres, double slack);
  const SphereCells& cells() const { return cells_; }
  std::span<const Side> sides() const { return sides_; }
  /// What contacts remember, and its description.
  const ContactMemory& memory() const { return memory_; }

  /// An order of `count` spheres in which neighbours are near, in blocks of cells; x by axis.
  void order(const std::array<const double*, 3>& x, const std::vector<std::int64_t>& id,
             std::vector<std::uint32_t>& order);

 private:
  void make_room_for_threads();
  void place(const SphereSet& spheres, SphereChunk& chunk, const std::vector<FoundPair>& found) const;
  void place_sides(const SphereSet& spheres, double slack, SphereChunk& chunk) const;

  Bounds bounds_;
  double reach_ = 0.0;
  std::size_t kinds_ = 0;
  std::vector<std::uint32_t> laws_;
  std::vector<Side> sides_;

  SphereCells cells_;
  std::vector<std::uint32_t> cell_of_, begin_, order_;
  AlignedVector<double> sorted_[4];  // x y z r, in the order of cells
  ContactMemory memory_;
  std::vector<std::vector<FoundPair>> found_;  // by thread
};

}  // namespace barchan
