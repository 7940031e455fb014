// Two equations for the turbulence that the spacing does not resolve: k, its kinetic energy, and omega, its specific
// dissipation rate (Wilcox 2006, Turbulence Modeling for CFD, 3rd ed., eqs. 4.36 to 4.42; Wilcox 2008, AIAA J. 46,
// 2823).
//
//   nu_t = k/max(omega, 7/8 |S|/sqrt(beta*)),   |S| = sqrt(2 S:S)                      (the limiter of the stress)
//   dk/dt     = nu_t |S|^2 - beta* k omega + div [(nu + 0.6 k/omega) grad k]
//   domega/dt = 0.52 omega/k nu_t |S|^2 - 0.0708 omega^2 + div [(nu + 0.5 k/omega) grad omega]
//               + 1/8 (grad k . grad omega)/omega where that is positive
//
// The second is solved for l = ln omega, so that omega is positive whatever the step:
//   dl/dt = 0.52 |S|^2/omega' - 0.0708 omega + div (G grad l) + G |grad l|^2 + 1/8 (grad k . grad l)/omega
// with omega' the larger of the two above. In the logarithmic layer k is constant and omega = u*/(sqrt(beta*) kappa d):
// G grows linearly and l as the logarithm of the distance, as viscosity and velocity do there. With the pair's
// logarithmic mean (laws/eddies.hpp) the flux G grad l is then exact on any arrangement of particles, and kappa =
// sqrt((0.0708/0.09 - 0.52) sqrt(0.09)/0.5) = 0.400. In two dimensions f_beta of Wilcox is 1; so it is taken in three.
#pragma once

#include <algorithm>
#include <cmath>

#include "laws/eddies.hpp"
#include "laws/grains_in_eddies.hpp"
#include "laws/pair.hpp"

namespace barchan {

struct Wilcox2006 {
  static constexpr double beta_star = 0.09, alpha = 0.52, beta = 0.0708, sigma_k = 0.6, sigma_omega = 0.5,
                          sigma_d = 0.125, limiter = 0.875;
};

/// The friction velocity (m/s) of a layer whose turbulence has the energy k (m2/s2).
inline double friction_velocity_of_energy(double k) {
  static const double root = std::sqrt(std::sqrt(Wilcox2006::beta_star));
  return root * std::sqrt(std::max(k, 0.0));
}
inline double energy_of_friction_velocity(double u) { return u * u / std::sqrt(Wilcox2006::beta_star); }

/// omega (1/s) in the logarithmic layer of the friction velocity u (m/s), at a distance d (m) from the ground.
inline double log_layer_omega(double u, double d) { return u / (std::sqrt(Wilcox2006::beta_star) * karman * d); }

/// omega (1/s) within a spacing of the ground, where the equation gives `made`: that of the layer, up to twice it where
/// the equation makes more. Air that slows down along the ground within a spacing, behind the crest of a steep hill,
/// has more: 1.3 to 1.7 times the layer's in finite volumes of a two-hundredth of the height of the RUSHIL hill. With
/// the layer's alone such air stays at the ground. The bound is needed: without it omega of single particles grows and
/// their k dies.
inline double omega_beside_ground(double made, double u, double d) {
  const double layer = log_layer_omega(u, d);
  return std::clamp(made, layer, 2.0 * layer);
}

/// omega' (1/s): what k is divided by to give nu_t.
inline double limited_omega(double omega, double shear) {
  return std::max(omega, Wilcox2006::limiter / std::sqrt(Wilcox2006::beta_star) * shear);
}

/// Sums of the pairs of a particle a of the fluid with others of it: what its own neighbourhood is, and the fluxes of k
/// and l as the pairs have them. Without the kernel's constant factor.
///   M = sum V F r (x) r,   C = sum V F w r,   L = sum V F w G_ab s_ab,   T = sum V F G_ab s_ab r,    s: k, l
/// of L for k the positive terms alone (on one side of zero are the pairs with more k, on the other those with less),
/// and sum V F w, sum V F w nu_ab for the mean of the pairs' k/omega.
struct KOmegaPairs : PairLaw<Needs::slope, Quantity::velocity, Quantity::pressure, Quantity::volume> {
  double viscosity;  // m2/s

  template <int Dim, class T>
  struct Own : PairLaw::Own<Dim, T> {
    std::array<T, Dim*(Dim + 1) / 2> anisotropy;  // as ConsistentFluid's
  };

  template <int Dim, class T>
  struct Sums {
    std::array<T, Dim*(Dim + 1) / 2> moment;
    std::array<T, Dim> weighted, flux_k, flux_l;
    T laplace_k, laplace_l, positive_k, weight, eddy;
  };

  template <int Dim, class T>
  BARCHAN_SIMD_INLINE void add(const Own<Dim, T>& a, const Particle<Dim, T, Reads>& b, const Pair<Dim, T>& ab,
                               Sums<Dim, T>& s) const {
    const T vf = b.volume * ab.f;
    const T wvf = fma(vf, lopsided<Dim, T>(a.anisotropy, ab.r) / ab.r2, vf);
    const T eddy = pair_viscosity(a.p, b.p);
    const T dk = fma(T(Wilcox2006::sigma_k), eddy, T(viscosity)) * (a.v[0] - b.v[0]);
    const T dl = fma(T(Wilcox2006::sigma_omega), eddy, T(viscosity)) * (a.v[1] - b.v[1]);
    std::size_t m = 0;
    for (std::size_t d = 0; d < Dim; ++d) {
      const T g = vf * ab.r[d];
      s.weighted[d] = fma(wvf, ab.r[d], s.weighted[d]);
      s.flux_k[d] = fma(dk, g, s.flux_k[d]);
      s.flux_l[d] = fma(dl, g, s.flux_l[d]);
      for (std::size_t e = 0; e <= d; ++e, ++m) s.moment[m] = fma(g, ab.r[e], s.moment[m]);
    }
    s.laplace_k = fma(wvf, dk, s.laplace_k);
    s.positive_k += simd::max(wvf * dk, T(0.0));
    s.weight += wvf;
    s.eddy = fma(wvf, eddy, s.eddy);
    s.laplace_l = fma(wvf, dl, s.laplace_l);
  }

  /// r.A.r
  template <int Dim, class T>
  static BARCHAN_SIMD_INLINE T lopsided(const std::array<T, Dim*(Dim + 1) / 2>& a, const std::array<T, Dim>& r) {
    T sum(0.0);
    std::size_t q = 0;
    for (std::size_t d = 0; d < Dim; ++d) {
      T along(0.0);
      for (std::size_t e = 0; e <= d; ++e, ++q) along = fma(a[q], r[e], along);
      sum = fma(along, r[d], sum);
    }
    return sum;
  }
};

/// The same with a solid, through which nothing of k passes: the model makes the flux of l of it. B = sum V F r.
struct KOmegaBorder : PairLaw<Needs::slope, Quantity::volume> {
  template <int Dim, class T>
  struct Own : PairLaw::Own<Dim, T> {
    std::array<T, Dim*(Dim + 1) / 2> anisotropy;
  };

  template <int Dim, class T>
  struct Sums {
    std::array<T, Dim*(Dim + 1) / 2> moment;
    std::array<T, Dim> weighted, concentration;
  };

  template <int Dim, class T>
  BARCHAN_SIMD_INLINE void add(const Own<Dim, T>& a, const Particle<Dim, T, Reads>& b, const Pair<Dim, T>& ab,
                               Sums<Dim, T>& s) const {
    const T vf = b.volume * ab.f;
    const T wvf = fma(vf, KOmegaPairs::lopsided<Dim, T>(a.anisotropy, ab.r) / ab.r2, vf);
    std::size_t m = 0;
    for (std::size_t d = 0; d < Dim; ++d) {
      const T g = vf * ab.r[d];
      s.weighted[d] = fma(wvf, ab.r[d], s.weighted[d]);
      s.concentration[d] = s.concentration[d] + g;
      for (std::size_t e = 0; e <= d; ++e, ++m) s.moment[m] = fma(g, ab.r[e], s.moment[m]);
    }
  }
};

/// What diffusion makes of k (m2/s3), of the corrected operator `made` and of the parts of its plain sum, of pairs with
/// more k and of pairs with less. The plain sum obeys the maximum principle: a particle loses k to those with less
/// only. The corrected one does not. Where few particles see it, next to a wall, it takes k of a particle that has the
/// least already, until nothing is left in a few steps; without eddies such a particle has no friction either.
inline double diffused(double made, double one_part, double other_part) {
  return std::max(made, std::min(one_part, 0.0) + std::min(other_part, 0.0));
}

/// What shifting carries in of k (m2/s3), `carried`: of a particle that is shifted through a spacing at most all of it.
inline double carried_at_most(double carried, double k, double shift_speed, double spacing) {
  return std::max(carried, -k * shift_speed / spacing);
}

/// The k/omega (m2/s) by which the flux of the pairs becomes a gradient: the particle's own, as in a logarithmic layer,
/// where that of the pairs is at most 2.5 times as large. Where the particle has hardly any eddies the flux is that of
/// its neighbours' eddies, and divided by its own it is no gradient: then a quarter of the mean of the pairs.
inline double eddy_of_flux(double own, double of_pairs) { return std::max(own, 0.25 * of_pairs); }

/// What a step of the two equations starts from, of one particle.
struct KOmegaPlace {
  double k, omega, shear, viscosity;  // m2/s2, 1/s, 1/s, m2/s
  double diffusion_k, diffusion_l;    // m2/s3, 1/s: div (G grad s), and what shifting carries
  double square_k_l, square_l;        // grad k . grad l (1/s2 over m), |grad l|^2
};

/// What heavy grains take of k and omega in a step of `dt` (s), implicit (Amoudry 2014; Chauchat et al. 2017, GMD 10,
/// 4367; C3 there): dk/dt = -f k, domega/dt = -0.35 f omega, f = 2 rate (1 - exp(-St/4)), St = 6 beta* omega response.
/// Grains of 0.25 mm within 3 cm of the ground have St > 12: they follow no eddy.
inline void slow_eddies(const GrainsInEddies& grains, double dt, double& k, double& omega) {
  constexpr double follows = 0.25, of_omega = 0.35;
  const double stokes = 6.0 * Wilcox2006::beta_star * omega * grains.response;
  const double f = -2.0 * grains.rate * std::expm1(-follows * stokes);
  k /= 1.0 + dt * f;
  omega /= 1.0 + dt * of_omega * f;
}

/// k and omega after a step of `dt`. What takes of them is implicit, so that both stay positive.
inline void step_k_omega(const KOmegaPlace& p, double dt, double& k, double& omega) {
  using W = Wilcox2006;
  const double eddy = p.k / p.omega, shear2 = p.shear * p.shear, limited = limited_omega(p.omega, p.shear);
  const double gains = W::alpha * shear2 / limited + (p.viscosity + W::sigma_omega * eddy) * p.square_l +
                       W::sigma_d * std::max(p.square_k_l, 0.0) / p.omega + p.diffusion_l;
  omega = p.omega * (1.0 + dt * std::max(gains, 0.0)) / (1.0 + dt * (W::beta * p.omega + std::max(-gains, 0.0)));
  const double least = 1e-30, made = p.k / limited * shear2;
  k = (p.k + dt * (made + std::max(p.diffusion_k, 0.0))) /
      (1.0 + dt * (W::beta_star * p.omega + std::max(-p.diffusion_k, 0.0) / std::max(p.k, least)));
}

}  // namespace barchan
