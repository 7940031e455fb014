// Eddy viscosity and the logarithmic law of rough ground: formulas of one particle.
//
//   mixing length  nu_t = (kappa d)^2 |S|          (Prandtl 1925), d the distance to the ground
//   Smagorinsky    nu_t = (C_s dx)^2 |S|           (Smagorinsky 1963),  |S| = sqrt(2 S:S)
//   rough ground   tau  = rho (kappa u/ln(d/z0))^2 (Prandtl 1932; eq. 18 of Halik et al. 2015)
#pragma once

#include <algorithm>
#include <cmath>
#include <type_traits>

#include "simd/vec.hpp"

namespace barchan {

inline constexpr double karman = 0.4;  // kappa, as in the wind of eq. (18)

/// The viscosity of a pair whose ends have the square roots s_a, s_b of viscosity: Simpson's rule for the logarithmic
/// mean (mu_a - mu_b)/ln(mu_a/mu_b), within 0.05 % for a ratio of 3. Where mu grows linearly and v as the logarithm of
/// the height, mu_ab v_ab is then the constant shear stress times the difference in height, at any distance.
template <class T>
inline T pair_viscosity(T s_a, T s_b) {
  using std::fma;
  const auto number = [](double x) {
    if constexpr (std::is_floating_point_v<T>) return static_cast<T>(x);
    else return T(static_cast<typename T::value_type>(x));
  };
  const T sixth = number(1.0 / 6.0);  // (s_a^2 + 4 s_a s_b + s_b^2)/6
  return fma(s_b, fma(sixth, s_b, number(2.0 / 3.0) * s_a), sixth * s_a * s_a);
}

/// nu_t from the size of the kinematic shear stress, phi = (nu + nu_t) |S|, and the length l of nu_t = l^2 |S|.
template <class T>
inline T eddy_viscosity(T nu, T length, T phi) {
  using std::sqrt;
  return T(0.5) * (sqrt(nu * nu + T(4.0) * length * length * phi) - nu);
}

/// The same over rough ground: nu_t = max(l sqrt(phi) - nu, 0), so that nu + nu_t = l^2 |S| wherever that is more than
/// nu. The logarithmic law of rough ground (Prandtl 1932) is one of the whole stress, tau = rho l^2 |S|^2; with nu
/// beside it the layer is not logarithmic where nu/(l sqrt(phi)) is not small: u would lack u*/kappa ln(1 + nu/(kappa
/// u* d)) between the distance d and the free layer. Never 0 quite: 0 says that there is none yet.
template <class T>
inline T rough_eddy_viscosity(T nu, T length, T phi) {
  using std::sqrt;
  return simd::max(length * sqrt(phi) - nu, T(1e-30));
}

/// (kappa/ln(d/z0))^2. Nearer than a quarter of a spacing, and nearer than twice z0, the law is not followed.
inline double log_law_friction(double distance, double roughness, double spacing) {
  const double s = karman / std::log(std::max({distance, 0.25 * spacing, 2.0 * roughness}) / roughness);
  return s * s;
}

/// The viscosity (Pa s) that turns the speed (m/s) of a particle of the fluid, against a grain whose centre is half a
/// spacing behind its surface, into the stress of the logarithmic law at this distance (m) from the surface:
/// mu u/(d + dx/2) = rho (kappa/ln(d/z0))^2 u^2.
inline double rough_viscosity(double density, double distance, double roughness, double spacing, double speed) {
  return density * log_law_friction(distance, roughness, spacing) * speed * (distance + 0.5 * spacing);
}

}  // namespace barchan
