// From the sums over a fluid particle's neighbours to its rates: the corrections of docs/method.md, shared by the
// passes over laminar and turbulent fluids. V: numbers of several particles side by side (Four), or of one.
#pragma once

#include <algorithm>
#include <array>
#include <bit>

#include "laws/consistent_fluid.hpp"
#include "laws/joined_fluids.hpp"
#include "laws/plain_fluid.hpp"
#include "models/fluid/fluid_rates.hpp"
#include "models/fluid/fluid_stress.hpp"
#include "models/fluid/fluid_surface.hpp"
#include "models/fluid/fluid_terms.hpp"
#include "models/fluid/rate_parts.hpp"

namespace barchan {

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

/// Of the plain scheme; see RateParts.
template <int Dim, class V>
BARCHAN_SIMD_INLINE void note_parts(RateParts<Dim, V>& parts, const typename PlainFluid<Dim>::template Sums<V>& s,
                                    double mu, V rho, V specific, const FluidParameters& q) {
  for (std::size_t d = 0; d < Dim; ++d) {
    parts.pressure[d] = -s.pressure[d] * specific;
    parts.friction[d] = V(2.0) * s.viscous[d] * specific;
    parts.stress[d] = parts.turning[d] = parts.carried[d] = V(0.0);
  }
  parts.viscosity = V(mu);
  parts.squeezed = rho * s.divergence + V(2.0 * parts.centring) * s.diffusion;
  parts.diffused = V(2.0 * (q.diffusivity / (q.sound_speed * q.sound_speed) - parts.centring)) * s.diffusion;
  parts.moved = parts.renewed = V(0.0);
}

template <int Dim, class V, class Parts>
BARCHAN_SIMD_INLINE Rates<Dim, V> finish(const typename PlainFluid<Dim>::template Sums<V>& s,
                                         [[maybe_unused]] double mu, V rho, const FluidParameters& q,
                                         std::array<V, Dim*(Dim + 1) / 2>&, Place<Dim, V>&,
                                         [[maybe_unused]] Parts& parts) {
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
  if constexpr (Parts::asked) note_parts<Dim, V>(parts, s, mu, rho, specific, q);
  return r;
}

/// A plain fluid with a free surface: chi = -tr M/Dim - h|B|/2 is 1 inside and about a half on a straight surface.
template <int Dim, class V, class Parts>
BARCHAN_SIMD_INLINE Rates<Dim, V> finish(const typename PlainSurface<Dim>::template Sums<V>& s, double mu, V rho,
                                         const FluidParameters& q, std::array<V, Dim*(Dim + 1) / 2>& anisotropy,
                                         Place<Dim, V>& place, Parts& parts) {
  const typename PlainFluid<Dim>::template Sums<V>& plain = s;
  Rates<Dim, V> r = finish<Dim, V>(plain, mu, rho, q, anisotropy, place, parts);
  keep_inside<Dim, V>(r.shift, place.normal);
  // Records hold the volume m/rho: the density takes out what compression does to it.
  const V lopsided = V(q.smoothing_length) * length_of<Dim, V>(s.concentration),
          compressed = rho * V(1.0 / q.reference_density);
  place.wholeness = V(-1.0 / Dim) * s.trace - V(0.5) * lopsided;
  const V loosened = loosen<Dim, V>(rho, s.trace * compressed, lopsided * compressed, q);
  if constexpr (Parts::asked) parts.renewed = loosened;
  r.density += loosened;
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
constexpr double least_determinant_of(bool surface) {
  return surface ? least_determinant * (Dim == 2 ? 0.25 : 0.125) : least_determinant;
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

/// mu grad v: as the pairs of a fluid with viscosities of its particles have it, or of the scene's viscosity.
template <int Dim, class V, class Friction>
BARCHAN_SIMD_INLINE std::array<std::array<V, Dim>, Dim> flux_of(const Friction& friction,
                                                                std::array<std::array<V, Dim>, Dim> grad_v,
                                                                const FluidParameters& q) {
  if constexpr (requires { friction.t; }) return friction.t;
  for (auto& row : grad_v)
    for (auto& g : row) g *= V(q.surface_viscosity);
  return grad_v;
}

/// `friction` gives, from M^-1 and grad v, the viscous sum less what a linear field makes of it: of the term
/// laplace_v mu friction.
template <int Dim, FluidTerms has, class V, class Friction, class Parts>
BARCHAN_SIMD_INLINE Rates<Dim, V> finish_consistent(const typename ConsistentFluid<Dim>::template Sums<V>& s, double mu,
                                                    V rho, const FluidParameters& q,
                                                    std::array<V, Dim*(Dim + 1) / 2>& anisotropy, Place<Dim, V>& place,
                                                    Friction&& friction, [[maybe_unused]] Parts& parts) {
  Rates<Dim, V> r;
  constexpr bool ends = has.ends, heavy = has.heavy(), stressed = has.stressed();
  r.shift = shift_of<Dim, V>(s.concentration, q);
  if constexpr (ends) keep_inside<Dim, V>(r.shift, place.normal);
  // A particle among grains in flight may have too few neighbours to invert anything: it goes uncorrected, M = -1.
  auto moment = s.moment;
  const V sign(Dim == 2 ? 1.0 : -1.0);
  const V content = sign * determinant(moment);
  const auto whole = content > V(least_determinant_of<Dim>(has.has_surface()));
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
  [[maybe_unused]] V beside_it(0.0);
  if constexpr (ends) {
    inner = simd::select(place.ends > V(0.0), smooth_step(place.wholeness, surface_begins, surface_ends), V(1.0));
    outer = V(1.0) - inner;
    if constexpr (heavy) {
      beside_it = beside_surface<Dim, V>(outer, place.normal);
      viscosity = least_viscosity<Dim, V>(V(mu), beside_it, beside_surface<Dim, V>(V(1.0), place.normal), q);
    }
  }
  const V laplace_v = V(-2.0 * Dim) * viscosity / (weighted_trace * rho), laplace_p = V(-2.0 * Dim) * per_trace;
  const V specific = V(1.0) / rho;
  const double c2 = q.sound_speed * q.sound_speed;
  [[maybe_unused]] const V push = V(2.0) * (place.pressure - V(q.void_pressure));
  std::array<V, Dim> grad_p, force;
  std::array<std::array<V, Dim>, Dim> grad_v;
  for (std::size_t d = 0; d < Dim; ++d)
    for (std::size_t e = 0; e < Dim; ++e) {
      grad_v[d][e] = s.velocity[d * Dim] * inverse[e];
      for (std::size_t f = 1; f < Dim; ++f)
        grad_v[d][e] = simd::fma(s.velocity[d * Dim + f], inverse[f * Dim + e], grad_v[d][e]);
    }
  const std::array<V, Dim> rubbed = friction(inverse, grad_v);
  [[maybe_unused]] V level(0.0), more(0.0);
  if constexpr (heavy) {
    level = level_surface<Dim, V>(place.normal, q);
    more = V(std::max(mu, bulk_friction * q.least_viscosity) - q.surface_viscosity) * level;
  }
  [[maybe_unused]] SurfaceStress<Dim, V> stress;
  if constexpr (stressed)
    stress = surface_stress<Dim, V>(flux_of<Dim, V>(friction, grad_v, q), grad_v, s.concentration,
                                    beside_surface<Dim, V>(outer, place.normal), more, q);
  for (std::size_t d = 0; d < Dim; ++d) {
    grad_p[d] = inverse[d * Dim] * s.pressure[0];
    for (std::size_t e = 1; e < Dim; ++e) grad_p[d] = simd::fma(inverse[d * Dim + e], s.pressure[e], grad_p[d]);
  }
  [[maybe_unused]] const auto pushed = [&](V across) __attribute__((always_inline)) {
    const V twice_p = push - across;
    std::array<V, Dim> f;
    for (std::size_t d = 0; d < Dim; ++d)
      f[d] = simd::fma(inner, grad_p[d], outer * simd::fma(twice_p, s.concentration[d], V(0.0) - s.pressure[d]));
    if constexpr (heavy) carry_weight<Dim, V>(f, grad_p, s, twice_p, across, outer, place.normal, q);
    return f;
  };
  if constexpr (ends) force = pushed(stressed ? V(2.0) * stress.normal : V(0.0));
  else force = grad_p;
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
    if constexpr (stressed) r.acceleration[d] = simd::fma(stress.drag[d], specific, r.acceleration[d]);
    if constexpr (Parts::asked) {
      parts.pressure[d] = -force[d] * specific;
      parts.friction[d] = laplace_v * rubbed[d];
      parts.stress[d] = parts.turning[d] = V(0.0);
      parts.carried[d] = transported;
    }
  }
  if constexpr (Parts::asked && stressed) {
    const auto bare = pushed(V(0.0));
    const auto own = surface_stress<Dim, V>(flux_of<Dim, V>(friction, grad_v, q), grad_v, s.concentration,
                                            beside_surface<Dim, V>(outer, place.normal), V(0.0), q);
    for (std::size_t d = 0; d < Dim; ++d) {
      parts.pressure[d] = -bare[d] * specific;
      parts.stress[d] = (bare[d] - force[d] + own.drag[d]) * specific;
      parts.turning[d] = (stress.drag[d] - own.drag[d]) * specific;
    }
  }
  // lap p + rho0 grad v : grad v^T vanishes for an incompressible flow: diffusion acts on what is left.
  V laplacian = laplace_p * dynamic, carried = along_p * V(1.0 / c2);
  if constexpr (ends) {
    V lost(0.0);
    if constexpr (heavy) lost = lost_beyond<Dim, V>(force, s.concentration, q);
    laplacian = inner * laplacian + outer * (V(2.0) * s.diffusion - lost);
    carried = inner * carried;
  }
  V diffusivity(q.diffusivity / c2), source(q.source_diffusivity / c2 * q.reference_density);
  if constexpr (heavy) {
    diffusivity = simd::fma(V(q.surface_diffusivity / c2), level, diffusivity);
    source = simd::fma(V(q.surface_diffusivity / c2 * q.reference_density), level, source);
  }
  r.density = -rho * divergence + diffusivity * laplacian + source * squared + carried;
  if constexpr (Parts::asked) {
    const V centred = V(parts.centring) * (laplacian + V(0.5 * q.reference_density) * squared);
    parts.viscosity = viscosity;
    parts.squeezed = centred - rho * divergence;
    parts.diffused = diffusivity * laplacian + source * squared - centred;
    parts.moved = carried;
    parts.renewed = V(0.0) - r.density;
  }
  if constexpr (has.pores) {
    const V counts = smooth_step(place.company, lonely, in_company), rate = (V(1.0) - counts) * V(q.pores);
    r.density = counts * r.density - rate * (rho - V(q.reference_density));
    for (std::size_t d = 0; d < Dim; ++d) {
      r.acceleration[d] = counts * r.acceleration[d] - V(pore_friction) * rate * place.velocity[d];
      r.shift[d] *= counts;
    }
  }
  if constexpr (has.has_surface()) r.density += loosen<Dim, V>(rho, trace_of<Dim, V>(s.moment), lopsided, q);
  if constexpr (heavy) r.density += relax_tension<V>(rho, beside_it, q);
  if constexpr (has.calming) r.density = calm<V>(r.density, rho, q);
  if constexpr (Parts::asked) parts.renewed += r.density;
  // The next step's weights; they stay positive: no entry of A beyond a half, save at a heavy surface.
  const V scale = V(-0.5 * (Dim + 2) * Dim) * per_trace;
  auto a = moment;
  for (std::size_t d = 0; d < Dim; ++d)
    for (std::size_t e = 0; e <= d; ++e) {
      const std::size_t m = moment_index(d, e);
      a[m] = scale * moment[m] + V(d == e ? 0.5 * (Dim + 2) : 0.0);
      anisotropy[m] = simd::mask_zero(whole, simd::max(simd::min(a[m], V(0.5)), V(-0.5)));
    }
  if constexpr (heavy) {
    V factor = raised_weights<Dim, V>(a, outer);
    factor = simd::fnma(kept_isotropic<V>(viscosity, more, q), factor - V(1.0), factor);
    for (auto& skew : anisotropy) skew *= factor;
  }
  return r;
}

template <int Dim, FluidTerms has, class V, class Parts>
BARCHAN_SIMD_INLINE Rates<Dim, V> finish(const typename ConsistentFluid<Dim>::template Sums<V>& s, double mu, V rho,
                                         const FluidParameters& q, std::array<V, Dim*(Dim + 1) / 2>& anisotropy,
                                         Place<Dim, V>& place, Parts& parts) {
  return finish_consistent<Dim, has, V>(
      s, mu, rho, q, anisotropy, place,
      [&](const auto&, const auto& grad_v) __attribute__((always_inline)) {
        std::array<V, Dim> friction = s.viscous;
        for (std::size_t d = 0; d < Dim; ++d)
          for (std::size_t e = 0; e < Dim; ++e) friction[d] -= grad_v[d][e] * s.weighted[e];
        return friction;
      },
      parts);
}

/// Next to an interface with another fluid: the flux of momentum has the kink of the velocity there.
template <int Dim, FluidTerms has, class V, class Parts>
BARCHAN_SIMD_INLINE Rates<Dim, V> finish(const typename JoinedFluids<Dim>::template Sums<V>& s, double mu, V rho,
                                         const FluidParameters& q, std::array<V, Dim*(Dim + 1) / 2>& anisotropy,
                                         Place<Dim, V>& place, Parts& parts) {
  return finish_consistent<Dim, has, V>(
      s, mu, rho, q, anisotropy, place,
      [&](const auto& inverse, const auto& grad_v) __attribute__((always_inline)) {
        std::array<V, Dim> friction = s.viscous;
        for (std::size_t d = 0; d < Dim; ++d)
          for (std::size_t e = 0; e < Dim; ++e) {
            V flux = grad_v[d][e];
            for (std::size_t f = 0; f < Dim; ++f) flux = simd::fma(s.kink[d * Dim + f], inverse[f * Dim + e], flux);
            friction[d] -= flux * s.weighted[e];
          }
        return friction;
      },
      parts);
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
