// Scene -> Plan: decides fields, lists, limits and tasks of a run. All later parts take them from the plan.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "engine/schedule.hpp"
#include "measure/instrument.hpp"
#include "models/layout.hpp"
#include "models/step_limits.hpp"
#include "scene/scene.hpp"
#include "start/generate.hpp"

namespace barchan {

struct Plan : Layout {
  std::vector<StepLimit> limits;
  std::vector<std::string> passes, skipped;  // stages of the schedule with and without tasks
  std::vector<RepeatCount> repeats;          // tasks that a step does not call once; nothing is counted yet
  std::vector<Instrument> instruments;       // what is measured
  double step() const;                       ///< the smallest limit, s (or the fixed step)
  double fixed_step = 0;                     // s, 0: none
  std::vector<std::string> warnings;         // what the scene may mean otherwise, one sentence each
};

/// Decides. What no law can do was refused when the scene was read (checks/check_physics.cpp). Throws SceneError where
/// only the particles show a mistake: no speed to choose a sound speed from.
Plan make_plan(const Scene& scene, const std::vector<ParticleBlock>& blocks);

/// Fills Plan::warnings; the last work of make_plan.
void add_warnings(const Scene& scene, const std::vector<ParticleBlock>& blocks, Plan& plan);

/// Adds warnings of fluids and elastic bodies whose rows of particles miss the mass of their shapes by more than 1e-3.
void warn_of_missed_mass(const Scene& scene, const std::vector<ParticleBlock>& blocks, Plan& plan);

/// Adds warnings of what lies outside the ranges of the stability atlas (docs/stability.md).
void warn_outside_stable_ranges(const Scene& scene, Plan& plan);

/// The plan as a person reads it (estimate.hpp has it as JSON).
std::string to_text(const Plan& plan, const Scene& scene);

}  // namespace barchan
