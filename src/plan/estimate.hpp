// What a run will take, from a few of its own steps.
#pragma once

#include "plan/plan.hpp"

namespace barchan {

struct Estimate {
  double steps = 0;              // steps to the end at the first step's length
  double processor_seconds = 0;  // s of one thread, output aside
  int threads = 1;
  double seconds = 0;  // s if the threads share it evenly and nothing else runs on the machine
  double particle_steps_per_second = 0;
  double bytes = 0;                                          // memory of particles, records and lists
  std::vector<std::pair<std::string, std::uint64_t>> pairs;  // directed pairs by entry
};

/// Runs batches of steps with one thread (at most about two seconds) on a copy and scales their medians up. Processor
/// time, so that other programs on the machine do not count. `threads` are those that OpenMP is set to. Writes nothing.
Estimate measure(const Scene& scene, const Plan& plan, const std::vector<ParticleBlock>& blocks);

std::string to_text(const Estimate& estimate);
std::string to_json(const Plan& plan, const Scene& scene, const Estimate& estimate);

}  // namespace barchan
