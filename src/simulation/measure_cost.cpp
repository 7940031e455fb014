#include "simulation/measure_cost.hpp"

#include <omp.h>

#include <algorithm>
#include <cmath>

#include "base/clock.hpp"
#include "base/errors.hpp"
#include "base/memory.hpp"
#include "scene/shared_start.hpp"
#include "simulation/measure_ranks.hpp"

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
  std::optional<RankMeasure> on_ranks;
  if (ranks > 0) {
    simulation.measure_processor_time();
    on_ranks.emplace(simulation, ranks);
  }
  constexpr int batch = 10;
  constexpr long most_steps = 300;
  constexpr long settling = 10;  // steps: of ranks, what goes between them is counted after them
  const double most_seconds = on_ranks ? 10.0 : 2.0;
  const auto goes_on = [&] { return simulation.time() < scene.time.end * (1 - 1e-12); };
  std::vector<double> seconds, lengths;  // of each batch: of processor time a step, and of simulated time a step
  const double start = thread_seconds();
  while (simulation.steps() < most_steps && thread_seconds() - start < most_seconds && goes_on()) {
    const double begin = thread_seconds(), time = simulation.time();
    int steps = 0;
    try {
      for (; steps < batch && thread_seconds() - start < most_seconds && goes_on(); ++steps) {
        simulation.step(scene.time.end - simulation.time());
        if (on_ranks && simulation.steps() == 1 && goes_on())
          on_ranks->begin();  // the first step has what starts a run
      }
    } catch (const BreakdownError& error) { e.failure = error.what(); }
    if (!e.failure.empty() && steps == 0) break;
    if (on_ranks && simulation.steps() == settling && goes_on()) on_ranks->begin();
    seconds.push_back((thread_seconds() - begin) / steps);
    lengths.push_back((simulation.time() - time) / steps);
    if (!e.failure.empty()) break;
  }
  omp_set_num_threads(e.threads);
  e.bytes = static_cast<double>(simulation.bytes());
  for (const auto& entry : plan.entries) e.pairs.emplace_back(entry.name, simulation.pairs(entry));
  if (!lengths.empty()) e.steps = scene.time.end / median(lengths);
  e.memory = memory_of_a_run(simulation, before, retreats ? states_kept(e.steps) : 0.0);
  if (on_ranks)
    e.ranks = on_ranks->plan(median(seconds), {part_of(e.memory, "program"), part_of(e.memory, "arrays"), of_blocks,
                                               part_of(e.memory, "a frame"), part_of(e.memory, "states to go back to"),
                                               why_start_is_whole(scene)});
  if (lengths.empty()) return e;
  e.measured = true;
  e.processor_seconds = e.steps * median(seconds);
  e.seconds = e.processor_seconds / e.threads;
  e.particle_steps_per_second = plan.particles() / median(seconds);
  return e;
}

}  // namespace barchan
