// [[forcing]] of a phase, compiled.
#pragma once

#include <array>
#include <vector>

#include "scene/formula.hpp"
#include "scene/scene.hpp"
#include "state/particles.hpp"

namespace barchan {

class Forces {
 public:
  Forces() = default;
  /// The [[forcing]] entries of this phase that give an acceleration, not those with hold.
  Forces(const Scene& scene, const std::string& phase);

  /// The sum of the components that are numbers (m/s2).
  Vec3 uniform() const;
  /// Adds to the accelerations the components that are formulas of place and time; `numbers`: those that are numbers
  /// too.
  void add(PhaseParticles& p, double time, bool numbers) const;
  bool any() const { return !forces_.empty(); }
  bool varies() const;

 private:
  std::vector<std::array<Formula, 3>> forces_;  // m/s2
};

/// A vector of the scene, compiled.
std::array<Formula, 3> compile(const VectorExpression& e);

}  // namespace barchan
