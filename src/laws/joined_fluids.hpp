// Two fluids that touch, corrected operators: what a pair across their interface adds to the rates of its first
// particle.
//
// Pressure is continuous there, its gradient is not: it jumps like the density. What is continuous is the acceleration
// grad p/rho, so with the interface between a and b
//   (p_a - p_i)/rho_a = (p_i - p_b)/rho_b,   p_i = (rho_b p_a + rho_a p_b)/(rho_a + rho_b)
// (Hu & Adams 2006; Adami et al. 2012), and a feels rho_a 2 (p_a - p_b)/(rho_a + rho_b) in place of p_a - p_b. Of
// particles a thousand times as heavy as a this is what a moving wall does; of particles a thousand times lighter, a
// free surface.
//
// Weight first: where between a and b the interface lies, nobody knows, and rho_b g dx misplaced by a tenth is a
// hundred times the weight of a. At rest p_a - p_b lies between rho_a g.r and rho_b g.r, wherever the interface is; so
// what lies between the two is weight, and only what is beyond accelerates:
//   p_ab = rho_a g.r + 2 rho_a/(rho_a + rho_b) J,   J = (p_a - p_b) clamped out of [rho_a g.r, rho_b g.r]
// Fluids at rest stay at rest to the bit, on any arrangement of particles; the interface is known to a spacing.
#pragma once

#include "laws/consistent_fluid.hpp"

namespace barchan {

template <int Dim>
struct JoinedFluids {
  static constexpr bool needs_distance = true;
  static constexpr bool corrected = true;
  static constexpr double middling = 0.01;

  template <class T>
  using Sums = typename ConsistentFluid<Dim>::template Sums<T>;

  template <class T>
  struct Own : ConsistentFluid<Dim>::template Own<T> {
    std::array<T, Dim> weight;  // rho_a g, Pa/m
    T ratio, share;             // rho_b/rho_a, 2 rho_a/(rho_a + rho_b)
  };

  template <class T>
  static BARCHAN_SIMD_INLINE void add(const Own<T>& a, const std::array<T, Dim>& r, T r2, T f, const T* v_b, T p_b,
                                      T volume_b, Sums<T>& s) {
    T own = a.weight[0] * r[0];
    for (std::size_t d = 1; d < Dim; ++d) own = fma(a.weight[d], r[d], own);
    const T theirs = a.ratio * own, dp = a.p - p_b;
    const T weight = simd::max(simd::min(own, theirs), simd::min(simd::max(own, theirs), dp));
    const T half = simd::broadcast<T>(0.5);
    const T jump = fma(simd::broadcast<T>(middling), weight - half * (own + theirs), dp - weight);
    ConsistentFluid<Dim>::add_difference(a, r, r2, f, v_b, fma(a.share, jump, own), volume_b, s);
  }
};

}  // namespace barchan
