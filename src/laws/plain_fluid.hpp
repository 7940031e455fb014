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
  static constexpr bool needs_distance = false;
  static constexpr bool corrected = false;

  /// Sums over neighbours, not initialised. T: a SIMD vector in the loop, a number after it.
  template <class T>
  struct Sums {
    std::array<T, Dim> pressure, viscous, concentration;  // sum V F (p_a+p_b) r, sum V F v_ab, sum V F r
    T divergence, diffusion;                              // sum V F v_ab.r, sum V F p_ab

    /// Adds the sums of one entry: `scale` its kernel's constant factor, `mu` its viscosity [Pa s]; `diffuse` 0 or 1
    /// switches density diffusion. `weight` is rho0 g [Pa/m].
    BARCHAN_SIMD_INLINE void take(const Sums& s, double scale, double mu, double diffuse,
                                  const std::array<double, 3>& weight) {
      const T k = simd::broadcast<T>(scale), viscosity = simd::broadcast<T>(scale * mu),
              kd = simd::broadcast<T>(scale * diffuse);
      T hydrostatic = simd::broadcast<T>(0.0);
      for (std::size_t d = 0; d < Dim; ++d) {
        pressure[d] = fma(k, s.pressure[d], pressure[d]);
        viscous[d] = fma(viscosity, s.viscous[d], viscous[d]);
        concentration[d] = fma(k, s.concentration[d], concentration[d]);
        hydrostatic = fma(simd::broadcast<T>(weight[d]), s.concentration[d], hydrostatic);
      }
      divergence = fma(k, s.divergence, divergence);
      diffusion = fma(kd, s.diffusion - hydrostatic, diffusion);
    }
  };

  /// The first particle, broadcast.
  template <class T>
  struct Own {
    std::array<T, Dim> x, v;
    T p;
  };

  /// Adds the pair: r = x_a - x_b, f the gradient factor of the kernel (up to a constant), b the neighbour.
  template <class T>
  static BARCHAN_SIMD_INLINE void add(const Own<T>& a, const std::array<T, Dim>& r, T, T f, const T* v_b, T p_b,
                                      T volume_b, Sums<T>& s) {
    const T vf = volume_b * f;
    const T pressure = vf * (a.p + p_b);
    T vr = simd::broadcast<T>(0.0);
    for (std::size_t d = 0; d < Dim; ++d) {
      const T dv = a.v[d] - v_b[d];
      vr = d == 0 ? dv * r[d] : fma(dv, r[d], vr);
      s.pressure[d] = fma(pressure, r[d], s.pressure[d]);
      s.viscous[d] = fma(vf, dv, s.viscous[d]);
      s.concentration[d] = fma(vf, r[d], s.concentration[d]);
    }
    s.divergence = fma(vf, vr, s.divergence);
    s.diffusion = fma(vf, a.p - p_b, s.diffusion);
  }
};

/// The same with the trace of the neighbourhood's moment, for a fluid with a free surface: tr M = sum V F r^2.
template <int Dim>
struct PlainSurface {
  static constexpr bool needs_distance = true;
  static constexpr bool corrected = false;

  template <class T>
  struct Sums : PlainFluid<Dim>::template Sums<T> {
    T trace;
    BARCHAN_SIMD_INLINE void take(const Sums& s, double scale, double mu, double diffuse,
                                  const std::array<double, 3>& weight) {
      PlainFluid<Dim>::template Sums<T>::take(s, scale, mu, diffuse, weight);
      trace = fma(simd::broadcast<T>(scale), s.trace, trace);
    }
  };

  template <class T>
  using Own = typename PlainFluid<Dim>::template Own<T>;

  template <class T>
  static BARCHAN_SIMD_INLINE void add(const Own<T>& a, const std::array<T, Dim>& r, T r2, T f, const T* v_b, T p_b,
                                      T volume_b, Sums<T>& s) {
    PlainFluid<Dim>::add(a, r, r2, f, v_b, p_b, volume_b, s);
    s.trace = fma(volume_b * f, r2, s.trace);
  }
};

}  // namespace barchan
