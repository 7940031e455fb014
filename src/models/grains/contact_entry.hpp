// Entries whose law is a contact through their kernel: grains with grains, walls or bodies; and the paper's wall of
// ghosts for a fluid.
#pragma once

#include <memory>

#include "models/model.hpp"

namespace barchan {

/// A contact of grains with grains, walls or bodies.
void describe_kernel_contact(const Scene& scene, const Interaction& pair, const Layout& layout, PlanEntry& e);
/// Throws SceneError when the entry's radius is so short that touching grains do not feel each other.
std::unique_ptr<Model> make_contact_entry(const Scene& scene, const Layout& layout, const PlanEntry& entry);

/// One row of ghosts that push a fluid (Halik et al. 2015, section 6; Monaghan 1994).
void describe_ghosts(const Scene& scene, const Interaction& pair, const Layout& layout, PlanEntry& e);
std::unique_ptr<Model> make_ghosts(const Scene& scene, const Layout& layout, const PlanEntry& entry);

}  // namespace barchan
