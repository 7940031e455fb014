#include "simulation/measure_cost.hpp"

#include <omp.h>

#include <algorithm>
#include <cmath>

#include "base/clock.hpp"
#include "base/errors.hpp"
#include "base/memory.hpp"
#include "simulation/measure_ranks.hpp"
#include "start/shared_start.hpp"

namespace barchan {

namespace {

double median(std::vector<double> values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// What a run holds at the most, from what this process holds now that has made the same steps: besides, a run writes
/// frames, one at a time, and keeps `states` to go back to. `before`: allocated_memory() without the simulation.
MemoryNeed memory_of_a_run(Simulation& simulation, double before, double states) {
  constexpr double writer = 3.1e6;   // VTK's writer and its buffers, the threads: code and data, measured
  constexpr double disorder = 0.04;  // of the arrays: by what lists grow in a long run, measured
  constexpr double holes = 0.06;     // of the heap: between blocks of the writer and of the steps, measured
  constexpr double of_a_vertex = 2 * sizeof(std::int32_t);  // of a frame, made when it is written
  const double now = resident_memory(), allocated = allocated_memory();
  MemoryNeed need;
  need.measured = true;
  if (now < 0.0 || allocated < 0.0) return need;
  const double arrays = allocated - before;
  const double state = static_cast<double>(size_of([&](Archive& a) { simulation.archive(a); }));
  const Frame frame = simulation.frame(0);
  need.parts = {{"program", now - arrays + writer},
                {"arrays", (1.0 + disorder) * arrays + holes * heap_memory()},
                {"a frame", static_cast<double>(frame.bytes()) + of_a_vertex * static_cast<double>(frame.size())}};
  if (states > 0.0) need.parts.emplace_back("states to go back to", states * state);
  if (const double more = most_resident_memory() - need.bytes(); more > 0.0)
    need.parts.emplace_back("more at the start", more);
  return need;
}

double states_kept(double steps) {
  return std::min(static_cast<double>(most_states),
                  1.0 + std::floor(steps / static_cast<double>(steps_between_states)));
}

double bytes_of(const std::vector<ParticleBlock>& blocks) {
  std::size_t bytes = 0;
  const auto add = [&](const auto& values) { bytes += values.capacity() * sizeof values[0]; };
  for (const ParticleBlock& b : blocks) {
    add(b.position);
    add(b.velocity);
    add(b.pressure);
    add(b.parts);
    add(b.radius);
    add(b.contacts);
    add(b.normal);
    add(b.depth);
    add(b.bend);
  }
  return static_cast<double>(bytes);
}

double part_of(const MemoryNeed& need, const std::string& name) {
  for (const auto& [part, bytes] : need.parts)
    if (part == name) return bytes;
  return 0.0;
}

/// What steps cost, at most ten at a time.
struct Batches {
  static constexpr int most = 10;
  std::vector<int> steps;
  std::vector<double> seconds, lengths;  // of a step: processor time, s, and simulated time, s

  struct Cost {
    double steps, seconds;
  };
  /// Of a run to the time `end`, s: the batches before `last` as they were, then the medians of those from it on.
  Cost to(double end, std::size_t last) const {
    Cost cost{0.0, 0.0};
    for (std::size_t k = 0; k < last; ++k) {
      cost.steps += steps[k];
      cost.seconds += steps[k] * seconds[k];
      end -= steps[k] * lengths[k];
    }
    const auto from = static_cast<std::ptrdiff_t>(last);
    const double more = end / median({lengths.begin() + from, lengths.end()});
    return {cost.steps + more, cost.seconds + more * median({seconds.begin() + from, seconds.end()})};
  }
};

// A loose bed makes its contacts in some thousand steps, and they are most of what it costs from then on: while pairs
// become more, so many times in 300 steps, steps are made for so many seconds.
constexpr double growth = 1.02, more_seconds = 4.0;

}  // namespace

Estimate measure(const Scene& scene, const Plan& plan, std::vector<ParticleBlock> blocks, bool retreats, int ranks) {
  Estimate e;
  e.threads = omp_get_max_threads();
  // One thread does the work: several that wait for each other on a busy machine would count their waiting.
  omp_set_num_threads(1);
  double before = allocated_memory();
  const double of_blocks = bytes_of(blocks);
  before -= of_blocks;
  Simulation simulation(scene, plan, std::move(blocks));
  simulation.check_start();
  e.history = simulation.history().names;
  std::optional<RankMeasure> on_ranks;
  if (ranks > 0) on_ranks.emplace(simulation, ranks);
  Batches batches;
  const auto goes_on = [&] { return simulation.time() < scene.time.end * (1 - 1e-12); };
  const auto make = [&](long most_steps, double most_seconds) {
    const double start = thread_seconds();
    while (e.failure.empty() && simulation.steps() < most_steps && thread_seconds() - start < most_seconds &&
           goes_on()) {
      const double begin = thread_seconds(), time = simulation.time();
      int steps = 0;
      try {
        for (; steps < Batches::most && thread_seconds() - start < most_seconds && goes_on(); ++steps)
          simulation.step(scene.time.end - simulation.time());
      } catch (const BreakdownError& error) { e.failure = error.what(); }
      if (steps == 0) break;
      batches.steps.push_back(steps);
      batches.seconds.push_back((thread_seconds() - begin) / steps);
      batches.lengths.push_back((simulation.time() - time) / steps);
    }
  };
  const auto pairs = [&] {
    std::uint64_t all = 0;
    for (const auto& entry : plan.entries) all += simulation.pairs(entry);
    return all;
  };
  constexpr long first_steps = 300;
  make(first_steps / 2, 1.0);
  std::uint64_t before_pairs = pairs();
  make(first_steps, 1.0);
  e.bytes = static_cast<double>(simulation.bytes());
  if (!batches.lengths.empty()) e.steps = scene.time.end / median(batches.lengths);
  e.memory = memory_of_a_run(simulation, before, retreats ? states_kept(e.steps) : 0.0);
  if (on_ranks)
    e.ranks = on_ranks->plan({part_of(e.memory, "program"), part_of(e.memory, "arrays"), of_blocks,
                              part_of(e.memory, "a frame"), part_of(e.memory, "states to go back to"),
                              why_start_is_whole(scene)});
  const std::size_t first_batches = batches.seconds.size();
  const double end_of_more = thread_seconds() + more_seconds;
  while (e.failure.empty() && goes_on() && thread_seconds() < end_of_more &&
         static_cast<double>(pairs()) > growth * static_cast<double>(before_pairs)) {
    before_pairs = pairs();
    make(simulation.steps() + first_steps, end_of_more - thread_seconds());
  }
  for (const auto& entry : plan.entries) e.pairs.emplace_back(entry.name, simulation.pairs(entry));
  omp_set_num_threads(e.threads);
  if (batches.lengths.empty()) return e;
  e.measured = true;
  const auto [steps, processor_seconds] =
      batches.to(scene.time.end, batches.seconds.size() > first_batches ? batches.seconds.size() * 3 / 4 : 0);
  e.steps = steps;
  e.processor_seconds = processor_seconds;
  e.seconds = e.processor_seconds / e.threads;
  e.particle_steps_per_second = plan.particles() * e.steps / e.processor_seconds;
  return e;
}

}  // namespace barchan
