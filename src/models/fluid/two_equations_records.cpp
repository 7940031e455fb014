#include <algorithm>
#include <cmath>

#include "laws/k_omega.hpp"
#include "models/fluid/two_equations.hpp"

namespace barchan {

namespace {

template <int Dim>
double pack(PhaseParticles& fluid, RecordArray& records, const KOmegaParameters& p) {
  using R = MotionRecord<Dim>;
  std::array<const double*, Dim> x{};
  for (int d = 0; d < Dim; ++d) x[static_cast<std::size_t>(d)] = std::as_const(fluid).column(Field::position, d);
  double *energy = fluid.column(Field::turbulent_kinetic_energy),
         *dissipation = fluid.column(Field::specific_dissipation_rate), *nu_t = fluid.column(Field::eddy_viscosity);
  const double* distance = std::as_const(fluid).column(Field::ground_distance);
  const double volume = std::pow(p.spacing, Dim);
  const auto n = static_cast<std::int64_t>(fluid.size());
  double largest = 0.0;
#pragma omp parallel for schedule(static) reduction(max : largest)
  for (std::int64_t q = 0; q < n; ++q) {
    const auto i = static_cast<std::size_t>(q);
    if (!(energy[i] > 0.0)) {
      energy[i] = energy_of_friction_velocity(p.begins);
      dissipation[i] = log_layer_omega(p.begins, std::max({distance[i], 0.25 * p.spacing, 2.0 * p.roughness}));
      nu_t[i] = energy[i] / dissipation[i];
    }
    const double eddy = energy[i] / dissipation[i];
    double* r = records[i];
    for (std::size_t d = 0; d < Dim; ++d) r[R::position + d] = x[d][i];
    if constexpr (Dim == 3) r[R::velocity + 2] = 0.0;
    r[R::velocity] = energy[i];
    r[R::velocity + 1] = std::log(dissipation[i]);
    r[R::pressure] = std::sqrt(eddy);
    r[R::volume] = volume;
    largest = std::max(largest, p.viscosity + Wilcox2006::sigma_k * eddy);
  }
  return largest;
}

}  // namespace

double pack_k_omega(PhaseParticles& fluid, RecordArray& records, const KOmegaParameters& p) {
  return fluid.dimensions() == 2 ? pack<2>(fluid, records, p) : pack<3>(fluid, records, p);
}

}  // namespace barchan
