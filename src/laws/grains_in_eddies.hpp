// Grains in a fluid as they act on its turbulence (laws/k_omega.hpp: slow_eddies).
#pragma once

namespace barchan {

/// Grains about a particle of the air: their drag by difference of speed over the mass of the air, and the time in
/// which one of them follows the air.
struct GrainsInEddies {
  double rate = 0.0, response = 0.0;  // 1/s; s
};

}  // namespace barchan
