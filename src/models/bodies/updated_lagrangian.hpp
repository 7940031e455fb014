// Elastic bodies: strain pass (velocities -> density and stress) and force pass (stress -> acceleration).
#pragma once

#include <span>

#include "engine/pair_loop.hpp"
#include "models/bodies/self_contact.hpp"
#include "scene/scene.hpp"
#include "state/particles.hpp"

namespace barchan {

/// One entry between elastic phases.
struct ElasticNeighbour {
  const PairList* list;
  const RecordArray* records;  // stress records of the other phase
  KernelKind kernel;
  double radius;                            // m
  double mass;                              // kg, of a particle of the other phase
  const RecordArray* artificial = nullptr;  // artificial stress of the other phase; null: the entry has none
  double inverse_weight = 0.0;              // m^dimensions, 1/W(dx); dx: mean spacing of both
  const FarPairs* held = nullptr;  // of a body that touches itself: the pairs of the list that hold it together
  PairList::Row row(std::size_t k) const { return held ? held->row(k) : list->row(k); }
};

struct ElasticParameters {
  double reference_density;  // kg/m3
  double shear_modulus;      // Pa, G
  double bulk_modulus;       // Pa, K; p = (K/rho0)(rho - rho0)
  double alpha, beta;        // Monaghan's viscosity
  double sound_speed;        // m/s, of the viscosity: sqrt(K/rho0)
  Vec3 gravity;              // m/s2
};

BARCHAN_PER_INSTRUCTION_SET(pack_stress,
                            /// Packs stress records: position, velocity, (s - p I)/rho^2, m/rho.
                            void pack_stress(const PhaseParticles& body, RecordArray& records);)

BARCHAN_PER_INSTRUCTION_SET(elastic_strain,
                            /// Advances density, pressure and deviatoric stress by dt with the velocity gradient at the
                            /// records' positions and velocities (the middle of the step).
                            void elastic_strain(PhaseParticles& body, const RecordArray& own,
                                                std::span<const ElasticNeighbour> neighbours,
                                                const ElasticParameters& parameters, double dt);)

BARCHAN_PER_INSTRUCTION_SET(elastic_forces,
                            /// Writes the acceleration, with artificial stress where `artificial` (that of the body) is
                            /// given; where the body has it, energy_rate [W/kg] by
                            /// laws/elastic.hpp with the velocities of the records.
                            void elastic_forces(PhaseParticles& body, const RecordArray& own,
                                                std::span<const ElasticNeighbour> neighbours,
                                                const ElasticParameters& parameters,
                                                const RecordArray* artificial = nullptr);)

}  // namespace barchan
