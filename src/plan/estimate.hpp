// What a run will take, from a few of its own steps.
#pragma once

#include "plan/plan.hpp"

namespace barchan {

struct Estimate {
  double steps = 0;    // steps to the end at the first step's length
  double seconds = 0;  // s of wall time, output aside
  double particle_steps_per_second = 0;
  double bytes = 0;                                          // memory of particles, records and lists
  std::vector<std::pair<std::string, std::uint64_t>> pairs;  // directed pairs by entry
};

/// Runs a handful of steps (at most about two seconds) on a copy and scales them up. Writes nothing.
Estimate measure(const Scene& scene, const Plan& plan, const std::vector<ParticleBlock>& blocks);

std::string to_text(const Estimate& estimate);
std::string to_json(const Plan& plan, const Scene& scene, const Estimate& estimate);

}  // namespace barchan
