// Fluids that touch each other and nothing else keep their momentum.
#pragma once

#include <memory>

#include "models/model.hpp"

namespace barchan {

/// Along the periodic axes on which nothing but weight acts, the fluids of the consistent scheme that meet at
/// interfaces get the uniform acceleration that closes their momentum, as an enclosed fluid keeps its mean density.
/// The corrected sums conserve momentum to the order of the scheme only: of a layer 830 times as light as the one under
/// it they made 15 % in the first steps (1e-4 m/s of the heavy one, each layer at its own speed, perturb 0.1).
/// Null where nothing is to be kept: other walls than sides with free slip, bodies, grains, [[forcing]], open sides.
std::unique_ptr<Model> kept_momentum(const Scene& scene, const Layout& layout);

}  // namespace barchan
