// Drives a scene through the library as `barchan run` does, without its output.
#pragma once

#include <gtest/gtest.h>

#include <cstdio>
#include <memory>
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

/// A scene in progress.
class Drive {
 public:
  explicit Drive(const std::string& name, const std::vector<std::string>& overrides = {})
      : scene_(read_scene(scene_file(name), overrides)) {
    const auto blocks = make_particles(scene_);
    simulation_ = std::make_unique<Simulation>(scene_, make_plan(scene_, blocks), blocks);
  }

  /// Steps up to exactly this time, s.
  void to(double time) {
    while (simulation_->time() < time * (1.0 - 1e-12)) simulation_->step(time - simulation_->time());
  }

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
