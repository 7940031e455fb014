// How the ranks of a run share the cells of one grid. Each rank owns a piece of the walk through the cells, cut between
// rows of a strip: so the particles of all ranks, one rank after another, stand in the order of one process, and the
// cells of a row that are contiguous in one process are so here too. Cells of other ranks and beyond periodic sides
// hold ghosts: images whose sources may stand on any rank, this one too.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/aligned.hpp"
#include "state/archive.hpp"

namespace barchan {

/// One periodic image: particle `source` of the phase, moved by `shift` periods.
struct Image {
  std::uint32_t source;
  std::array<std::int8_t, 3> shift;
  std::int8_t none = 0;  // a checkpoint has every byte: none is without a value
  bool shifted() const { return shift[0] != 0 || shift[1] != 0 || shift[2] != 0; }
};

/// Which rank owns which cells of a grid.
struct CellOwners {
  /// Divided by particles, a rank that has so many times the mean gives some away at the next sort.
  static constexpr double imbalance = 1.1;
  static bool must_rebalance(std::size_t most, std::size_t total, std::size_t ranks) {
    return static_cast<double>(most) * static_cast<double>(ranks) > imbalance * static_cast<double>(total);
  }

  std::vector<std::uint32_t> first;  // by rank: where its cells begin in the walk, and its end
  std::vector<std::int32_t> owner;   // by padded cell: rank; of cells beyond periodic sides none
  std::size_t ranks() const { return first.size() - 1; }
};

struct SharedCells : CellOwners {
  // Search positions (m) of the images of own particles beyond periodic sides, by halo cell.
  std::array<std::vector<float>, 3> image_search;
  std::vector<std::uint32_t> image_begin;
  // What this rank sends when images are filled, by rank, and where what comes belongs.
  std::vector<Image> sends;
  std::vector<std::size_t> send_counts, receive_counts;  // by rank
  std::vector<std::uint32_t> slots;
  std::vector<std::byte> out, in;  // buffers
  /// Of them, images of own particles beyond periodic sides, which no message brings: where they begin in `sends` and
  /// in `slots`. The counts without them, by rank.
  struct OwnImages {
    std::size_t sends = 0, slots = 0, count = 0;
  } own_images;
  std::vector<std::size_t> away_counts, come_counts;
  /// Finds them from what is sent and received; `rank`: this one.
  void sort_out_own_images(std::size_t rank);
  /// Own cells with cells of others, or beyond periodic sides, no more than `border_width` cells away along each axis,
  /// in the order of the walk; found again when the division has changed.
  std::vector<std::uint32_t> border, border_of;  // border_of: `first` as it was then
  int border_width = -1;

  /// Cells that this rank asks others for, and cells that others ask of it.
  struct Question {
    std::vector<std::uint32_t> ask, asked;              // cells, by the rank that is asked, that asks
    std::vector<std::size_t> ask_counts, asked_counts;  // by rank
    std::vector<std::uint32_t> numbers;                 // of particles in the cells of `ask`
  };

  /// What a checkpoint holds of the grid of one process.
  struct Whole {
    Rows rows;  // particles
    // On the first rank:
    std::vector<std::uint32_t> begin, end;
    std::vector<Image> images;
    std::array<std::vector<float>, 3> beyond;  // search positions (m) behind those of the particles
  };
};

}  // namespace barchan
