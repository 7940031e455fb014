// Tangential stiffness of two spheres over the normal one, k_t/k.
//
//   constant   k_t = 2/7 k: spheres that stick turn and part in the same time (Schaefer, Dippel and Wolf 1996), so that
//              nearly all of the speed along their surfaces is turned back; a softer spring turns less back
//   Mindlin    k_t = 3 (1 - nu)/(2 - nu) k, k = F/delta of Hertz (Mindlin 1949)
//
// Where a Hertzian contact is loaded, its slip shrinks as k_t grows (new surface carries no strain); unloaded, the
// force shrinks with k_t (Thornton, Cummins and Cleary 2013): a cycle of loads gains no energy.
#pragma once

#include <span>
#include <vector>

#include "laws/touching_spheres.hpp"
#include "scene/contact_words.hpp"

namespace barchan {

struct ConstantSlipStiffness {
  double ratio = 2.0 / 7.0;

  static ConstantSlipStiffness between(std::span<const SphereMaterial* const> grains) {
    std::vector<double> ratios;
    for (const SphereMaterial* g : grains) ratios.push_back(g->tangential_stiffness.value_or(2.0 / 7.0));
    return {mean_of(ratios)};
  }
  template <class V>
  static BARCHAN_SIMD_INLINE SlipStiffness<V> of(V ratio, const NormalForce<V>& n, V, const ContactStep<V>&) {
    const V k_t = ratio * n.stiffness;
    return {k_t, k_t, V(1.0)};
  }
};

struct MindlinSlipStiffness {
  double ratio = 0.0;

  static MindlinSlipStiffness of_poisson(double nu) { return {3.0 * (1.0 - nu) / (2.0 - nu)}; }
  static MindlinSlipStiffness between(std::span<const SphereMaterial* const> grains) {
    std::vector<double> ratios;
    for (const SphereMaterial* g : grains) ratios.push_back(of_poisson(g->poisson).ratio);
    return {mean_of(ratios)};
  }
  /// The overlap of the step before was delta + v_n dt.
  template <class V>
  static BARCHAN_SIMD_INLINE SlipStiffness<V> of(V ratio, const NormalForce<V>& n, V v_n, const ContactStep<V>& dt) {
    const V k_t = ratio * n.stiffness;
    const V was = simd::sqrt(simd::max(simd::fma(v_n * dt.whole, n.inverse_depth, V(1.0)), V(0.0)));
    return {k_t, k_t * was, simd::min(was, V(1.0))};
  }
};

}  // namespace barchan
