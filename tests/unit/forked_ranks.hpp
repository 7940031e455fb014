// Ranks of a test: forked processes that share memory in the place of MPI.
#pragma once

#include <gtest/gtest.h>
#include <omp.h>
#include <pthread.h>
#include <semaphore.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <cstring>
#include <exception>
#include <stdexcept>
#include <string>
#include <vector>

#include "base/ranks.hpp"

namespace barchan::forked {

constexpr std::size_t most_ranks = 8, room = std::size_t{1} << 26;  // bytes, of what a rank says at once

struct Mail {
  sem_t full, empty;
  std::byte text[1 << 16];
};

/// What all processes see. Its memory begins as zeros and is there only where it is used.
struct Shared {
  pthread_barrier_t barrier;
  Mail mail[most_ranks];                // by the rank that receives: from the one before it
  std::size_t result_size[most_ranks];  // of the answers at the end
  std::byte said[most_ranks][room];
};

class Ranks final : public Communicator {
 public:
  Ranks(Shared& shared, int rank, int size) : shared_(shared), rank_(rank), size_(size) {}
  int rank() const override { return rank_; }
  int size() const override { return size_; }
  void reduce(double* values, std::size_t count, Take how) override { all(values, count, how); }
  void reduce(float* values, std::size_t count, Take how) override { all(values, count, how); }
  void reduce(std::int64_t* values, std::size_t count, Take how) override { all(values, count, how); }
  void all_gather(const void* mine, std::size_t bytes, void* all) override {
    say(0, mine, bytes);
    together([&] {
      for (int r = 0; r < size_; ++r)
        hear(r, 0, static_cast<std::byte*>(all) + static_cast<std::size_t>(r) * bytes, bytes);
    });
  }
  void gather_in_place(void* all, const std::vector<std::size_t>& counts, std::size_t width) override {
    auto* const to = static_cast<std::byte*>(all);
    std::vector<std::size_t> first(counts.size(), 0);
    for (std::size_t r = 1; r < counts.size(); ++r) first[r] = first[r - 1] + counts[r - 1] * width;
    const auto own = static_cast<std::size_t>(rank_);
    say(0, to + first[own], counts[own] * width);
    together([&] {
      for (int r = 0; r < size_; ++r)
        hear(r, 0, to + first[static_cast<std::size_t>(r)], counts[static_cast<std::size_t>(r)] * width);
    });
  }
  void broadcast(void* data, std::size_t bytes, int from) override {
    if (rank_ == from) say(0, data, bytes);
    together([&] { hear(from, 0, data, bytes); });
  }
  void exchange(const void* send, const std::vector<std::size_t>& send_counts, void* receive,
                const std::vector<std::size_t>& receive_counts, std::size_t width) override {
    const std::size_t head = send_counts.size() * sizeof(std::size_t);
    std::size_t total = 0;
    for (const std::size_t n : send_counts) total += n;
    say(0, send_counts.data(), head);
    say(head, send, total * width);
    together([&] {
      auto* to = static_cast<std::byte*>(receive);
      for (int r = 0; r < size_; ++r) {
        std::vector<std::size_t> counts(send_counts.size());
        hear(r, 0, counts.data(), head);
        std::size_t before = 0;
        for (int q = 0; q < rank_; ++q) before += counts[static_cast<std::size_t>(q)];
        const std::size_t n = counts[static_cast<std::size_t>(rank_)];
        if (n != receive_counts[static_cast<std::size_t>(r)]) throw std::logic_error("another number was expected");
        hear(r, head + before * width, to, n * width);
        to += n * width;
      }
    });
  }
  void gather(const void* mine, std::size_t count, void* all, const std::vector<std::size_t>& counts,
              std::size_t width) override {
    std::vector<std::size_t> to(static_cast<std::size_t>(size_), 0), from = to;
    to[0] = count;
    if (rank_ == 0) from = counts;
    exchange(mine, to, all, from, width);
  }
  void send(const void* data, std::size_t bytes, int to) override {
    Mail& mail = shared_.mail[to];
    if (bytes > sizeof mail.text || to != rank_ + 1) throw std::logic_error("such mail was not foreseen");
    sem_wait(&mail.empty);
    std::memcpy(mail.text, data, bytes);
    sem_post(&mail.full);
  }
  void receive(void* data, std::size_t bytes, int) override {
    Mail& mail = shared_.mail[rank_];
    sem_wait(&mail.full);
    std::memcpy(data, mail.text, bytes);
    sem_post(&mail.empty);
  }

 private:
  void say(std::size_t at, const void* data, std::size_t bytes) {
    if (at + bytes > room) throw std::logic_error("a rank has no room for what it says");
    if (bytes > 0) std::memcpy(shared_.said[rank_] + at, data, bytes);
  }
  void hear(int from, std::size_t at, void* data, std::size_t bytes) const {
    if (bytes > 0) std::memcpy(data, shared_.said[from] + at, bytes);
  }
  template <class F>
  void together(F&& f) {
    pthread_barrier_wait(&shared_.barrier);
    f();
    pthread_barrier_wait(&shared_.barrier);
  }
  template <class T>
  static T joined(T a, T b, Take how) {
    if (how == Take::largest) return std::max(a, b);
    if (how == Take::least) return std::min(a, b);
    if constexpr (std::is_integral_v<T>)
      if (how == Take::bits) return a | b;
    return a + b;
  }
  template <class T>
  void all(T* values, std::size_t count, Take how) {
    say(0, values, count * sizeof(T));
    together([&] {
      std::vector<T> one(count);
      for (int r = 0; r < size_; ++r) {
        hear(r, 0, one.data(), count * sizeof(T));
        for (std::size_t k = 0; k < count; ++k) values[k] = r == 0 ? one[k] : joined(values[k], one[k], how);
      }
    });
  }

  Shared& shared_;
  int rank_, size_;
};

/// Calls `answer`, which returns a std::string of any bytes, on so many ranks. Returns what each has answered. A rank
/// that throws, or that waits for the others in vain, fails the test.
template <class Answer>
std::vector<std::string> on_ranks(int count, Answer&& answer) {
  void* const memory =
      mmap(nullptr, sizeof(Shared), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  if (memory == MAP_FAILED) throw std::runtime_error("no memory to share");
  auto& shared = *static_cast<Shared*>(memory);
  pthread_barrierattr_t for_processes;
  pthread_barrierattr_init(&for_processes);
  pthread_barrierattr_setpshared(&for_processes, PTHREAD_PROCESS_SHARED);
  pthread_barrier_init(&shared.barrier, &for_processes, static_cast<unsigned>(count));
  for (Mail& mail : shared.mail) {
    sem_init(&mail.full, 1, 0);
    sem_init(&mail.empty, 1, 1);
  }
  std::vector<pid_t> children;
  for (int rank = 0; rank < count; ++rank) {
    const pid_t child = fork();
    if (child > 0) children.push_back(child);
    if (child != 0) continue;
    alarm(120);
    omp_set_num_threads(1);
    int status = 1;
    try {
      Ranks ranks(shared, rank, count);
      ranks::give(&ranks);
      const std::string mine = answer();
      pthread_barrier_wait(&shared.barrier);  // nobody says anything any more
      if (mine.size() > room) throw std::logic_error("a rank has no room for its answer");
      std::memcpy(shared.said[rank], mine.data(), mine.size());
      shared.result_size[rank] = mine.size();
      status = 0;
    } catch (const std::exception& error) { std::fprintf(stderr, "rank %d: %s\n", rank, error.what()); }
    _exit(status);
  }
  std::vector<std::string> answers;
  for (std::size_t r = 0; r < children.size(); ++r) {
    int status = 0;
    waitpid(children[r], &status, 0);
    EXPECT_EQ(status, 0) << "rank " << r;
    answers.emplace_back(reinterpret_cast<const char*>(shared.said[r]), shared.result_size[r]);
  }
  munmap(memory, sizeof(Shared));
  return answers;
}

}  // namespace barchan::forked
