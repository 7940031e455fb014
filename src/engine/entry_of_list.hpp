// From an entry of a pair list to the particle behind it.
#pragma once

#include <array>

#include "engine/cell_grid.hpp"

namespace barchan {

/// A particle that a list names: itself, or its image, which stands `shift` (m) beside it.
template <std::size_t Dim>
struct ListedParticle {
  std::size_t source;
  std::array<double, Dim> shift;
};

/// `index`: of a list (a listed number over PairList::stride), not the dummy's. `particles`: of the phase.
template <std::size_t Dim>
ListedParticle<Dim> look_up(std::size_t index, const CellGrid& grid, std::size_t particles) {
  ListedParticle<Dim> entry{index, {}};
  if (index >= particles) {
    const Image& image = grid.image_list()[index - particles];
    entry.source = image.source;
    for (std::size_t d = 0; d < Dim; ++d) entry.shift[d] = image.shift[d] * grid.period()[d];
  }
  return entry;
}

}  // namespace barchan
