// How many threads a command uses, and whether the system lets it make them.
#include <omp.h>

#include <algorithm>
#include <latch>
#include <system_error>
#include <thread>
#include <vector>

#include "app/commands.hpp"
#include "base/errors.hpp"

namespace barchan {

namespace {

/// Makes as many threads at once and ends them. OpenMP's library ends the program with a message of its own when it
/// cannot make one, so this is asked first.
void make_sure_of(int threads) {
  std::latch together(1);
  std::vector<std::thread> made;
  std::string why;
  try {
    for (int k = 0; k < threads; ++k) made.emplace_back([&] { together.wait(); });
  } catch (const std::system_error& e) { why = e.code().message(); }
  together.count_down();
  const std::size_t count = made.size();
  for (auto& thread : made) thread.join();
  if (!why.empty())
    throw OutputError("cannot make " + std::to_string(threads) + " threads (" + std::to_string(count) +
                      " were made): " + why +
                      "; expected fewer (--threads), or a larger limit of processes and memory (ulimit -u, ulimit -v)");
}

}  // namespace

void use_threads(int wanted, double particles) {
  const int useful = 1 + static_cast<int>(std::min(particles / 2000.0, 4095.0));
  const int threads = wanted > 0 ? wanted : std::min(omp_get_max_threads(), useful);
  make_sure_of(threads);  // all but the one that is there, and the writer of frames
  omp_set_num_threads(threads);
}

}  // namespace barchan
