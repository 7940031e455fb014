// Artificial stress of updated Lagrangian bodies: laws/elastic.hpp.
#pragma once

#include "engine/records.hpp"
#include "state/particles.hpp"

namespace barchan {

/// Writes -strength [sigma/rho^2]+ (Pa m6/kg2) of each particle, sigma = s - p I: [ ]+ keeps the principal stresses
/// that pull; of those in the plane in two dimensions.
void pack_artificial_stress(const PhaseParticles& body, double strength, RecordArray& records);

}  // namespace barchan
