// Eddy viscosity and the logarithmic law of rough ground: formulas of one particle.
//
//   mixing length  nu_t = (kappa d)^2 |S|          (Prandtl 1925), d the distance to the ground
//   Smagorinsky    nu_t = (C_s dx)^2 |S|           (Smagorinsky 1963),  |S| = sqrt(2 S:S)
//   rough ground   tau  = rho (kappa u/ln(d/z0))^2 (Prandtl 1932; eq. 18 of Halik et al. 2015)
#pragma once

#include <algorithm>
#include <cmath>

namespace barchan {

inline constexpr double karman = 0.4;  // kappa, as in the wind of eq. (18)

/// The viscosity of a pair whose ends have the square roots s_a, s_b of viscosity: Simpson's rule for the logarithmic
/// mean (mu_a - mu_b)/ln(mu_a/mu_b), within 0.05 % for a ratio of 3. Where mu grows linearly and v as the logarithm of
/// the height, mu_ab v_ab is then the constant shear stress times the difference in height, at any distance.
template <class T>
inline T pair_viscosity(T s_a, T s_b) {
  const T sum = s_a + s_b, product = s_a * s_b;
  return (sum * sum + (product + product)) * T(1.0 / 6.0);
}

/// nu_t from the size of the kinematic shear stress, phi = (nu + nu_t) |S|, and the length l of nu_t = l^2 |S|.
inline double eddy_viscosity(double nu, double length, double phi) {
  return 0.5 * (std::sqrt(nu * nu + 4.0 * length * length * phi) - nu);
}

/// (kappa/ln(d/z0))^2. Nearer than a quarter of a spacing, and nearer than twice z0, the law is not followed.
inline double log_law_friction(double distance, double roughness, double spacing) {
  const double s = karman / std::log(std::max({distance, 0.25 * spacing, 2.0 * roughness}) / roughness);
  return s * s;
}

}  // namespace barchan
