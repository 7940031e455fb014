// Which spheres may touch before the next search: pairs with a gap below the slack, each in the chunks of its spheres.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "engine/cell_grid.hpp"
#include "models/grains/sphere_pairs.hpp"

namespace barchan {

/// How many spheres there are of each order of magnitude: class c has diameters of 2^-c to 2^-(c+1) of the largest sum
/// of radii, class 0 the larger ones too, the last class the smaller ones.
class SphereSizes {
 public:
  static constexpr std::size_t classes = SphereCells::most_levels;
  explicit SphereSizes(double reach = 1.0) : reach_(reach) { largest[0] = reach; }
  std::size_t class_of(double radius) const {
    int halvings = 0;
    std::frexp(2.0 * radius / reach_, &halvings);
    return static_cast<std::size_t>(std::clamp(-halvings, 0, static_cast<int>(classes) - 1));
  }
  void add(double radius, bool moves) {
    const std::size_t c = class_of(radius);
    ++count[c];
    moving[c] += moves ? 1u : 0u;
    if (c > 0) largest[c] = std::max(largest[c], 2.0 * radius);
  }

  std::array<std::size_t, classes> count{}, moving{};
  std::array<double, classes> largest{};  // m, across the largest of the class; of class 0 the largest sum of radii

 private:
  double reach_;
};

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
  /// The spheres have these sizes: chooses the levels of the cells. Without it there is one. To be called where spheres
  /// were made or removed.
  void take_sizes(const SphereSizes& sizes);
  std::size_t levels() const { return cells_.levels; }
  /// m: the largest sum of radii where there is one level, else the harmonic mean of the diameters, so that the pairs
  /// nearer than a share of it are about that share more than those that touch.
  double scale() const { return scale_; }
  /// Whether a periodic axis is so narrow that two spheres may touch on both sides at once (pair_image).
  bool images() const { return images_; }
  /// m: the shortest periodic axis where images() is true, else no bound.
  double narrowest() const { return narrowest_; }
  /// Room for what packings of `all` spheres need, so that later searches seldom allocate. `sleep`: some may.
  void reserve(std::size_t all, std::span<SphereChunk> chunks, bool sleep);

  /// Before find(): takes the memory out of the pairs (ContactMemory::keep). `before`: numbers of the spheres when the
  /// chunks were filled last.
  /// `places`: of the spheres when the pairs were found, by all axes (m).
  void keep(std::size_t begin, std::size_t end, std::size_t all, std::span<const SphereChunk> chunks,
            const std::uint32_t* before, const double* places = nullptr) {
    memory_.keep(begin, end, all, chunks, before, images_ ? places : nullptr);
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
  static constexpr std::size_t most_keys = 256;  // four a law
  using Places = std::array<std::uint32_t, most_keys>;

  void make_room_for_threads();
  void divide(SphereLevel& level, std::size_t spheres, double slack);
  std::uint32_t add_groups(SphereChunk& chunk, std::span<const FoundPair> found, std::uint32_t at, Places& next) const;
  void place(const SphereSet& spheres, SphereChunk& chunk, std::vector<FoundPair>& found) const;
  void place_sides(const SphereSet& spheres, double slack, SphereChunk& chunk) const;

  Bounds bounds_;
  double reach_ = 0.0, scale_ = 0.0, narrowest_ = 1e300;
  bool images_ = false;
  SphereSizes sizes_;
  std::array<std::uint8_t, SphereSizes::classes> level_of_class_{};
  std::size_t kinds_ = 0;
  std::vector<std::uint32_t> laws_;
  std::vector<Side> sides_;

  SphereCells cells_;
  std::vector<std::uint32_t> cell_of_, begin_, order_;
  std::vector<std::uint8_t> level_;  // by sphere
  AlignedVector<double> sorted_[4];  // x y z r, in the order of cells
  ContactMemory memory_;
  std::vector<std::vector<FoundPair>> found_;  // by thread
};

}  // namespace barchan
