// The time and memory of a run, estimated from a few of its own steps.
#pragma once

#include "plan/run_cost.hpp"
#include "start/generate.hpp"

namespace barchan {

/// Runs batches of steps with one thread (at most about two seconds, ten with `ranks`; four more while the pairs become
/// more, as in a loose bed of grains) on a copy and scales their medians up. Processor time, so that other programs on
/// the machine do not count. `threads` are those that OpenMP is set to. Writes nothing. `blocks` are given back once
/// the simulation has them, as a run does. `retreats`: as in memory_need(). `ranks` > 0: what a run on so many ranks
/// would be as well.
Estimate measure(const Scene& scene, const Plan& plan, std::vector<ParticleBlock> blocks, bool retreats, int ranks = 0);

}  // namespace barchan
