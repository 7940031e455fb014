// The memory that a run will take: a bound from the plan alone, which is known before anything is allocated, or what
// the run's own arrays take (simulation/measure_cost.hpp).
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "plan/plan.hpp"

namespace barchan {

/// A run keeps its state every so many steps, to go back to; so many at the most.
inline constexpr long steps_between_states = 256;
inline constexpr std::size_t most_states = 2;

struct MemoryNeed {
  std::vector<std::pair<std::string, double>> parts;  // bytes, of each kind of array
  bool measured = false;                              // or reckoned
  double bytes() const;
};

/// `retreats`: whether states of the past are kept to go back to. An upper bound: the lists are reckoned as in a full
/// neighbourhood, which only a particle inside has.
MemoryNeed memory_need(const Scene& scene, const Plan& plan, bool retreats);

/// Throws SceneError with the numbers when the machine, the control group or ulimit leave less than that.
void check_memory(const Scene& scene, const MemoryNeed& need);

std::string to_text(const MemoryNeed& need);

}  // namespace barchan
