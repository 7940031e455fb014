#include "models/coupling/drag.hpp"

#include "engine/shares.hpp"
#include "kernels/kernel.hpp"
#include "laws/grain_drag.hpp"

namespace barchan::BARCHAN_TARGET {

namespace {

template <int Dim>
void drag(PhaseParticles& a, const RecordArray& own, const PairList& list, const RecordArray& others,
          const DragEntry& e, bool a_is_fluid) {
  using R = MotionRecord<Dim>;
  std::array<double*, Dim> acceleration{};
  for (int d = 0; d < Dim; ++d) acceleration[static_cast<std::size_t>(d)] = a.column(Field::acceleration, d);
  const double inverse_mass = 1.0 / a.mass();
  const auto n = static_cast<std::int64_t>(a.size());
  const ReadyKernel ready(e.kernel, e.radius, Dim);
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
    const Lanes own_volume(record[R::volume]), strength(e.strength), density(e.density);
    ready([&](const auto& kernel) __attribute__((always_inline)) {
      for_each_neighbour<R::size>(
          row, others, [&](const Lanes* b) __attribute__((always_inline)) {
            std::array<Lanes, Dim> r, dv;
            const Lanes r2 = separation<Dim>(x, b + R::position, r);
            for (std::size_t d = 0; d < Dim; ++d) dv[d] = v[d] - b[R::velocity + d];
            Lanes w, f;
            kernel.value_and_gradient(r2, w, f);
            const Lanes volume = a_is_fluid ? own_volume : b[R::volume];
            GrainDrag::add(dv, strength * w * volume, force);
            e.barrier.add(r, r2, dv, density * volume, force);
          });
    });
    for (std::size_t d = 0; d < Dim; ++d) acceleration[d][k] += simd::sum(force[d]) * inverse_mass;
  }
}

}  // namespace

void drag_forces(PhaseParticles& a, const RecordArray& own, const PairList& list, const RecordArray& others,
                 const DragEntry& entry, bool a_is_fluid) {
  if (a.dimensions() == 2) drag<2>(a, own, list, others, entry, a_is_fluid);
  else drag<3>(a, own, list, others, entry, a_is_fluid);
}

}  // namespace barchan::BARCHAN_TARGET
