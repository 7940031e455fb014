// Viscous stress at a free surface (docs/method.md): nothing lies beyond it, so the stress there is that of the void.
//
//   p - n.T.n = p_v  across the surface,   T.n - n (n.T.n) = 0  along it,   T = mu (grad v + grad v^T)
//
// The Laplacian of friction ends at the surface and knows neither: in a potential flow it is zero, and a wave in
// viscous water kept its amplitude. V: numbers of several particles side by side (Four), or of one.
#pragma once

#include <array>

#include "models/fluid/fluid_rates.hpp"
#include "models/fluid/fluid_surface.hpp"
#include "simd/vec.hpp"

namespace barchan {

/// Water that a wave moves has a layer below its surface, sqrt(2 nu/omega) thick, in which the stress along the surface
/// vanishes. Rows that do not resolve it do not hand on to the wave what the layer takes (a tenth to a half of it was
/// missing). Of a potential flow the layer's pull on the wave is exactly that of a second normal stress (Lundgren &
/// Mansour 1988; Joseph & Wang 2004: the viscous correction of the pressure), so that with the share s of it,
///   p - (1 + s) n.T.n = p_v,   T.n of the surface without s 2 mu grad(v.n)
/// s = 1/(1 + (layer/3.2 dx)^2.5), with the layer of a wave 100 spacings long. Without gravity s = 0.
constexpr double resolved_layer = 3.2, wave_of_layer = 16.0;

/// The Laplacian of the top row along the surface sees this of its truth while its weights are isotropic. What lies
/// between the middle of the stress of the top row and the surface asks for 1.5 of it.
constexpr double seen_along = 0.47, asked_along = 1.5;

/// n.g/|g| from which on a surface counts as level. A film that runs up a wall is none: with the friction and the
/// diffusion of a level surface, one of fifty broken dams had a film whose density came off by 3 %.
constexpr double level_from = 0.5, level_to = 0.9;

/// Of a particle at the surface; elsewhere zero.
template <int Dim, class V>
struct SurfaceStress {
  V normal;                 // Pa, (1 + s) n.T.n, from the stretching along the surface
  std::array<V, Dim> drag;  // N/m3, of the stress along the surface
};

/// `flux`: mu grad v (Pa); `b`: sum V F r, inwards; `beside`: what of the particle counts as the surface.
/// `more` (Pa s): what the friction of the rows below has beyond mu. It holds a top row back that turns, slides, say;
/// without it nothing did, and a tank at rest got a drift along its surface.
template <int Dim, class V>
BARCHAN_SIMD_INLINE SurfaceStress<Dim, V> surface_stress(const std::array<std::array<V, Dim>, Dim>& flux,
                                                         const std::array<std::array<V, Dim>, Dim>& grad_v,
                                                         const std::array<V, Dim>& b, V beside, V more,
                                                         const FluidParameters& q) {
  const double turned = 1.0 - 2.0 * q.layer_share;
  SurfaceStress<Dim, V> stress;
  V square(1e-24), divergence(0.0), across(0.0);
  for (std::size_t d = 0; d < Dim; ++d) {
    square = simd::fma(b[d], b[d], square);
    divergence += flux[d][d];
    V pull(0.0);
    for (std::size_t e = 0; e < Dim; ++e) {
      const V turning = more * (grad_v[d][e] - grad_v[e][d]);
      pull = simd::fma(simd::fma(V(turned), flux[e][d], flux[d][e]) + turning, b[e], pull);
      across = simd::fma(flux[d][e] * b[d], b[e], across);
    }
    stress.drag[d] = pull;
  }
  const V rate = across / square, scale = V(2.0 * q.per_top_row) * beside;
  stress.normal = simd::select(beside > V(0.0), V(2.0 * (1.0 + q.layer_share)) * (rate - divergence), V(0.0));
  for (std::size_t d = 0; d < Dim; ++d)
    stress.drag[d] = scale * simd::fnma(V(1.0 + turned) * rate, b[d], stress.drag[d]);
  return stress;
}

/// 1 beside a level surface, 0 beside one that stands and away from surfaces. `b`: the direction inwards, any length.
template <int Dim, class V>
BARCHAN_SIMD_INLINE V level_surface(const std::array<V, Dim>& b, const FluidParameters& q) {
  V size(1e-24), weight(1e-24), along(0.0);
  for (std::size_t d = 0; d < Dim; ++d) {
    size = simd::fma(b[d], b[d], size);
    weight += V(q.gravity[d] * q.gravity[d]);
    along = simd::fma(b[d], V(q.gravity[d]), along);
  }
  return smooth_step(along / simd::sqrt(size * weight), level_from, level_to);
}

/// How isotropic the weights of the top row stay, for the part of the friction above; 0: as raised_weights says.
template <class V>
BARCHAN_SIMD_INLINE V kept_isotropic(V viscosity, V more, const FluidParameters& q) {
  const V asked = V(asked_along) * simd::fma(V(0.3), more, V((1.0 - q.layer_share) * q.surface_viscosity));
  return simd::min(asked / (V(seen_along) * viscosity), V(1.0));
}

}  // namespace barchan
