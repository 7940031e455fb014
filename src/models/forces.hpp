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
  /// The acceleration at a place (m/s2), numbers too.
  Vec3 at(const Vec3& x, double time, int dimensions) const;
  /// The components that are formulas, or hold in a box only, at a place (m/s2).
  Vec3 varying(const Vec3& x, double time, int dimensions) const;
  /// The norm of the derivatives of the formulas by place (1/s2), over differences of `apart` (m).
  double stiffness(const Vec3& x, double time, int dimensions, double apart) const;
  /// Adds what brings the phase to the velocities of its zones. dt (s): a step takes half of the difference at most.
  void relax(PhaseParticles& p, double time, double dt) const;
  /// Sum over the particles of all that the [[forcing]] entries give them now, numbers too (m/s2).
  Vec3 sum(const PhaseParticles& p, double time, double dt) const;
  bool any() const { return !forces_.empty(); }
  bool varies() const;

 private:
  struct Force {
    std::array<Formula, 3> acceleration;  // m/s2
    std::optional<BoxShape> box;          // empty: everywhere
  };
  void add_varying(Vec3& total, const PhaseParticles& p, double time, double dt) const;
  struct Zone {
    std::array<Formula, 3> velocity;  // m/s
    Formula rate;                     // 1/s
    std::optional<BoxShape> box;
  };
  std::vector<Force> forces_;
  std::vector<Zone> zones_;
};

/// A vector of the scene, compiled.
std::array<Formula, 3> compile(const VectorExpression& e);

}  // namespace barchan
