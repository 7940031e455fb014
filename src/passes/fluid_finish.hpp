// From the sums over a fluid particle's neighbours to its rates: the corrections of docs/method.md, shared by the
// passes over laminar and turbulent fluids. V: numbers of several particles side by side (Four), or of one.
#pragma once

#include <array>
#include <bit>

#include "laws/consistent_fluid.hpp"
#include "laws/plain_fluid.hpp"
#include "passes/fluid.hpp"

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

template <int Dim, class V>
BARCHAN_SIMD_INLINE Rates<Dim, V> finish(const typename PlainFluid<Dim>::template Sums<V>& s, double, V rho,
                                         const FluidParameters& q, std::array<V, Dim*(Dim + 1) / 2>&) {
  Rates<Dim, V> r;
  r.shift = shift_of<Dim, V>(s.concentration, q);
  const V specific = V(1.0) / rho;
  for (std::size_t d = 0; d < Dim; ++d)
    r.acceleration[d] = (V(2.0) * s.viscous[d] - s.pressure[d]) * specific + V(q.gravity[d] + q.acceleration[d]);
  r.density = rho * s.divergence + V(2.0 * q.diffusivity / (q.sound_speed * q.sound_speed)) * s.diffusion;
  return r;
}

/// det(-M) of a full neighbourhood is 1, perturbed by a fifth of a spacing 0.8 to 1.2. Below this there is a void
/// (behind a grain that has left, say): corrections would raise the local speed of sound, and with it break the step's
/// limit.
constexpr double least_determinant = 0.6;

/// Place of (d, e) in a moment: xx xy yy | xx xy yy xz yz zz.
constexpr std::size_t moment_index(std::size_t d, std::size_t e) {
  return d >= e ? d * (d + 1) / 2 + e : e * (e + 1) / 2 + d;
}

/// `friction` gives, from M^-1 and grad v, the viscous sum less what a linear field makes of it: of the term
/// laplace_v mu friction.
template <int Dim, class V, class Friction>
BARCHAN_SIMD_INLINE Rates<Dim, V> finish_consistent(const typename ConsistentFluid<Dim>::template Sums<V>& s, double mu,
                                                    V rho, const FluidParameters& q,
                                                    std::array<V, Dim*(Dim + 1) / 2>& anisotropy, Friction&& friction) {
  Rates<Dim, V> r;
  r.shift = shift_of<Dim, V>(s.concentration, q);
  // A particle among grains in flight may have too few neighbours to invert anything: it goes uncorrected, M = -1.
  auto moment = s.moment;
  const V sign(Dim == 2 ? 1.0 : -1.0);
  const auto whole = sign * determinant(moment) > V(least_determinant);
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
  const V laplace_v = V(-2.0 * Dim * mu) / (weighted_trace * rho), laplace_p = V(-2.0 * Dim) * per_trace;
  const V specific = V(1.0) / rho;
  const double c2 = q.sound_speed * q.sound_speed;
  std::array<V, Dim> grad_p;
  std::array<std::array<V, Dim>, Dim> grad_v;
  for (std::size_t d = 0; d < Dim; ++d) {
    grad_p[d] = inverse[d * Dim] * s.pressure[0];
    for (std::size_t e = 1; e < Dim; ++e) grad_p[d] = simd::fma(inverse[d * Dim + e], s.pressure[e], grad_p[d]);
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
    r.acceleration[d] =
        laplace_v * rubbed[d] - grad_p[d] * specific + V(q.gravity[d] + q.acceleration[d]) + transported;
  }
  // lap p + rho0 grad v : grad v^T vanishes for an incompressible flow: diffusion acts on what is left.
  r.density = -rho * divergence + V(q.diffusivity / c2) * laplace_p * dynamic +
              V(q.source_diffusivity / c2 * q.reference_density) * squared + along_p * V(1.0 / c2);
  // The next step's weights; they stay positive: no entry of A beyond a half.
  const V scale = V(-0.5 * (Dim + 2) * Dim) * per_trace;
  for (std::size_t d = 0; d < Dim; ++d)
    for (std::size_t e = 0; e <= d; ++e) {
      const std::size_t m = moment_index(d, e);
      const V a = scale * moment[m] + V(d == e ? 0.5 * (Dim + 2) : 0.0);
      anisotropy[m] = simd::mask_zero(whole, simd::max(simd::min(a, V(0.5)), V(-0.5)));
    }
  return r;
}

template <int Dim, class V>
BARCHAN_SIMD_INLINE Rates<Dim, V> finish(const typename ConsistentFluid<Dim>::template Sums<V>& s, double mu, V rho,
                                         const FluidParameters& q, std::array<V, Dim*(Dim + 1) / 2>& anisotropy) {
  return finish_consistent<Dim, V>(
      s, mu, rho, q, anisotropy, [&](const auto&, const auto& grad_v) __attribute__((always_inline)) {
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
