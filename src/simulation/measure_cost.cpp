#include "simulation/measure_cost.hpp"

#include <omp.h>

#include <algorithm>
#include <ctime>

#include "base/errors.hpp"
#include "simulation/simulation.hpp"

namespace barchan {

namespace {

double median(std::vector<double> values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

Estimate measure(const Scene& scene, const Plan& plan, const std::vector<ParticleBlock>& blocks) {
  Estimate e;
  e.threads = omp_get_max_threads();
  // One thread does the work: several that wait for each other on a busy machine would count their waiting.
  omp_set_num_threads(1);
  Simulation simulation(scene, plan, blocks);
  simulation.check_start();
  constexpr int batch = 10;
  constexpr long most_steps = 300;
  constexpr double most_seconds = 2.0;
  const auto processor = [] {
    timespec t{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
  };
  const auto goes_on = [&] { return simulation.time() < scene.time.end * (1 - 1e-12); };
  std::vector<double> seconds, lengths;  // of each batch: of processor time a step, and of simulated time a step
  const double start = processor();
  while (simulation.steps() < most_steps && processor() - start < most_seconds && goes_on()) {
    const double before = processor(), time = simulation.time();
    int steps = 0;
    try {
      for (; steps < batch && processor() - start < most_seconds && goes_on(); ++steps)
        simulation.step(scene.time.end - simulation.time());
    } catch (const BreakdownError& error) { e.failure = error.what(); }
    if (!e.failure.empty() && steps == 0) break;
    seconds.push_back((processor() - before) / steps);
    lengths.push_back((simulation.time() - time) / steps);
    if (!e.failure.empty()) break;
  }
  omp_set_num_threads(e.threads);
  e.bytes = static_cast<double>(simulation.bytes());
  for (const auto& entry : plan.entries) e.pairs.emplace_back(entry.name, simulation.pairs(entry));
  if (lengths.empty()) return e;
  e.measured = true;
  e.steps = scene.time.end / median(lengths);
  e.processor_seconds = e.steps * median(seconds);
  e.seconds = e.processor_seconds / e.threads;
  e.particle_steps_per_second = plan.particles() / median(seconds);
  return e;
}

}  // namespace barchan
