// The fluid pass written the slow way, from the formulas in the heads of src/laws/plain_fluid.hpp,
// src/laws/consistent_fluid.hpp and the comments of src/models/fluid/fluid_finish.hpp: every pair and every image, one
// number at a time.
#pragma once

#include <algorithm>
#include <utility>

#include "kernels/kernel.hpp"
#include "models/fluid/fluid_rates.hpp"
#include "unit/particle_sets.hpp"

namespace barchan::naive {

struct Entry {
  std::size_t other;  // phase
  KernelKind kernel;
  double radius, viscosity;
  bool diffuse;
  double joined = 0;  // density of another fluid across an interface (src/laws/joined_fluids.hpp), 0: none
  double beyond = 0;  // its viscosity
  const std::vector<double>*distances = nullptr, *theirs = nullptr;  // of both fluids' particles to the interface
};

struct Rates {
  std::array<std::vector<double>, 3> acceleration, shift;
  std::array<std::vector<double>, 6> anisotropy;
  std::vector<double> density;
  std::vector<double> wholeness;               // chi
  std::array<std::vector<double>, 3> inwards;  // B
  int limited = 0;                             // particles whose shift met its limit
  int uncorrected = 0;                         // particles with too few neighbours
  int blended = 0;                             // particles with a part of both kinds of operators
  int turned = 0;                              // particles whose shift would have led out of the fluid
  int loosened = 0;                            // particles whose density decays
};

using Matrix = std::array<Vec3, 3>;

inline double volume(const PhaseParticles& p, std::size_t k) { return p.mass() / p.column(Field::density)[k]; }

/// F = W'/r of an entry.
inline double gradient_factor(KernelKind kernel, double radius, int dimensions, double r) {
  return with_kernel<double>(kernel, radius, dimensions, [&](const auto& w) { return w.derivative(r) / r; });
}
inline double weight(KernelKind kernel, double radius, int dimensions, double r) {
  return with_kernel<double>(kernel, radius, dimensions, [&](const auto& w) { return w.value(r); });
}

/// Calls f(b, j, r, F) for every neighbour j, in phase b, of particle k of phase a within the entries' radii.
template <class F>
void for_neighbours(const sets::Cast& cast, std::size_t a, std::size_t k, const std::vector<Entry>& entries, F&& f) {
  for (const Entry& e : entries)
    sets::for_all_pairs(cast.bounds, cast.phases[a], k, cast.phases[e.other], e.other == a, e.radius,
                        [&](std::size_t j, const Vec3& r, const std::array<int, 3>&) {
                          f(e, cast.phases[e.other], j, r,
                            gradient_factor(e.kernel, e.radius, cast.bounds.dimensions, norm(r)));
                        });
}

/// du = -U h B, at most the limit. At a free surface, whose inward direction n the phase holds, the part of du against
/// n is taken away.
inline void keep_shift(Rates& out, const PhaseParticles& p, std::size_t k, Vec3 concentration,
                       const FluidParameters& q) {
  Vec3 du = -q.shift_speed * q.smoothing_length * concentration;
  if (norm(du) > q.shift_limit) {
    du = q.shift_limit / norm(du) * du;
    ++out.limited;
  }
  if (p.has(Field::surface_normal)) {
    const Vec3 n = sets::vector(p, Field::surface_normal, k);
    const double length = norm(n);
    if (length > 0.0 && dot(du, n) < 0.0) {
      du = du - dot(du, n) / (length * length) * n;
      ++out.turned;
    }
  }
  for (std::size_t d = 0; d < 3; ++d) {
    out.shift[d].push_back(du[d]);
    out.inwards[d].push_back(concentration[d]);
  }
}

/// drho/dt of loose fluid: the density above that at rest decays at the rate `loosening` times what the fullness
/// (0.67 h|B| - tr M/Dim), 1 on a lattice, misses beyond 1.5 %, at most a half.
inline double loosen(Rates& out, double rho, double trace, double h_b, int dimensions, const FluidParameters& q) {
  const double fullness = (0.67 * h_b - trace / dimensions) / q.lattice_moment;
  const double missing = std::clamp(0.985 - fullness, 0.0, 0.5);
  const double above = std::max(rho - q.reference_density, 0.0);
  if (missing * above > 0.0) ++out.loosened;
  return -q.loosening * missing * above;
}

inline Rates plain_rates(const sets::Cast& cast, std::size_t a, const std::vector<Entry>& entries,
                         const FluidParameters& q) {
  Rates out;
  const PhaseParticles& p = cast.phases[a];
  for (std::size_t k = 0; k < p.size(); ++k) {
    const double rho_a = p.column(Field::density)[k], p_a = p.column(Field::pressure)[k];
    const Vec3 v_a = sets::vector(p, Field::velocity, k);
    Vec3 dv = q.gravity + q.acceleration, concentration{};
    double drho = 0.0, trace = 0.0;
    for_neighbours(cast, a, k, entries,
                   [&](const Entry& e, const PhaseParticles& b, std::size_t j, const Vec3& r, double f) {
                     const double v_j = volume(b, j), p_b = b.column(Field::pressure)[j];
                     const Vec3 grad_w = f * r, v_ab = v_a - sets::vector(b, Field::velocity, j);
                     dv = dv - v_j * (p_a + p_b - 2.0 * q.void_pressure) / rho_a * grad_w +
                          2.0 * e.viscosity * v_j * f / rho_a * v_ab;
                     drho += rho_a * v_j * dot(v_ab, grad_w);
                     if (e.diffuse)
                       drho += q.diffusivity / (q.sound_speed * q.sound_speed) * 2.0 * v_j * f *
                               (p_a - p_b - q.reference_density * dot(q.gravity, r));
                     concentration = concentration + v_j * grad_w;
                     trace += v_j * dot(r, grad_w);
                   });
    const double h_b = q.smoothing_length * norm(concentration);
    out.wholeness.push_back(-trace / cast.bounds.dimensions - 0.5 * h_b);
    if (p.has(Field::wholeness)) {  // of volumes m/rho0, as if nothing were compressed
      const double compressed = rho_a / q.reference_density;
      drho += loosen(out, rho_a, compressed * trace, compressed * h_b, cast.bounds.dimensions, q);
    }
    for (std::size_t d = 0; d < 3; ++d) out.acceleration[d].push_back(dv[d]);
    out.density.push_back(drho);
    keep_shift(out, p, k, concentration, q);
  }
  return out;
}

/// Solves m x = b by elimination with pivots; m has `n` rows.
inline Vec3 solve(Matrix m, Vec3 b, std::size_t n) {
  for (std::size_t c = 0; c < n; ++c) {
    std::size_t pivot = c;
    for (std::size_t row = c + 1; row < n; ++row)
      if (std::abs(m[row][c]) > std::abs(m[pivot][c])) pivot = row;
    std::swap(m[c], m[pivot]);
    std::swap(b[c], b[pivot]);
    for (std::size_t row = 0; row < n; ++row) {
      if (row == c) continue;
      const double factor = m[row][c] / m[c][c];
      m[row] = m[row] - factor * m[c];
      b[row] -= factor * b[c];
    }
  }
  Vec3 x{};
  for (std::size_t c = 0; c < n; ++c) x[c] = b[c] / m[c][c];
  return x;
}

inline double determinant(const Matrix& m) {
  return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) - m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
         m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
}

/// The matrix A of a particle from the field: 2D xx xy, 3D in the order of the moment, xx xy yy xz yz zz.
inline Matrix anisotropy(const PhaseParticles& p, std::size_t k) {
  const auto c = [&](int component) { return p.column(Field::anisotropy, component)[k]; };
  if (p.dimensions() == 2) return {{{c(0), c(1), 0}, {c(1), -c(0), 0}, {0, 0, 0}}};
  return {{{c(0), c(1), c(3)}, {c(1), c(2), c(4)}, {c(3), c(4), c(5)}}};
}

inline Rates consistent_rates(const sets::Cast& cast, std::size_t a, const std::vector<Entry>& entries,
                              const FluidParameters& q) {
  Rates out;
  const PhaseParticles& p = cast.phases[a];
  const auto dim = static_cast<std::size_t>(cast.bounds.dimensions);
  const double n = static_cast<double>(dim), c2 = q.sound_speed * q.sound_speed;
  for (std::size_t k = 0; k < p.size(); ++k) {
    const double rho = p.column(Field::density)[k], p_a = p.column(Field::pressure)[k];
    const Vec3 v_a = sets::vector(p, Field::velocity, k);
    Matrix A = anisotropy(p, k), M{}, U{}, flux{};
    Vec3 B{}, P{}, C{}, L_v{};
    double L_p = 0.0;
    for_neighbours(cast, a, k, entries,
                   [&](const Entry& e, const PhaseParticles& b, std::size_t j, const Vec3& r, double f) {
                     const double vf = volume(b, j) * f;
                     double p_ab = p_a - b.column(Field::pressure)[j], rubbing = 1.0;
                     if (e.joined > 0) {
                       const double own = rho * dot(q.gravity, r), theirs = own * e.joined / q.reference_density;
                       const double low = std::min(own, theirs), high = std::max(own, theirs);
                       const double beyond = p_ab > high ? p_ab - high : p_ab < low ? p_ab - low : 0.0;
                       const double jump = beyond + 0.01 * (p_ab - beyond - 0.5 * (own + theirs));
                       p_ab = own + 2.0 * q.reference_density / (q.reference_density + e.joined) * jump;
                       const double d_a = (*e.distances)[k], theta = d_a / (d_a + (*e.theirs)[j]);
                       rubbing = e.beyond / (theta * e.beyond + (1 - theta) * entries.front().viscosity);
                     }
                     const Vec3 v_ab = v_a - sets::vector(b, Field::velocity, j);
                     double w = 1.0;
                     for (std::size_t d = 0; d < dim; ++d) w += r[d] * dot(A[d], r) / dot(r, r);
                     for (std::size_t d = 0; d < dim; ++d) {
                       M[d] = M[d] + vf * r[d] * r;
                       U[d] = U[d] + vf * v_ab[d] * r;
                     }
                     B = B + vf * r;
                     P = P + vf * p_ab * r;
                     C = C + vf * w * r;
                     L_v = L_v + rubbing * vf * w * v_ab;
                     for (std::size_t d = 0; d < dim; ++d) flux[d] = flux[d] + rubbing * vf * v_ab[d] * r;
                     L_p += vf * p_ab;
                   });
    keep_shift(out, p, k, B, q);
    // Few neighbours, det(-M) below 0.6 (of half a neighbourhood, 1/2^Dim, at a free surface): uncorrected, M = -1 and
    // A = 0.
    Matrix minus_m{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
    for (std::size_t d = 0; d < dim; ++d)
      for (std::size_t e = 0; e < dim; ++e) minus_m[d][e] = -M[d][e];
    const double content = determinant(minus_m), h_b = q.smoothing_length * norm(B);
    const bool whole = content > (q.loosening > 0.0 ? 0.6 * std::pow(0.5, cast.bounds.dimensions) : 0.6);
    // chi = det(-M) - h|B|/2; the corrected operators count with w(chi), which rises from 0 at 0.3 to 1 at 0.6.
    const double chi = content - 0.5 * h_b, rise = std::clamp((chi - 0.3) / 0.3, 0.0, 1.0);
    const double inner = 3 * rise * rise - 2 * rise * rise * rise, outer = 1 - inner;
    out.wholeness.push_back(chi);
    out.blended += inner > 0.0 && outer > 0.0;
    double drho = 0.0;
    if (q.loosening > 0.0) {
      double trace = 0.0;
      for (std::size_t d = 0; d < dim; ++d) trace += M[d][d];
      drho = loosen(out, rho, trace, h_b, cast.bounds.dimensions, q);
    }
    if (!whole) {
      M = {{{-1, 0, 0}, {0, -1, 0}, {0, 0, dim == 3 ? -1.0 : 0.0}}};
      A = {};
      ++out.uncorrected;
    }
    const Vec3 du{out.shift[0][k], out.shift[1][k], out.shift[2][k]};
    const Vec3 grad_p = solve(M, P, dim);
    Matrix grad_v{};
    double trace = 0.0, weighted = 0.0, divergence = 0.0, squared = 0.0;
    for (std::size_t d = 0; d < dim; ++d) {
      grad_v[d] = solve(M, U[d], dim);  // U M^-1, M symmetric
      trace += M[d][d];
      weighted += M[d][d] + dot(A[d], M[d]);
      divergence += grad_v[d][d];
    }
    weighted = std::min(weighted, 0.5 * trace);  // both are negative
    const Vec3 pushed = 2.0 * (p_a - q.void_pressure) * B - P;
    Vec3 dv = q.gravity + q.acceleration - 1.0 / rho * (inner * grad_p + outer * pushed);
    for (std::size_t d = 0; d < dim; ++d) {
      const double laplacian = -2.0 * n * (L_v[d] - dot(solve(M, flux[d], dim), C)) / weighted;
      dv[d] += entries.front().viscosity / rho * laplacian + dot(grad_v[d], du);
      for (std::size_t e = 0; e < dim; ++e) squared += grad_v[d][e] * grad_v[e][d];
    }
    const double laplacian_p = inner * (-2.0 * n / trace) * (L_p - dot(grad_p, B)) +
                               outer * 2.0 * (L_p - q.reference_density * dot(q.gravity, B));
    out.density.push_back(drho - rho * divergence + q.diffusivity / c2 * laplacian_p +
                          q.source_diffusivity / c2 * q.reference_density * squared + inner * dot(du, grad_p) / c2);
    for (std::size_t d = 0; d < 3; ++d) out.acceleration[d].push_back(dv[d]);
    const auto next = [&](std::size_t d, std::size_t e) {
      const double weight = -0.5 * (n + 2.0) * (n * M[d][e] / trace - (d == e ? 1.0 : 0.0));
      return std::clamp(weight, -0.5, 0.5);
    };
    constexpr std::array<std::pair<std::size_t, std::size_t>, 6> moment{
        {{0, 0}, {1, 0}, {1, 1}, {2, 0}, {2, 1}, {2, 2}}};
    for (std::size_t c = 0; c < (dim == 2 ? 2 : 6); ++c)
      out.anisotropy[c].push_back(next(moment[c].first, moment[c].second));
  }
  return out;
}

}  // namespace barchan::naive
