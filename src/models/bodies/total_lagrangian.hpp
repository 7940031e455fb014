// The sums of a total Lagrangian body (docs/method.md): gradient of the displacement, stress, acceleration.
#pragma once

#include <type_traits>

#include "laws/hyperelastic.hpp"
#include "models/bodies/part_turns.hpp"
#include "models/bodies/reference_body.hpp"
#include "scene/scene.hpp"
#include "state/particles.hpp"

namespace barchan {

struct TotalParameters {
  Elasticity law = Elasticity::neo_hookean;
  ElasticModuli moduli;
  double hourglass = 0.0;  // kappa, Pa
  double along = 0.0;      // kappa_l, Pa, of the lengths of pairs (laws/stray_length.hpp)
  double density = 0.0;    // kg/m3, at rest
  Vec3 gravity{};
  Vec3 period{};  // m; 0: not periodic
};

/// What the sums work on, in the order of ids. T: float in mixed precision. Columns that neighbours are read from have
/// room for a register on both sides.
template <class T>
struct TotalWork {
  /// In mixed precision displacements are whole numbers of `unit`: their differences are exact.
  using Place = std::conditional_t<std::is_same_v<T, float>, std::int32_t, T>;
  static constexpr std::size_t margin = 16;

  std::array<AlignedVector<Place>, 3> displacement;  // less that of the piece's anchor
  std::array<AlignedVector<T>, 3> velocity;          // of damped bodies, less that of the anchor
  std::array<AlignedVector<T>, 9> reach;             // Q = kappa H - P M^-1, Pa
  std::array<AlignedVector<T>, 9> gradient;          // H, of a body whose pairs keep their lengths (total_along.hpp)
  PartTurns turns;                                   // in mixed precision only
  std::vector<double> largest;                       // m, of each piece: the largest component of its displacements
  double unit = 1.0;                                 // m, a power of two that follows the largest displacement
  std::array<std::vector<double>, 3> displaced;      // m, the whole displacement, of periodic domains: unwrapped
  double stiffening = 1.0;                           // of the stiffest particle, over the modulus at rest
  double least_volume = 1.0;                         // det F of the particle that is pressed most
  const std::uint32_t* at = nullptr;                 // place of each id in the phase (PhaseParticles::places)
  bool in_order = true;                              // at[k] == k

  void resize(std::size_t size, std::size_t width, int dimensions, const TotalParameters& parameters);
};

/// What only outputs read, of one particle: the gradient H and the energy density of the hourglass control (J/m3).
struct TotalDetail {
  std::array<AlignedVector<double>, 9> gradient;
  AlignedVector<double> hourglass;
};

/// Displacements (and velocities) of the particles' places. In mixed precision it chooses `unit` anew where the largest
/// displacement is no longer 2^26 to 2^30 of it: a body that hardly moves keeps the digits of its small strains. Turns
/// of parts are taken out (PartTurns).
BARCHAN_PER_INSTRUCTION_SET(pack_displacements,
                            void pack_displacements(const PhaseParticles& body, const ReferenceBody<float>& reference,
                                                    TotalWork<float>& work, const TotalParameters& parameters);
                            void pack_displacements(const PhaseParticles& body, const ReferenceBody<double>& reference,
                                                    TotalWork<double>& work, const TotalParameters& parameters);)

/// H, the density, Q, the stiffening and the least volume.
BARCHAN_PER_INSTRUCTION_SET(total_stress, void total_stress(PhaseParticles& body, const ReferenceBody<float>& reference,
                                                            TotalWork<float>& work, const TotalParameters& parameters);
                            void total_stress(PhaseParticles& body, const ReferenceBody<double>& reference,
                                              TotalWork<double>& work, const TotalParameters& parameters);)

/// The acceleration by stress, hourglass control and gravity.
BARCHAN_PER_INSTRUCTION_SET(total_forces,
                            void total_forces(PhaseParticles& body, const ReferenceBody<float>& reference,
                                              const TotalWork<float>& work, const TotalParameters& parameters);
                            void total_forces(PhaseParticles& body, const ReferenceBody<double>& reference,
                                              const TotalWork<double>& work, const TotalParameters& parameters);)

/// H and the energy of the hourglass control, by id.
BARCHAN_PER_INSTRUCTION_SET(total_detail,
                            void total_detail(const ReferenceBody<float>& reference, const TotalWork<float>& work,
                                              const TotalParameters& parameters, TotalDetail& detail);
                            void total_detail(const ReferenceBody<double>& reference, const TotalWork<double>& work,
                                              const TotalParameters& parameters, TotalDetail& detail);)

}  // namespace barchan
