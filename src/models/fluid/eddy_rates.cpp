// The pair passes of eddies.hpp.
#include <algorithm>
#include <cmath>

#include "engine/pair_pass.hpp"
#include "laws/eddy_fluid.hpp"
#include "laws/eddy_friction.hpp"
#include "models/fluid/fluid_rows.hpp"
#include "models/fluid/turbulence.hpp"

namespace barchan::BARCHAN_TARGET {

namespace {

template <int Dim>
using RawSums = typename ConsistentFluid<Dim>::template Sums<Four>;
template <int Dim>
using EddySums = typename EddyFluid<Dim>::template Sums<Four>;

/// What a turbulent fluid's particles have beside the columns of every fluid.
template <int Dim>
struct EddyColumns {
  double *nu_t, *shear = nullptr;
  const double *distance, *root, *touch;
  std::array<const double*, Dim> velocity;

  EddyColumns(PhaseParticles& fluid, const EddyRecords& records)
      : nu_t(fluid.column(Field::eddy_viscosity)),
        distance(fluid.column(Field::ground_distance)),
        root(records.root.data()),
        touch(records.touch.data()) {
    for (std::size_t d = 0; d < Dim; ++d) velocity[d] = fluid.column(Field::velocity, static_cast<int>(d));
    if (fluid.has(Field::shear_rate)) shear = fluid.column(Field::shear_rate);
  }
};

/// The stress tau that a wall of given friction puts on particles; n: into the fluid.
template <int Dim>
std::array<Four, Dim> wall_stress(const EddyNeighbour& e, const std::array<Four, Dim>& normal,
                                  const EddyColumns<Dim>& columns, const FourOf& at, const EddyParameters& p) {
  std::array<Four, Dim> tau;
  Four along(0.0);
  for (std::size_t d = 0; d < Dim; ++d) {
    tau[d] = e.friction == Friction::driven
                 ? Four(-e.stress[d])
                 : load_four(columns.velocity[d], at.first, at.count) - Four(e.wall_velocity[d]);
    along += tau[d] * normal[d];
  }
  for (std::size_t d = 0; d < Dim; ++d) tau[d] -= along * normal[d];
  if (e.friction == Friction::driven) return tau;
  if (e.given) {
    const Four speed = length_of<Dim, Four>(tau), stress = load_four(e.given->data(), at.first, at.count);
    for (auto& t : tau) t *= simd::select(speed > Four(0.0), stress / speed, Four(0.0));
    return tau;
  }
  alignas(32) std::array<double, 4> law{};
  for (std::size_t lane = 0; lane < at.count; ++lane)
    law[lane] = p.density * log_law_friction(columns.distance[at.first + lane], e.roughness, p.spacing);
  const Four size = Four::load(law.data()) * length_of<Dim, Four>(tau);
  for (auto& t : tau) t *= size;
  return tau;
}

/// The viscosity of the pairs of a solid that rubs by one.
template <int Dim>
Four wall_viscosity(const EddyNeighbour& e, const EddyColumns<Dim>& columns, const FourOf& at,
                    const EddyParameters& p) {
  const Four root = load_four(columns.root, at.first, at.count);
  return e.friction == Friction::grains   ? load_four(columns.touch, at.first, at.count)
         : e.friction == Friction::smooth ? pair_viscosity(root, Four(std::sqrt(p.density * p.viscosity)))
                                          : root * root;
}

/// The sums of a solid's pairs with their friction.
template <int Dim>
EddySums<Dim> with_friction(const EddyNeighbour& e, const RawSums<Dim>& raw, double scale,
                            const EddyColumns<Dim>& columns, const FourOf& at, const EddyParameters& p) {
  using Law = EddyFluid<Dim>;
  if (e.friction != Friction::rough && e.friction != Friction::driven)
    return Law::with_viscosity(raw, wall_viscosity<Dim>(e, columns, at, p));
  const auto normal = Law::template normal_of<Four>(raw, scale);
  return Law::with_stress(raw, normal, wall_stress<Dim>(e, normal, columns, at, p));
}

/// Sums over all entries; `company`: share of the neighbourhood that the fluid itself fills, the first entry.
template <int Dim, class T, class OwnOf>
BARCHAN_SIMD_INLINE EddySums<Dim> sum_entries(const FourOf& at, std::span<const EddyNeighbour> neighbours,
                                              const std::vector<ReadyKernelOf<T>>& kernels, LanesOf<T> unit,
                                              OwnOf&& own_of, const EddyColumns<Dim>& columns, const Vec3& weight,
                                              const EddyParameters& p, Four& company) {
  EddySums<Dim> s{}, pairs;
  RawSums<Dim> raw;
  for (std::size_t c = 0; c < neighbours.size(); ++c) {
    const auto& e = neighbours[c];
    const double scale = kernels[c].slope_factor();
    if (e.friction == Friction::fluid) {
      const Roots roots{e.eddies ? e.eddies->root.data() : nullptr, e.root};
      if (sum_rows<Dim, EddyFluid, T>(at, e.pair, kernels[c], unit, own_of, pairs, roots)) s.take(pairs, scale, weight);
    } else if (sum_rows<Dim, ConsistentFluid, T>(at, e.pair, kernels[c], unit, own_of, raw)) {
      s.take(with_friction<Dim>(e, raw, scale, columns, at, p), scale, weight);
    }
    if (c == 0) company = Four(-1.0 / Dim) * trace_of<Dim, Four>(s.moment);
  }
  return s;
}

/// The gradient of the pairs' flux, T/mu, is divided by this. Where the logarithmic layer begins T/mu is up to
/// eight times the gradient of the differences, and right. It is wrong where the viscosity of the particle is far below
/// that of its neighbours, which makes the flux: then T/mu lowers the viscosity of the particle further, nu_t = k/(2.9
/// |T|/mu), and makes k without end. So it is at most `most` times the gradient of the differences, |S|.
template <int Dim>
BARCHAN_SIMD_INLINE Four above_differences(const typename EddyFluid<Dim>::template Stress<Four>& stress, Four root) {
  constexpr double most = 10.0;
  const Four mu = simd::max(root * root, Four(1e-30));
  return simd::max(simd::sqrt(stress.phi2) / simd::max(Four(most) * mu * simd::sqrt(stress.shear2), Four(1e-30)),
                   Four(1.0));
}

/// nu_t of the next step; where there is none yet, from the strain alone. Of a fluid whose turbulence has equations of
/// its own (two_equations.hpp): |S|.
template <int Dim>
BARCHAN_SIMD_INLINE void renew_viscosity(const EddyColumns<Dim>& columns,
                                         const typename EddyFluid<Dim>::template Stress<Four>& stress, const FourOf& at,
                                         const EddyParameters& p) {
  if (p.model == Turbulence::none) return;
  if (columns.shear) {
    const Four root = load_four(columns.root, at.first, at.count);
    const Four shear = simd::sqrt(stress.phi2) / simd::max(root * root, Four(1e-30));
    store_four(shear / above_differences<Dim>(stress, root), columns.shear, at.first, at.count);
    return;
  }
  const Four length = p.mixing_length(load_four(columns.distance, at.first, at.count));
  const Four phi = simd::sqrt(stress.phi2) * Four(1.0 / p.density), nu(p.viscosity);
  const Four grown = p.rough_ground ? rough_eddy_viscosity(nu, length, phi) : eddy_viscosity(nu, length, phi);
  const Four begun = length * length * simd::sqrt(stress.shear2);
  const Four before = load_four(columns.nu_t, at.first, at.count);
  store_four(simd::select(before > Four(0.0), grown, begun), columns.nu_t, at.first, at.count);
}

/// du . grad v by the gradient T/mu of the pairs' flux, in place of that of the differences. Beside the ground v grows
/// as the logarithm and walls continue it as free slip: there the differences show less than half of its slope.
template <int Dim>
void carry_by_flux(Rates<Dim, Four>& r, const typename EddyFluid<Dim>::template Stress<Four>& stress, Four root) {
  const Four per_viscosity = Four(1.0) / simd::max(root * root, Four(1e-30)) / above_differences<Dim>(stress, root);
  for (std::size_t d = 0; d < Dim; ++d)
    for (std::size_t e = 0; e < Dim; ++e)
      r.acceleration[d] += r.shift[e] * (stress.t[d][e] * per_viscosity - stress.gradient[d][e]);
}

/// What makes rates of the sums over the neighbours of four particles of a turbulent fluid, and stores them.
template <int Dim>
struct EddyFinish {
  using Columns = RateColumns<Dim, true>;

  /// `company`: see Place.
  template <FluidTerms has>
  static void four(const EddySums<Dim>& s, const Four& company, const FourOf& at, const Columns& columns,
                   const EddyColumns<Dim>& eddy_columns, const FluidParameters& q, const EddyParameters& p) {
    auto anisotropy = columns.anisotropy(at);
    auto place = columns.template place<has>(at, company);
    typename EddyFluid<Dim>::template Stress<Four> stress{s};
    const Four rho = load_four(columns.rho, at.first, at.count);
    auto r = finish_consistent<Dim, has, Four>(s, 1.0, rho, q, anisotropy, place, stress, no_parts);
    if (eddy_columns.shear) carry_by_flux<Dim>(r, stress, load_four(eddy_columns.root, at.first, at.count));
    renew_viscosity<Dim>(eddy_columns, stress, at, p);
    columns.template store<has>(at, r, anisotropy, place, s.concentration, q);
  }
};

template <int Dim, class T>
void rates(PhaseParticles& fluid, const T* own_records, double length_unit, const EddyRecords& eddies,
           std::span<const EddyNeighbour> neighbours, const FluidParameters& q, const EddyParameters& p) {
  using V = LanesOf<T>;
  constexpr auto record_size = static_cast<std::size_t>(MotionRecord<Dim>::size);
  const V unit = simd::broadcast<V>(length_unit);
  const Vec3 weight{q.reference_density * q.gravity[0], q.reference_density * q.gravity[1],
                    q.reference_density * q.gravity[2]};
  const auto& kernels = ready_kernels<T>(neighbours, Dim, &EddyNeighbour::pair);
  const RateColumns<Dim, true> columns(fluid);
  const EddyColumns<Dim> eddy_columns(fluid, eddies);
  const auto finish = finish_of<EddyFinish<Dim>>(terms_of(q));
  const std::size_t n = fluid.size();
  const std::int64_t blocks = FourOf::blocks(n);
  Shares shares(blocks, 64);
#pragma omp parallel
  for (const std::int64_t block : shares) {
    const FourOf at(block, n);
    const auto own_of = [&](std::size_t k) __attribute__((always_inline)) {
      auto own = load_own<Dim, EddyFluid>(own_records + k * record_size);
      columns.weigh(own, k);
      own.root = simd::broadcast<V>(eddies.root[k]);
      return own;
    };
    Four company(0.0);
    const auto s = sum_entries<Dim, T>(at, neighbours, kernels, unit, own_of, eddy_columns, weight, p, company);
    finish(s, company, at, columns, eddy_columns, q, p);
  }
}

template <class T>
void dispatch(PhaseParticles& fluid, const T* own, double unit, const EddyRecords& eddies,
              std::span<const EddyNeighbour> neighbours, const FluidParameters& q, const EddyParameters& e) {
  const auto call = fluid.dimensions() == 2 ? rates<2, T> : rates<3, T>;
  call(fluid, own, unit, eddies, neighbours, q, e);
}

template <int Dim>
void reaction(PhaseParticles& solid, const RecordArray& own, const FluidNeighbour& e, const EddyRecords& eddies,
              double molecular) {
  using R = MotionRecord<Dim>;
  const PairEntry<EddyFriction> entry{
      e.list, e.records, e.kernel, e.radius, EddyFriction{{}, molecular}, eddies.touch.data()};
  std::array<double*, Dim> acceleration{};
  for (std::size_t d = 0; d < Dim; ++d) acceleration[d] = solid.column(Field::acceleration, static_cast<int>(d));
  const double inverse_mass = 1.0 / solid.mass(), factor = ReadyKernel(e.kernel, e.radius, Dim).slope_factor();
  pair_pass<Dim, EddyFriction>(
      solid.size(), 256, own, {&entry, 1}, [](std::size_t, auto&) {},
      [&](std::size_t k, const auto& sums, bool) {
        for (std::size_t d = 0; d < Dim; ++d)
          acceleration[d][k] += 2.0 * factor * own[k][R::volume] * inverse_mass * simd::sum(sums.drawn[d]);
      });
}

}  // namespace

void eddy_rates(PhaseParticles& fluid, const RecordArray& own, const EddyRecords& eddies,
                std::span<const EddyNeighbour> neighbours, const FluidParameters& q, const EddyParameters& e) {
  dispatch(fluid, own.data(), 1.0, eddies, neighbours, q, e);
}

void eddy_rates(PhaseParticles& fluid, const CompactRecords& own, const EddyRecords& eddies,
                std::span<const EddyNeighbour> neighbours, const FluidParameters& q, const EddyParameters& e) {
  dispatch(fluid, own.data(), own.unit(), eddies, neighbours, q, e);
}

void eddy_reaction(PhaseParticles& solid, const RecordArray& own, const FluidNeighbour& fluid,
                   const EddyRecords& eddies, double molecular) {
  if (solid.dimensions() == 2) reaction<2>(solid, own, fluid, eddies, molecular);
  else reaction<3>(solid, own, fluid, eddies, molecular);
}

}  // namespace barchan::BARCHAN_TARGET
