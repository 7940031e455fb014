#include "models/fluid/fluid_rates.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "engine/shares.hpp"
#include "kernels/kernel.hpp"
#include "laws/consistent_fluid.hpp"
#include "laws/joined_fluids.hpp"
#include "laws/plain_fluid.hpp"
#include "models/fluid/fluid_rows.hpp"
#include "models/fluid/interface_distance.hpp"

namespace barchan::BARCHAN_TARGET {

namespace {

/// Particle k as the first one of pairs across an interface; rho: its density, so that it carries its own weight
/// exactly; mu: the viscosity of its fluid (Pa s).
template <int Dim, class T>
BARCHAN_SIMD_INLINE typename JoinedFluids<Dim>::template Own<LanesOf<T>> joined_own(
    const typename ConsistentFluid<Dim>::template Own<LanesOf<T>>& own, const FluidNeighbour& e,
    const FluidParameters& q, double rho, double mu, std::size_t k) {
  using V = LanesOf<T>;
  constexpr double most = 1e6;  // mu_b/mu_a of a fluid a without friction
  typename JoinedFluids<Dim>::template Own<V> joined{own, {}, {}, {}, {}, {}, {}, {}, {}};
  const double* normal = &q.planes->normal[Dim * k];
  double lift = 0.0, planar = 0.0;
  for (std::size_t d = 0; d < Dim; ++d) {
    joined.weight[d] = simd::broadcast<V>(rho * q.gravity[d]);
    lift += (rho - e.joined) * q.gravity[d] * normal[d];
    planar += normal[d] * normal[d];
  }
  joined.lift = simd::broadcast<V>(lift);
  joined.tolerance = simd::broadcast<V>(JoinedFluids<Dim>::deviations * std::abs(lift) * q.planes->spread[k]);
  joined.halfway = simd::broadcast<V>(planar > 0.0 ? 0.0 : 0.5 * (e.joined / q.reference_density - 1.0));
  joined.share = simd::broadcast<V>(2.0 * q.reference_density / (q.reference_density + e.joined));
  joined.rubbing = simd::broadcast<V>(e.beyond < most * mu ? e.beyond / mu : e.beyond > 0.0 ? most : 1.0);
  joined.distance = simd::broadcast<V>(std::max(q.distances->root[k], e.nearest));
  joined.nearest = simd::broadcast<V>(e.nearest);
  return joined;
}

/// The plain sums push with the pressures above that of the void: sum V F (p_a + p_b - 2 p_v) r. Written as a fused
/// product, so that no compiler chooses the bits.
template <int Dim, class Sums>
BARCHAN_SIMD_INLINE Sums lifted(Sums s, const FluidParameters& q) {
  for (std::size_t d = 0; d < Dim; ++d)
    s.pressure[d] = simd::fma(Four(-2.0 * q.void_pressure), s.concentration[d], s.pressure[d]);
  return s;
}

/// What makes rates of the sums of a law over the neighbours of four particles: it stores them or, for `parts`, their
/// parts in place of them.
template <int Dim, class Law, bool parts>
struct Finish {
  using Sums = typename Law::template Sums<Four>;
  using Columns = RateColumns<Dim, Law::corrected>;
  /// `company`: see Place; `mu` (Pa s): of the fluid; `into`: null where nobody asks for parts. Inlined into the loop,
  /// a row saves a twentieth of it where a particle has few neighbours.
  template <FluidTerms has>
  static BARCHAN_SIMD_INLINE void inlined(const Sums& s, const Four& company, double mu, const FourOf& at,
                                          const Columns& columns, const FluidParameters& q,
                                          [[maybe_unused]] PartColumns* into) {
    auto anisotropy = columns.anisotropy(at);
    auto place = columns.template place<has>(at, company);
    const Four rho = load_four(columns.rho, at.first, at.count);
    const auto rates = [&](auto& of) __attribute__((always_inline)) {
      if constexpr (Law::corrected) return finish<Dim, has, Four>(s, mu, rho, q, anisotropy, place, of);
      else return finish<Dim, Four>(lifted<Dim>(s, q), mu, rho, q, anisotropy, place, of);
    };
    if constexpr (parts) {
      auto of = into->of<Dim>();
      rates(of);
      into->store(of, at.first, at.count);
    } else {
      columns.template store<has>(at, rates(no_parts), anisotropy, place, s.concentration, q);
    }
  }
  template <FluidTerms has>
  static void four(const Sums& s, const Four& company, double mu, const FourOf& at, const Columns& columns,
                   const FluidParameters& q, PartColumns* into) {
    inlined<has>(s, company, mu, at, columns, q, into);
  }
};

/// `finish`: a function of Finish<Dim, Total, ...>.
template <int Dim, template <int> class Law, class Total = Law<Dim>, class T, class F>
void rates(PhaseParticles& fluid, const T* own_records, double length_unit, std::span<const FluidNeighbour> neighbours,
           const FluidParameters& q, PartColumns* parts, F finish) {
  constexpr bool joined = !std::is_same_v<Total, Law<Dim>>;  // at an interface with another fluid
  using L = Law<Dim>;
  using V = LanesOf<T>;
  constexpr auto record_size = static_cast<std::size_t>(MotionRecord<Dim>::size);
  const V unit = simd::broadcast<V>(length_unit);
  const Vec3 weight{q.reference_density * q.gravity[0], q.reference_density * q.gravity[1],
                    q.reference_density * q.gravity[2]};
  const double mu = neighbours.empty() ? 0.0 : neighbours.front().viscosity;
  const auto& kernels = ready_kernels<T>(neighbours, Dim);
  const RateColumns<Dim, L::corrected> columns(fluid);
  const std::size_t n = fluid.size();
  const std::int64_t blocks = FourOf::blocks(n);
  Shares shares(blocks, 64);
#pragma omp parallel
  for (const std::int64_t block : shares) {
    const FourOf at(block, n);
    const auto own_of = [&](std::size_t k) __attribute__((always_inline)) {
      auto own = load_own<Dim, Law>(own_records + k * record_size);
      if constexpr (L::corrected) columns.weigh(own, k);
      return own;
    };
    typename Total::template Sums<Four> s{};
    typename L::template Sums<Four> raw;
    [[maybe_unused]] typename JoinedFluids<Dim>::template Sums<Four> crossing;
    Four company(0.0);
    for (std::size_t c = 0; c < neighbours.size(); ++c) {
      const auto& e = neighbours[c];
      if constexpr (joined) {
        if (e.joined > 0) {
          const auto across = [&](std::size_t k) __attribute__((always_inline)) {
            return joined_own<Dim, T>(own_of(k), e, q, columns.rho[k], mu, k);
          };
          const Roots distances{e.distances->root.data(), 0.0};
          if (sum_rows<Dim, JoinedFluids, T>(at, e, kernels[c], unit, across, crossing, distances))
            s.take(crossing, kernels[c].slope_factor(), 0.0, 0.0, weight);
          continue;
        }
      }
      const double across = e.pressure_share;
      const auto pressed = [&](std::size_t k) __attribute__((always_inline)) {
        auto own = own_of(k);
        if (across != 1.0) own.p *= simd::broadcast<V>((2.0 - across) / across);
        return own;
      };
      if (sum_rows<Dim, Law, T>(at, e, kernels[c], unit, pressed, raw)) {
        if (across != 1.0)
          for (Four& p : raw.pressure) p *= Four(across);
        if constexpr (joined)
          s.take(JoinedFluids<Dim>::template without_kink<Four>(raw), kernels[c].slope_factor(), 0.0, 0.0, weight);
        else s.take(raw, kernels[c].slope_factor(), e.viscosity, e.diffuse ? 1.0 : 0.0, weight);
      }
      if constexpr (L::corrected)
        if (c == 0) company = Four(-1.0 / Dim) * trace_of<Dim, Four>(s.moment);  // the fluid's own entry is the first
    }
    finish(s, company, mu, at, columns, q, parts);
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
  Shares shares(n, 256);
#pragma omp parallel
  for (const std::int64_t i : shares) {
    const auto k = static_cast<std::size_t>(i);
    const auto row = e.list->row(k);
    if (row.begin == row.end) continue;
    const double* record = own_records[k];
    typename L::template Sums<Lanes> raw, s{};
    sum_row<Dim, PlainFluid, double>(row, e, kernel, load_own<Dim, PlainFluid>(record), Lanes(1.0), raw);
    s.take(raw, kernel.slope_factor(), e.viscosity, 0.0, {0, 0, 0});
    const Lanes closing(pores ? 2.0 * record[R::pressure] : 0.0);
    for (std::size_t d = 0; d < Dim; ++d)
      a[d][k] += record[R::volume] * inverse_mass *
                 simd::sum(Lanes(2.0) * s.viscous[d] - s.pressure[d] + closing * s.concentration[d]);
  }
}

constexpr FluidTerms fills{.calming = true};  // a fluid that fills its space

template <int Dim, bool keeps, class T>
void dispatch_in(PhaseParticles& fluid, const T* own, double unit, std::span<const FluidNeighbour> neighbours,
                 const FluidParameters& q, FluidScheme scheme, PartColumns* parts) {
  using Consistent = Finish<Dim, ConsistentFluid<Dim>, keeps>;
  constexpr FluidTerms surface{.ends = true, .surface = SurfaceTerms::loose};
  const bool joined =
      !keeps && std::any_of(neighbours.begin(), neighbours.end(), [](const auto& e) { return e.joined > 0; });
  if (scheme == FluidScheme::plain) {
    if (fluid.has(Field::wholeness))
      rates<Dim, PlainSurface>(fluid, own, unit, neighbours, q, parts,
                               Finish<Dim, PlainSurface<Dim>, keeps>::template four<surface>);
    else
      rates<Dim, PlainFluid>(
          fluid, own, unit, neighbours, q, parts, [](const auto&... a) __attribute__((always_inline)) {
            Finish<Dim, PlainFluid<Dim>, keeps>::template inlined<FluidTerms{}>(a...);
          });
  } else if (joined) {
    rates<Dim, ConsistentFluid, JoinedFluids<Dim>>(fluid, own, unit, neighbours, q, parts,
                                                   finish_of<Finish<Dim, JoinedFluids<Dim>, false>>(terms_of(q, true)));
  } else if (const FluidTerms terms = terms_of(q); !keeps && terms == fills) {
    rates<Dim, ConsistentFluid>(
        fluid, own, unit, neighbours, q, parts,
        [](const auto&... a) __attribute__((always_inline)) { Consistent::template inlined<fills>(a...); });
  } else {
    rates<Dim, ConsistentFluid>(fluid, own, unit, neighbours, q, parts, finish_of<Consistent>(terms));
  }
}

template <bool keeps, class T>
void dispatch(PhaseParticles& fluid, const T* own, double unit, std::span<const FluidNeighbour> neighbours,
              const FluidParameters& q, FluidScheme scheme, PartColumns* parts) {
  const auto call = fluid.dimensions() == 2 ? dispatch_in<2, keeps, T> : dispatch_in<3, keeps, T>;
  call(fluid, own, unit, neighbours, q, scheme, parts);
}

}  // namespace

void fluid_rates(PhaseParticles& fluid, const RecordArray& own, std::span<const FluidNeighbour> neighbours,
                 const FluidParameters& q, FluidScheme scheme) {
  dispatch<false>(fluid, own.data(), 1.0, neighbours, q, scheme, nullptr);
}

void fluid_rates(PhaseParticles& fluid, const CompactRecords& own, std::span<const FluidNeighbour> neighbours,
                 const FluidParameters& q, FluidScheme scheme) {
  dispatch<false>(fluid, own.data(), own.unit(), neighbours, q, scheme, nullptr);
}

void fluid_rate_parts(PhaseParticles& fluid, const RecordArray& own, std::span<const FluidNeighbour> neighbours,
                      const FluidParameters& q, FluidScheme scheme, PartColumns& parts) {
  dispatch<true>(fluid, own.data(), 1.0, neighbours, q, scheme, &parts);
}

void fluid_rate_parts(PhaseParticles& fluid, const CompactRecords& own, std::span<const FluidNeighbour> neighbours,
                      const FluidParameters& q, FluidScheme scheme, PartColumns& parts) {
  dispatch<true>(fluid, own.data(), own.unit(), neighbours, q, scheme, &parts);
}

void fluid_reaction(PhaseParticles& solid, const RecordArray& own, const FluidNeighbour& fluid, bool pores) {
  if (solid.dimensions() == 2) reaction<2>(solid, own, fluid, pores);
  else reaction<3>(solid, own, fluid, pores);
}

}  // namespace barchan::BARCHAN_TARGET
