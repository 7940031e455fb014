// From the sums over a fluid particle's neighbours to its rates: the corrections of docs/method.md, shared by the
// passes over laminar and turbulent fluids.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <span>

#include "laws/consistent_fluid.hpp"
#include "laws/plain_fluid.hpp"
#include "passes/fluid.hpp"

namespace barchan {

inline double determinant(const std::array<double, 3>& m) { return m[0] * m[2] - m[1] * m[1]; }
inline double determinant(const std::array<double, 6>& m) {
  return m[0] * (m[2] * m[5] - m[4] * m[4]) - m[1] * (m[1] * m[5] - m[4] * m[3]) + m[3] * (m[1] * m[4] - m[2] * m[3]);
}

/// Inverse of a symmetric matrix given by its lower triangle (xx xy yy | xx xy yy xz yz zz).
inline std::array<double, 4> inverse_symmetric(const std::array<double, 3>& m) {
  const double det = m[0] * m[2] - m[1] * m[1], s = 1.0 / det;
  return {m[2] * s, -m[1] * s, -m[1] * s, m[0] * s};
}
inline std::array<double, 9> inverse_symmetric(const std::array<double, 6>& m) {
  const double xx = m[0], xy = m[1], yy = m[2], xz = m[3], yz = m[4], zz = m[5];
  const double a = yy * zz - yz * yz, b = xz * yz - xy * zz, c = xy * yz - xz * yy;
  const double s = 1.0 / (xx * a + xy * b + xz * c);
  const double d = (xx * zz - xz * xz) * s, e = (xy * xz - xx * yz) * s, f = (xx * yy - xy * xy) * s;
  return {a * s, b * s, c * s, b * s, d, e, c * s, e, f};
}

template <int Dim>
struct Rates {
  std::array<double, Dim> acceleration, shift;
  double density;
};

template <int Dim>
std::array<double, Dim> shift_of(const std::array<double, Dim>& concentration, const FluidParameters& q) {
  std::array<double, Dim> du;
  double speed2 = 0.0;
  for (std::size_t d = 0; d < Dim; ++d) {
    du[d] = -q.shift_speed * q.smoothing_length * concentration[d];
    speed2 += du[d] * du[d];
  }
  if (speed2 > q.shift_limit * q.shift_limit) {
    const double s = q.shift_limit / std::sqrt(speed2);
    for (auto& u : du) u *= s;
  }
  return du;
}

template <int Dim>
Rates<Dim> finish(const typename PlainFluid<Dim>::template Sums<double>& s, double, double rho,
                  const FluidParameters& q, std::span<double>) {
  Rates<Dim> r;
  r.shift = shift_of<Dim>(s.concentration, q);
  for (std::size_t d = 0; d < Dim; ++d)
    r.acceleration[d] = (2.0 * s.viscous[d] - s.pressure[d]) / rho + q.gravity[d] + q.acceleration[d];
  r.density = rho * s.divergence + 2.0 * q.diffusivity / (q.sound_speed * q.sound_speed) * s.diffusion;
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
template <int Dim, class Friction>
Rates<Dim> finish_consistent(const typename ConsistentFluid<Dim>::template Sums<double>& s, double mu, double rho,
                             const FluidParameters& q, std::span<double> anisotropy, Friction&& friction) {
  Rates<Dim> r;
  r.shift = shift_of<Dim>(s.concentration, q);
  // A particle among grains in flight may have too few neighbours to invert anything: it goes uncorrected, M = -1.
  auto moment = s.moment;
  const double sign = Dim == 2 ? 1.0 : -1.0;
  const bool whole = sign * determinant(moment) > least_determinant;
  if (!whole)
    for (std::size_t d = 0; d < Dim; ++d)
      for (std::size_t e = 0; e <= d; ++e) {
        moment[moment_index(d, e)] = d == e ? -1.0 : 0.0;
        anisotropy[moment_index(d, e)] = 0.0;
      }
  const auto inverse = inverse_symmetric(moment);
  double trace = 0.0, weighted_trace = 0.0;
  for (std::size_t d = 0; d < Dim; ++d) {
    trace += moment[moment_index(d, d)];
    for (std::size_t e = 0; e < Dim; ++e) weighted_trace += anisotropy[moment_index(d, e)] * moment[moment_index(d, e)];
  }
  weighted_trace = std::min(weighted_trace + trace, 0.5 * trace);  // both negative
  const double laplace_v = -2.0 * Dim / weighted_trace, laplace_p = -2.0 * Dim / trace;
  const double c2 = q.sound_speed * q.sound_speed;
  std::array<double, Dim> grad_p{};
  std::array<std::array<double, Dim>, Dim> grad_v{};
  for (std::size_t d = 0; d < Dim; ++d)
    for (std::size_t e = 0; e < Dim; ++e) {
      grad_p[d] += inverse[d * Dim + e] * s.pressure[e];
      for (std::size_t f = 0; f < Dim; ++f) grad_v[d][e] += s.velocity[d * Dim + f] * inverse[f * Dim + e];
    }
  const std::array<double, Dim> rubbed = friction(inverse, grad_v);
  double divergence = 0.0, along_p = 0.0, dynamic = s.diffusion, squared = 0.0;
  for (std::size_t d = 0; d < Dim; ++d) {
    divergence += grad_v[d][d];
    along_p += r.shift[d] * grad_p[d];
    dynamic -= (grad_p[d] - q.reference_density * q.gravity[d]) * s.concentration[d];
    double transported = 0.0;
    for (std::size_t e = 0; e < Dim; ++e) {
      transported += r.shift[e] * grad_v[d][e];
      squared += grad_v[d][e] * grad_v[e][d];
    }
    r.acceleration[d] = (laplace_v * mu * rubbed[d] - grad_p[d]) / rho + q.gravity[d] + q.acceleration[d] + transported;
  }
  // lap p + rho0 grad v : grad v^T vanishes for an incompressible flow: diffusion acts on what is left.
  r.density = -rho * divergence + q.diffusivity / c2 * laplace_p * dynamic +
              q.source_diffusivity / c2 * q.reference_density * squared + along_p / c2;
  const double scale = -0.5 * (Dim + 2) * Dim / trace;
  for (std::size_t d = 0; d < Dim; ++d)
    for (std::size_t e = 0; e <= d; ++e)
      anisotropy[moment_index(d, e)] =
          !whole ? 0.0 : scale * moment[moment_index(d, e)] + (d == e ? 0.5 * (Dim + 2) : 0.0);
  // Weights stay positive: no entry of A beyond a half.
  for (std::size_t d = 0; d < Dim; ++d)
    for (std::size_t e = 0; e <= d; ++e) {
      double& a = anisotropy[moment_index(d, e)];
      a = std::clamp(a, -0.5, 0.5);
    }
  return r;
}

template <int Dim>
Rates<Dim> finish(const typename ConsistentFluid<Dim>::template Sums<double>& s, double mu, double rho,
                  const FluidParameters& q, std::span<double> anisotropy) {
  return finish_consistent<Dim>(s, mu, rho, q, anisotropy, [&](const auto&, const auto& grad_v) {
    std::array<double, Dim> friction = s.viscous;
    for (std::size_t d = 0; d < Dim; ++d)
      for (std::size_t e = 0; e < Dim; ++e) friction[d] -= grad_v[d][e] * s.weighted[e];
    return friction;
  });
}

/// The sums over the lanes of every member: both are plain aggregates of the same shape, of vectors and of numbers.
template <class Reduced, class Sums>
BARCHAN_SIMD_INLINE Reduced reduce(const Sums& from) {
  constexpr std::size_t count = sizeof(Sums) / sizeof(Lanes);
  static_assert(count == sizeof(Reduced) / sizeof(double));
  const auto v = std::bit_cast<std::array<Lanes, count>>(from);
  alignas(64) std::array<double, count> x;
  std::size_t k = 0;
  for (; k + 4 <= count; k += 4) simd::sum(v[k], v[k + 1], v[k + 2], v[k + 3]).store(x.data() + k);
  for (; k < count; ++k) x[k] = simd::sum(v[k]);
  return std::bit_cast<Reduced>(x);
}

}  // namespace barchan
