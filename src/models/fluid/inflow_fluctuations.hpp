// Synthetic turbulence for an inflow: a frozen field of Fourier modes with random directions,
//
//   u'(x) = sqrt(2/N) sum_n p_n cos(k_n.x + phi_n),   k_n.p_n = 0
//
// without divergence (Kraichnan 1970), with any stress tensor R = <u' u'> (Smirnov, Shi & Celik 2001 bring a field to R
// after it was made, which costs the first property). Here p_n = A xi_n with isotropic xi_n and A so that the mean of
// p_n p_n is R exactly; then k_n is drawn across p_n. Of isotropic fluctuations the longitudinal integral length is
// `length`: with a Rayleigh distribution of |k| of parameter K it is sqrt(2 pi)/K in 2D, 3 pi/4 sqrt(pi/2)/K in 3D.
// Across a periodic axis k is rounded to whole waves; there the divergence is that of the rounding.
#pragma once

#include <array>
#include <string>

#include "base/vec3.hpp"
#include "models/fluid/flow_lanes.hpp"
#include "scene/scene.hpp"
#include "state/archive.hpp"

namespace barchan {

class InflowFluctuations {
 public:
  static constexpr std::size_t modes = 128;

  /// `density`: kg/m3. `periods`: m, of periodic axes, else 0.
  InflowFluctuations(const Fluctuations& given, double density, int dimensions, const Vec3& periods);

  /// u' (m/s) at a place (m).
  Vec3 operator()(const Vec3& x) const;

 private:
  struct Mode {
    Vec3 wave;       // 1/m
    Vec3 amplitude;  // m/s
    double phase;
  };
  std::array<Mode, modes> modes_;
};

/// The fluctuations of a zone beyond a side: carried in with the mean speed that the scene gives there.
class EnteringFluctuations {
 public:
  EnteringFluctuations(const FlowEnd& end, const InflowFluctuations& field) : end_(end), field_(field) {}

  /// At each step, of length `dt` (s). What they would bring of mass on the whole is taken out.
  void carry(const FlowLanes& lanes, const GivenVelocity& velocity, double time, double dt);
  /// u' (m/s) at a place of the zone where the scene gives this velocity: less than the whole below half of the mean
  /// speed, nothing where nothing flows in.
  Vec3 operator()(const Vec3& x, const Vec3& given) const;
  void archive(Archive& a, const std::string& zone);

 private:
  double part_at(const Vec3& given) const;

  FlowEnd end_;
  InflowFluctuations field_;
  double way_ = 0.0;                    // m, so far
  double speed_ = 0.0, surplus_ = 0.0;  // m/s, mean through the side; of u', by its part
};

/// m2/s2, <u' v'> in the first two axes, of a shear stress (Pa).
inline double covariance_of(const Fluctuations& given, double density) { return -given.shear_stress / density; }

}  // namespace barchan
