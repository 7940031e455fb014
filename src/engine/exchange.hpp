// What the processes that share a run, its ranks, tell each other of numbers and lists while it goes on. It is the only
// way by which models reach other ranks; particles and records go with the cells (engine/neighbours.hpp). Where one
// process has all that counts, nothing is sent and a value stays as it is.
//
// Every call is made by all ranks, in the same order: what decides about a call must be the same on all of them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <string>
#include <utility>
#include <vector>

#include "base/ranks.hpp"
#include "engine/reproducible_sum.hpp"
#include "state/particles.hpp"

namespace barchan {

class Exchange {
 public:
  using Take = Communicator::Take;
  using Share = ranks::Share;
  using Sums = ranks::Sums;

  /// Among the ranks that share the particles out.
  Exchange() : all_(ranks::active()) {}
  /// Of what belongs to the particles of a phase: where every rank holds it whole, each has the same bits by itself.
  explicit Exchange(const PhaseParticles& p) : all_(p.is_whole() ? nullptr : ranks::active()) {}
  /// Among nobody: of what every rank holds, or of what one process computes.
  static Exchange none() {
    Exchange alone;
    alone.all_ = nullptr;
    return alone;
  }
  /// Whether the run has more than one process, shared out yet or not.
  static bool may_be() { return ranks::available() != nullptr; }
  /// From now on the particles are shared out.
  static void share_out() { ranks::share(); }
  /// Whether this is the first process, shared out yet or not.
  static bool is_first_process() { return ranks::is_first(); }

  /// Of what all ranks hold together, the share that stands on this machine.
  static double share_of_machine() { return ranks::share_of_machine(); }

  /// Whether others have a part.
  bool is_shared() const { return all_ != nullptr; }
  int rank() const { return all_ ? all_->rank() : 0; }
  int size() const { return all_ ? all_->size() : 1; }
  bool is_first() const { return rank() == 0; }
  /// The part of a sequence that this rank works at.
  Share share() const { return {static_cast<std::size_t>(rank()), static_cast<std::size_t>(size())}; }

  template <class T>
  T largest(T value) const {
    return ranks::reduced(value, Take::largest, all_);
  }
  template <class T>
  T least(T value) const {
    return ranks::reduced(value, Take::least, all_);
  }
  std::int64_t total(std::int64_t count) const { return ranks::reduced(count, Take::sum, all_); }
  std::size_t total(std::size_t count) const {
    return static_cast<std::size_t>(total(static_cast<std::int64_t>(count)));
  }
  bool any(bool value) const { return largest(std::int64_t{value ? 1 : 0}) != 0; }
  /// Each value becomes the largest, the least, the sum or the union of the bits of all ranks'.
  template <class T>
  void reduce(T* values, std::size_t count, Take how) const {
    if (all_) all_->reduce(values, count, how);
  }

  /// Sum of f(k) over k < n of every rank; its bits do not depend on the order (engine/reproducible_sum.hpp).
  template <class F>
  double sum(std::size_t n, F&& f) const {
    return reproducible_sum(n, std::forward<F>(f), all_);
  }

  /// The value of each rank.
  template <class T>
  std::vector<T> each(const T& value) const {
    return ranks::each(value, all_);
  }
  /// The value of the first rank that has one; where none has, this rank's.
  template <class T>
  T of_first(bool has, const T& value) const {
    return ranks::of_first(has, value, all_);
  }
  /// What `candidate` is best by `better`, a strict order; equal ones: the first rank's. Returns the rank.
  template <class T, class Better>
  int best(T& candidate, Better&& better) const {
    return ranks::best(candidate, std::forward<Better>(better), all_);
  }
  /// The text of one rank.
  std::string text_of(int rank, std::string text) const {
    return all_ ? ranks::text_of_rank(rank, std::move(text)) : text;
  }
  /// Where the particles of this rank begin among those of all ranks, in the order of one process.
  std::size_t before(std::size_t count) const { return ranks::before(count, all_); }
  /// The values of all ranks, one rank after another, on every one of them.
  template <class T>
  void join(std::vector<T>& values) const {
    ranks::join(values, all_);
  }
  /// Items for each rank, one rank after another; `counts`: for how many each. Returns those that are for this one.
  template <class T>
  std::vector<T> exchanged(const std::vector<T>& items, const std::vector<std::size_t>& counts) const {
    return ranks::exchanged(items, counts, *all_);
  }
  /// The same of bytes whose numbers are known on both sides; items have `width` bytes.
  void exchange(const void* send, const std::vector<std::size_t>& send_counts, void* receive,
                const std::vector<std::size_t>& receive_counts, std::size_t width) const {
    all_->exchange(send, send_counts, receive, receive_counts, width);
  }
  /// Items of all ranks, one rank after another, on every one of them: each has put its own where they stand.
  void gather_in_place(void* all, const std::vector<std::size_t>& counts, std::size_t width) const {
    all_->gather_in_place(all, counts, width);
  }
  /// The same on the first rank alone.
  void gather(const void* mine, std::size_t count, void* all, const std::vector<std::size_t>& counts,
              std::size_t width) const {
    all_->gather(mine, count, all, counts, width);
  }
  /// Sums that go through the particles in the order of one process: each rank takes them from the one before it,
  /// calls `add`, and hands them on; at last all have them. For what happens once a run or once in many steps.
  template <class T, class Add>
  void in_turn(T& value, Add&& add) const {
    ranks::in_turn(value, std::forward<Add>(add), all_);
  }
  template <class Add>
  void in_turn(std::initializer_list<Sums> sums, Add&& add) const {
    ranks::in_turn(sums, std::forward<Add>(add), all_);
  }

 private:
  Communicator* all_;  // null: nobody else has a part
};

/// As long as it lives, what the engine does is this process's own: a search among particles that every rank holds.
using ComputedByAll = ranks::Alone;

}  // namespace barchan
