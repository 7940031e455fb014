// The processes that share one run, its ranks. A run of one process has none of this: available() is null and every
// function here does nothing. The program brings a communicator (app/mpi_ranks.cpp); the library knows no MPI.
//
// Every call is made by all ranks, in the same order: what decides about a call must be the same on all of them.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <functional>
#include <initializer_list>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace barchan {

class Communicator {
 public:
  Communicator() = default;
  virtual ~Communicator() = default;
  Communicator(const Communicator&) = delete;
  Communicator& operator=(const Communicator&) = delete;

  enum class Take { largest, least, sum, bits };  // bits: those that any rank has set, of whole numbers

  virtual int rank() const = 0;
  virtual int size() const = 0;
  /// Each value becomes the largest, the least or the sum of those of all ranks. Sums of doubles have the same bits on
  /// all ranks; only where all partial sums are exact do they not depend on the ranks.
  virtual void reduce(double* values, std::size_t count, Take how) = 0;
  virtual void reduce(float* values, std::size_t count, Take how) = 0;
  virtual void reduce(std::int64_t* values, std::size_t count, Take how) = 0;
  /// `bytes` of every rank, one after another.
  virtual void all_gather(const void* mine, std::size_t bytes, void* all) = 0;
  virtual void broadcast(void* data, std::size_t bytes, int from) = 0;
  /// Items of `width` bytes: send_counts[r] of them to rank r, one rank after another; likewise what comes.
  virtual void exchange(const void* send, const std::vector<std::size_t>& send_counts, void* receive,
                        const std::vector<std::size_t>& receive_counts, std::size_t width) = 0;
  /// The same; `beside` is called while the items are on their way, and touches none of them.
  virtual void exchange_beside(const void* send, const std::vector<std::size_t>& send_counts, void* receive,
                               const std::vector<std::size_t>& receive_counts, std::size_t width,
                               const std::function<void()>& beside) {
    exchange(send, send_counts, receive, receive_counts, width);
    beside();
  }
  /// Items of all ranks, one rank after another, on rank 0; `counts` (there): of each rank.
  virtual void gather(const void* mine, std::size_t count, void* all, const std::vector<std::size_t>& counts,
                      std::size_t width) = 0;
  /// From one rank to the next.
  virtual void send(const void* data, std::size_t bytes, int to) = 0;
  virtual void receive(void* data, std::size_t bytes, int from) = 0;
  /// What this rank has sent to others so far. gather_in_place() counts as a message to each other rank, where this one
  /// has items; reductions, broadcasts and the like count once, as collectives.
  struct Traffic {
    std::int64_t messages = 0, bytes = 0, collectives = 0;
  };
  virtual Traffic traffic() const { return {}; }
  /// What this rank has spent in calls of its communicator so far: wall time, and processor time of the thread that
  /// makes them (s). Where each thread of all ranks has a core, the second is taken to be the first.
  struct Waits {
    double seconds = 0, processor_seconds = 0;
  };
  virtual Waits waits() const { return {}; }
  /// How many of the ranks are processes of this machine.
  virtual int on_this_machine() const { return size(); }
  /// Items of `width` bytes of all ranks, one rank after another, on every one of them: each rank has put its own where
  /// they stand in `all`. `counts`: of each rank.
  virtual void gather_in_place(void* all, const std::vector<std::size_t>& counts, std::size_t width) = 0;
};

namespace ranks {

namespace detail {
inline Communicator* given = nullptr;
inline bool shared = false;
}  // namespace detail

/// Of the program; null: one process.
inline Communicator* available() { return detail::given; }
/// Null as long as every process holds all particles. They are shared out when they are sorted first, or before any is
/// made (start/shared_start.hpp).
inline Communicator* active() { return detail::shared ? detail::given : nullptr; }
inline void give(Communicator* communicator) { detail::given = communicator; }
/// What is shared out stays so: who calls this where it is Alone changes nothing.
inline void share() {
  if (detail::given) detail::shared = true;
}

/// As long as it lives, `alone` makes this process one without others: for what every rank holds and computes itself,
/// with the same bits, so that nothing is to be shared out or reduced.
class Alone {
 public:
  explicit Alone(bool alone = true) : all_(alone ? detail::given : nullptr) {
    if (all_)
      detail::given = nullptr;  // without others nothing is written: simulations of one process run side by side
  }
  ~Alone() {
    if (all_) detail::given = all_;
  }
  Alone(const Alone&) = delete;
  Alone& operator=(const Alone&) = delete;

 private:
  Communicator* all_;  // who comes back, or null
};

inline bool is_first() { return !detail::given || detail::given->rank() == 0; }

template <class T>
T reduced(T value, Communicator::Take how, Communicator* all = active()) {
  if (all) all->reduce(&value, 1, how);
  return value;
}
/// Of all ranks.
inline double largest(double value) { return reduced(value, Communicator::Take::largest); }
inline double least(double value) { return reduced(value, Communicator::Take::least); }
inline std::int64_t largest(std::int64_t value) { return reduced(value, Communicator::Take::largest); }
inline std::int64_t total(std::int64_t value) { return reduced(value, Communicator::Take::sum); }
inline std::size_t total(std::size_t count) {
  return static_cast<std::size_t>(total(static_cast<std::int64_t>(count)));
}
inline bool any(bool value) { return largest(std::int64_t{value ? 1 : 0}) != 0; }

/// The value of each rank; of one process its own.
template <class T>
std::vector<T> each(const T& value, Communicator* all = active()) {
  static_assert(std::is_trivially_copyable_v<T>);
  std::vector<T> values(all ? static_cast<std::size_t>(all->size()) : 1, value);
  if (all) all->all_gather(&value, sizeof(T), values.data());
  return values;
}

/// Whether particles that enter are made here: on the first rank, before the next sort brings them to theirs.
inline bool makes_particles() { return !active() || active()->rank() == 0; }

/// The value of the first rank that has one; where none has, this rank's. Of one process its own.
template <class T>
T of_first(bool has, const T& value, Communicator* all = active()) {
  struct Offer {
    bool has;
    T value;
  };
  if (!all) return value;
  for (const Offer& offer : each(Offer{has, value}, all))
    if (offer.has) return offer.value;
  return value;
}

/// The values of all ranks, one rank after another, on every one of them.
template <class T>
void join(std::vector<T>& values, Communicator* all = active()) {
  static_assert(std::is_trivially_copyable_v<T>);
  if (!all) return;
  const auto counts = each(values.size(), all);
  std::size_t total = 0, own = 0;
  for (std::size_t r = 0; r < counts.size(); ++r) {
    if (static_cast<int>(r) == all->rank()) own = total;
    total += counts[r];
  }
  std::vector<T> together(total);
  std::copy(values.begin(), values.end(), together.begin() + static_cast<std::ptrdiff_t>(own));
  std::size_t at = 0;
  for (std::size_t r = 0; r < counts.size(); at += counts[r++])
    if (counts[r] > 0) all->broadcast(together.data() + at, counts[r] * sizeof(T), static_cast<int>(r));
  values = std::move(together);
}

/// Where the particles of this rank begin among those of all ranks, in the order of one process.
inline std::size_t before(std::size_t count, Communicator* all = active()) {
  if (!all) return 0;
  const auto counts = each(count, all);
  std::size_t sum = 0;
  for (int r = 0; r < all->rank(); ++r) sum += counts[static_cast<std::size_t>(r)];
  return sum;
}

/// The text that one rank has, before anything is shared out too. There are ranks.
inline std::string text_of_rank(int rank, std::string text) {
  Communicator& all = *available();
  std::uint64_t size = text.size();
  all.broadcast(&size, sizeof size, rank);
  text.resize(size);
  all.broadcast(text.data(), size, rank);
  return text;
}
/// The text of one rank; of one process its own.
inline std::string text_of(int rank, std::string text) { return active() ? text_of_rank(rank, std::move(text)) : text; }

/// The first text of all processes that is not empty, on every one of them, shared out or not; "" where all are empty.
inline std::string first_text(std::string text) {
  Communicator* const all = available();
  if (!all) return text;
  const char mine = text.empty() ? 0 : 1;
  std::vector<char> has(static_cast<std::size_t>(all->size()), 0);
  all->all_gather(&mine, 1, has.data());
  const auto who = std::find(has.begin(), has.end(), 1) - has.begin();
  if (who == all->size()) return "";
  std::uint64_t size = text.size();
  all->broadcast(&size, sizeof size, static_cast<int>(who));
  text.resize(size);
  all->broadcast(text.data(), size, static_cast<int>(who));
  return text;
}

/// Items for each rank, one rank after another; `counts`: for how many each. Returns those that all ranks have for this
/// one, one rank after another.
template <class T>
std::vector<T> exchanged(const std::vector<T>& items, const std::vector<std::size_t>& counts,
                         Communicator& all = *active()) {
  static_assert(std::is_trivially_copyable_v<T>);
  const std::vector<std::size_t> ones(counts.size(), 1);
  std::vector<std::size_t> coming(counts.size(), 0);
  all.exchange(counts.data(), ones, coming.data(), ones, sizeof(std::size_t));
  std::size_t total = 0;
  for (const std::size_t n : coming) total += n;
  std::vector<T> come(total);
  all.exchange(items.data(), counts, come.data(), coming, sizeof(T));
  return come;
}

/// Of what all ranks hold together, the share that stands on this machine.
inline double share_of_machine() {
  return active() ? static_cast<double>(active()->on_this_machine()) / active()->size() : 1.0;
}

/// A part of a sequence: `number` of `count`, about as long as the others.
struct Share {
  std::size_t number = 0, count = 1;
  /// Where it begins in a sequence of n, and where it ends.
  std::size_t begin(std::size_t n) const { return n * number / count; }
  std::size_t end(std::size_t n) const { return n * (number + 1) / count; }
};
/// That of this rank; of one process all.
inline Share own_share() {
  if (!active()) return {};
  return {static_cast<std::size_t>(active()->rank()), static_cast<std::size_t>(active()->size())};
}

/// What `candidate` is best by `better`, a strict order; equal ones: the first rank's. Returns the rank.
template <class T, class Better>
int best(T& candidate, Better&& better, Communicator* all = active()) {
  if (!all) return 0;
  const auto candidates = each(candidate, all);
  std::size_t first = 0;
  for (std::size_t r = 1; r < candidates.size(); ++r)
    if (better(candidates[r], candidates[first])) first = r;
  candidate = candidates[first];
  return static_cast<int>(first);
}

/// Bytes of a sum, or of several that stand side by side.
struct Sums {
  void* data;
  std::size_t bytes;
};

/// Sums that go through the particles in the order of one process: each rank takes `sums` from the one before it, calls
/// `add`, and hands them on; at last all have them. For what happens once a run or once in many steps.
template <class Add>
void in_turn(std::initializer_list<Sums> sums, Add&& add, Communicator* all = active()) {
  if (all && all->rank() > 0)
    for (const Sums& s : sums) all->receive(s.data, s.bytes, all->rank() - 1);
  add();
  if (!all) return;
  if (all->rank() + 1 < all->size())
    for (const Sums& s : sums) all->send(s.data, s.bytes, all->rank() + 1);
  for (const Sums& s : sums) all->broadcast(s.data, s.bytes, all->size() - 1);
}
template <class T, class Add>
void in_turn(T& value, Add&& add, Communicator* all = active()) {
  static_assert(std::is_trivially_copyable_v<T>);
  in_turn({Sums{&value, sizeof value}}, add, all);
}

}  // namespace ranks

}  // namespace barchan
