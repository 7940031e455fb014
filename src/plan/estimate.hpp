// What a run will take, from a few of its own steps.
#pragma once

#include "plan/plan.hpp"

namespace barchan {

struct Estimate {
  double steps = 0;  // steps to the end at the first step's length
  int threads = 1;
  double seconds = 0;            // s with these threads on a machine that does nothing else, output aside
  double processor_seconds = 0;  // s of all threads together
  double particle_steps_per_second = 0;
  double bytes = 0;                                          // memory of particles, records and lists
  std::vector<std::pair<std::string, std::uint64_t>> pairs;  // directed pairs by entry
};

/// Runs batches of steps (at most about two seconds of processor time) on a copy and scales their medians up: seconds
/// are the processor time of the calling thread, which takes part in all work, so that other programs on the machine do
/// not count. Writes nothing.
Estimate measure(const Scene& scene, const Plan& plan, const std::vector<ParticleBlock>& blocks);

std::string to_text(const Estimate& estimate);
std::string to_json(const Plan& plan, const Scene& scene, const Estimate& estimate);

}  // namespace barchan
