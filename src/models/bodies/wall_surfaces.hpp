// Walls as bodies of particles touch them: by their outlines, whose normals do not know the lattice of the wall.
#pragma once

#include <vector>

#include "laws/body_contact.hpp"
#include "models/bodies/contact_surface.hpp"
#include "models/layout.hpp"
#include "state/particles.hpp"

namespace barchan {

/// All surfaces of a wall that are not sides of the domain (those are planes, body_forces.hpp).
class WallSurfaces {
 public:
  /// Of the fills of the wall, whose shapes all have surfaces (has_surface() of scene/couplings.hpp).
  WallSurfaces(const Scene& scene, const Layout& layout, const Phase& wall);

  bool empty() const { return surfaces_.empty(); }

  /// Adds to the acceleration (and to contact_force, where the body has it) what the wall gives: a particle is a ball
  /// of half a spacing, and the law that of two particles that face each other across the surface. Where several
  /// surfaces of the wall are near, those whose normals differ by more than 60 degrees from the deeper ones act too: a
  /// corner does, the joint of two boxes does not. dt: s, of the step. `spacing`: of the body (m).
  void push(PhaseParticles& body, double spacing, const BodyContactLaw& law, double dt) const;

 private:
  template <int Dim, bool Rubs>
  void push_in(PhaseParticles& body, double spacing, const BodyContactLaw& law, double dt) const;
  std::size_t touched(Vec3 x, double reach, std::array<Gap, 4>& found) const;

  std::vector<ContactSurface> surfaces_;
  std::array<double, 3> low_{}, high_{}, period_{};  // m; period 0: none
  int dimensions_;
  double half_;  // m, of the wall's spacing
};

}  // namespace barchan
