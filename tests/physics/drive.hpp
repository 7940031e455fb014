// Drives a scene through the library as `barchan run` does, without its output.
#pragma once

#include <gtest/gtest.h>

#include <cstdio>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "checks/reader.hpp"
#include "plan/plan.hpp"
#include "simulation/settle.hpp"
#include "simulation/simulation.hpp"
#include "start/generate.hpp"

namespace barchan::testing {

/// Path of a scene of the repository, "verification/couette".
inline std::string scene_file(const std::string& name) { return BARCHAN_SOURCE_DIR "/scenes/" + name + ".toml"; }

/// Steps up to exactly this time, s.
inline void run_to(Simulation& run, double time) {
  while (run.time() < time * (1.0 - 1e-12)) run.step(time - run.time());
}

/// Of the first column of the history that begins so, now. Throws std::out_of_range where there is none.
inline double value(const Simulation& run, const std::string& column) {
  const HistoryRow row = run.history();
  for (std::size_t k = 0; k < row.names.size(); ++k)
    if (row.names[k].starts_with(column)) return row.values[k];
  throw std::out_of_range("no column " + column);
}

/// Mean of a column over a time (s), every step.
inline double mean_of(Simulation& run, const std::string& column, double from, double to) {
  run_to(run, from);
  double sum = 0.0, before = run.time();
  while (run.time() < to * (1.0 - 1e-12)) {
    run.begin_row();
    run.step(to - run.time());
    sum += value(run, column) * (run.time() - before);
    before = run.time();
  }
  return sum / (to - from);
}

/// A scene in progress.
class Drive {
 public:
  explicit Drive(const std::string& name, const std::vector<std::string>& overrides = {})
      : scene_(read_scene(scene_file(name), overrides)) {
    const auto blocks = make_particles(scene_);
    simulation_ = std::make_unique<Simulation>(scene_, make_plan(scene_, blocks), blocks);
  }

  /// Steps up to exactly this time, s.
  void to(double time) { run_to(*simulation_, time); }

  Simulation& simulation() { return *simulation_; }
  const Scene& scene() const { return scene_; }
  const Plan& plan() const { return simulation_->plan(); }
  PhaseParticles& phase(std::size_t k) { return simulation_->phases()[k]; }

 private:
  Scene scene_;
  std::unique_ptr<Simulation> simulation_;
};

/// Prints a measured figure beside its bound and keeps it in the test's XML.
inline void report(const std::string& what, double measured, double bound) {
  char value[32];
  std::snprintf(value, sizeof value, "%.3g", measured);
  std::printf("  %-48s %10s   bound %.3g\n", what.c_str(), value, bound);
  ::testing::Test::RecordProperty(what, value);
}

}  // namespace barchan::testing
