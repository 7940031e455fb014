// What the ranks of a run tell each other about the fluid at a border.
#include <algorithm>
#include <numeric>

#include "engine/exchange.hpp"
#include "models/coupling/border_neighbours.hpp"

namespace barchan {

void BorderNeighbours::find_owners() {
  const CellGrid& grid = w_->neighbours.grid(fluid_);
  own_rank_ = Exchange().rank();
  owners_.clear();
  for (const PiecePlace& piece : *pieces_) {
    std::array<float, 3> at = piece.sorted;
    for (std::size_t d = 0; d < at.size(); ++d) at[d] += static_cast<float>(piece.beside[d]);
    owners_.push_back(grid.rank_of(at, *grid.owners()));
  }
}

/// Each rank sends what it has about the pieces of others.
void BorderNeighbours::exchange() {
  const Exchange all;
  const auto count = static_cast<std::int64_t>(owners_.size());
  of_others_.resize(std::max(of_others_.size(), owners_.size()));
#pragma omp parallel for schedule(dynamic, 16)
  for (std::int64_t i = 0; i < count; ++i) {
    const auto piece = static_cast<std::size_t>(i);
    of_others_[piece].clear();
    if (!is_own(piece)) find(piece, of_others_[piece]);
  }
  const auto size = static_cast<std::size_t>(all.size());
  std::vector<std::size_t> ones(size, 1), sent(size, 0), coming(size, 0);
  for (std::size_t piece = 0; piece < owners_.size(); ++piece)
    sent[static_cast<std::size_t>(owners_[piece])] += of_others_[piece].size();
  all.exchange(sent.data(), ones, coming.data(), ones, sizeof(std::size_t));
  std::vector<BorderNeighbour> out;
  for (std::int32_t rank = 0; rank < all.size(); ++rank)
    for (std::size_t piece = 0; piece < owners_.size(); ++piece)
      if (owners_[piece] == rank) out.insert(out.end(), of_others_[piece].begin(), of_others_[piece].end());
  received_.resize(std::accumulate(coming.begin(), coming.end(), std::size_t{0}));
  all.exchange(out.data(), sent, received_.data(), coming, sizeof(BorderNeighbour));
  std::stable_sort(received_.begin(), received_.end(), [](const BorderNeighbour& a, const BorderNeighbour& b) {
    return a.piece != b.piece ? a.piece < b.piece : before(a, b);
  });
  first_received_.assign(owners_.size() + 1, 0);
  for (const BorderNeighbour& near : received_) ++first_received_[near.piece + 1];
  std::partial_sum(first_received_.begin(), first_received_.end(), first_received_.begin());
}

}  // namespace barchan
