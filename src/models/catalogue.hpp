// Which model each phase and each entry of a scene has: the one place that asks for the kind of a phase.
#pragma once

#include <optional>

#include "models/model.hpp"

namespace barchan {

/// What the descriptions of other phases ask: sizes, who moves, who flows. Names, counts and spacings are there.
void declare_phases(const Scene& scene, Layout& layout);

/// What the plan has to know of the phases before entries are made. Throws SceneError where only the particles show a
/// mistake.
void describe_phases(const Scene& scene, const std::vector<ParticleBlock>& blocks, Layout& layout,
                     std::vector<std::string>& warnings);

/// What the law of an entry declares, and which of its phases is the fluid; the numbers of the scene are there. Throws
/// SceneError when there is no law for their kinds.
void describe_entry(const Scene& scene, const Interaction& pair, const Layout& layout, PlanEntry& entry);

/// The second entry that a pair has where parts of one body touch each other.
std::optional<PlanEntry> contact_with_itself(const Scene& scene, const Interaction& pair, const Layout& layout,
                                             const PlanEntry& entry);

/// The models of a scene, in the order in which they act within a stage of the step.
Models make_models(const Scene& scene, const Layout& layout);

/// Their tasks.
Schedule make_schedule(const Models& models);

}  // namespace barchan
