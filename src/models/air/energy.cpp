#include "models/air/energy.hpp"

#include "engine/pair_pass.hpp"
#include "laws/plain_energy.hpp"

namespace barchan::BARCHAN_TARGET {

namespace {

template <int Dim>
void energy(PhaseParticles& fluid, const RecordArray& own, std::span<const FluidNeighbour> neighbours) {
  std::array<PairEntry<PlainEnergy>, most_entries> entries{};
  for (std::size_t c = 0; c < neighbours.size(); ++c) {
    const FluidNeighbour& e = neighbours[c];
    entries[c] = {e.list, e.records, e.kernel, e.radius, PlainEnergy{{}, e.viscosity}};
  }
  const double* rho = fluid.column(Field::density);
  double* rate = fluid.column(Field::energy_rate);
  pair_pass<Dim, PlainEnergy>(
      fluid.size(), 256, own, {entries.data(), neighbours.size()}, [](std::size_t, auto&) {},
      [&](std::size_t k, const auto& sums, bool) { rate[k] = sums.total / rho[k]; });
}

}  // namespace

void fluid_energy(PhaseParticles& fluid, const RecordArray& own, std::span<const FluidNeighbour> neighbours) {
  fluid.dimensions() == 2 ? energy<2>(fluid, own, neighbours) : energy<3>(fluid, own, neighbours);
}

}  // namespace barchan::BARCHAN_TARGET
