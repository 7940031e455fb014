// What a run on several ranks cannot do yet.
#pragma once

#include "plan/plan.hpp"

namespace barchan {

/// Throws SceneError with the name of the first thing in the scene that cannot run on several ranks.
void check_for_ranks(const Scene& scene, const Plan& plan);

}  // namespace barchan
