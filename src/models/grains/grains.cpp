#include "models/grains/grains.hpp"

#include "engine/shares.hpp"
#include "kernels/kernel.hpp"

namespace barchan::BARCHAN_TARGET {

namespace {

template <int Dim>
void contacts(PhaseParticles& a, const RecordArray& own, const PairList& list, const RecordArray& others,
              KernelKind kind, double radius, const KernelContact& law) {
  using R = MotionRecord<Dim>;
  std::array<double*, Dim> acceleration{};
  for (int d = 0; d < Dim; ++d) acceleration[static_cast<std::size_t>(d)] = a.column(Field::acceleration, d);
  const double inverse_mass = 1.0 / a.mass();
  const KernelContact::Constants<Lanes> constants(law);
  const auto n = static_cast<std::int64_t>(a.size());
  const ReadyKernel ready(kind, radius, Dim);
  Shares shares(n, 64);
#pragma omp parallel
  for (const std::int64_t i : shares) {
    const auto k = static_cast<std::size_t>(i);
    const auto row = list.row(k);
    if (row.begin == row.end) continue;
    const double* record = own[k];
    std::array<Lanes, Dim> x, v, force;
    for (std::size_t d = 0; d < Dim; ++d) {
      x[d] = Lanes(record[R::position + d]);
      v[d] = Lanes(record[R::velocity + d]);
      force[d] = Lanes(0.0);
    }
    ready([&](const auto& kernel) __attribute__((always_inline)) {
      for_each_neighbour<R::size>(
          row, others, [&](const Lanes* b) __attribute__((always_inline)) {
            std::array<Lanes, Dim> r, dv;
            const Lanes r2 = separation<Dim>(x, b + R::position, r);
            for (std::size_t d = 0; d < Dim; ++d) dv[d] = v[d] - b[R::velocity + d];
            Lanes w, f;
            kernel.value_and_gradient(r2, w, f);
            KernelContact::add(constants, r, r2, dv, w, f, force);
          });
    });
    for (std::size_t d = 0; d < Dim; ++d) acceleration[d][k] += simd::sum(force[d]) * inverse_mass;
  }
}

}  // namespace

void contact_forces(PhaseParticles& a, const RecordArray& own, const PairList& list, const RecordArray& others,
                    KernelKind kernel, double radius, const KernelContact& law) {
  if (a.dimensions() == 2) contacts<2>(a, own, list, others, kernel, radius, law);
  else contacts<3>(a, own, list, others, kernel, radius, law);
}

}  // namespace barchan::BARCHAN_TARGET
