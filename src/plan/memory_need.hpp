// The memory that a run will take, from the plan alone: known before anything is allocated.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "plan/plan.hpp"

namespace barchan {

struct MemoryNeed {
  std::vector<std::pair<std::string, double>> parts;  // bytes, of each kind of array
  double bytes() const;
};

/// `retreats`: whether states of the past are kept to go back to. The lists are reckoned as in a full neighbourhood,
/// which only a particle inside has, so they are an upper bound.
MemoryNeed memory_need(const Scene& scene, const Plan& plan, bool retreats);

/// Throws SceneError with the numbers when the machine, the control group or ulimit leave less than that.
void check_memory(const Scene& scene, const MemoryNeed& need);

std::string to_text(const MemoryNeed& need);

}  // namespace barchan
