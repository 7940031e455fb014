#include "base/memory.hpp"

#include <malloc.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cstdio>
#include <fstream>
#include <sstream>

namespace barchan {

namespace {

/// The number of a file that holds nothing else; negative: none ("max", no such file).
double number_in(const std::string& file) {
  std::ifstream stream(file);
  double value = -1.0;
  return stream >> value ? value : -1.0;
}

void lower(AvailableMemory& least, double bytes, const char* of) {
  if (bytes < least.bytes) least = {bytes > 0.0 ? bytes : 0.0, of};
}

/// What the machine can give without taking it from programs: MemAvailable of /proc/meminfo, kB.
void ask_machine(AvailableMemory& least) {
  std::ifstream stream("/proc/meminfo");
  for (std::string line; std::getline(stream, line);)
    if (double kilobytes = 0; std::sscanf(line.c_str(), "MemAvailable: %lf", &kilobytes) == 1)
      lower(least, kilobytes * 1024.0, "the machine");
}

/// Versions 2 and 1 of Linux' control groups, as this process sees them; parents limit too.
void ask_control_group(AvailableMemory& least) {
  std::ifstream stream("/proc/self/cgroup");
  for (std::string line; std::getline(stream, line);) {
    const bool second = line.starts_with("0::");
    if (!second && line.find(":memory:") == std::string::npos) continue;
    const std::string root = second ? "/sys/fs/cgroup" : "/sys/fs/cgroup/memory";
    std::string group = line.substr(line.rfind(':') + 1);
    while (true) {
      const std::string folder = root + (group == "/" ? "" : group);
      const double limit = number_in(folder + (second ? "/memory.max" : "/memory.limit_in_bytes"));
      const double used = number_in(folder + (second ? "/memory.current" : "/memory.usage_in_bytes"));
      if (limit >= 0.0 && used >= 0.0) lower(least, limit - used, "the control group");
      if (group.empty() || group == "/") break;
      group.resize(group.rfind('/'));
    }
  }
}

/// What /proc/self/statm tells, bytes.
struct Pages {
  double size = 0, resident = -1, data = 0;  // addresses; in memory; private
};

Pages pages() {
  double size = 0, resident = 0, shared = 0, text = 0, library = 0, data = 0;
  std::ifstream stream("/proc/self/statm");
  if (!(stream >> size >> resident >> shared >> text >> library >> data)) return {};
  const auto page = static_cast<double>(sysconf(_SC_PAGESIZE));
  return {size * page, resident * page, data * page};
}

/// RLIMIT_AS counts addresses, RLIMIT_DATA private memory.
void ask_limits(AvailableMemory& least) {
  const Pages now = pages();
  rlimit limit{};
  if (getrlimit(RLIMIT_AS, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY)
    lower(least, static_cast<double>(limit.rlim_cur) - now.size, "ulimit -v");
  if (getrlimit(RLIMIT_DATA, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY)
    lower(least, static_cast<double>(limit.rlim_cur) - now.data, "ulimit -d");
}

}  // namespace

AvailableMemory available_memory() {
  AvailableMemory least;
  ask_machine(least);
  ask_control_group(least);
  ask_limits(least);
  return least;
}

double allocated_memory() {
#ifdef __GLIBC__
  const auto heap = mallinfo2();
  const auto bytes = static_cast<double>(heap.uordblks) + static_cast<double>(heap.hblkhd);
  return bytes > 0.0 ? bytes : -1.0;  // a sanitizer's allocator tells nothing
#else
  return -1.0;
#endif
}

double heap_memory() {
#ifdef __GLIBC__
  return static_cast<double>(mallinfo2().uordblks);
#else
  return 0.0;
#endif
}

double resident_memory() { return pages().resident; }

double mapped_memory() { return pages().size; }

double most_resident_memory() {
  std::ifstream stream("/proc/self/status");
  for (std::string line; std::getline(stream, line);)
    if (double kilobytes = 0; std::sscanf(line.c_str(), "VmHWM: %lf", &kilobytes) == 1) return 1024.0 * kilobytes;
  return -1.0;
}

void return_freed_arrays() {
#ifdef __GLIBC__
  mallopt(M_MMAP_THRESHOLD, 1 << 17);
  mallopt(M_ARENA_MAX, 1);  // steps allocate nothing, so that threads need no memory of their own
#endif
}

std::string memory_text(double bytes) {
  char text[40];
  if (bytes >= 1e9) std::snprintf(text, sizeof text, "%.3g GB", bytes * 1e-9);
  else std::snprintf(text, sizeof text, "%.3g MB", bytes * 1e-6);
  return text;
}

}  // namespace barchan
