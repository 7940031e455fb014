// Fluids with a viscosity of their own at every particle, and walls whose shear stress is given.
#pragma once

#include <span>
#include <vector>

#include "engine/records.hpp"
#include "laws/eddies.hpp"
#include "models/fluid/fluid_rates.hpp"
#include "models/fluid/ground_distance.hpp"
#include "models/layout.hpp"

namespace barchan {

struct EddyNeighbour {
  FluidNeighbour pair;
  Friction friction = Friction::fluid;
  const EddyRecords* eddies = nullptr;           // friction fluid: the neighbour's, null: `root` is all of them's
  double root = 0.0;                             // sqrt(Pa s), of a fluid without eddies
  double roughness = 0.0;                        // m
  const PhaseParticles* wall = nullptr;          // slides with the velocity; null: stands
  Vec3 wall_velocity{};                          // m/s
  Vec3 stress{};                                 // Pa, on the fluid
  const AlignedVector<double>* given = nullptr;  // Pa, by particle, against its motion along the wall
};

struct EddyParameters {
  Turbulence model = Turbulence::none;
  double density = 0.0;       // kg/m3
  double viscosity = 0.0;     // m2/s, molecular and artificial
  double length = 0.0;        // m, C_s dx
  double spacing = 0.0;       // m
  double roughness = 0.0;     // m, of grains
  bool rough_ground = false;  // over_rough_walls: nu_t of a mixing length is rough_eddy_viscosity
  double grain_reach = 0.0;   // m: air farther from the ground meets only grains in flight
  template <class V>
  V mixing_length(V distance) const {
    return model == Turbulence::mixing_length ? V(karman) * distance
                                              : V(model == Turbulence::smagorinsky ? length : 0.0);
  }
};

/// Whether walls with a roughness are ground of a fluid with these entries, by the logarithmic law, and nothing else
/// is.
bool over_rough_walls(std::span<const EddyNeighbour> neighbours);

/// Writes ground_distance and the records. Returns the largest kinematic viscosity, m2/s.
double pack_eddies(PhaseParticles& fluid, EddyRecords& records, const GroundDistance& ground, const EddyParameters& e);

BARCHAN_PER_INSTRUCTION_SET(
    eddy_rates,
    /// As fluid_rates of the consistent scheme, with div (mu grad v) for mu lap v; renews eddy_viscosity.
    ///   div (mu grad v) = -2 Dim [ sum V F w mu_ab v_ab - T . C ] / (tr M + A:M),   T = (sum V F mu_ab v_ab (x) r)
    ///   M^-1
    /// T is the flux mu grad v as the pairs have it, and |T|/rho = (nu + nu_t)|S| gives the next step's nu_t. With the
    /// pair's logarithmic mean, a logarithmic profile is an exact solution on any arrangement of particles, up to a
    /// wall that enters by its stress: n the direction to the fluid, mu_ab v_ab = tau (r.n) for its pairs. In two
    /// dimensions the motion records of fluids with eddies hold their roots (give_roots); in three, `eddies` does.
    void eddy_rates(PhaseParticles& fluid, const RecordArray& own, const EddyRecords& eddies,
                    std::span<const EddyNeighbour> neighbours, const FluidParameters& q, const EddyParameters& e);

    /// The same in mixed precision: differences and a row's sums in single, all else in double.
    void eddy_rates(PhaseParticles& fluid, const CompactRecords& own, const EddyRecords& eddies,
                    std::span<const EddyNeighbour> neighbours, const FluidParameters& q, const EddyParameters& e);)

BARCHAN_PER_INSTRUCTION_SET(
    eddy_reaction,
    /// Adds to a grain's acceleration what the logarithmic law adds to the friction of fluid_reaction.
    void eddy_reaction(PhaseParticles& solid, const RecordArray& own, const FluidNeighbour& fluid,
                       const EddyRecords& eddies, double molecular);)

}  // namespace barchan
