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

/// "1.5 GB", "320 MB".
std::string memory_text(double bytes);

}  // namespace barchan
