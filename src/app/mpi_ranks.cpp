#include "app/mpi_ranks.hpp"

#include "base/ranks.hpp"

#ifdef BARCHAN_MPI

#define OMPI_SKIP_MPICXX 1
#include <mpi.h>
#include <omp.h>
#include <sched.h>
#include <sys/prctl.h>
#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <cstring>
#include <ctime>
#include <limits>
#include <numeric>
#include <set>
#include <thread>
#include <vector>

#include "base/clock.hpp"
#include "base/errors.hpp"
#include "output/placement.hpp"

namespace barchan {

namespace {

constexpr int tag = 1, collective_tag = 2;

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

/// Adds the time of a block to what a rank has waited, by the clock of its processor: where other programs want its
/// core too, wall time is no processor time.
class Waiting {
 public:
  explicit Waiting(Communicator::Waits& waits) : waits_(waits), processor_(thread_seconds()), begin_(Clock::now()) {}
  ~Waiting() {
    waits_.seconds += std::chrono::duration<double>(Clock::now() - begin_).count();
    waits_.processor_seconds += thread_seconds() - processor_;
  }
  Waiting(const Waiting&) = delete;
  Waiting& operator=(const Waiting&) = delete;

 private:
  using Clock = std::chrono::steady_clock;
  Communicator::Waits& waits_;
  double processor_;
  Clock::time_point begin_;
};

/// How a rank waits for others, and the time that it takes. It looks for the message again and again, as MPI does. On a
/// machine that gives the cores of the ranks to other programs too, it sleeps between two looks after a moment: a rank
/// that looks all the time uses up its share of its core, and has none left when the message comes.
class Patience {
 public:
  explicit Patience(Communicator::Waits& waits) : waits_(waits) { prctl(PR_SET_TIMERSLACK, 1000UL); }
  void always_polite() { polite_until_ = std::numeric_limits<double>::max(); }

  /// Calls what does not wait.
  template <class Call>
  void call(Call&& call) {
    const double begin = now();
    call();
    add_short(now() - begin);
  }

  /// Returns as soon as `done` does so with true.
  template <class Done>
  void until(Done&& done) {
    const double begin = now();
    const bool at_once = done();
    add_short(now() - begin);
    if (at_once) return;
    // MPI may give the core away in each look, so that the shortest wait may be no processor time.
    const Waiting waiting(waits_);
    while (now() - begin < moment)
      if (done()) return;
    wait_long(done);
  }

 private:
  static constexpr double moment = 50e-6;   // s, of looking without a sleep
  static constexpr double one_look = 4e-6;  // s, of a look that keeps its core, at most
  static constexpr long pause = 20'000;     // ns, of sleep
  static constexpr double look = 20e-3;     // s, between two questions to the system
  static constexpr double busy = 40.0;      // 1/s, how often a rank loses its core on a machine that others use
  static constexpr double polite = 0.2;     // s, for which it is then taken to be so
  static constexpr int looks_a_clock = 64;

  /// Of one call. A longer time than that of a look may be one without a core, and counts as work.
  void add_short(double seconds) {
    waits_.seconds += seconds;
    if (seconds < one_look) waits_.processor_seconds += seconds;
  }

  static double now() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
  }

  template <class Done>
  void wait_long(Done& done) {
    while (true) {
      if (is_polite()) {
        const timespec time{0, pause};
        nanosleep(&time, nullptr);
        if (done()) return;
      }
      for (int k = 0; k < looks_a_clock; ++k)
        if (done()) return;
    }
  }

  bool is_polite() {
    const double at = now();
    if (at - looked_ < look) return at < polite_until_;
    rusage use{};
    getrusage(RUSAGE_THREAD, &use);
    if (static_cast<double>(use.ru_nivcsw - lost_) > busy * (at - looked_))
      polite_until_ = std::max(polite_until_, at + polite);
    looked_ = at;
    lost_ = use.ru_nivcsw;
    return at < polite_until_;
  }

  Communicator::Waits& waits_;
  double looked_ = now(), polite_until_ = 0.0;
  long lost_ = 0;  // how often the system has taken the core of this rank
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
    if (std::count(any.begin(), any.end(), 1) < on_this_machine_) patience_.always_polite();
    MPI_Comm_free(&here);
    apart_ = size_ > most_by_pairs || on_this_machine_ < size_;
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
    ++traffic_.collectives;
    if (apart_) {
      const Waiting waiting(waits_);
      MPI_Allgather(mine, count_of(bytes), MPI_BYTE, all, count_of(bytes), MPI_BYTE, MPI_COMM_WORLD);
      return;
    }
    exchange_all(mine, bytes, static_cast<char*>(all));
  }
  void gather_in_place(void* all, const std::vector<std::size_t>& counts, std::size_t width) override {
    const Waiting waiting(waits_);
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
    ++traffic_.collectives;
    MPI_Request one = MPI_REQUEST_NULL;
    MPI_Ibcast(data, count_of(bytes), MPI_BYTE, from, MPI_COMM_WORLD, &one);
    wait(one);
  }
  void exchange(const void* send, const std::vector<std::size_t>& send_counts, void* receive,
                const std::vector<std::size_t>& receive_counts, std::size_t width) override {
    start(send, send_counts, receive, receive_counts, width);
    wait();
  }
  void exchange_beside(const void* send, const std::vector<std::size_t>& send_counts, void* receive,
                       const std::vector<std::size_t>& receive_counts, std::size_t width,
                       const std::function<void()>& beside) override {
    start(send, send_counts, receive, receive_counts, width);
    beside();
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
    note(bytes);
    MPI_Request one = MPI_REQUEST_NULL;
    MPI_Isend(data, count_of(bytes), MPI_BYTE, to, tag, MPI_COMM_WORLD, &one);
    wait(one);
  }
  void receive(void* data, std::size_t bytes, int from) override {
    MPI_Request one = MPI_REQUEST_NULL;
    MPI_Irecv(data, count_of(bytes), MPI_BYTE, from, tag, MPI_COMM_WORLD, &one);
    wait(one);
  }

 private:
  static constexpr int most_by_pairs = 8;  // ranks whose collectives are messages from each to each

  /// Of few ranks of one machine: each sends to each. MPI's own collectives look for messages without a pause, and
  /// those that return at once take twice the time.
  template <class T>
  void all(T* values, std::size_t count, Take how, MPI_Datatype type) {
    ++traffic_.collectives;
    if (apart_) {
      const Waiting waiting(waits_);
      MPI_Allreduce(MPI_IN_PLACE, values, count_of(count), type, operation(how), MPI_COMM_WORLD);
      return;
    }
    const std::size_t bytes = count * sizeof(T);
    collected_.resize(static_cast<std::size_t>(size_) * bytes);
    exchange_all(values, bytes, collected_.data());
    // In the order of the ranks, so that a sum has the same bits on all of them.
    std::memcpy(values, collected_.data(), bytes);
    for (int r = 1; r < size_; ++r)
      MPI_Reduce_local(collected_.data() + static_cast<std::size_t>(r) * bytes, values, count_of(count), type,
                       operation(how));
  }
  /// `bytes` of each rank, one after another.
  void exchange_all(const void* mine, std::size_t bytes, char* all) {
    const int n = count_of(bytes);
    collecting_.clear();
    for (int r = 0; r < size_; ++r) {
      char* const place = all + static_cast<std::size_t>(r) * bytes;
      if (r == rank_) std::memcpy(place, mine, bytes);
      else MPI_Irecv(place, n, MPI_BYTE, r, collective_tag, MPI_COMM_WORLD, &collecting_.emplace_back());
    }
    for (int r = 0; r < size_; ++r)
      if (r != rank_) MPI_Isend(mine, n, MPI_BYTE, r, collective_tag, MPI_COMM_WORLD, &collecting_.emplace_back());
    wait(collecting_);
  }
  void start(const void* send, const std::vector<std::size_t>& send_counts, void* receive,
             const std::vector<std::size_t>& receive_counts, std::size_t width) {
    patience_.call([&] { post(send, send_counts, receive, receive_counts, width); });
  }
  void post(const void* send, const std::vector<std::size_t>& send_counts, void* receive,
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
  void wait() { wait(requests_); }
  void wait(std::vector<MPI_Request>& requests) {
    patience_.until([&] {
      int done = 0;
      MPI_Testall(static_cast<int>(requests.size()), requests.data(), &done, MPI_STATUSES_IGNORE);
      return done != 0;
    });
  }
  void wait(MPI_Request& request) {
    patience_.until([&] {
      int done = 0;
      MPI_Test(&request, &done, MPI_STATUS_IGNORE);
      return done != 0;
    });
  }
  void note(std::size_t bytes) {
    ++traffic_.messages;
    traffic_.bytes += static_cast<std::int64_t>(bytes);
  }
  Traffic traffic_;
  Waits waits_;
  Patience patience_{waits_};
  int rank_ = 0, size_ = 1, on_this_machine_ = 1;
  bool apart_ = false;  // on several machines, or too many for collectives by pairs
  char* own_to_ = nullptr;
  std::vector<MPI_Request> requests_, collecting_;
  std::vector<char> collected_;
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
  return threads_of_placement(placements_of_ranks(0), ranks::available()->rank(), omp_get_max_threads());
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
