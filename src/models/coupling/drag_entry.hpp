// An entry of a fluid and grains with a form drag given by a number.
#pragma once

#include <memory>

#include "models/model.hpp"

namespace barchan {

/// Null: the entry has no such drag.
std::unique_ptr<Model> make_drag_entry(const Scene& scene, const Layout& layout, const PlanEntry& entry);

}  // namespace barchan
