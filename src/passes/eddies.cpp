#include "passes/eddies.hpp"

#include <algorithm>
#include <cmath>

#include "kernels/kernel.hpp"
#include "laws/consistent_fluid.hpp"
#include "passes/fluid_finish.hpp"

namespace barchan {

void EddyRecords::resize(std::size_t particles, std::size_t images) {
  const std::size_t needed = particles + images + 1;  // and the dummy
  for (auto* values : {&root, &touch}) {
    if (values->size() < needed) values->resize(needed + images / 4 + 64);
    (*values)[particles + images] = 0.0;
  }
}

void EddyRecords::fill_images(std::size_t particles, const CellGrid& grid) {
  const auto& images = grid.image_list();
  for (std::size_t k = 0; k < images.size(); ++k) {
    root[particles + k] = root[images[k].source];
    touch[particles + k] = touch[images[k].source];
  }
}

double pack_eddies(PhaseParticles& fluid, EddyRecords& records, const GroundDistance& ground, const EddyParameters& e) {
  double *distance = fluid.column(Field::ground_distance), *nu_t = fluid.column(Field::eddy_viscosity);
  std::array<const double*, 3> x{}, v{};
  for (int d = 0; d < fluid.dimensions(); ++d) {
    x[static_cast<std::size_t>(d)] = fluid.column(Field::position, d);
    v[static_cast<std::size_t>(d)] = fluid.column(Field::velocity, d);
  }
  const auto n = static_cast<std::int64_t>(fluid.size());
  double largest = 0.0;
#pragma omp parallel for schedule(static) reduction(max : largest)
  for (std::int64_t i = 0; i < n; ++i) {
    const auto k = static_cast<std::size_t>(i);
    Vec3 place{};
    double speed2 = 0.0;
    for (std::size_t d = 0; d < static_cast<std::size_t>(fluid.dimensions()); ++d) {
      place[d] = x[d][k];
      speed2 += v[d][k] * v[d][k];
    }
    const double at = ground.distance(place), nu = e.viscosity + nu_t[k];
    distance[k] = at;
    largest = std::max(largest, nu);
    records.root[k] = std::sqrt(e.density * nu);
    // Grains stand half a spacing behind their surface; the pair's viscosity turns the speed into the law's stress.
    records.touch[k] = e.density * e.viscosity;
    if (e.roughness > 0.0 && at < e.grain_reach)
      records.touch[k] +=
          e.density * log_law_friction(at, e.roughness, e.spacing) * std::sqrt(speed2) * (at + 0.5 * e.spacing);
  }
  return largest;
}

namespace {

/// One number of each neighbour from `at` on.
BARCHAN_SIMD_INLINE Lanes gather_of(const double* values, const std::uint32_t* at) {
  std::array<std::uint32_t, static_cast<std::size_t>(Lanes::width)> index;
  for (std::size_t c = 0; c < index.size(); ++c) index[c] = at[c] / PairList::stride;
  return simd::gather<double, Lanes::width>(values, index.data());
}

template <int Dim>
struct PairSums {
  typename ConsistentFluid<Dim>::template Sums<Lanes> fluid;
  std::array<Lanes, Dim> viscous;
  std::array<Lanes, Dim * Dim> flux;
};

template <int Dim>
using Own = typename ConsistentFluid<Dim>::template Own<Lanes>;

/// Sums over one row. `root_b(q)`: sqrt of the viscosities of the neighbours q to a vector on, or nothing: `Alone`.
template <int Dim, bool Alone, class Root>
BARCHAN_SIMD_INLINE void walk(PairList::Row row, const FluidNeighbour& e, const ReadyKernel& ready, const Own<Dim>& own,
                              Lanes root_a, Root&& root_b, PairSums<Dim>& s) {
  using R = MotionRecord<Dim>;
  const double* data = e.records->data();
  ready([&](const auto& kernel) __attribute__((always_inline)) {
    for (const std::uint32_t* q = row.begin; q != row.end; q += Lanes::width) {
      Lanes b[R::size];
      simd::load_transposed<R::size>(data, R::size / PairList::stride, q, b);
      std::array<Lanes, Dim> r;
      const Lanes r2 = separation<Dim>(own.x, b + R::position, r);
      const Lanes f = kernel.slope(r2);
      ConsistentFluid<Dim>::add(own, r, r2, f, b + R::velocity, b[R::pressure], b[R::volume], s.fluid);
      if constexpr (!Alone) {
        Lanes lopsided(0.0);
        std::size_t m = 0;
        for (std::size_t d = 0; d < Dim; ++d)
          for (std::size_t c = 0; c <= d; ++c, ++m) lopsided = simd::fma(own.anisotropy[m] * r[d], r[c], lopsided);
        const Lanes mu = pair_viscosity(root_a, root_b(q)), muf = mu * b[R::volume] * f;
        const Lanes weighted = simd::fma(muf, lopsided / r2, muf);
        for (std::size_t d = 0; d < Dim; ++d) {
          const Lanes dv = own.v[d] - b[R::velocity + d];
          s.viscous[d] = simd::fma(weighted, dv, s.viscous[d]);
          for (std::size_t c = 0; c < Dim; ++c) s.flux[d * Dim + c] = simd::fma(muf * dv, r[c], s.flux[d * Dim + c]);
        }
      }
    }
  });
}

/// The stress that a wall with given friction puts on a particle at velocity v: mu dv/dn, n into the fluid.
template <int Dim>
std::array<double, Dim> wall_flux(const EddyNeighbour& e, const std::array<double, Dim>& normal, const double* v,
                                  double distance, const EddyParameters& p) {
  std::array<double, Dim> flux{};
  double along = 0.0, size2 = 0.0;
  for (std::size_t d = 0; d < Dim; ++d) {
    flux[d] = e.friction == Friction::driven ? -e.stress[d] : v[d] - e.wall_velocity[d];
    along += flux[d] * normal[d];
  }
  for (std::size_t d = 0; d < Dim; ++d) {
    flux[d] -= along * normal[d];
    size2 += flux[d] * flux[d];
  }
  if (e.friction == Friction::rough) {
    const double scale = p.density * log_law_friction(distance, e.roughness, p.spacing) * std::sqrt(size2);
    for (auto& f : flux) f *= scale;
  }
  return flux;
}

template <int Dim>
void rates(PhaseParticles& fluid, const RecordArray& own_records, const EddyRecords& eddies,
           std::span<const EddyNeighbour> neighbours, const FluidParameters& q, const EddyParameters& p) {
  using R = MotionRecord<Dim>;
  using Fluid = ConsistentFluid<Dim>;
  using Reduced = typename Fluid::template Sums<double>;
  using One = simd::Vec<double, 1>;
  using Sums = typename Fluid::template Sums<One>;
  const std::array<double, 3> weight{q.reference_density * q.gravity[0], q.reference_density * q.gravity[1],
                                     q.reference_density * q.gravity[2]};
  constexpr std::size_t moments = Dim * (Dim + 1) / 2;
  std::array<double*, Dim> a{}, du{};
  for (int d = 0; d < Dim; ++d) {
    a[static_cast<std::size_t>(d)] = fluid.column(Field::acceleration, d);
    if (fluid.has(Field::shift_velocity)) du[static_cast<std::size_t>(d)] = fluid.column(Field::shift_velocity, d);
  }
  double *rate = fluid.column(Field::density_rate), *nu_t = fluid.column(Field::eddy_viscosity);
  const double *rho = fluid.column(Field::density), *distance = fluid.column(Field::ground_distance);
  std::array<double*, moments> skew{};  // 2D: xx xy, and yy = -xx
  for (std::size_t c = 0; c < (Dim == 2 ? 2 : moments); ++c)
    skew[c] = fluid.column(Field::anisotropy, static_cast<int>(c));
  static thread_local std::vector<ReadyKernel> kernels;
  kernels.reserve(16);
  kernels.clear();
  for (const auto& e : neighbours) kernels.emplace_back(e.pair.kernel, e.pair.radius, Dim);
  const auto& ready = kernels;
  const double molecular = std::sqrt(p.density * p.viscosity);
  const SurfaceColumns<Dim> surface(fluid);
  const auto n = static_cast<std::int64_t>(fluid.size());
#pragma omp parallel for schedule(dynamic, 256)
  for (std::int64_t i = 0; i < n; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const double* record = own_records[k];
    std::array<double, moments> anisotropy{};
    if constexpr (Dim == 2) anisotropy = {skew[0][k], skew[1][k], -skew[0][k]};
    else
      for (std::size_t c = 0; c < moments; ++c) anisotropy[c] = skew[c][k];
    Own<Dim> own;
    for (std::size_t d = 0; d < Dim; ++d) {
      own.x[d] = Lanes(record[R::position + d]);
      own.v[d] = Lanes(record[R::velocity + d]);
      for (std::size_t e = 0; e <= d; ++e)
        own.anisotropy[moment_index(d, e)] = Lanes((d == e ? 1.0 : 2.0) * anisotropy[moment_index(d, e)]);
    }
    own.p = Lanes(record[R::pressure]);
    const double root = eddies.root[k];
    Sums s{};
    std::array<double, Dim * Dim> flux{};
    for (std::size_t c = 0; c < neighbours.size(); ++c) {
      const auto& e = neighbours[c];
      const auto row = e.pair.list->row(k);
      if (row.begin == row.end) continue;
      PairSums<Dim> pairs{};
      if (e.friction == Friction::fluid) {
        if (e.eddies)
          walk<Dim, false>(
              row, e.pair, ready[c], own, Lanes(root),
              [&](const std::uint32_t* at)
                  __attribute__((always_inline)) { return gather_of(e.eddies->root.data(), at); },
              pairs);
        else
          walk<Dim, false>(
              row, e.pair, ready[c], own, Lanes(root), [&](const std::uint32_t*) { return Lanes(e.root); }, pairs);
      } else {
        walk<Dim, true>(
            row, e.pair, ready[c], own, Lanes(root), [](const std::uint32_t*) { return Lanes(0.0); }, pairs);
      }
      ready[c]([&](const auto& kernel) {
        const double scale = kernel.slope_factor();
        auto entry = reduce<Reduced>(pairs.fluid);
        // What the friction across this entry makes of the raw sums.
        std::array<double, Dim> viscous{};
        std::array<double, Dim * Dim> stress{};
        if (e.friction == Friction::fluid) {
          for (std::size_t d = 0; d < Dim; ++d) viscous[d] = simd::sum(pairs.viscous[d]);
          for (std::size_t m = 0; m < Dim * Dim; ++m) stress[m] = simd::sum(pairs.flux[m]);
        } else if (e.friction == Friction::rough || e.friction == Friction::driven) {
          std::array<double, Dim> normal{}, tau;
          double size = 0.0;
          for (std::size_t d = 0; d < Dim; ++d) size += entry.concentration[d] * entry.concentration[d];
          size = std::copysign(std::sqrt(size), scale);  // the raw sums lack the kernel's constant and its sign
          if (size != 0.0)
            for (std::size_t d = 0; d < Dim; ++d) normal[d] = -entry.concentration[d] / size;
          tau = wall_flux<Dim>(e, normal, record + R::velocity, distance[k], p);
          double across = 0.0;
          std::array<double, Dim> moment{};
          for (std::size_t d = 0; d < Dim; ++d) {
            across += entry.weighted[d] * normal[d];
            for (std::size_t f = 0; f < Dim; ++f) moment[d] += entry.moment[moment_index(d, f)] * normal[f];
          }
          for (std::size_t d = 0; d < Dim; ++d) {
            viscous[d] = tau[d] * across;
            for (std::size_t f = 0; f < Dim; ++f) stress[d * Dim + f] = tau[d] * moment[f];
          }
        } else {
          const double mu = e.friction == Friction::grains   ? eddies.touch[k]
                            : e.friction == Friction::smooth ? pair_viscosity(root, molecular)
                                                             : root * root;
          for (std::size_t d = 0; d < Dim; ++d) viscous[d] = mu * entry.viscous[d];
          for (std::size_t m = 0; m < Dim * Dim; ++m) stress[m] = mu * entry.velocity[m];
        }
        entry.viscous = viscous;
        for (std::size_t m = 0; m < Dim * Dim; ++m) flux[m] += scale * stress[m];
        s.take(std::bit_cast<Sums>(entry), scale, 0.0, 0.0, weight);
      });
    }
    One phi2(0.0), shear2(0.0);  // (|T|/rho)^2 and |S|^2
    auto skewness = std::bit_cast<std::array<One, moments>>(anisotropy);
    const auto friction_of = [&](const auto& inverse, const auto& grad_v) {
      std::array<std::array<One, Dim>, Dim> t;
      std::array<One, Dim> friction = s.viscous;
      for (std::size_t d = 0; d < Dim; ++d)
        for (std::size_t e = 0; e < Dim; ++e) {
          t[d][e] = One(0.0);
          for (std::size_t f = 0; f < Dim; ++f) t[d][e] += One(flux[d * Dim + f]) * inverse[f * Dim + e];
          friction[d] -= t[d][e] * s.weighted[e];
        }
      for (std::size_t d = 0; d < Dim; ++d)
        for (std::size_t e = 0; e < Dim; ++e) {
          const One both = t[d][e] + t[e][d], strain = grad_v[d][e] + grad_v[e][d];
          phi2 += One(0.5) * both * both;
          shear2 += One(0.5) * strain * strain;
        }
      return friction;
    };
    Place<Dim, One> place{One(record[R::pressure]), {}, {}};
    for (std::size_t d = 0; d < Dim; ++d) place.normal[d] = One(surface.wholeness ? surface.normal[d][k] : 0.0);
    const auto r = finish_consistent<Dim, One>(s, 1.0, One(rho[k]), q, skewness, place, friction_of);
    if (surface.wholeness) {
      surface.wholeness[k] = place.wholeness.v;
      for (std::size_t d = 0; d < Dim; ++d) surface.normal[d][k] = s.concentration[d].v;
    }
    anisotropy = std::bit_cast<std::array<double, moments>>(skewness);
    if (p.model != Turbulence::none) {
      const double length = p.mixing_length(distance[k]);
      nu_t[k] = nu_t[k] > 0.0 ? eddy_viscosity(p.viscosity, length, std::sqrt(phi2.v) / p.density)
                              : length * length * std::sqrt(shear2.v);
    }
    for (std::size_t c = 0; c < (Dim == 2 ? 2 : moments); ++c) skew[c][k] = anisotropy[c];
    for (std::size_t d = 0; d < Dim; ++d) {
      a[d][k] = r.acceleration[d].v;
      if (du[d]) du[d][k] = r.shift[d].v;
    }
    rate[k] = r.density.v;
  }
}

template <int Dim>
void reaction(PhaseParticles& solid, const RecordArray& own_records, const FluidNeighbour& e, const EddyRecords& eddies,
              double molecular) {
  using R = MotionRecord<Dim>;
  const double inverse_mass = 1.0 / solid.mass();
  const double* data = e.records->data();
  const ReadyKernel ready(e.kernel, e.radius, Dim);
  const auto n = static_cast<std::int64_t>(solid.size());
#pragma omp parallel for schedule(dynamic, 256)
  for (std::int64_t i = 0; i < n; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const auto row = e.list->row(k);
    const double* record = own_records[k];
    std::array<Lanes, Dim> x, v, sum{};
    for (std::size_t d = 0; d < Dim; ++d) {
      x[d] = Lanes(record[R::position + d]);
      v[d] = Lanes(record[R::velocity + d]);
    }
    double factor = 0.0;
    ready([&](const auto& kernel) __attribute__((always_inline)) {
      factor = kernel.slope_factor();
      for (const std::uint32_t* q = row.begin; q != row.end; q += Lanes::width) {
        Lanes b[R::size];
        simd::load_transposed<R::size>(data, R::size / PairList::stride, q, b);
        std::array<Lanes, Dim> r;
        const Lanes f = kernel.slope(separation<Dim>(x, b + R::position, r)) * b[R::volume] *
                        (gather_of(eddies.touch.data(), q) - Lanes(molecular));
        for (std::size_t d = 0; d < Dim; ++d) sum[d] = simd::fma(f, v[d] - b[R::velocity + d], sum[d]);
      }
    });
    for (std::size_t d = 0; d < Dim; ++d)
      solid.column(Field::acceleration, static_cast<int>(d))[k] +=
          2.0 * factor * record[R::volume] * inverse_mass * simd::sum(sum[d]);
  }
}

}  // namespace

void eddy_rates(PhaseParticles& fluid, const RecordArray& own, const EddyRecords& eddies,
                std::span<const EddyNeighbour> neighbours, const FluidParameters& q, const EddyParameters& e) {
  if (fluid.dimensions() == 2) rates<2>(fluid, own, eddies, neighbours, q, e);
  else rates<3>(fluid, own, eddies, neighbours, q, e);
}

void eddy_reaction(PhaseParticles& solid, const RecordArray& own, const FluidNeighbour& fluid,
                   const EddyRecords& eddies, double molecular) {
  if (solid.dimensions() == 2) reaction<2>(solid, own, fluid, eddies, molecular);
  else reaction<3>(solid, own, fluid, eddies, molecular);
}

}  // namespace barchan
