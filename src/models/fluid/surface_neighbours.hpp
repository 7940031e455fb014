// What walks over the rows of a pair list read of a fluid's free surface: of its particles, of their images and, on
// several ranks, of ghosts.
#pragma once

#include <array>
#include <cstring>
#include <vector>

#include "engine/cell_grid.hpp"
#include "engine/entry_of_list.hpp"
#include "engine/pair_list.hpp"
#include "state/particles.hpp"

namespace barchan {

/// Place, wholeness and `surface_normal` of what a list names. It is valid until particles move or are sorted.
template <std::size_t Dim>
class SurfaceNeighbours {
 public:
  /// `ghosts` keeps what other ranks send; without ranks it is not touched. All ranks must come here together.
  SurfaceNeighbours(const PhaseParticles& fluid, const CellGrid& grid, std::vector<double>& ghosts)
      : grid_(grid), ghosts_(ghosts), own_(fluid.size()), shared_(grid.is_shared()) {
    columns_[Dim] = fluid.column(Field::wholeness);
    for (std::size_t d = 0; d < Dim; ++d) {
      columns_[d] = fluid.column(Field::position, static_cast<int>(d));
      columns_[Dim + 1 + d] = fluid.column(Field::surface_normal, static_cast<int>(d));
    }
    if (shared_) take_ghosts();
  }

  bool shared() const { return shared_; }

  /// f(b, r) for every neighbour of the row that is `asked`(b) for and nearer than the root of `within2` (m2) to the
  /// place x: r = x - x_b (m). b names it in the calls below; on several ranks numbers from the fluid's own on are
  /// ghosts.
  template <class Asked, class F>
  void each(PairList::Row row, const std::array<double, Dim>& x, double within2, Asked&& asked, F&& f) const {
    const std::size_t dummy = own_ + grid_.images();
    for (const std::uint32_t* q = row.begin; q != row.end; ++q) {
      const std::size_t index = *q / PairList::stride;
      if (index == dummy) continue;
      const auto entry = look_up<Dim>(index, grid_, own_);
      const std::size_t b = shared_ && index >= own_ ? index : entry.source;
      if (!asked(b)) continue;
      std::array<double, Dim> r;
      double square = 0.0;
      for (std::size_t d = 0; d < Dim; ++d) {
        r[d] = x[d] - value(b, d) - entry.shift[d];
        square += r[d] * r[d];
      }
      if (square < within2) f(b, r);
    }
  }

  double wholeness(std::size_t b) const { return value(b, Dim); }
  double normal(std::size_t b, std::size_t d) const { return value(b, Dim + 1 + d); }

 private:
  static constexpr std::size_t width = 2 * Dim + 1;

  double value(std::size_t b, std::size_t c) const {
    return shared_ && b >= own_ ? ghosts_[(b - own_) * width + c] : columns_[c][b];
  }

  void take_ghosts() {
    if (ghosts_.size() < grid_.images() * width) ghosts_.resize(grid_.images() * width);
    grid_.fill_ghosts(
        width * sizeof(double),
        [&](const Image& image, std::byte* item) {
          std::array<double, width> values{};
          for (std::size_t c = 0; c < width; ++c) values[c] = columns_[c][image.source];
          std::memcpy(item, values.data(), sizeof values);
        },
        [&](std::size_t ghost, const std::byte* item) {
          std::memcpy(ghosts_.data() + ghost * width, item, width * sizeof(double));
        });
  }

  const CellGrid& grid_;
  std::vector<double>& ghosts_;
  std::size_t own_;
  bool shared_;
  std::array<const double*, width> columns_{};
};

}  // namespace barchan
