#include "models/fluid/energy.hpp"

#include <utility>

#include "engine/pair_pass.hpp"
#include "laws/plain_energy.hpp"

namespace barchan::BARCHAN_TARGET {

namespace {

/// One law's pass. First: writes the rate, else adds to it.
template <int Dim, class Law, bool First>
void pass(PhaseParticles& fluid, const RecordArray& own, std::span<const PairEntry<Law>> entries, double age) {
  const double* rho = std::as_const(fluid).column(Field::density);
  double* rate = fluid.column(Field::energy_rate);
  std::array<const double*, Dim> acceleration{};
  for (std::size_t d = 0; d < Dim; ++d)
    acceleration[d] = std::as_const(fluid).column(Field::acceleration, static_cast<int>(d));
  pair_pass<Dim, Law>(
      fluid.size(), 256, own, entries, [](std::size_t, auto&) {},
      [&](std::size_t k, const auto& sums, bool) __attribute__((always_inline)) {
        double power = sums.total;
        for (std::size_t d = 0; d < Dim; ++d) power -= age * acceleration[d][k] * simd::sum(sums.force[d]);
        if constexpr (First) rate[k] = power / rho[k];
        else rate[k] += power / rho[k];
      });
}

template <int Dim>
void energy(PhaseParticles& fluid, const RecordArray& own, std::span<const FluidNeighbour> fluids,
            std::span<const SolidNeighbour> solids, double age) {
  std::array<PairEntry<PlainEnergy>, most_entries> among{};
  for (std::size_t c = 0; c < fluids.size(); ++c) {
    const FluidNeighbour& e = fluids[c];
    among[c] = {e.list, e.records, e.kernel, e.radius, PlainEnergy{{}, e.viscosity}};
  }
  pass<Dim, PlainEnergy, true>(fluid, own, {among.data(), fluids.size()}, age);
  if (solids.empty()) return;
  std::array<PairEntry<SolidEnergy>, most_entries> beside{};
  for (std::size_t c = 0; c < solids.size(); ++c) {
    const FluidNeighbour& e = solids[c].pair;
    beside[c] = {e.list, e.records, e.kernel, e.radius, SolidEnergy{{}, e.viscosity}, nullptr, solids[c].carried};
  }
  pass<Dim, SolidEnergy, false>(fluid, own, {beside.data(), solids.size()}, age);
}

}  // namespace

void fluid_energy(PhaseParticles& fluid, const RecordArray& own, std::span<const FluidNeighbour> fluids,
                  std::span<const SolidNeighbour> solids, double age) {
  fluid.dimensions() == 2 ? energy<2>(fluid, own, fluids, solids, age) : energy<3>(fluid, own, fluids, solids, age);
}

}  // namespace barchan::BARCHAN_TARGET
