#include "passes/fluid.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "kernels/kernel.hpp"
#include "laws/consistent_fluid.hpp"
#include "laws/plain_fluid.hpp"

namespace barchan {

namespace {

template <int Dim, template <int> class Law>
BARCHAN_SIMD_INLINE typename Law<Dim>::template Own<Lanes> load_own(const double* record) {
  using R = MotionRecord<Dim>;
  typename Law<Dim>::template Own<Lanes> own;
  for (std::size_t d = 0; d < Dim; ++d) {
    own.x[d] = Lanes(record[R::position + d]);
    own.v[d] = Lanes(record[R::velocity + d]);
  }
  own.p = Lanes(record[R::pressure]);
  return own;
}

/// Adds one entry's row to `total`.
template <int Dim, template <int> class Law>
BARCHAN_SIMD_INLINE void add_row(PairList::Row row, const FluidNeighbour& e, const ReadyKernel& ready,
                                 const typename Law<Dim>::template Own<Lanes>& own, const Vec3& weight,
                                 typename Law<Dim>::template Sums<Lanes>& total) {
  using R = MotionRecord<Dim>;
  ready([&](const auto& kernel) __attribute__((always_inline)) {
    typename Law<Dim>::template Sums<Lanes> sums{};
    for_each_neighbour<R::size>(
        row, *e.records, [&](const Lanes* b) __attribute__((always_inline)) {
          std::array<Lanes, Dim> r;
          const Lanes r2 = separation<Dim>(own.x, b + R::position, r);
          Law<Dim>::add(own, r, r2, kernel.slope(r2), b + R::velocity, b[R::pressure], b[R::volume], sums);
        });
    total.take(sums, kernel.slope_factor(), e.viscosity, e.diffuse ? 1.0 : 0.0, weight);
  });
}

/// At most this many entries a phase.
constexpr std::size_t most_entries = 16;

std::vector<ReadyKernel>& ready_kernels(std::span<const FluidNeighbour> neighbours, int dimensions) {
  thread_local std::vector<ReadyKernel> kernels;
  kernels.reserve(most_entries);
  kernels.clear();
  for (const auto& e : neighbours) kernels.emplace_back(e.kernel, e.radius, dimensions);
  return kernels;
}

double determinant(const std::array<double, 3>& m) { return m[0] * m[2] - m[1] * m[1]; }
double determinant(const std::array<double, 6>& m) {
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

template <int Dim>
Rates<Dim> finish(const typename ConsistentFluid<Dim>::template Sums<double>& s, double mu, double rho,
                  const FluidParameters& q, std::span<double> anisotropy) {
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
  double divergence = 0.0, along_p = 0.0, dynamic = s.diffusion, squared = 0.0;
  for (std::size_t d = 0; d < Dim; ++d) {
    divergence += grad_v[d][d];
    along_p += r.shift[d] * grad_p[d];
    dynamic -= (grad_p[d] - q.reference_density * q.gravity[d]) * s.concentration[d];
    double friction = s.viscous[d], transported = 0.0;
    for (std::size_t e = 0; e < Dim; ++e) {
      friction -= grad_v[d][e] * s.weighted[e];
      transported += r.shift[e] * grad_v[d][e];
      squared += grad_v[d][e] * grad_v[e][d];
    }
    r.acceleration[d] = (laplace_v * mu * friction - grad_p[d]) / rho + q.gravity[d] + q.acceleration[d] + transported;
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

template <int Dim, template <int> class Law>
void rates(PhaseParticles& fluid, const RecordArray& own_records, std::span<const FluidNeighbour> neighbours,
           const FluidParameters& q) {
  using L = Law<Dim>;
  const Vec3 weight{q.reference_density * q.gravity[0], q.reference_density * q.gravity[1],
                    q.reference_density * q.gravity[2]};
  std::array<double*, Dim> a{}, du{};
  for (int d = 0; d < Dim; ++d) {
    a[static_cast<std::size_t>(d)] = fluid.column(Field::acceleration, d);
    if (fluid.has(Field::shift_velocity)) du[static_cast<std::size_t>(d)] = fluid.column(Field::shift_velocity, d);
  }
  double* rate = fluid.column(Field::density_rate);
  const double* rho = fluid.column(Field::density);
  const double mu = neighbours.empty() ? 0.0 : neighbours.front().viscosity;
  const auto& kernels = ready_kernels(neighbours, Dim);
  constexpr std::size_t moments = Dim * (Dim + 1) / 2;
  std::array<double*, moments> skew{};  // 2D: xx xy, and yy = -xx
  if constexpr (L::corrected)
    for (std::size_t c = 0; c < (Dim == 2 ? 2 : moments); ++c)
      skew[c] = fluid.column(Field::anisotropy, static_cast<int>(c));
  const auto n = static_cast<std::int64_t>(fluid.size());
#pragma omp parallel for schedule(dynamic, 256)
  for (std::int64_t i = 0; i < n; ++i) {
    const auto k = static_cast<std::size_t>(i);
    typename L::template Sums<Lanes> sums{};
    std::array<double, moments> anisotropy{};
    if constexpr (L::corrected) {
      if constexpr (Dim == 2) anisotropy = {skew[0][k], skew[1][k], -skew[0][k]};
      else
        for (std::size_t c = 0; c < moments; ++c) anisotropy[c] = skew[c][k];
    }
    auto own = load_own<Dim, Law>(own_records[k]);
    if constexpr (L::corrected)
      for (std::size_t d = 0; d < Dim; ++d)
        for (std::size_t e = 0; e <= d; ++e)
          own.anisotropy[moment_index(d, e)] = Lanes((d == e ? 1.0 : 2.0) * anisotropy[moment_index(d, e)]);
    for (std::size_t c = 0; c < neighbours.size(); ++c) {
      const auto& e = neighbours[c];
      const auto row = e.list->row(k);
      if (row.begin == row.end) continue;
      add_row<Dim, Law>(row, e, kernels[c], own, weight, sums);
    }
    const auto s = reduce<typename L::template Sums<double>>(sums);
    const auto r = finish<Dim>(s, mu, rho[k], q, anisotropy);
    if constexpr (L::corrected)
      for (std::size_t c = 0; c < (Dim == 2 ? 2 : moments); ++c) skew[c][k] = anisotropy[c];
    for (std::size_t d = 0; d < Dim; ++d) {
      a[d][k] = r.acceleration[d];
      if (du[d]) du[d][k] = r.shift[d];
    }
    rate[k] = r.density;
  }
}

template <int Dim>
void reaction(PhaseParticles& solid, const RecordArray& own_records, const FluidNeighbour& e, bool pores) {
  using R = MotionRecord<Dim>;
  using L = PlainFluid<Dim>;
  std::array<double*, Dim> a{};
  for (int d = 0; d < Dim; ++d) a[static_cast<std::size_t>(d)] = solid.column(Field::acceleration, d);
  const double inverse_mass = 1.0 / solid.mass();
  const ReadyKernel kernel(e.kernel, e.radius, Dim);
  const auto n = static_cast<std::int64_t>(solid.size());
#pragma omp parallel for schedule(dynamic, 256)
  for (std::int64_t i = 0; i < n; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const auto row = e.list->row(k);
    if (row.begin == row.end) continue;
    const double* record = own_records[k];
    typename L::template Sums<Lanes> sums{};
    add_row<Dim, PlainFluid>(row, e, kernel, load_own<Dim, PlainFluid>(record), {0, 0, 0}, sums);
    const auto s = reduce<typename L::template Sums<double>>(sums);
    const double closing = pores ? 2.0 * record[R::pressure] : 0.0;
    for (std::size_t d = 0; d < Dim; ++d)
      a[d][k] += record[R::volume] * inverse_mass * (2.0 * s.viscous[d] - s.pressure[d] + closing * s.concentration[d]);
  }
}

}  // namespace

void fluid_rates(PhaseParticles& fluid, const RecordArray& own, std::span<const FluidNeighbour> neighbours,
                 const FluidParameters& q, FluidScheme scheme) {
  const bool plain = scheme == FluidScheme::plain;
  if (fluid.dimensions() == 2)
    plain ? rates<2, PlainFluid>(fluid, own, neighbours, q) : rates<2, ConsistentFluid>(fluid, own, neighbours, q);
  else plain ? rates<3, PlainFluid>(fluid, own, neighbours, q) : rates<3, ConsistentFluid>(fluid, own, neighbours, q);
}

void fluid_reaction(PhaseParticles& solid, const RecordArray& own, const FluidNeighbour& fluid, bool pores) {
  if (solid.dimensions() == 2) reaction<2>(solid, own, fluid, pores);
  else reaction<3>(solid, own, fluid, pores);
}

}  // namespace barchan
