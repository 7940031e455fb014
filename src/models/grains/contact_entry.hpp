// An entry whose law is a contact through its kernel: grains with grains, walls or bodies; and the paper's wall of
// ghosts for a fluid.
#pragma once

#include <memory>

#include "models/model.hpp"

namespace barchan {

/// Throws SceneError when the entry's radius is so short that touching grains do not feel each other.
std::unique_ptr<Model> make_contact_entry(const Scene& scene, const Layout& layout, const PlanEntry& entry);

}  // namespace barchan
