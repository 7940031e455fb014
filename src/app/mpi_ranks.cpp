#include "app/mpi_ranks.hpp"

#include "base/ranks.hpp"

#ifdef BARCHAN_MPI

#define OMPI_SKIP_MPICXX 1
#include <mpi.h>
#include <omp.h>
#include <sched.h>

#include <algorithm>
#include <chrono>
#include <limits>
#include <numeric>
#include <set>
#include <thread>
#include <vector>

#include "base/clock.hpp"
#include "base/errors.hpp"
#include "output/seats.hpp"

namespace barchan {

namespace {

constexpr int tag = 1;

MPI_Op operation(Communicator::Take how) {
  switch (how) {
    case Communicator::Take::largest: return MPI_MAX;
    case Communicator::Take::least: return MPI_MIN;
    case Communicator::Take::sum: return MPI_SUM;
    case Communicator::Take::bits: break;
  }
  return MPI_BOR;
}

constexpr std::size_t most_of_mpi = std::numeric_limits<int>::max();

int count_of(std::size_t count) {
  if (count > most_of_mpi)
    throw OutputError("a message between ranks has " + std::to_string(count) +
                      " items; expected at most 2147483647: more ranks, so that each has fewer particles");
  return static_cast<int>(count);
}

/// How MPI counts items of `width` bytes, `all` of them in a call: by bytes, or, where these are more than MPI counts,
/// by a type of that many bytes, which costs a call of MPI to make and one to free.
class Items {
 public:
  Items(std::size_t width, std::size_t all) : each_(width * all <= most_of_mpi ? width : 1) {
    if (each_ == width) return;
    MPI_Type_contiguous(count_of(width), MPI_BYTE, &made_);
    MPI_Type_commit(&made_);
  }
  ~Items() {
    if (made_ != MPI_DATATYPE_NULL) MPI_Type_free(&made_);
  }
  Items(const Items&) = delete;
  Items& operator=(const Items&) = delete;
  MPI_Datatype type() const { return made_ == MPI_DATATYPE_NULL ? MPI_BYTE : made_; }
  int count(std::size_t items) const { return count_of(items * each_); }

 private:
  std::size_t each_;  // of what MPI counts, in an item
  MPI_Datatype made_ = MPI_DATATYPE_NULL;
};

std::size_t sum(const std::vector<std::size_t>& counts) {
  return std::accumulate(counts.begin(), counts.end(), std::size_t{0});
}

/// Adds the time of a block to what a rank has waited. To ask for processor time is a call of the kernel (0.6e-6 s, as
/// much as a small reduction). A rank that has its cores alone does not ask: it waits in a loop, so that its processor
/// time is the wall time.
class Waiting {
 public:
  Waiting(Communicator::Waits& waits, bool shares_cores)
      : waits_(waits), asks_(shares_cores), processor_(asks_ ? thread_seconds() : 0.0), begin_(Clock::now()) {}
  ~Waiting() {
    const double seconds = std::chrono::duration<double>(Clock::now() - begin_).count();
    waits_.seconds += seconds;
    waits_.processor_seconds += asks_ ? thread_seconds() - processor_ : seconds;
  }
  Waiting(const Waiting&) = delete;
  Waiting& operator=(const Waiting&) = delete;

 private:
  using Clock = std::chrono::steady_clock;
  Communicator::Waits& waits_;
  bool asks_;
  double processor_;
  Clock::time_point begin_;
};

class Mpi final : public Communicator {
 public:
  Mpi() {
    MPI_Comm_rank(MPI_COMM_WORLD, &rank_);
    MPI_Comm_size(MPI_COMM_WORLD, &size_);
    MPI_Comm here = MPI_COMM_NULL;
    MPI_Comm_split_type(MPI_COMM_WORLD, MPI_COMM_TYPE_SHARED, 0, MPI_INFO_NULL, &here);
    MPI_Comm_size(here, &on_this_machine_);
    std::vector<char> any(CPU_SETSIZE, 0);  // which cores the ranks of this machine may use
    for (const int core : cores_of_process()) any[static_cast<std::size_t>(core)] = 1;
    MPI_Allreduce(MPI_IN_PLACE, any.data(), CPU_SETSIZE, MPI_BYTE, MPI_BOR, here);
    if (const auto cores = std::count(any.begin(), any.end(), 1); cores > 0) cores_ = static_cast<int>(cores);
    MPI_Comm_free(&here);
  }
  int rank() const override { return rank_; }
  int size() const override { return size_; }
  int on_this_machine() const override { return on_this_machine_; }
  void reduce(double* values, std::size_t count, Take how) override { all(values, count, how, MPI_DOUBLE); }
  void reduce(float* values, std::size_t count, Take how) override { all(values, count, how, MPI_FLOAT); }
  void reduce(std::int64_t* values, std::size_t count, Take how) override { all(values, count, how, MPI_INT64_T); }
  Traffic traffic() const override { return traffic_; }
  Waits waits() const override { return waits_; }
  void all_gather(const void* mine, std::size_t bytes, void* all) override {
    const Waiting waiting = begin_waiting();
    ++traffic_.collectives;
    MPI_Allgather(mine, count_of(bytes), MPI_BYTE, all, count_of(bytes), MPI_BYTE, MPI_COMM_WORLD);
  }
  void gather_in_place(void* all, const std::vector<std::size_t>& counts, std::size_t width) override {
    const Waiting waiting = begin_waiting();
    const Items items(width, sum(counts));
    std::vector<int> number, first;
    std::size_t before = 0;
    for (const std::size_t n : counts) {
      number.push_back(items.count(n));
      first.push_back(items.count(before));
      before += n;
    }
    const std::size_t own = counts[static_cast<std::size_t>(rank_)];
    for (int r = 1; r < size_ && own > 0; ++r) note(own * width);
    MPI_Allgatherv(MPI_IN_PLACE, 0, items.type(), all, number.data(), first.data(), items.type(), MPI_COMM_WORLD);
  }
  void broadcast(void* data, std::size_t bytes, int from) override {
    const Waiting waiting = begin_waiting();
    ++traffic_.collectives;
    MPI_Bcast(data, count_of(bytes), MPI_BYTE, from, MPI_COMM_WORLD);
  }
  void exchange(const void* send, const std::vector<std::size_t>& send_counts, void* receive,
                const std::vector<std::size_t>& receive_counts, std::size_t width) override {
    const Waiting waiting = begin_waiting();
    start(send, send_counts, receive, receive_counts, width);
    wait();
  }
  void exchange_beside(const void* send, const std::vector<std::size_t>& send_counts, void* receive,
                       const std::vector<std::size_t>& receive_counts, std::size_t width,
                       const std::function<void()>& beside) override {
    {
      const Waiting waiting = begin_waiting();
      start(send, send_counts, receive, receive_counts, width);
    }
    beside();
    const Waiting waiting = begin_waiting();
    wait();
  }
  void gather(const void* mine, std::size_t count, void* all, const std::vector<std::size_t>& counts,
              std::size_t width) override {
    std::vector<std::size_t> to(static_cast<std::size_t>(size_), 0), from(static_cast<std::size_t>(size_), 0);
    to[0] = count;
    if (rank_ == 0) from = counts;
    exchange(mine, to, all, from, width);
  }
  void send(const void* data, std::size_t bytes, int to) override {
    const Waiting waiting = begin_waiting();
    note(bytes);
    MPI_Send(data, count_of(bytes), MPI_BYTE, to, tag, MPI_COMM_WORLD);
  }
  void receive(void* data, std::size_t bytes, int from) override {
    const Waiting waiting = begin_waiting();
    MPI_Recv(data, count_of(bytes), MPI_BYTE, from, tag, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
  }

 private:
  Waiting begin_waiting() { return {waits_, on_this_machine_ * omp_get_max_threads() > cores_}; }
  template <class T>
  void all(T* values, std::size_t count, Take how, MPI_Datatype type) {
    const Waiting waiting = begin_waiting();
    ++traffic_.collectives;
    MPI_Allreduce(MPI_IN_PLACE, values, count_of(count), type, operation(how), MPI_COMM_WORLD);
  }
  void start(const void* send, const std::vector<std::size_t>& send_counts, void* receive,
             const std::vector<std::size_t>& receive_counts, std::size_t width) {
    const Items items(width, std::max(sum(send_counts), sum(receive_counts)));
    requests_.clear();
    const char* from = static_cast<const char*>(send);
    char* to = static_cast<char*>(receive);
    const char* own = nullptr;
    for (int r = 0; r < size_; ++r) {
      const std::size_t count = receive_counts[static_cast<std::size_t>(r)];
      if (count > 0 && r != rank_)
        MPI_Irecv(to, items.count(count), items.type(), r, tag, MPI_COMM_WORLD, &requests_.emplace_back());
      if (r == rank_) own_to_ = to;
      to += count * width;
    }
    for (int r = 0; r < size_; ++r) {
      const std::size_t count = send_counts[static_cast<std::size_t>(r)];
      if (count > 0 && r != rank_) note(count * width);
      if (count > 0 && r != rank_)
        MPI_Isend(from, items.count(count), items.type(), r, tag, MPI_COMM_WORLD, &requests_.emplace_back());
      if (r == rank_) own = from;
      from += count * width;
    }
    const std::size_t kept = send_counts[static_cast<std::size_t>(rank_)] * width;
    if (own && own_to_ && kept > 0) std::memcpy(own_to_, own, kept);
  }
  void wait() { MPI_Waitall(static_cast<int>(requests_.size()), requests_.data(), MPI_STATUSES_IGNORE); }
  void note(std::size_t bytes) {
    ++traffic_.messages;
    traffic_.bytes += static_cast<std::int64_t>(bytes);
  }
  Traffic traffic_;
  Waits waits_;
  int rank_ = 0, size_ = 1, on_this_machine_ = 1;
  int cores_ = 1;  // of this machine, that its ranks may use
  char* own_to_ = nullptr;
  std::vector<MPI_Request> requests_;
};

bool joined = false;

/// The text of every rank.
std::vector<std::string> texts(Mpi& mpi, const std::string& mine) {
  std::vector<std::string> all;
  for (int r = 0; r < mpi.size(); ++r) {
    std::uint64_t size = mine.size();
    mpi.broadcast(&size, sizeof size, r);
    std::string text = r == mpi.rank() ? mine : std::string(size, ' ');
    text.resize(size);
    mpi.broadcast(text.data(), size, r);
    all.push_back(text);
  }
  return all;
}

}  // namespace

bool has_mpi() { return true; }

void join_ranks(const Launch& launch, const std::string& command, const std::string& out) {
  if (!launch.together()) return;
  int provided = 0;
  MPI_Init_thread(nullptr, nullptr, MPI_THREAD_FUNNELED, &provided);
  joined = true;
  static Mpi mpi;
  if (mpi.size() == 1) return refuse_one_folder_for_many(launch, out);  // of a library that does not know this launcher
  const auto folders = texts(mpi, out), commands = texts(mpi, command);
  const std::set<std::string> different(folders.begin(), folders.end());
  const bool apart = different.size() == folders.size() && different.count("") == 0;
  if (apart) return;
  if (std::set<std::string>(commands.begin(), commands.end()).size() > 1 || different.size() > 1)
    throw SceneError(launch.told() +
                     ", and their commands are neither the same nor are all their --out different; expected one "
                     "command for all (ranks of one run), or an --out of its own for each (independent runs)");
  ranks::give(&mpi);
}

int threads_of_a_rank() {
  if (!ranks::available()) return 0;
  return threads_on_seat(seats_of_ranks(0), ranks::available()->rank(), omp_get_max_threads());
}

int leave_ranks(int status) {
  if (joined) MPI_Finalize();
  joined = false;
  return status;
}

bool all_failed() {
  if (!joined || !ranks::available()) return true;
  MPI_Request together = MPI_REQUEST_NULL;
  MPI_Ibarrier(MPI_COMM_WORLD, &together);
  int done = 0;
  for (int k = 0; k < 300 && done == 0; ++k) {
    MPI_Test(&together, &done, MPI_STATUS_IGNORE);
    if (done == 0) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return done != 0;
}

void abort_ranks(int status) { MPI_Abort(MPI_COMM_WORLD, status); }

}  // namespace barchan

#else

namespace barchan {

bool has_mpi() { return false; }
void join_ranks(const Launch& launch, const std::string&, const std::string& out) {
  refuse_one_folder_for_many(launch, out);
}
int threads_of_a_rank() { return 0; }
int leave_ranks(int status) { return status; }
bool all_failed() { return true; }
void abort_ranks(int) {}

}  // namespace barchan

#endif
