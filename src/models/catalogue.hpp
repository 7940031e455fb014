// Which model each phase and each entry of a scene has: the one place that asks for the kind of a phase.
#pragma once

#include "models/model.hpp"

namespace barchan {

/// What the plan has to know of the phases before entries are made; names, counts and masses are there. Throws
/// SceneError where only the particles show a mistake.
void describe_phases(const Scene& scene, const std::vector<ParticleBlock>& blocks, Layout& layout,
                     std::vector<std::string>& warnings);

/// The law of an entry, and which of its phases is a fluid. Throws SceneError when there is no law for their kinds.
void classify(const Scene& scene, PlanEntry& entry);

/// The models of a scene, in the order in which they act within a stage of the step.
Models make_models(const Scene& scene, const Layout& layout);

/// Their tasks.
Schedule make_schedule(const Models& models);

}  // namespace barchan
