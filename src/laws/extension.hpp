// A fluid's pressure and velocity continued into a solid, so that a fluid particle near one finds neighbours all round.
// Sums over the fluid particles a about a particle w of the solid, and the formulas that close them:
//
//   p_w = [sum p_a W + sum rho_a (g - a_w).(x_w - x_a) W] / sum W               (Adami et al. 2012, eq. 27)
//     rho_a: the density at rest; of a calm heavy fluid that at its pressure. With that at rest the wall below a tank
//     lacked 0.25 % of the weight of a spacing at c = 20 sqrt(gH), and the bottom rows moved at 6e-5 sqrt(gH)
//     a_w is that of an elastic body; grains count as unaccelerated: the blows of their contacts, thousands of g for
//     some microseconds, are no motion of a boundary that the fluid could follow
//   no-slip, depth known: v_w = v_wall - phi_w sum W phi_a (v_a - v_wall) / sum W phi_a^2, the line through the wall's
//     velocity at the surface that fits the fluid best (phi: distance to the surface); exact for a linear profile.
//     Fluid inside the surface, where r < phi_w, or about to enter, counts as fluid as far outside: with a negative
//     phi_a it would be met by its own velocity magnified, and drawn in
//   no-slip, depth unknown: v_w = 2 v_wall - sum v_a W / sum W                   (Adami et al. 2012, eq. 23)
//   grains: v_w = v_wall, their own; a jump of twice the slip across one grain in flight would be no smooth field.
//     Where a form drag acts, a grain alone in the fluid has the fluid's mean velocity instead: one spacing cannot
//     resolve the flow about it, and what it takes from the fluid is the drag. Between `solid_share` and `open_share`
//     of the fluid that a lone grain has about it, v_w goes from the one to the other
//   free-slip: the normal part as no-slip, the tangential part the fluid's mean. Where the wall is curved, the pressure
//     falls or rises with what turns the fluid: p_w = ... + rho u.H.u sum W (phi_a + phi_w) / sum W
//
// W stands for V_a W(r). Without fluid near, the solid keeps its own velocity and the pressure is zero.
#pragma once

#include <algorithm>
#include <array>

#include "laws/pair.hpp"

namespace barchan {

/// Acceleration towards the fluid of what follows the surface at the velocity u: u.H.u. bend: H, xx or xx xz zz (1/m).
template <std::size_t Dim>
double turn(const double* bend, const std::array<double, Dim>& u) {
  if constexpr (Dim == 2) return bend[0] * u[0] * u[0];
  else return bend[0] * u[0] * u[0] + 2.0 * bend[1] * u[0] * u[2] + bend[2] * u[2] * u[2];
}

/// 3 x^2 - 2 x^3 of x held in [0, 1].
inline double smooth_share(double x) {
  const double t = std::clamp(x, 0.0, 1.0);
  return t * t * (3.0 - 2.0 * t);
}

/// How the density of a fluid follows its pressure, to first order: rho + (p - rest) per_c2.
struct Compression {
  double rest = 0.0;    // Pa, its pressure at the density at rest
  double per_c2 = 0.0;  // s2/m2, 1/c^2; 0: the density at rest counts
};

/// Curved: with the sum that a curved wall's pressure needs. OneSided: of a body that may be thin, whose depth and
/// normal are known, fluid behind the surface counts a millionth: it decides only where there is no other.
template <bool Curved, bool OneSided = false>
struct Extension : PairLaw<Needs::value_and_gradient, Quantity::velocity, Quantity::pressure, Quantity::volume> {
  static constexpr double solid_share = 0.65, open_share = 0.9, from_behind = 1e-6;
  double density;  // kg/m3, of the fluid at rest
  Compression compression;

  /// The particle of the solid. Its record holds what the step before made of it: only the position counts.
  template <int Dim, class T>
  struct Own : Particle<Dim, T, Quantities<>> {
    std::array<T, Dim> velocity;  // of the surface [m/s]
    std::array<T, Dim> normal;    // into the fluid
    std::array<T, Dim> pull;      // g - a_w [m/s2]
    T behind;                     // -phi_w [m]
    T inside2;                    // m2: fluid nearer than its root is inside the solid, or about to enter
  };

  template <int Dim, class T>
  struct Sums {
    T weight, pressure, depth2;           // sum W, sum W (p + rho (g-a).r), sum W phi_a^2
    T lever;                              // curved walls: sum W rho (phi_a + phi_w)
    std::array<T, Dim> velocity, sloped;  // sum W v, sum W phi_a (v - v_wall)
  };

  template <int Dim, class T>
  BARCHAN_SIMD_INLINE void add(const Own<Dim, T>& w, const Particle<Dim, T, Reads>& a, const Pair<Dim, T>& wa,
                               Sums<Dim, T>& s) const {
    T weight = wa.w * a.volume;
    const T rho = fma(T(compression.per_c2), a.p - T(compression.rest), T(density));
    T p = a.p, phi = w.behind;
    for (std::size_t d = 0; d < Dim; ++d) {
      p = fma(rho * w.pull[d], wa.r[d], p);
      phi = fnma(w.normal[d], wa.r[d], phi);  // phi_a = n.(x_a - x_w) - phi_w
    }
    if constexpr (OneSided) weight = select(phi < T(0.0), T(from_behind) * weight, weight);
    else phi = select((phi < T(0.0)) & (wa.r2 < w.inside2), T(0.0) - phi, phi);
    const T w_phi = weight * phi;
    s.weight += weight;
    if constexpr (Curved) s.lever = fma(weight * T(density), phi - w.behind, s.lever);
    s.pressure = fma(weight, p, s.pressure);
    s.depth2 = fma(w_phi, phi, s.depth2);
    for (std::size_t d = 0; d < Dim; ++d) {
      s.velocity[d] = fma(weight, a.v[d], s.velocity[d]);
      s.sloped[d] = fma(w_phi, a.v[d] - w.velocity[d], s.sloped[d]);
    }
  }
};

/// The sums of one particle as numbers, and what closes them.
template <std::size_t Dim>
struct ExtendedState {
  double weight, depth2;                 // sum W > 0, sum W phi_a^2
  std::array<double, Dim> mean;          // sum W v / sum W
  std::array<double, Dim> sloped;        // sum W phi_a (v_a - v_wall)
  std::array<double, Dim> wall, normal;  // v_wall; n, zero where the depth is unknown
  double depth;                          // phi_w; 0: unknown
  double least_phi = 0.0;                // m; a root mean square of phi_a below it counts as this one

  /// Velocity of the wall's particle that makes the fluid stick to it.
  std::array<double, Dim> no_slip() const {
    std::array<double, Dim> v;
    const double square = std::max(depth2, weight * least_phi * least_phi);
    for (std::size_t d = 0; d < Dim; ++d)
      v[d] = depth > 0.0 && square > 0.0 ? wall[d] - depth * sloped[d] / square : 2.0 * wall[d] - mean[d];
    return v;
  }
  /// Of a grain; alone: sum W of the fluid about a grain alone in it, 0 where no form drag acts.
  std::array<double, Dim> grain(double alone) const {
    using E = Extension<false>;
    const double open =
        alone > 0.0 ? smooth_share((weight / alone - E::solid_share) / (E::open_share - E::solid_share)) : 0.0;
    std::array<double, Dim> v;
    for (std::size_t d = 0; d < Dim; ++d) v[d] = wall[d] + open * (mean[d] - wall[d]);
    return v;
  }
  /// The normal part of `stuck`, the tangential part of the fluid's mean.
  std::array<double, Dim> free_slip(const std::array<double, Dim>& stuck) const {
    const double mean_normal = along_normal(mean), stuck_normal = along_normal(stuck);
    std::array<double, Dim> v;
    for (std::size_t d = 0; d < Dim; ++d) v[d] = mean[d] + (stuck_normal - mean_normal) * normal[d];
    return v;
  }
  /// Between free slip and `stuck`, of which the share `rub` is left; `stuck` where the depth is unknown.
  std::array<double, Dim> rubbed(const std::array<double, Dim>& stuck, double rub) const {
    if (!(depth > 0.0) || rub >= 1.0) return stuck;
    std::array<double, Dim> v = free_slip(stuck);
    for (std::size_t d = 0; d < Dim; ++d) v[d] += rub * (stuck[d] - v[d]);
    return v;
  }
  /// Of a wall that does not pull: a pressure (Pa) below zero becomes zero, and fluid that goes away from the wall, or
  /// beside a wall without a normal, has its own velocity v there.
  void let_go(double& pressure, std::array<double, Dim>& v) const {
    if (!(pressure <= 0.0)) return;
    pressure = 0.0;
    if (along_normal(mean) >= along_normal(wall)) v = mean;
  }
  /// Pressure (Pa) of a curved wall over that of a flat one: lever = sum W rho (phi_a + phi_w).
  double turning_pressure(const double* bend, double lever) const {
    const double across = along_normal(mean) - along_normal(wall);
    std::array<double, Dim> along;
    for (std::size_t d = 0; d < Dim; ++d) along[d] = mean[d] - wall[d] - across * normal[d];
    return turn<Dim>(bend, along) * lever / weight;
  }

 private:
  double along_normal(const std::array<double, Dim>& v) const {
    double sum = 0.0;
    for (std::size_t d = 0; d < Dim; ++d) sum += v[d] * normal[d];
    return sum;
  }
};

}  // namespace barchan
