// The time and memory of a run, as simulation/measure_cost.hpp measures them.
#pragma once

#include <optional>

#include "plan/memory_need.hpp"
#include "plan/rank_plan.hpp"

namespace barchan {

struct Estimate {
  std::string failure;  // why the measurement failed or stopped early; empty: it did not
  bool measured = false;
  double steps = 0;              // steps to the end at the first step's length
  double processor_seconds = 0;  // s of one thread, output aside
  int threads = 1;
  double seconds = 0;  // s if the threads share it evenly and nothing else runs on the machine
  double particle_steps_per_second = 0;
  double bytes = 0;                                          // memory of particles, records and lists
  MemoryNeed memory;                                         // of a run, measured; no parts: it was not
  double start_seconds = 0;                                  // s before the first step: particles are made, beds settle
  std::vector<std::pair<std::string, std::uint64_t>> pairs;  // directed pairs by entry
  std::vector<std::string> history;                          // columns of history.csv
  std::optional<RankPlan> ranks;                             // of a run on several ranks; none: not asked for
};

std::string to_text(const Estimate& estimate);
std::string to_json(const Plan& plan, const Scene& scene, const Estimate& estimate);

}  // namespace barchan
