// The particles of a fluid about the pieces of a border, on several ranks those of all.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "models/share_items.hpp"
#include "models/workspace.hpp"

namespace barchan {

/// Where a piece of a border stands: beside a particle of its solid.
struct PiecePlace {
  Vec3 particle;                // m
  std::array<float, 3> sorted;  // m, where that was when the particles were sorted, less the domain's lower corner
  Vec3 beside;                  // m, from the particle to the piece
};
/// `particle`: where it stands in the phase `solid`. `beside`: m.
PiecePlace piece_place(const Workspace& w, std::size_t solid, std::size_t particle, const Vec3& beside);

/// A particle of the fluid as a piece sees it.
struct BorderNeighbour {
  Vec3 from;                        // m, from the piece to it
  Vec3 velocity;                    // m/s
  double pressure;                  // Pa
  double share;                     // of it that counts (Spray::share)
  std::uint32_t piece, turn, cell;  // number of the piece; on several ranks what orders those of a piece (before())
};

/// Finds all that is within a radius of each piece and has moved no farther from the piece's particle than the widest
/// skin of the lists since the particles were sorted. Only particles are looked at, not the images of the grid: these
/// reach no farther than the lists.
///
/// On several ranks a piece belongs to the rank in whose cells of the fluid it stands. All ranks know all pieces; each
/// looks among its own particles and sends to the owners what their pieces see.
class BorderNeighbours {
 public:
  /// Of the phase `fluid`; `radius` in m.
  BorderNeighbours(const Layout& layout, std::size_t fluid, double radius);

  /// Before of(): the pieces as they stand now, the same on all ranks, which call this together. They must outlive the
  /// calls of of(), and the particles must stay where they are.
  void look_from(const Workspace& w, const std::vector<PiecePlace>& pieces);
  /// Whether of() may be asked for a piece on this rank; of one process for all.
  bool is_own(std::size_t piece) const { return owners_.empty() || owners_[piece] == own_rank_; }
  /// In the order of one process. Valid until this thread asks for those of another piece.
  const std::vector<BorderNeighbour>& of(std::size_t piece);
  /// Every rank gets the values of pieces that their owners have.
  template <class T>
  void share(std::vector<T>& values) const {
    share_items(owners_, 1, [&](std::size_t piece) { return &values[piece]; });
  }

 private:
  /// Those of one piece in one process: by periods of the domain, within them by cells, within a cell as sorted.
  static bool before(const BorderNeighbour& a, const BorderNeighbour& b) {
    return a.turn != b.turn ? a.turn < b.turn : a.cell < b.cell;
  }
  template <int Dim>
  void find(std::size_t piece, std::vector<BorderNeighbour>& found) const;
  void find(std::size_t piece, std::vector<BorderNeighbour>& found) const;
  // of a run on several ranks
  void find_owners();
  void exchange();

  std::size_t fluid_;
  double radius_, reach_;  // m; reach: with the widest skin
  const Workspace* w_ = nullptr;
  const std::vector<PiecePlace>* pieces_ = nullptr;
  std::vector<std::vector<BorderNeighbour>> found_;  // by thread
  // On several ranks; of one process empty.
  std::vector<std::int32_t> owners_;  // by piece
  std::int32_t own_rank_ = 0;
  std::vector<std::vector<BorderNeighbour>> of_others_;  // by piece, what its owner gets
  std::vector<BorderNeighbour> received_;                // by piece, in order
  std::vector<std::size_t> first_received_;              // by piece, and the end
};

}  // namespace barchan
