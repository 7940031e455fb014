// What is written of a solid's stress and strain: derived for outputs only, not in a step.
#pragma once

#include <array>

#include "base/aligned.hpp"
#include "laws/hyperelastic.hpp"
#include "scene/scene.hpp"
#include "state/particles.hpp"

namespace barchan {

/// Symmetric tensors in the order xx yy zz xy yz xz.
using Symmetric = std::array<double, 6>;

struct SolidState {
  Symmetric stress{};   // Pa, of Cauchy
  Symmetric strain{};   // of Green and Lagrange
  double energy = 0.0;  // J/m3 of the first volume
};

/// The state of a particle from H, row by row; plane strain in two dimensions.
SolidState solid_of(const std::array<AlignedVector<double>, 9>& gradient, std::size_t k, int dimensions, Elasticity law,
                    const ElasticModuli& moduli);

/// Pa: the largest first.
std::array<double, 3> principal_stresses(const Symmetric& stress);
double von_mises_stress(const Symmetric& stress);

/// The fields of a phase that tell of its stress and strain, those that it has.
class SolidFields {
 public:
  explicit SolidFields(PhaseParticles& particles);
  /// Writes pressure, stress and all that follows from them.
  void write(std::size_t k, const SolidState& state) const;
  /// Those that follow from a stress that is there: von Mises and principal stresses.
  void write_from_stress(std::size_t k) const;

 private:
  void write_stress(std::size_t k, const Symmetric& stress) const;
  double *pressure_ = nullptr, *mises_ = nullptr;
  std::array<double*, 6> stress_{}, strain_{};
  std::array<double*, 3> principal_{};
};

}  // namespace barchan
