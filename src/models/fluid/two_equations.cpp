// The pair passes of two_equations.hpp.
#include "models/fluid/two_equations.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "engine/pair_pass.hpp"
#include "laws/k_omega.hpp"
#include "models/fluid/fluid_finish.hpp"

namespace barchan::BARCHAN_TARGET {

namespace {

template <int Dim>
struct Columns {
  static constexpr std::size_t moments = Dim * (Dim + 1) / 2, kept = Dim == 2 ? 2 : moments;
  double *k, *omega, *nu_t;
  const double *shear, *distance;
  std::array<const double*, kept> skew{};
  std::array<const double*, Dim> shift{};

  explicit Columns(PhaseParticles& p)
      : k(p.column(Field::turbulent_kinetic_energy)),
        omega(p.column(Field::specific_dissipation_rate)),
        nu_t(p.column(Field::eddy_viscosity)),
        shear(std::as_const(p).column(Field::shear_rate)),
        distance(std::as_const(p).column(Field::ground_distance)) {
    for (std::size_t c = 0; c < kept; ++c) skew[c] = std::as_const(p).column(Field::anisotropy, static_cast<int>(c));
    if (p.has(Field::shift_velocity))
      for (std::size_t d = 0; d < Dim; ++d)
        shift[d] = std::as_const(p).column(Field::shift_velocity, static_cast<int>(d));
  }

  std::array<double, moments> anisotropy(std::size_t i) const {
    std::array<double, moments> a{};
    for (std::size_t m = 0; m < kept; ++m) a[m] = skew[m][i];
    if constexpr (Dim == 2) a[2] = -a[0];
    return a;
  }
};

/// As ConsistentFluid's first particle: off the diagonal doubled.
template <int Dim, class Own>
BARCHAN_SIMD_INLINE void weigh(Own& own, const std::array<double, Dim*(Dim + 1) / 2>& a) {
  for (std::size_t d = 0; d < Dim; ++d)
    for (std::size_t e = 0; e <= d; ++e) {
      const std::size_t m = moment_index(d, e);
      own.anisotropy[m] = Lanes(d == e ? a[m] : 2.0 * a[m]);
    }
}

template <int Dim>
using Sums = KOmegaPairs::Sums<Dim, double>;

/// The pairs of one row, reduced.
template <int Dim, class Law>
BARCHAN_SIMD_INLINE typename Law::template Sums<Dim, double> row_sums(const Law& law, const KOmegaNeighbour& n,
                                                                      const ReadyKernel& kernel, PairList::Row row,
                                                                      const double* own,
                                                                      const std::array<double, Dim*(Dim + 1) / 2>& a) {
  typename Law::template Own<Dim, Lanes> first;
  detail::broadcast(first, own);
  weigh<Dim>(first, a);
  const PairEntry<Law> entry{n.pair.list, n.records, n.pair.kernel, n.pair.radius, law};
  typename Law::template Sums<Dim, Lanes> sums{};
  kernel([&](const auto& ready) __attribute__((always_inline)) { add_row<Dim>(law, ready, first, row, entry, sums); });
  return reduce<typename Law::template Sums<Dim, double>>(sums);
}

/// A solid's pairs with the flux of l through its surface.
template <int Dim>
void add_border(const KOmegaBorder::Sums<Dim, double>& raw, double scale, double flux, Sums<Dim>& s) {
  std::array<double, Dim> normal{};
  double size = 0.0, across = 0.0;
  for (const double b : raw.concentration) size += b * b;
  size = std::copysign(std::sqrt(size), scale);
  for (std::size_t d = 0; d < Dim; ++d) {
    normal[d] = size != 0.0 ? -raw.concentration[d] / size : 0.0;
    across += raw.weighted[d] * normal[d];
    s.weighted[d] += scale * raw.weighted[d];
  }
  for (std::size_t m = 0; m < raw.moment.size(); ++m) s.moment[m] += scale * raw.moment[m];
  for (std::size_t d = 0; d < Dim; ++d)
    for (std::size_t e = 0; e < Dim; ++e) s.flux_l[d] += scale * flux * raw.moment[moment_index(d, e)] * normal[e];
  s.laplace_l += scale * flux * across;
}

template <int Dim>
void add_scaled(const Sums<Dim>& raw, double scale, Sums<Dim>& s) {
  constexpr std::size_t count = sizeof(Sums<Dim>) / sizeof(double);
  auto to = std::bit_cast<std::array<double, count>>(s);
  const auto from = std::bit_cast<std::array<double, count>>(raw);
  for (std::size_t m = 0; m < count; ++m) to[m] += scale * from[m];
  s = std::bit_cast<Sums<Dim>>(to);
}

/// The operators of the sums. A particle with too few neighbours to invert anything keeps what it has.
template <int Dim>
void finish(const Sums<Dim>& s, const std::array<double, Dim*(Dim + 1) / 2>& a, std::size_t i, const Columns<Dim>& c,
            double spacing, KOmegaPlace& p) {
  constexpr double least = Dim == 2 ? 0.15 : 0.075;
  if (!((Dim == 2 ? 1.0 : -1.0) * determinant(s.moment) > least)) return;
  const auto inverse = inverse_symmetric(s.moment);
  double trace = trace_of<Dim, double>(s.moment), skewed = 0.0;
  for (std::size_t d = 0; d < Dim; ++d)
    for (std::size_t e = 0; e < Dim; ++e) skewed += a[moment_index(d, e)] * s.moment[moment_index(d, e)];
  const double laplace = -2.0 * Dim / std::min(trace + skewed, 0.5 * trace),
               eddy = eddy_of_flux(p.k / p.omega, s.weight != 0.0 ? s.eddy / s.weight : 0.0);
  const double tiny = 1e-30, per_k = 1.0 / (p.viscosity + Wilcox2006::sigma_k * eddy + tiny),
               per_l = 1.0 / (p.viscosity + Wilcox2006::sigma_omega * eddy + tiny);
  double rest_k = s.laplace_k, rest_l = s.laplace_l, carried_k = 0.0, shift2 = 0.0;
  for (std::size_t d = 0; d < Dim; ++d) {
    double k = 0.0, l = 0.0;  // fluxes
    for (std::size_t e = 0; e < Dim; ++e) {
      k += s.flux_k[e] * inverse[e * Dim + d];
      l += s.flux_l[e] * inverse[e * Dim + d];
    }
    rest_k -= k * s.weighted[d];
    rest_l -= l * s.weighted[d];
    const double grad_k = k * per_k, grad_l = l * per_l;
    p.square_l += grad_l * grad_l;
    p.square_k_l += grad_k * grad_l;
    if (!c.shift[d]) continue;
    carried_k += c.shift[d][i] * grad_k;
    shift2 += c.shift[d][i] * c.shift[d][i];
    p.diffusion_l += c.shift[d][i] * grad_l;
  }
  p.diffusion_k = carried_at_most(carried_k, p.k, std::sqrt(shift2), spacing) +
                  diffused(laplace * rest_k, laplace * s.positive_k, laplace * (s.laplace_k - s.positive_k));
  p.diffusion_l += laplace * rest_l;
}

template <int Dim>
Sums<Dim> sum_entries(std::size_t i, const double* own, const std::array<double, Dim*(Dim + 1) / 2>& a,
                      std::span<const KOmegaNeighbour> neighbours, std::span<const ReadyKernel> kernels,
                      const KOmegaParameters& q, double k) {
  Sums<Dim> s{};
  for (std::size_t e = 0; e < neighbours.size(); ++e) {
    const KOmegaNeighbour& n = neighbours[e];
    const PairList::Row row = n.pair.list->row(i);
    if (row.begin == row.end) continue;
    const double scale = kernels[e].slope_factor();
    if (n.solid) {
      const double u = n.side > 0.0 ? friction_velocity_of_energy(k) : n.velocity;
      const double flux = -n.side * karman * Wilcox2006::sigma_omega * u;
      add_border<Dim>(row_sums<Dim>(KOmegaBorder{}, n, kernels[e], row, own, a), scale, flux, s);
    } else {
      add_scaled<Dim>(row_sums<Dim>(KOmegaPairs{{}, q.viscosity}, n, kernels[e], row, own, a), scale, s);
    }
  }
  return s;
}

template <int Dim>
void step(PhaseParticles& fluid, const RecordArray& own, std::span<const KOmegaNeighbour> neighbours,
          const KOmegaParameters& q) {
  thread_local std::vector<ReadyKernel> ready;
  ready.clear();
  for (const auto& n : neighbours) ready.emplace_back(n.pair.kernel, n.pair.radius, Dim);
  const std::span<const ReadyKernel> kernels(ready);
  const Columns<Dim> c(fluid);
  const double* records = own.data();
  Shares shares(static_cast<std::int64_t>(fluid.size()), 64);
#pragma omp parallel
  for (const std::int64_t block : shares) {
    const auto i = static_cast<std::size_t>(block);
    const auto a = c.anisotropy(i);
    KOmegaPlace p{c.k[i], c.omega[i], c.shear[i], q.viscosity, 0.0, 0.0, 0.0, 0.0};
    const auto s = sum_entries<Dim>(i, records + i * MotionRecord<Dim>::size, a, neighbours, kernels, q, p.k);
    finish<Dim>(s, a, i, c, q.spacing, p);
    double k = p.k, omega = p.omega;
    step_k_omega(p, q.step, k, omega);
    if (q.grains) slow_eddies(q.grains[i], q.step, k, omega);
    if (c.distance[i] < q.spacing)
      omega = omega_beside_ground(omega, friction_velocity_of_energy(k),
                                  std::max({c.distance[i], 0.25 * q.spacing, 2.0 * q.roughness}));
    c.k[i] = k;
    c.omega[i] = omega;
    c.nu_t[i] = k / limited_omega(omega, p.shear);
  }
}

}  // namespace

void k_omega_step(PhaseParticles& fluid, const RecordArray& own, std::span<const KOmegaNeighbour> neighbours,
                  const KOmegaParameters& p) {
  fluid.dimensions() == 2 ? step<2>(fluid, own, neighbours, p) : step<3>(fluid, own, neighbours, p);
}

}  // namespace barchan::BARCHAN_TARGET
