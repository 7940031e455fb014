// The two equations of a fluid with turbulence = "k-omega" (laws/k_omega.hpp): its records, and a step of them.
#pragma once

#include <span>

#include "laws/grains_in_eddies.hpp"
#include "models/fluid/fluid_rates.hpp"

namespace barchan {

/// One entry of the matrix as the turbulence sees it.
struct KOmegaNeighbour {
  FluidNeighbour pair;
  const RecordArray* records = nullptr;  // turbulence records of a fluid; motion records of a solid
  bool solid = false;
  // What leaves through a solid of l = ln omega, so that a logarithmic layer lies on it: -kappa/2 times a friction
  // velocity. Zero through a solid that is no ground.
  double side = 0.0;      // 1: ground; -1: a lid, beyond which the layer goes on; 0: nothing passes
  double velocity = 0.0;  // m/s, that friction velocity, of a lid; of ground it follows from k
};

struct KOmegaParameters {
  double viscosity = 0.0;                  // m2/s
  double spacing = 0.0;                    // m
  double roughness = 0.0;                  // m, the largest of the ground
  double begins = 0.0;                     // m/s, friction velocity of the layer that it begins as
  double step = 0.0;                       // s
  const GrainsInEddies* grains = nullptr;  // by particle; null: none are in the fluid
};

/// Writes the turbulence records; gives particles that have no k the k and omega of the logarithmic layer.
/// Reads ground_distance. Returns the largest diffusivity, m2/s.
double pack_k_omega(PhaseParticles& fluid, RecordArray& records, const KOmegaParameters& p);

BARCHAN_PER_INSTRUCTION_SET(k_omega_step,
                            /// Takes k and omega on by a step, with the shear_rate and anisotropy of now; renews
                            /// eddy_viscosity. `own`: the turbulence records of the fluid. Within a spacing of the
                            /// ground omega is that of the logarithmic layer whose friction velocity k has.
                            void k_omega_step(PhaseParticles& fluid, const RecordArray& own,
                                              std::span<const KOmegaNeighbour> neighbours, const KOmegaParameters& p);)

}  // namespace barchan
