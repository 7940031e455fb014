// Which spheres may touch before the next search: pairs with a gap below the slack, each in the chunks of its spheres.
#pragma once

#include <array>
#include <span>

#include "engine/cell_grid.hpp"
#include "models/grains/sphere_work.hpp"

namespace barchan {

/// The spheres that are searched.
struct SphereSet {
  int dimensions = 2;
  const double* records = nullptr;         // SphereRecord
  std::size_t moving = 0, all = 0;         // the moving come first; two far away follow after all
  const std::uint32_t* numbers = nullptr;  // lasting, in the order of ids
  const std::uint8_t* kinds = nullptr;     // row and column in the table of laws
};

class SphereSearch {
 public:
  static constexpr std::uint32_t none = 0xffffffffu;

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

  /// Fills the chunks with the pairs nearer than `slack` (m), with the memory that they had. `before`: numbers of the
  /// spheres when the chunks were filled last. Allocates only to grow.
  void find(const SphereSet& spheres, double slack, std::vector<SphereChunk>& chunks, const std::uint32_t* before);

  /// An order of `count` spheres in which neighbours are near, in blocks of cells; x by axis.
  void order(const std::array<const double*, 3>& x, std::size_t count, std::vector<std::uint32_t>& order);

 private:
  struct Kept {
    std::uint32_t number, with;  // of both
    double memory[6];
  };
  struct Found {
    std::uint32_t a, b, key;
  };

  void sort(const SphereSet& spheres, double slack);
  void keep(const SphereSet& spheres, const std::vector<SphereChunk>& chunks, const std::uint32_t* before);
  void fill(const SphereSet& spheres, double slack, SphereChunk& chunk, std::vector<Found>& found) const;
  void place(const SphereSet& spheres, SphereChunk& chunk, const std::vector<Found>& found) const;
  void place_sides(const SphereSet& spheres, double slack, SphereChunk& chunk) const;
  const double* memory_of(std::uint32_t number, std::uint32_t with) const;
  std::size_t coordinate(double x, std::size_t axis) const;

  Bounds bounds_;
  double reach_ = 0.0;
  std::size_t kinds_ = 0, numbers_ = 0;
  std::vector<std::uint32_t> laws_;
  std::vector<Side> sides_;

  std::array<std::size_t, 3> count_{1, 1, 1};
  std::array<double, 3> inverse_cell_{}, period_{};
  std::vector<std::uint32_t> cell_of_, begin_, order_;
  AlignedVector<double> sorted_;  // x y z r, in the order of cells
  std::vector<std::uint32_t> kept_begin_;
  std::vector<Kept> kept_;
  std::vector<std::vector<Found>> found_;  // by thread
};

}  // namespace barchan
