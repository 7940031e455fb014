#include "models/bodies/body_forces.hpp"

#include "engine/shares.hpp"

namespace barchan::BARCHAN_TARGET {

namespace {

/// The columns of contact_force; null where the phase does not have it.
template <int Dim>
std::array<double*, Dim> felt_columns(PhaseParticles& p) {
  std::array<double*, Dim> felt{};
  for (int d = 0; d < Dim && p.has(Field::contact_force); ++d)
    felt[static_cast<std::size_t>(d)] = p.column(Field::contact_force, d);
  return felt;
}

/// List: PairList or FarPairs.
template <int Dim, bool Rubs, class List>
void contacts(PhaseParticles& a, const RecordArray& own, const List& list, const RecordArray& others,
              const BodyContactLaw& law, double dt) {
  using R = MotionRecord<Dim>;
  std::array<double*, Dim> acceleration{};
  for (int d = 0; d < Dim; ++d) acceleration[static_cast<std::size_t>(d)] = a.column(Field::acceleration, d);
  const std::array<double*, Dim> felt = felt_columns<Dim>(a);
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
    for (std::size_t d = 0; d < Dim; ++d) {
      const double sum = simd::sum(force[d]);
      acceleration[d][k] += sum * inverse_mass;
      if (felt[d]) felt[d][k] += sum;
    }
  }
}

template <int Dim, bool Rubs>
void surface_contacts(PhaseParticles& a, const RecordArray& own, const PairList& list, const RecordArray& others,
                      const SmoothContactLaw& law, double dt) {
  using R = SurfaceRecord<Dim>;
  std::array<double*, Dim> acceleration{};
  for (int d = 0; d < Dim; ++d) acceleration[static_cast<std::size_t>(d)] = a.column(Field::acceleration, d);
  const std::array<double*, Dim> felt = felt_columns<Dim>(a);
  const double inverse_mass = 1.0 / a.mass();
  const SmoothContactLaw::Constants<Lanes> constants(law, dt);
  Shares shares(static_cast<std::int64_t>(a.size()), 64);
#pragma omp parallel
  for (const std::int64_t i : shares) {
    const auto k = static_cast<std::size_t>(i);
    const auto row = list.row(k);
    const double* record = own[k];
    if (row.begin == row.end || record[R::share] == 0.0) continue;
    std::array<Lanes, Dim> x, v, n, force;
    for (std::size_t d = 0; d < Dim; ++d) {
      x[d] = Lanes(record[R::position + d]);
      v[d] = Lanes(record[R::velocity + d]);
      n[d] = Lanes(record[R::normal + d]);
      force[d] = Lanes(0.0);
    }
    const Lanes share(record[R::share]);
    for_each_neighbour<R::size>(
        row, others, [&](const Lanes* b) __attribute__((always_inline)) {
          std::array<Lanes, Dim> r, dv;
          const Lanes r2 = separation<Dim>(x, b + R::position, r);
          for (std::size_t d = 0; d < Dim; ++d) dv[d] = v[d] - b[R::velocity + d];
          SmoothContactLaw::add<Rubs>(constants, r, r2, dv, n, b + R::normal, share * b[R::share], force);
        });
    for (std::size_t d = 0; d < Dim; ++d) {
      const double sum = simd::sum(force[d]);
      acceleration[d][k] += sum * inverse_mass;
      if (felt[d]) felt[d][k] += sum;
    }
  }
}

/// The particles k .. k + width - 1.
template <class V, int Dim, bool Rubs>
BARCHAN_SIMD_INLINE void at_side(const std::array<double*, Dim>& x, const std::array<double*, Dim>& v,
                                 const std::array<double*, Dim>& a, const std::array<double*, Dim>& felt,
                                 const BodySide& side, double half, const BodyContactLaw::Constants<V>& constants,
                                 double inverse_mass, std::size_t k) {
  std::array<V, Dim> r, speed, force;
  for (std::size_t d = 0; d < Dim; ++d) {
    r[d] = force[d] = V(0.0);
    speed[d] = V::load(v[d] + k);
  }
  const V height = V(side.sign) * (V::load(x[side.axis] + k) - V(side.place)) + V(half);
  if (!simd::any(height < constants.distance)) return;
  r[side.axis] = V(side.sign) * height;
  BodyContactLaw::add<Rubs>(constants, r, simd::fma(height, height, V(least_square)), speed, force);
  for (std::size_t d = 0; d < Dim; ++d) {
    simd::fma(force[d], V(inverse_mass), V::load(a[d] + k)).store(a[d] + k);
    if (felt[d]) (V::load(felt[d] + k) + force[d]).store(felt[d] + k);
  }
}

template <int Dim, bool Rubs>
void sides(PhaseParticles& body, const BodySide& side, double half, const BodyContactLaw& law, double dt) {
  using One = simd::Vec<double, 1>;
  std::array<double*, Dim> x{}, v{}, a{};
  for (int d = 0; d < Dim; ++d) {
    x[static_cast<std::size_t>(d)] = body.column(Field::position, d);
    v[static_cast<std::size_t>(d)] = body.column(Field::velocity, d);
    a[static_cast<std::size_t>(d)] = body.column(Field::acceleration, d);
  }
  const std::array<double*, Dim> felt = felt_columns<Dim>(body);
  const double inverse_mass = 1.0 / body.mass();
  constexpr std::size_t width = static_cast<std::size_t>(Lanes::width);
  const BodyContactLaw::Constants<Lanes> constants(law, dt);
  const std::size_t n = body.size();
  const auto whole = static_cast<std::int64_t>(n / width);
#pragma omp parallel for schedule(static)
  for (std::int64_t q = 0; q < whole; ++q)
    at_side<Lanes, Dim, Rubs>(x, v, a, felt, side, half, constants, inverse_mass, static_cast<std::size_t>(q) * width);
  const BodyContactLaw::Constants<One> single(law, dt);
  for (std::size_t k = static_cast<std::size_t>(whole) * width; k < n; ++k)
    at_side<One, Dim, Rubs>(x, v, a, felt, side, half, single, inverse_mass, k);
}

}  // namespace

void body_side_forces(PhaseParticles& a, const BodySide& side, double half, const BodyContactLaw& law, double dt) {
  const bool rubs = law.friction > 0.0;
  if (a.dimensions() == 2) rubs ? sides<2, true>(a, side, half, law, dt) : sides<2, false>(a, side, half, law, dt);
  else rubs ? sides<3, true>(a, side, half, law, dt) : sides<3, false>(a, side, half, law, dt);
}

namespace {

template <class List>
void contacts_of(PhaseParticles& a, const RecordArray& own, const List& list, const RecordArray& others,
                 const BodyContactLaw& law, double dt) {
  const bool rubs = law.friction > 0.0;
  if (a.dimensions() == 2)
    rubs ? contacts<2, true>(a, own, list, others, law, dt) : contacts<2, false>(a, own, list, others, law, dt);
  else rubs ? contacts<3, true>(a, own, list, others, law, dt) : contacts<3, false>(a, own, list, others, law, dt);
}

}  // namespace

void body_contact_forces(PhaseParticles& a, const RecordArray& own, const PairList& list, const RecordArray& others,
                         const BodyContactLaw& law, double dt) {
  contacts_of(a, own, list, others, law, dt);
}
void body_contact_forces(PhaseParticles& a, const RecordArray& own, const PairList& list, const RecordArray& others,
                         const SmoothContactLaw& law, double dt) {
  const bool rubs = law.pair.friction > 0.0;
  if (a.dimensions() == 2)
    rubs ? surface_contacts<2, true>(a, own, list, others, law, dt)
         : surface_contacts<2, false>(a, own, list, others, law, dt);
  else
    rubs ? surface_contacts<3, true>(a, own, list, others, law, dt)
         : surface_contacts<3, false>(a, own, list, others, law, dt);
}
void body_contact_forces(PhaseParticles& a, const RecordArray& own, const FarPairs& list, const BodyContactLaw& law,
                         double dt) {
  contacts_of(a, own, list, own, law, dt);
}

}  // namespace barchan::BARCHAN_TARGET
