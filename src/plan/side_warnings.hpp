// Walls that are not where a scene needs them.
#pragma once

#include <vector>

#include "plan/plan.hpp"
#include "start/generate.hpp"

namespace barchan {

/// Warnings of sides of the domain that nothing closes, and of walls far outside the domain.
void add_side_warnings(const Scene& scene, const std::vector<ParticleBlock>& blocks, Plan& plan);

}  // namespace barchan
