// How the particles of a loop are shared out among threads whose work is uneven.
#pragma once

#include <omp.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>

namespace barchan {

/// The numbers 0 .. n-1 in pieces. Each thread takes the pieces of its own share, the same part of the particles in
/// every loop and step, so that they stay in its core's cache; then it helps the others, piece by piece. Two cores that
/// write each other's particles lose more by fetching lines than by waiting. For loops that gather, whose results do
/// not depend on who does what:
///   Shares shares(n, 64);
///   #pragma omp parallel
///   for (const std::int64_t k : shares) ...
class Shares {
 public:
  Shares(std::int64_t n, std::int64_t piece)
      : n_(n),
        piece_(piece),
        pieces_((n + piece - 1) / piece),
        count_(std::min<std::int64_t>(omp_get_max_threads(), most)) {
    for (std::int64_t share = 0; share < count_; ++share)
      next_[static_cast<std::size_t>(share)].piece.store(first(share), std::memory_order_relaxed);
  }

  /// The numbers that the calling thread gets.
  class Walk {
   public:
    explicit Walk(Shares& shares) : shares_(&shares), share_(omp_get_thread_num() % shares.count_) { take(); }
    std::int64_t operator*() const { return k_; }
    Walk& operator++() {
      if (++k_ == end_) take();
      return *this;
    }
    struct End {};
    bool operator!=(End) const { return k_ < end_; }

   private:
    void take() {
      for (; visited_ < shares_->count_; ++visited_, share_ = (share_ + 1) % shares_->count_) {
        const std::int64_t piece =
            shares_->next_[static_cast<std::size_t>(share_)].piece.fetch_add(1, std::memory_order_relaxed);
        if (piece >= shares_->first(share_ + 1)) continue;
        k_ = piece * shares_->piece_;
        end_ = std::min(k_ + shares_->piece_, shares_->n_);
        return;
      }
      k_ = end_ = 0;
    }
    Shares* shares_;
    std::int64_t share_, visited_ = 0;  // visited: shares in which nothing is left
    std::int64_t k_ = 0, end_ = 0;
  };
  Walk begin() { return Walk(*this); }
  static Walk::End end() { return {}; }

 private:
  static constexpr std::int64_t most = 64;  // shares; with more threads than that, several begin with the same
  struct alignas(64) Next {
    std::atomic<std::int64_t> piece;
  };
  std::int64_t first(std::int64_t share) const { return pieces_ * share / count_; }

  std::int64_t n_, piece_, pieces_, count_;
  std::array<Next, static_cast<std::size_t>(most)> next_;
};

}  // namespace barchan
