// How much memory this process may still take.
#pragma once

#include <string>

namespace barchan {

struct AvailableMemory {
  double bytes = 1e300;       // infinite where nothing tells it
  std::string of = "nobody";  // "the machine", "the control group", "ulimit -v"
};

/// The least of what the machine has, the limits of the control group, and those of ulimit leave.
AvailableMemory available_memory();

/// Bytes that this program has allocated and not freed; negative where the C library does not tell.
double allocated_memory();

/// Bytes of it in blocks too small to be given back one by one; 0 where the C library does not tell.
double heap_memory();

/// Bytes of the machine's memory that this process holds now, and the most that it has held, shared libraries included;
/// negative where nothing tells.
double resident_memory();
double most_resident_memory();

/// Bytes of addresses that this process has in use, which RLIMIT_AS counts; 0 where nothing tells.
double mapped_memory();

/// From now on large arrays that are freed go back to the machine at once, so that what a process holds is what it has
/// allocated. Does nothing where the C library has no such switch.
void return_freed_arrays();

/// "1.5 GB", "320 MB".
std::string memory_text(double bytes);

}  // namespace barchan
