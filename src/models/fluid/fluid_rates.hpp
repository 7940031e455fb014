// Rates of a fluid phase: one loop over all its neighbours, then the laws' sums become accelerations.
#pragma once

#include <atomic>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/pair_entry.hpp"
#include "engine/pair_loop.hpp"
#include "scene/scene.hpp"
#include "state/particles.hpp"

namespace barchan {

/// One entry of the matrix as the fluid sees it.
struct FluidNeighbour {
  const PairList* list;
  const RecordArray* records;  // motion records of the other phase (a solid's: pressure and velocity extended into it)
  KernelKind kernel;
  double radius;                            // m
  double viscosity;                         // Pa s, of the pair
  bool diffuse;                             // density diffusion acts across this entry
  const CompactRecords* compact = nullptr;  // the same records for mixed precision, null in double
  double joined = 0;                        // kg/m3: density at rest of another fluid, consistent scheme; 0: no fluid
  double beyond = 0;                        // Pa s: viscosity of that fluid
  const EddyRecords* distances = nullptr;   // of that fluid's particles to the interface (3D; 2D: in their records)
  double nearest = 0;                       // m, of friction across that interface the least distance of a particle
  double pressure_share = 1;                // 2 rho_a/(rho_a + rho_b) of another fluid b, plain scheme
};

struct InterfacePlanes;

/// Particles of a fluid that may stand beside a void, collected by the pass over its rates in any order.
struct LooseParticles {
  static constexpr std::uint32_t broken = 1u << 31;  // with the number of a particle whose neighbourhood is broken
  std::vector<std::uint32_t> place;                  // room for all
  std::atomic<std::size_t> count{0};
  /// Any thread may call it.
  void add(std::size_t k, bool is_broken) {
    place[count.fetch_add(1, std::memory_order_relaxed)] = static_cast<std::uint32_t>(k) | (is_broken ? broken : 0u);
  }
};

/// Without friction, the rows beside a heavy free surface rock each other up, at the rate of gravity over a spacing,
/// and the disorder of an inviscid interior swells it by a tenth of a per cent in a period of a wave. So a heavy fluid
/// with a free surface has at least these viscosities, in rho0 h sqrt(g h): everywhere; more near the surface, where
/// the operators are plain. Friction beside the surface where they are corrected is none of these: with 6.4 there a
/// wave 25 rows deep was 0.15 % slower and lost 1.8 % more. Without weight a surface needs none.
constexpr double bulk_friction = 0.08, plain_friction = 5.0;

/// Beside a heavy free surface the density diffuses with so much more h c: disordered rows make noise there that
/// delta = 0.05 does not take, and a disturbed tank of 50 rows moved at 0.06 sqrt(gH) for good. 0.05 is too little;
/// with 0.15 a tank disturbed by a quarter of a spacing breaks down.
constexpr double surface_diffusion = 0.1;

struct FluidParameters {
  double reference_density;   // kg/m3
  double sound_speed;         // m/s
  double diffusivity;         // m2/s, of the density: theta c^2 dt + delta h c
  double source_diffusivity;  // m2/s, consistent scheme: of the part of lap p that the flow itself makes
  double shift_speed;         // m/s: du = -shift_speed * h * B, at most `shift_limit`
  double shift_limit;         // m/s
  double smoothing_length;    // m, of the phase with itself
  Vec3 gravity;               // m/s2
  Vec3 acceleration;          // m/s2, further uniform body force
  double void_pressure;       // Pa, of what lies beyond the fluid where a neighbourhood is not whole; plain: everywhere
  double pores;               // 1/s, rate at which a particle alone among grains returns to rest; 0: no grains
  double least_viscosity;  // Pa s, rho0 h sqrt(g h) of a laminar fluid with a free surface (fluid_surface.hpp); else 0
  double surface_depth;    // m, of the middle of the top row below a heavy free surface, half a spacing
  double surface_diffusivity = 0.0;  // m2/s, of the density beside a heavy free surface, added
  bool stressed = false;             // a free surface bears no viscous stress (fluid_stress.hpp)
  double surface_viscosity = 0.0;    // Pa s, the scene's, of a laminar fluid that is stressed
  double layer_share = 0.0;          // of the stress along the surface, the share that acts as pressure
  double per_top_row = 1.0;          // 1/(2 dx |B|) of the top row of a lattice
  double loosening;                  // 1/s, at which loose fluid loses its pressure (free surface); 0: none
  double calming = 0.0;              // 1/s, of a fluid that fills its space: see calm() in fluid_finish.hpp; 0: none
  double lattice_moment;             // -tr M/Dim on a lattice at rest, 1
  bool ends;                         // a void or a free surface is near some particle, or solids move in the fluid
  LooseParticles* loose;             // where particles that may stand beside a void are noted; null: nobody asks
  const EddyRecords* distances = nullptr;   // of its particles to the interface with another fluid
  const InterfacePlanes* planes = nullptr;  // of that interface
};

/// Below this wholeness (laws' chi, fluid_finish.hpp) a particle belongs to the free surface.
constexpr double surface_wholeness(FluidScheme scheme) { return scheme == FluidScheme::consistent ? 0.33 : 0.55; }

BARCHAN_PER_INSTRUCTION_SET(
    fluid_rates,
    /// Writes acceleration, density_rate and (if the field is there) shift_velocity of `fluid`. `own` are its records.
    void fluid_rates(PhaseParticles& fluid, const RecordArray& own, std::span<const FluidNeighbour> neighbours,
                     const FluidParameters& parameters, FluidScheme scheme);
    /// The same in mixed precision: differences and a row's sums in single, all else in double.
    void fluid_rates(PhaseParticles& fluid, const CompactRecords& own, std::span<const FluidNeighbour> neighbours,
                     const FluidParameters& parameters, FluidScheme scheme);)

BARCHAN_PER_INSTRUCTION_SET(
    fluid_reaction,
    /// Adds to the acceleration of a solid's particles what the fluid does to them, the reaction to fluid_rates of the
    /// plain scheme: m_b dv_b = -m_a dv_a for every pair. With `pores`, the pressure is closed behind a particle that
    /// has fluid on one side only by its own extended pressure (air in the pores of a bed), so that a uniform pressure
    /// lifts nothing.
    void fluid_reaction(PhaseParticles& solid, const RecordArray& own, const FluidNeighbour& fluid, bool pores);)

}  // namespace barchan
