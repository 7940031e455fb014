#include "output/placement.hpp"

#include <sched.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <map>
#include <sstream>

#include "base/ranks.hpp"
#include "output/folder_lock.hpp"

namespace barchan {

namespace {

std::string number_of(std::size_t count, const std::string& thing) {
  return std::to_string(count) + " " + thing + (count == 1 ? "" : "s");
}

}  // namespace

std::set<int> cores_of_process() {
  std::set<int> cores;
  cpu_set_t allowed;
  CPU_ZERO(&allowed);
  if (::sched_getaffinity(0, sizeof allowed, &allowed) != 0) return cores;
  for (int k = 0; k < CPU_SETSIZE; ++k)
    if (CPU_ISSET(k, &allowed)) cores.insert(k);
  return cores;
}

std::string list_of_cores(const std::set<int>& cores) {
  std::string text;
  for (auto at = cores.begin(); at != cores.end();) {
    const int first = *at;
    int last = first;
    for (++at; at != cores.end() && *at == last + 1; ++at) last = *at;
    text += (text.empty() ? "" : ",") + std::to_string(first);
    if (last > first) text += "-" + std::to_string(last);
  }
  return text;
}

std::set<int> cores_of_list(const std::string& list) {
  std::set<int> cores;
  std::istringstream parts(list);
  for (std::string part; std::getline(parts, part, ',');) {
    int first = 0, last = 0;
    const char* const end = part.data() + part.size();
    const auto [dash, wrong] = std::from_chars(part.data(), end, first);
    if (wrong != std::errc{}) continue;
    if (dash == end || std::from_chars(dash + 1, end, last).ec != std::errc{}) last = first;
    for (int k = first; k <= last; ++k) cores.insert(k);
  }
  return cores;
}

std::vector<RunReport::Placement> placements_of_ranks(int threads) {
  std::vector<RunReport::Placement> placements;
  Communicator* const all = ranks::available();
  if (!all) return placements;
  const std::string host = host_name(), cores = list_of_cores(cores_of_process());
  for (int r = 0; r < all->size(); ++r) {
    RunReport::Placement placement{1, ranks::text_of_rank(r, host), ranks::text_of_rank(r, cores), threads};
    all->broadcast(&placement.threads, sizeof placement.threads, r);
    if (!placements.empty() && placements.back().is_like(placement)) ++placements.back().ranks;
    else placements.push_back(placement);
  }
  return placements;
}

int threads_of_placement(const std::vector<RunReport::Placement>& placements, int rank, int most) {
  auto own = placements.begin();
  for (int first = own->ranks; first <= rank; first += own->ranks) ++own;
  const std::set<int> cores = cores_of_list(own->cores);
  int sharing = 0;
  for (const RunReport::Placement& placement : placements) {
    const std::set<int> theirs = cores_of_list(placement.cores);
    const bool shares = std::any_of(cores.begin(), cores.end(), [&](int core) { return theirs.count(core) > 0; });
    if (placement.host == own->host && (shares || cores.empty())) sharing += placement.ranks;
  }
  const int all = cores.empty() ? most : static_cast<int>(cores.size());
  return std::max(1, std::min(most, all / std::max(1, sharing)));
}

std::string to_text(const std::vector<RunReport::Placement>& placements) {
  std::string text;
  for (const RunReport::Placement& placement : placements)
    text += "  " + number_of(static_cast<std::size_t>(placement.ranks), "rank") + " on " + placement.host + ", " +
            number_of(static_cast<std::size_t>(placement.threads), "thread") + (placement.ranks == 1 ? "" : " each") +
            (placement.cores.empty() ? "" : ", cores " + placement.cores) + "\n";
  return text.empty() ? text : "ranks\n" + text;
}

std::vector<std::string> warnings_of(const std::vector<RunReport::Placement>& placements) {
  struct Machine {
    std::set<int> cores;
    long threads = 0;
  };
  std::map<std::string, Machine> machines;
  for (const RunReport::Placement& placement : placements) {
    machines[placement.host].cores.merge(cores_of_list(placement.cores));
    machines[placement.host].threads += long{placement.ranks} * placement.threads;
  }
  std::vector<std::string> warnings;
  for (const auto& [host, machine] : machines)
    if (const auto cores = static_cast<long>(machine.cores.size()); cores > 0 && machine.threads > cores)
      warnings.push_back("the ranks on " + host + " have " + std::to_string(machine.threads) + " threads on " +
                         number_of(machine.cores.size(), "core") +
                         ": they take turns and wait for each other; expected at most one thread for each core "
                         "(fewer ranks, or --threads)");
  return warnings;
}

}  // namespace barchan
