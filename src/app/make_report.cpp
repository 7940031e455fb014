#include "app/make_report.hpp"

#include <omp.h>
#include <unistd.h>

#include <algorithm>
#include <ctime>

#include "base/errors.hpp"
#include "base/memory.hpp"
#include "base/ranks.hpp"
#include "base/version.hpp"
#include "engine/rank_load.hpp"
#include "output/folder_lock.hpp"

namespace barchan {

namespace {

double cpu_seconds() {
  timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

void add_plan(RunReport& r, const Simulation& simulation) {
  for (const auto& p : simulation.plan().phases) {
    r.particles[p.name] = static_cast<long>(p.count);
    for (const Field f : p.fields) r.fields[p.name].emplace_back(info(f).name);
  }
  for (const auto& e : simulation.plan().entries) r.pairs[e.name] = static_cast<long>(simulation.pairs(e));
}

/// Adds the passes and their seconds; returns the seconds of all steps.
double add_passes(RunReport& r, const Simulation& simulation) {
  double stepping = 0;
  for (std::size_t k = 0; k < simulation.seconds().size(); ++k) {
    const auto& [name, seconds] = simulation.seconds()[k];
    stepping += seconds;
    if (simulation.executed()[k] == 0) continue;
    r.passes.push_back(name);
    r.seconds.emplace_back(name, seconds);
  }
  r.repeats = simulation.schedule().repeats();
  return stepping;
}

void add_measured(RunReport& r, const Plan& plan, const Measurements& measurements) {
  r.seconds.emplace_back("measuring", measurements.seconds());
  for (std::size_t k = 0; k < plan.instruments.size(); ++k) {
    const Instrument& i = plan.instruments[k];
    r.measured.push_back(
        {kind_name(i.kind), i.name, i.files(), static_cast<long>(measurements.accumulators().moments[k])});
  }
}

void add_budgets(RunReport& r, const Simulation& simulation) {
  const HistoryRow row = simulation.history();
  for (std::size_t c = HistoryRow::dt; c < row.names.size(); ++c)
    r.budgets[row.names[c].substr(0, row.names[c].find(" ["))] = row.values[c];
  if (const auto drift = simulation.budget().momentum_drift(simulation.state())) r.budgets["momentum_drift"] = *drift;
  if (const auto drift = simulation.budget().turning_drift(simulation.state()))
    r.budgets["angular_momentum_drift"] = *drift;
  if (const auto growth = simulation.budget().energy_growth(simulation.state(), simulation.held_energy()))
    r.budgets["energy_growth"] = *growth;
  r.budgets["neighbour_rebuilds"] = static_cast<double>(simulation.searches());
  r.budgets["bytes_per_particle"] =
      static_cast<double>(simulation.bytes()) / std::max(simulation.plan().particles(), 1.0);
}

}  // namespace

RunReport start_report(const Scene& scene) {
  RunReport r;
  r.version = version();
  r.commit = commit();
  r.compiler = compiler();
  r.instruction_set = instruction_set();
  r.vtk = vtk_version();
  r.threads = omp_get_max_threads();
  r.scene_title = scene.title;
  r.scene_file = scene.file;
  r.overrides = scene.overrides;
  r.scene_state = scene.state;
  r.scene_spacing = scene.spacing;
  r.scene_gravity = {scene.domain.gravity[0], scene.domain.gravity[1], scene.domain.gravity[2]};
  r.process = ::getpid();
  r.host = host_name();
  return r;
}

namespace {

/// What the ranks have sent to each other; all of them call it.
RunReport::Ranks traffic(const Simulation& simulation) {
  RunReport::Ranks r;
  Communicator* const all = ranks::active();
  if (!all) return r;
  const Communicator::Traffic mine = all->traffic();
  r.count = all->size();
  r.collectives = mine.collectives;
  r.messages = ranks::total(mine.messages);
  r.bytes = ranks::total(mine.bytes);
  std::int64_t particles = 0, ghosts = 0;
  for (std::size_t p = 0; p < simulation.phases().size(); ++p) {
    particles += static_cast<std::int64_t>(simulation.phases()[p].size());
    const Neighbours& neighbours = simulation.neighbours();
    if (neighbours.has_grid(p) && neighbours.grid(p).is_shared())
      ghosts += static_cast<std::int64_t>(neighbours.grid(p).images());
  }
  r.ghosts = ranks::total(ghosts);
  r.most_particles = ranks::largest(particles);
  const double memory = most_resident_memory();
  r.memory_of_first = ranks::of_first(true, memory);
  r.most_memory_of_others = ranks::largest(ranks::is_first() ? 0.0 : memory);
  const RankLoad& load = simulation.neighbours().load();
  for (const RankLoad::Seconds& seconds : ranks::each(load.seconds())) {
    r.busy_seconds.push_back(seconds.busy);
    r.waiting_seconds.push_back(seconds.waiting);
  }
  r.division = name_of(simulation.neighbours().division());
  r.divisions = load.divisions();
  r.dividing_seconds = ranks::largest(load.seconds_dividing());
  return r;
}

}  // namespace

RunReport make_report(const Simulation& simulation, const SeriesWriter* series, const Measurements* measurements,
                      const Progress& progress) {
  RunReport r = start_report(simulation.scene());
  add_plan(r, simulation);
  r.steps = simulation.steps();
  r.simulated_time = simulation.time();
  const double stepping = add_passes(r, simulation);
  r.seconds.emplace_back("output (waiting)", series ? series->seconds_waiting() : 0.0);
  r.seconds.emplace_back("output (behind)", series ? series->seconds_writing() : 0.0);
  if (measurements) add_measured(r, simulation.plan(), *measurements);
  r.wall_seconds = progress.seconds();
  r.cpu_seconds = cpu_seconds();
  double pairs = 0;
  for (const auto& [name, count] : r.pairs) pairs += static_cast<double>(count);
  const double steps = static_cast<double>(std::max(simulation.steps(), 1L));
  r.particle_steps_per_second = simulation.plan().particles() * steps / std::max(stepping, 1e-9);
  r.pair_interactions_per_second = pairs * steps / std::max(stepping, 1e-9);
  for (const auto& [limit, count] : simulation.limit_counts())
    if (count > 0) r.time_step_limits[limit] = count;
  add_budgets(r, simulation);
  r.ranks = traffic(simulation);
  r.warnings = simulation.plan().warnings;
  for (const std::string& warning : simulation.warnings().texts()) r.warnings.push_back(warning);
  return r;
}

void try_to_write(const std::filesystem::path& file, const RunReport& report) {
  try {
    write_run_report(file, report);
  } catch (const OutputError&) { overwrite_run_report(file, report); }
}

}  // namespace barchan
