// A smooth control volume about a wall: a weight w(x) that is one at the wall and falls to zero with the distance as
//
//   w = erfc((d - d0)/(sqrt 2 s))/2,   d0 = 6 dx, s = 1.5 dx, nothing beyond d0 + 4 s = 12 dx
//
// With the momentum equation times w the force of a fluid on the wall needs no value at the wall,
//
//   F = - sum m w (dv/dt - g) + sum V p grad w + sum V mu [ v lap w + (grad grad w) v ]
//
// (Noca, Shiels & Jeon 1999 have sharp control volumes; the last term is the friction div(mu (grad v + grad v^T))
// integrated twice by parts, mu constant). Dv/Dt follows the particles, so that no flux of momentum is there. Sums over
// particles of such a Gauss curve miss its integral by exp(-2 pi^2 s^2/dx^2) on a lattice; a polynomial with two
// continuous derivatives over six spacings missed 14 % of the friction.
// d is a smooth distance, - l ln sum exp(-r/l) with l = dx/2 over the wall's particles; w is the cubic B-spline (two
// continuous derivatives) of its values on a grid of half a spacing.
#pragma once

#include <array>
#include <vector>

#include "models/layout.hpp"
#include "state/particles.hpp"

namespace barchan {

class ControlVolume {
 public:
  static constexpr double middle = 6.0, width = 1.5, end = 12.0;  // d0, s, and where w ends, in spacings

  struct Weight {
    double w = 0.0;
    Vec3 slope{};                // 1/m
    std::array<Vec3, 3> bend{};  // 1/m2, rows of the second derivatives
  };

  ControlVolume() = default;
  /// About particles of a wall that stays, of one spacing (m). It is there() only where it lies inside the domain.
  ControlVolume(const PhaseParticles& wall, double spacing, const Layout& layout);

  bool there() const { return !nodes_.empty(); }
  /// Whether a place is in the box outside of which w is zero.
  bool near(const Vec3& x) const {
    for (std::size_t d = 0; d < dimensions_; ++d)
      if (!(x[d] > low_[d] && x[d] < high_[d])) return false;
    return true;
  }
  /// At a place that is near().
  Weight at(const Vec3& x) const;

  /// What a particle gives to the force (N; per metre of depth in 2D).
  struct Share {
    Vec3 inertia;                // N
    Vec3 slope;                  // V grad w: m, in 3D m2
    double pressure;             // Pa
    std::array<Vec3, 3> rubbed;  // rows of mu V (lap w + grad grad w): N s/m
    Vec3 velocity;               // m/s
  };
  /// `a`: less gravity (m/s2); mass in kg, density in kg/m3, pressure in Pa, viscosity in Pa s.
  Share share(const Vec3& x, const Vec3& v, const Vec3& a, double mass, double density, double pressure,
              double viscosity) const;
  /// The sum over all particles that are near(), in an order that does not matter.
  static Vec3 force(const std::vector<Share>& shares);
  std::size_t bytes() const { return nodes_.capacity() * sizeof(double); }

 private:
  std::size_t dimensions_ = 2;
  double step_ = 1.0;    // m, of the grid
  Vec3 low_{}, high_{};  // m, the box
  std::array<std::size_t, 3> count_{1, 1, 1};
  std::vector<double> nodes_;  // x fastest; the first node one and a half steps below low_
};

}  // namespace barchan
