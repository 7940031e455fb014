// What the free surface of a fluid adds to its rates: shifts, fullness, friction and pressure of the rows beside it
// (docs/method.md). V: numbers of several particles side by side (Four), or of one.
#pragma once

#include <algorithm>
#include <array>

#include "laws/consistent_fluid.hpp"
#include "models/fluid/fluid_rates.hpp"

namespace barchan {

template <class V>
BARCHAN_SIMD_INLINE V determinant(const std::array<V, 3>& m) {
  return m[0] * m[2] - m[1] * m[1];
}
template <class V>
BARCHAN_SIMD_INLINE V determinant(const std::array<V, 6>& m) {
  return m[0] * (m[2] * m[5] - m[4] * m[4]) - m[1] * (m[1] * m[5] - m[4] * m[3]) + m[3] * (m[1] * m[4] - m[2] * m[3]);
}

/// 0 below a, 1 above b, smooth between (3 x^2 - 2 x^3).
template <class V>
BARCHAN_SIMD_INLINE V smooth_step(V x, double a, double b) {
  const V t = simd::min(simd::max((x - V(a)) * V(1.0 / (b - a)), V(0.0)), V(1.0));
  return t * t * (V(3.0) - V(2.0) * t);
}

/// Takes the part of the shift that leads out of the fluid away; what leads inwards or along the surface stays.
template <int Dim, class V>
BARCHAN_SIMD_INLINE void keep_inside(std::array<V, Dim>& shift, const std::array<V, Dim>& normal) {
  V along = shift[0] * normal[0], square = normal[0] * normal[0];
  for (std::size_t d = 1; d < Dim; ++d) {
    along = simd::fma(shift[d], normal[d], along);
    square = simd::fma(normal[d], normal[d], square);
  }
  const V out = simd::select(along < V(0.0), along / square, V(0.0));  // a normal of zero has nothing along it
  for (std::size_t d = 0; d < Dim; ++d) shift[d] = simd::fnma(out, normal[d], shift[d]);
}

/// How full a neighbourhood is, 1 in a whole fluid and at its straight surface alike: what tr M misses beyond a
/// surface, |B| tells. Measured: 0.98 to 1.04 in the rows at the surface of a lattice, within 0.05 of that on disturbed
/// particles; 0.4 in spray. Half of a Wendland kernel has tr M = -Dim/2 and h|B| = 7/(3 pi) in 2D.
constexpr double surface_share = 0.67;
/// A loose neighbourhood (spray that landed, a pool that swelled) bears no pressure: what of its density is above that
/// at rest decays at the rate `loosening` times what the neighbourhood misses beyond this share (at most a half, so
/// that a step of 0.4 h/c takes no more than there is). Energy of compression is lost, none is won; weight then draws
/// the fluid together. Water at rest keeps what is tolerated: a broken dam with 0.04, 0.02, 0.005 was 4.7, 2.4, 1.0 %
/// above its volume.
constexpr double tolerated_swelling = 0.015;

template <int Dim, class V>
BARCHAN_SIMD_INLINE V loosen(V rho, V trace, V lopsided, const FluidParameters& q) {
  const V fullness = (V(surface_share) * lopsided - trace * V(1.0 / Dim)) * V(1.0 / q.lattice_moment);
  return V(q.loosening) * simd::min(simd::max(fullness - V(1.0 - tolerated_swelling), V(-0.5)), V(0.0)) *
         simd::max(rho - V(q.reference_density), V(0.0));
}

/// What of `outer` counts beside a surface: of a particle with a normal.
template <int Dim, class V>
BARCHAN_SIMD_INLINE V beside_surface(V outer, const std::array<V, Dim>& normal) {
  V square(0.0);
  for (std::size_t d = 0; d < Dim; ++d) square = simd::fma(normal[d], normal[d], square);
  return simd::mask_zero(square > V(0.0), outer);
}

/// `beside`: beside_surface of what is plain; `near`: beside_surface of 1. In 2D the row below the top one has half of
/// the bulk friction: its sums find the kink that the velocity along the surface has at the top row (a gradient of one
/// side, 1.7 % with 25 rows), and its friction made nearly all that a wave of 12 rows lost. With none, ripples of 2.5
/// spacings grew in a tank at rest. In 3D, where rows rock in two directions, half is too little: 12 rows at rest moved
/// at 1.3e-5 sqrt(gH) for 0.9e-5.
template <int Dim>
constexpr double friction_below_top = Dim == 2 ? 0.5 : 1.0;

template <int Dim, class V>
BARCHAN_SIMD_INLINE V least_viscosity(V mu, V beside, V near, const FluidParameters& q) {
  const V bulk = V(bulk_friction) * (V(1.0) - V(1.0 - friction_below_top<Dim>) * (near - beside));
  return simd::max(mu, simd::fma(V(plain_friction), beside, bulk) * V(q.least_viscosity));
}

/// Beside a heavy surface fluid bears no lasting tension: what of its density is below that at rest returns at half of
/// the rate `loosening`, where the operators are plain. The plain push is not the opposite of the corrected divergence,
/// and a particle under tension between the two won energy: in a film that ran up a wall, where the surface was torn,
/// tension grew by e in 1.5 ms (4 dx/c), to a tenth of the density, in one of 60 broken dams. Under pressure: zero.
template <class V>
BARCHAN_SIMD_INLINE V relax_tension(V rho, V beside, const FluidParameters& q) {
  return V(0.5 * q.loosening) * beside * simd::max(V(q.reference_density) - rho, V(0.0));
}

/// The top row of a calm heavy surface. It carries the water above its middle, p_s, and its gradient is the corrected
/// one,
///   grad p = M^-1 P + 4 B (p_a - p_v - p_s) + 0.3 dx B/|B| [L_p - (M^-1 P - rho0 g).B],   p_s = d n.M^-1 P,   n =
///   B/|B|
/// d is half of the distance to the row below, so that p_s knows how the rows are strained; the gradient knows how they
/// are accelerated. A fixed p_s = rho0 dx/2 g.n made waves those of water half a spacing less deep: (coth kH - tanh kH)
/// k dx/4 too slow, 0.57 % of 0.86 % with 12 rows at kH = pi/2. p_s stays within a half of the fixed one. It is the
/// fixed one where the water's own viscosity is that of the bulk's friction or more: its gradient would have to be that
/// of p - n.T.n (a wave of Re 2500, 50 rows, decayed at 0.978 of its rate for 0.997). The plain sum answers a tilt of
/// the rows with a tenth too little, and waves were slow by it. The last term takes a quarter of the curvature along
/// the surface out of the slope across it, for which a one-sided gradient holds it (all of it makes ripples of two
/// spacings grow). Calm: p_a is within 25 % of the fixed p_s; beyond 50 % (a jet, a splash, a steep front) the plain
/// sum counts alone: the corrected one then feeds energy in, 1 % of a broken dam's.
constexpr double surface_answer = 4.0, curvature_in_slope = 0.6, calm_within = 0.25, rough_beyond = 0.5;

inline double strain_share(const FluidParameters& q) {
  return std::max(1.0 - q.surface_viscosity / (bulk_friction * q.least_viscosity), 0.0);
}

/// Adds to `force` what makes this of it, where the plain sum counts with `outer`; twice_p: 2 (p_a - p_v), of which
/// `stress` is what the surface bears beside (2 (1 + s) n.T.n): calm is what the pressure alone says, so that a
/// released particle of a standing face, p_a = p_v, stays rough. `normal`: of the step before, 1/(2 d) long
/// (SurfaceFinder); zero: d is half a spacing.
template <int Dim, class V, class Sums>
BARCHAN_SIMD_INLINE void carry_weight(std::array<V, Dim>& force, const std::array<V, Dim>& grad_p, const Sums& s,
                                      V twice_p, V stress, V outer, const std::array<V, Dim>& normal,
                                      const FluidParameters& q) {
  const auto& b = s.concentration;
  V square(1e-24), inwards(0.0), slope(0.0), curved = s.diffusion, length(0.0);
  for (std::size_t d = 0; d < Dim; ++d) {
    square = simd::fma(b[d], b[d], square);
    inwards = simd::fma(b[d], V(q.gravity[d]), inwards);
    slope = simd::fma(b[d], grad_p[d], slope);
    length = simd::fma(normal[d], normal[d], length);
    curved = simd::fnma(b[d], grad_p[d] - V(q.reference_density * q.gravity[d]), curved);  // L_p is the dynamic part's
  }
  const V per_size = V(1.0) / simd::sqrt(square);
  const V fixed = V(q.reference_density * q.surface_depth) * simd::max(inwards * per_size, V(1e-9));
  const V depth = simd::select(length > V(0.0), V(0.5) / simd::sqrt(length + V(1e-300)), V(q.surface_depth));
  const V strained = simd::min(simd::max(depth * slope * per_size, V(0.5) * fixed), V(1.5) * fixed);
  const V weight = simd::fma(V(strain_share(q)), strained - fixed, fixed);
  const V pressed = V(0.5) * (twice_p + stress), off = pressed - weight, away = pressed - fixed;
  const V rough = smooth_step(simd::max(away, V(0.0) - away) / fixed, calm_within, rough_beyond);
  const V counts = outer * (V(1.0) - rough);
  const V along = V(surface_answer) * (off - V(0.5) * stress) +
                  V(curvature_in_slope * q.surface_depth) * curved * per_size - twice_p;
  for (std::size_t d = 0; d < Dim; ++d) {
    const V change = simd::fma(along, b[d], grad_p[d] + s.pressure[d]);
    force[d] = simd::fma(counts, change, force[d]);
  }
}

/// In the top row the one-sided gradient takes curvature for its own: with weights that are isotropic the Laplacian
/// sees x^2 along the surface with 0.47 of its truth, y^2 across with -0.06, and drags a potential flow with 0.5 nu k^2
/// v. Weights of 0.12 along the surface leave below 0.005 (solved on lattices, radii of 2.1 to 4, 2D and 3D alike), so
/// that there A grows until its least eigenvalue is -0.88.
constexpr double surface_skew = 0.88, largest_raise = 3.0;

/// The factor of A that makes it so; 1 inside. No weight comes below 0.1: the least eigenvalue of A (traceless) follows
/// from its size and, in 3D, its determinant, within 2 %.
template <int Dim, class V>
BARCHAN_SIMD_INLINE V raised_weights(const std::array<V, Dim*(Dim + 1) / 2>& a, V outer) {
  V square(1e-6);
  for (std::size_t d = 0; d < Dim; ++d)
    for (std::size_t e = 0; e <= d; ++e)
      square = simd::fma(V(d == e ? 1.0 : 2.0) * a[moment_index(d, e)], a[moment_index(d, e)], square);
  const V size = simd::sqrt(square);
  V least = V(0.7071067811865476) * size;  // -(the least eigenvalue)
  if constexpr (Dim == 3) {
    const V shape = determinant(a) * V(7.3484692283495345) / (square * size);  // 1: (-1, -1, 2), -1: (1, 1, -2)
    const V half = simd::sqrt(simd::min(simd::max(V(0.5) - V(0.5) * shape, V(0.0)), V(1.0)));
    least = V(0.816496580927726) * size * (V(0.5) + V(0.5) * half);
  }
  return V(1.0) + outer * (simd::min(V(surface_skew) / least, V(largest_raise)) - V(1.0));
}

/// What the plain Laplacian of p - rho0 g.x lacks at a heavy surface, beyond which nothing lies: 2 B times its
/// gradient, which the force knows. Without it the diffusion moved the surface: 1.1 % of a wave a period with 50 rows.
template <int Dim, class V>
BARCHAN_SIMD_INLINE V lost_beyond(const std::array<V, Dim>& force, const std::array<V, Dim>& concentration,
                                  const FluidParameters& q) {
  V lost(0.0);
  for (std::size_t d = 0; d < Dim; ++d)
    lost = simd::fma(V(2.0) * (force[d] - V(q.reference_density * q.gravity[d])), concentration[d], lost);
  return lost;
}

}  // namespace barchan
