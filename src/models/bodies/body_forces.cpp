#include "models/bodies/body_forces.hpp"

#include "engine/shares.hpp"

namespace barchan::BARCHAN_TARGET {

namespace {

template <int Dim, bool Rubs>
void contacts(PhaseParticles& a, const RecordArray& own, const PairList& list, const RecordArray& others,
              const BodyContactLaw& law, double dt) {
  using R = MotionRecord<Dim>;
  std::array<double*, Dim> acceleration{};
  for (int d = 0; d < Dim; ++d) acceleration[static_cast<std::size_t>(d)] = a.column(Field::acceleration, d);
  const double inverse_mass = 1.0 / a.mass();
  const BodyContactLaw::Constants<Lanes> constants(law, dt);
  Shares shares(static_cast<std::int64_t>(a.size()), 64);
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
    for_each_neighbour<R::size>(
        row, others, [&](const Lanes* b) __attribute__((always_inline)) {
          std::array<Lanes, Dim> r, dv;
          const Lanes r2 = separation<Dim>(x, b + R::position, r);
          for (std::size_t d = 0; d < Dim; ++d) dv[d] = v[d] - b[R::velocity + d];
          BodyContactLaw::add<Rubs>(constants, r, r2, dv, force);
        });
    for (std::size_t d = 0; d < Dim; ++d) acceleration[d][k] += simd::sum(force[d]) * inverse_mass;
  }
}

}  // namespace

void body_contact_forces(PhaseParticles& a, const RecordArray& own, const PairList& list, const RecordArray& others,
                         const BodyContactLaw& law, double dt) {
  const bool rubs = law.friction > 0.0;
  if (a.dimensions() == 2)
    rubs ? contacts<2, true>(a, own, list, others, law, dt) : contacts<2, false>(a, own, list, others, law, dt);
  else rubs ? contacts<3, true>(a, own, list, others, law, dt) : contacts<3, false>(a, own, list, others, law, dt);
}

}  // namespace barchan::BARCHAN_TARGET
