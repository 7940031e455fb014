#include "models/air/energy.hpp"

#include "engine/shares.hpp"
#include "kernels/kernel.hpp"

namespace barchan::BARCHAN_TARGET {

namespace {

template <int Dim>
void energy(PhaseParticles& fluid, const RecordArray& own, std::span<const FluidNeighbour> neighbours) {
  using R = MotionRecord<Dim>;
  const double* rho = fluid.column(Field::density);
  double* rate = fluid.column(Field::energy_rate);
  const auto n = static_cast<std::int64_t>(fluid.size());
  Shares shares(n, 256);
#pragma omp parallel
  for (const std::int64_t i : shares) {
    const auto k = static_cast<std::size_t>(i);
    const double* record = own[k];
    std::array<Lanes, Dim> x, v;
    for (std::size_t d = 0; d < Dim; ++d) {
      x[d] = Lanes(record[R::position + d]);
      v[d] = Lanes(record[R::velocity + d]);
    }
    const Lanes half_p(0.5 * record[R::pressure]);
    double total = 0.0;
    for (const auto& e : neighbours) {
      const auto row = e.list->row(k);
      if (row.begin == row.end) continue;
      const Lanes mu(e.viscosity);
      Lanes sum(0.0);
      with_kernel<double>(e.kernel, e.radius, Dim, [&](const auto& kernel) {
        for_each_neighbour<R::size>(
            row, *e.records, [&](const Lanes* b) __attribute__((always_inline)) {
              std::array<Lanes, Dim> r;
              const Lanes r2 = separation<Dim>(x, b + R::position, r);
              const Lanes vf = b[R::volume] * kernel.gradient(r2);
              Lanes vr(0.0), v2(0.0);
              for (std::size_t d = 0; d < Dim; ++d) {
                const Lanes dv = v[d] - b[R::velocity + d];
                vr = simd::fma(dv, r[d], vr);
                v2 = simd::fma(dv, dv, v2);
              }
              const Lanes work = simd::fma(simd::fma(Lanes(0.5), b[R::pressure], half_p), vr, -(mu * v2));
              sum = simd::fma(vf, work, sum);
            });
      });
      total += simd::sum(sum);
    }
    rate[k] = total / rho[k];
  }
}

}  // namespace

void fluid_energy(PhaseParticles& fluid, const RecordArray& own, std::span<const FluidNeighbour> neighbours) {
  fluid.dimensions() == 2 ? energy<2>(fluid, own, neighbours) : energy<3>(fluid, own, neighbours);
}

}  // namespace barchan::BARCHAN_TARGET
