// Weakly compressible fluid, symmetric form: what a pair adds to the rates of its first particle.
//
//   dv_a/dt   = -(1/rho_a) sum V_b (p_a + p_b) grad W + (1/rho_a) sum 2 mu_ab V_b F v_ab         (momentum)
//   drho_a/dt =  rho_a sum V_b v_ab . grad W + D/c^2 sum 2 V_b F [p_ab - rho0 g . r_ab]           (continuity)
//
// The volume form stands any density ratio between neighbours (Colagrossi & Landrini 2003; Hu & Adams 2006): force
// m_a dv_a = -V_a V_b (p_a + p_b) grad W is antisymmetric. Viscosity: Morris et al. 1997. Density diffusion:
// Molteni & Colagrossi 2009 on the pressure less its hydrostatic part (Fourtakas et al. 2019).
// Eq. (12) of Halik et al. 2015 is the same for equal densities.
#pragma once

#include <array>

#include "simd/vec.hpp"

namespace barchan {

template <int Dim>
struct PlainFluid {
  static constexpr bool corrected = false;

  /// Sums over neighbours. T: a SIMD vector in the loop, a number after it.
  template <class T>
  struct Sums {
    std::array<T, Dim> pressure{}, viscous{}, concentration{};   // sum V F (p_a+p_b) r, sum mu V F v_ab, sum V F r
    T divergence{}, diffusion{};                                 // sum V F v_ab.r, sum V F (p_ab - rho0 g.r)
  };

  /// The first particle and what the entry fixes, broadcast.
  template <class T>
  struct Own {
    std::array<T, Dim> x, v, weight;   // weight: rho0 g [Pa/m]
    T p, mu, diffusive;                // mu: viscosity of the entry [Pa s]; diffusive: 1, or 0 to switch diffusion off
  };

  /// Adds the pair: r = x_a - x_b, F the gradient factor of the kernel, b the neighbour.
  template <class T>
  static void add(const Own<T>& a, const std::array<T, Dim>& r, T, T f, const T* v_b, T p_b, T volume_b, Sums<T>& s) {
    const T vf = volume_b * f;
    const T pressure = vf * (a.p + p_b);
    const T friction = vf * a.mu;
    T vr(0.0), dynamic = a.p - p_b;
    for (std::size_t d = 0; d < Dim; ++d) {
      const T dv = a.v[d] - v_b[d];
      vr = fma(dv, r[d], vr);
      dynamic = fnma(a.weight[d], r[d], dynamic);
      s.pressure[d] = fma(pressure, r[d], s.pressure[d]);
      s.viscous[d] = fma(friction, dv, s.viscous[d]);
      s.concentration[d] = fma(vf, r[d], s.concentration[d]);
    }
    s.divergence = fma(vf, vr, s.divergence);
    s.diffusion = fma(vf * a.diffusive, dynamic, s.diffusion);
  }
};

}  // namespace barchan
