// From the sums over a fluid particle's neighbours to its rates: the corrections of docs/method.md, shared by the
// passes over laminar and turbulent fluids. V: numbers of several particles side by side (Four), or of one.
#pragma once

#include <array>
#include <bit>

#include "laws/consistent_fluid.hpp"
#include "laws/plain_fluid.hpp"
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

/// Inverse of a symmetric matrix given by its lower triangle (xx xy yy | xx xy yy xz yz zz).
template <class V>
BARCHAN_SIMD_INLINE std::array<V, 4> inverse_symmetric(const std::array<V, 3>& m) {
  const V s = V(1.0) / determinant(m), xy = -m[1] * s;
  return {m[2] * s, xy, xy, m[0] * s};
}
template <class V>
BARCHAN_SIMD_INLINE std::array<V, 9> inverse_symmetric(const std::array<V, 6>& m) {
  const V xx = m[0], xy = m[1], yy = m[2], xz = m[3], yz = m[4], zz = m[5];
  const V a = yy * zz - yz * yz, b = xz * yz - xy * zz, c = xy * yz - xz * yy;
  const V s = V(1.0) / (xx * a + xy * b + xz * c);
  const V d = (xx * zz - xz * xz) * s, e = (xy * xz - xx * yz) * s, f = (xx * yy - xy * xy) * s;
  return {a * s, b * s, c * s, b * s, d, e, c * s, e, f};
}

template <int Dim, class V>
struct Rates {
  std::array<V, Dim> acceleration, shift;
  V density;
};

/// What may lie beside the particles of a fluid. nothing: it is whole, and no solid that moves is in it; neither plain
/// operators nor surfaces are looked at. ends: a void or a free surface is near some of them, or solids move in it.
enum class Beside { nothing, ends };

/// Where a particle stands in its fluid. Read: its company, pressure, velocity, whether its fluid ends near it, and the
/// direction inwards at and near the free surface, of the step before (zero elsewhere). Written: its wholeness (chi
/// below).
template <int Dim, class V>
struct Place {
  V company;  // share of the neighbourhood that its own fluid fills, -tr M/Dim of the fluid's entry with itself
  V pressure;
  V ends;  // above 0: a void or a surface may be near
  std::array<V, Dim> velocity, normal;
  V wholeness;
  decltype(V() < V()) loose;  // its wholeness is below `loose_below`: is there a void?
};

/// The columns behind it; null without a free surface. What is left in `normal` is B = sum V F r, see SurfaceFinder.
template <int Dim>
struct SurfaceColumns {
  double* wholeness = nullptr;
  std::array<double*, Dim> normal{};
  explicit SurfaceColumns(PhaseParticles& fluid) {
    if (!fluid.has(Field::wholeness)) return;
    wholeness = fluid.column(Field::wholeness);
    for (std::size_t d = 0; d < Dim; ++d) normal[d] = fluid.column(Field::surface_normal, static_cast<int>(d));
  }
};

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

template <int Dim, class V>
BARCHAN_SIMD_INLINE std::array<V, Dim> shift_of(const std::array<V, Dim>& concentration, const FluidParameters& q) {
  std::array<V, Dim> du;
  V speed2(0.0);
  for (std::size_t d = 0; d < Dim; ++d) {
    du[d] = V(-q.shift_speed * q.smoothing_length) * concentration[d];
    speed2 += du[d] * du[d];
  }
  const V limit(q.shift_limit);
  const V s = simd::select(speed2 > limit * limit, limit / simd::sqrt(speed2), V(1.0));
  for (auto& u : du) u *= s;
  return du;
}

template <int Dim, Beside, class V>
BARCHAN_SIMD_INLINE Rates<Dim, V> finish(const typename PlainFluid<Dim>::template Sums<V>& s, double, V rho,
                                         const FluidParameters& q, std::array<V, Dim*(Dim + 1) / 2>&, Place<Dim, V>&) {
  Rates<Dim, V> r;
  r.shift = shift_of<Dim, V>(s.concentration, q);
  const V specific = V(1.0) / rho;
  // What is fused is written, so that a fluid with a surface has the same bits inside, whatever the compiler chooses.
  const V diffusivity(2.0 * q.diffusivity / (q.sound_speed * q.sound_speed));
  for (std::size_t d = 0; d < Dim; ++d) {
    const V push = simd::fma(V(2.0), s.viscous[d], -s.pressure[d]);
    r.acceleration[d] = simd::fma(push, specific, V(q.gravity[d] + q.acceleration[d]));
  }
  r.density = simd::fma(rho, s.divergence, diffusivity * s.diffusion);
  return r;
}

/// A plain fluid with a free surface: chi = -tr M/Dim - h|B|/2 is 1 inside and about a half on a straight surface.
template <int Dim, Beside beside, class V>
BARCHAN_SIMD_INLINE Rates<Dim, V> finish(const typename PlainSurface<Dim>::template Sums<V>& s, double mu, V rho,
                                         const FluidParameters& q, std::array<V, Dim*(Dim + 1) / 2>& anisotropy,
                                         Place<Dim, V>& place) {
  const typename PlainFluid<Dim>::template Sums<V>& plain = s;
  Rates<Dim, V> r = finish<Dim, beside, V>(plain, mu, rho, q, anisotropy, place);
  keep_inside<Dim, V>(r.shift, place.normal);
  // Records hold the volume m/rho: the density takes out what compression does to it.
  const V lopsided = V(q.smoothing_length) * length_of<Dim, V>(s.concentration),
          compressed = rho * V(1.0 / q.reference_density);
  place.wholeness = V(-1.0 / Dim) * s.trace - V(0.5) * lopsided;
  r.density += loosen<Dim, V>(rho, s.trace * compressed, lopsided * compressed, q);
  return r;
}

/// det(-M) of a full neighbourhood is 1, perturbed by a fifth of a spacing 0.8 to 1.2. Below this there is a void
/// (behind a grain that has left, say): corrections would raise the local speed of sound, and with it break the step's
/// limit. At a free surface half of a neighbourhood is missing, det(-M) of half a one is 1/2^Dim, and the top row must
/// know the velocity gradient: uncorrected it found half of it, its friction then held it back (0.87 of a wave's speed
/// with 25 rows over the depth), its divergence moved its pressure, waves were 1.3 to 1.9 % too fast, and a rotating
/// patch gained 0.6 % of its energy.
constexpr double least_determinant = 0.6;

template <int Dim>
constexpr double least_determinant_of(const FluidParameters& q) {
  return q.loosening > 0.0 ? least_determinant * (Dim == 2 ? 0.25 : 0.125) : least_determinant;
}

/// A fluid particle alone in the pores of a bed is no fluid: the grains about it answer with its own pressure, and what
/// compresses it meets nothing. Below this share of its own fluid it feels neither pressure nor weight, is not shifted,
/// stays in its pore (its velocity decays at the rate 0.4 `pores`), and its density returns to rest at the rate
/// `pores`.
constexpr double lonely = 0.1, in_company = 0.3, pore_friction = 0.4;

/// Where a neighbourhood is not whole, corrected operators feed energy in. chi = det(-M) - h|B|/2 tells: of particles
/// disturbed by a fifth of a spacing, 99 % of a straight surface lie below 0.31 and 99.9 % of an interior above 0.39.
/// The corrected operators count with the weight w(chi), the plain ones, in which neighbours push and nothing beyond
/// them does, with 1 - w:
///   grad p    = w M^-1 P + (1-w) [2 (p_a - p_v) B - P]
///   lap p     = w (-2 Dim/tr M) [L_p - (M^-1 P).B] + (1-w) 2 [L_p - rho0 g.B]
/// p_v is the pressure of the void: zero beyond a free surface; below zero in a fluid that fills its space, so that a
/// hole behind a grain closes. Disorder alone brings chi below 0.6 too, and plain operators there cost a whole fluid a
/// fifth to a third of its accuracy: in a fluid without a surface and without solids that move, w = 1 but beside voids
/// (VoidFinder).
constexpr double surface_begins = 0.3, surface_ends = 0.6;

/// Particles beside a void of a fluid that fills its space have a wholeness below this (a hole of one lost particle:
/// 0.6; of six spacings: 0.2 to 0.45), and so has one in a thousand of a disturbed interior: VoidFinder looks at them.
constexpr double loose_below = 0.5;

/// A neighbourhood of a lower wholeness is broken, void or not: in a flow that its spacing cannot resolve the corrected
/// operators then gain energy without bound (inviscid Taylor-Green vortices of 10 particles a side: five times the
/// energy in 1.2 s). Vortices of 25 a side and more do not come below it, save a strained one (Re 10000, 25 a side):
/// two of four runs do, and their errors become 0.94 and 0.58 of those without.
constexpr double broken_below = 0.2;

/// chi < loose_below, without the root of |B|.
template <int Dim, class V>
BARCHAN_SIMD_INLINE auto is_loose(V content, const std::array<V, Dim>& concentration, const FluidParameters& q) {
  const V over = content - V(loose_below), half = V(0.5 * q.smoothing_length);
  V square(0.0);
  for (std::size_t d = 0; d < Dim; ++d) square = simd::fma(concentration[d], concentration[d], square);
  return (over < V(0.0)) | (half * half * square > over * over);
}

/// Without friction, rows next to a heavy free surface rock each other up, where the operators change from corrected to
/// plain, and the disorder of an inviscid interior swells it by a tenth of a per cent in a period of a wave. The rate
/// is that of gravity over a spacing. So a heavy fluid with a free surface has at least these viscosities, in rho0 h
/// sqrt(g h): everywhere; more near the surface, where the operators are corrected, and where they are plain. Measured
/// with a tank at rest (100 crossings) and a standing wave 50 spacings deep; without weight a surface needs none.
constexpr double bulk_friction = 0.08, corrected_friction = 6.4, plain_friction = 3.0;

template <int Dim, class V>
BARCHAN_SIMD_INLINE V least_viscosity(V mu, V inner, const std::array<V, Dim>& normal, const FluidParameters& q) {
  V square(0.0);
  for (std::size_t d = 0; d < Dim; ++d) square = simd::fma(normal[d], normal[d], square);
  const V near = simd::mask_zero(square > V(0.0), V(plain_friction) + inner * V(corrected_friction - plain_friction));
  return simd::max(mu, (V(bulk_friction) + near) * V(q.least_viscosity));
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
  if (q.least_viscosity > 0.0)
    for (std::size_t d = 0; d < Dim; ++d)
      lost = simd::fma(V(2.0) * (force[d] - V(q.reference_density * q.gravity[d])), concentration[d], lost);
  return lost;
}

/// Where walls of different velocities meet, the pressure has no bound, and a particle that is squeezed into the corner
/// may change its density by a multiple in one step (a lid-driven cavity of Re 1000 with the default radius). In a
/// fluid that fills its space a density off by more than `tolerated_error` of rest decays with the rate `calming`, and
/// no rate exceeds a tenth of `calming` times the density at rest, a twentieth of it in h/c. A weakly compressible flow
/// is off by less than a hundredth, and there this adds zero: it changes no bit.
constexpr double tolerated_error = 0.05;

template <class V>
BARCHAN_SIMD_INLINE V calm(V rate, V rho, const FluidParameters& q) {
  const V off = rho - V(q.reference_density), tolerated(tolerated_error * q.reference_density), zero(0.0);
  const V excess = simd::max(off - tolerated, zero) + simd::min(off + tolerated, zero);
  const V most(0.1 * q.calming * q.reference_density);
  return simd::max(simd::min(simd::fnma(V(q.calming), excess, rate), most), zero - most);
}

/// `friction` gives, from M^-1 and grad v, the viscous sum less what a linear field makes of it: of the term
/// laplace_v mu friction.
template <int Dim, Beside beside, class V, class Friction>
BARCHAN_SIMD_INLINE Rates<Dim, V> finish_consistent(const typename ConsistentFluid<Dim>::template Sums<V>& s, double mu,
                                                    V rho, const FluidParameters& q,
                                                    std::array<V, Dim*(Dim + 1) / 2>& anisotropy, Place<Dim, V>& place,
                                                    Friction&& friction) {
  Rates<Dim, V> r;
  constexpr bool ends = beside == Beside::ends;
  r.shift = shift_of<Dim, V>(s.concentration, q);
  if constexpr (ends) keep_inside<Dim, V>(r.shift, place.normal);
  // A particle among grains in flight may have too few neighbours to invert anything: it goes uncorrected, M = -1.
  auto moment = s.moment;
  const V sign(Dim == 2 ? 1.0 : -1.0);
  const V content = sign * determinant(moment);
  const auto whole = content > V(least_determinant_of<Dim>(q));
  [[maybe_unused]] const V lopsided = V(q.smoothing_length) * length_of<Dim, V>(s.concentration);
  place.wholeness = content - V(0.5) * lopsided;
  for (std::size_t d = 0; d < Dim; ++d)
    for (std::size_t e = 0; e <= d; ++e) {
      const std::size_t m = moment_index(d, e);
      moment[m] = simd::select(whole, moment[m], V(d == e ? -1.0 : 0.0));
      anisotropy[m] = simd::mask_zero(whole, anisotropy[m]);
    }
  const auto inverse = inverse_symmetric(moment);
  V trace(0.0), weighted_trace(0.0);
  for (std::size_t d = 0; d < Dim; ++d) {
    trace += moment[moment_index(d, d)];
    for (std::size_t e = 0; e < Dim; ++e) weighted_trace += anisotropy[moment_index(d, e)] * moment[moment_index(d, e)];
  }
  weighted_trace = simd::min(weighted_trace + trace, V(0.5) * trace);  // both negative
  const V per_trace = V(1.0) / trace;
  place.loose = is_loose<Dim, V>(content, s.concentration, q);
  V inner(1.0), outer(0.0), viscosity(mu);
  if constexpr (ends) {
    inner = simd::select(place.ends > V(0.0), smooth_step(place.wholeness, surface_begins, surface_ends), V(1.0));
    outer = V(1.0) - inner;
    if (q.least_viscosity > 0.0) viscosity = least_viscosity<Dim, V>(V(mu), inner, place.normal, q);
  }
  const V laplace_v = V(-2.0 * Dim) * viscosity / (weighted_trace * rho), laplace_p = V(-2.0 * Dim) * per_trace;
  const V specific = V(1.0) / rho;
  const double c2 = q.sound_speed * q.sound_speed;
  [[maybe_unused]] const V push = V(2.0) * (place.pressure - V(q.void_pressure));
  std::array<V, Dim> grad_p, force;
  std::array<std::array<V, Dim>, Dim> grad_v;
  for (std::size_t d = 0; d < Dim; ++d) {
    grad_p[d] = inverse[d * Dim] * s.pressure[0];
    for (std::size_t e = 1; e < Dim; ++e) grad_p[d] = simd::fma(inverse[d * Dim + e], s.pressure[e], grad_p[d]);
    if constexpr (ends) force[d] = inner * grad_p[d] + outer * (push * s.concentration[d] - s.pressure[d]);
    else force[d] = grad_p[d];
    for (std::size_t e = 0; e < Dim; ++e) {
      grad_v[d][e] = s.velocity[d * Dim] * inverse[e];
      for (std::size_t f = 1; f < Dim; ++f)
        grad_v[d][e] = simd::fma(s.velocity[d * Dim + f], inverse[f * Dim + e], grad_v[d][e]);
    }
  }
  const std::array<V, Dim> rubbed = friction(inverse, grad_v);
  V divergence(0.0), along_p(0.0), dynamic = s.diffusion, squared(0.0);
  for (std::size_t d = 0; d < Dim; ++d) {
    divergence += grad_v[d][d];
    along_p += r.shift[d] * grad_p[d];
    dynamic -= (grad_p[d] - V(q.reference_density * q.gravity[d])) * s.concentration[d];
    V transported(0.0);
    for (std::size_t e = 0; e < Dim; ++e) {
      transported += r.shift[e] * grad_v[d][e];
      squared += grad_v[d][e] * grad_v[e][d];
    }
    r.acceleration[d] = laplace_v * rubbed[d] - force[d] * specific + V(q.gravity[d] + q.acceleration[d]) + transported;
  }
  // lap p + rho0 grad v : grad v^T vanishes for an incompressible flow: diffusion acts on what is left.
  V laplacian = laplace_p * dynamic, carried = along_p * V(1.0 / c2);
  if constexpr (ends) {
    laplacian = inner * laplacian + outer * (V(2.0) * s.diffusion - lost_beyond<Dim, V>(force, s.concentration, q));
    carried = inner * carried;
  }
  r.density = -rho * divergence + V(q.diffusivity / c2) * laplacian +
              V(q.source_diffusivity / c2 * q.reference_density) * squared + carried;
  if (ends && q.pores > 0.0) {
    const V counts = smooth_step(place.company, lonely, in_company), rate = (V(1.0) - counts) * V(q.pores);
    r.density = counts * r.density - rate * (rho - V(q.reference_density));
    for (std::size_t d = 0; d < Dim; ++d) {
      r.acceleration[d] = counts * r.acceleration[d] - V(pore_friction) * rate * place.velocity[d];
      r.shift[d] *= counts;
    }
  }
  if (ends && q.loosening > 0.0) r.density += loosen<Dim, V>(rho, trace_of<Dim, V>(s.moment), lopsided, q);
  if (q.calming > 0.0) r.density = calm<V>(r.density, rho, q);
  // The next step's weights; they stay positive: no entry of A beyond a half, save at a heavy surface.
  const V scale = V(-0.5 * (Dim + 2) * Dim) * per_trace;
  auto a = moment;
  for (std::size_t d = 0; d < Dim; ++d)
    for (std::size_t e = 0; e <= d; ++e) {
      const std::size_t m = moment_index(d, e);
      a[m] = scale * moment[m] + V(d == e ? 0.5 * (Dim + 2) : 0.0);
      anisotropy[m] = simd::mask_zero(whole, simd::max(simd::min(a[m], V(0.5)), V(-0.5)));
    }
  if (ends && q.least_viscosity > 0.0) {
    const V factor = raised_weights<Dim, V>(a, outer);
    for (auto& skew : anisotropy) skew *= factor;
  }
  return r;
}

template <int Dim, Beside beside, class V>
BARCHAN_SIMD_INLINE Rates<Dim, V> finish(const typename ConsistentFluid<Dim>::template Sums<V>& s, double mu, V rho,
                                         const FluidParameters& q, std::array<V, Dim*(Dim + 1) / 2>& anisotropy,
                                         Place<Dim, V>& place) {
  return finish_consistent<Dim, beside, V>(
      s, mu, rho, q, anisotropy, place, [&](const auto&, const auto& grad_v) __attribute__((always_inline)) {
        std::array<V, Dim> friction = s.viscous;
        for (std::size_t d = 0; d < Dim; ++d)
          for (std::size_t e = 0; e < Dim; ++e) friction[d] -= grad_v[d][e] * s.weighted[e];
        return friction;
      });
}

/// The sums over the lanes of every member of one particle's sums.
template <class Reduced, class Sums>
BARCHAN_SIMD_INLINE Reduced reduce(const Sums& from) {
  constexpr std::size_t count = sizeof(Sums) / sizeof(Lanes);
  static_assert(count == sizeof(Reduced) / sizeof(double));
  const auto v = std::bit_cast<std::array<Lanes, count>>(from);
  std::array<double, count> x;
  for (std::size_t k = 0; k < count; ++k) x[k] = simd::sum(v[k]);
  return std::bit_cast<Reduced>(x);
}

}  // namespace barchan
