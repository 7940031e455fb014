#include "models/packing.hpp"

#include <array>

#include "engine/fours.hpp"

namespace barchan::BARCHAN_TARGET {

namespace {

/// What the records are made of. The columns that a phase lacks, or whose values do not count, are null.
template <std::size_t Dim>
struct Source {
  std::array<const double*, Dim> x{}, v{};
  const double *pressure = nullptr, *density = nullptr;
  double mass, volume;  // kg, m^Dim

  Source(const PhaseParticles& p, const MotionPacking& how, double fixed) : mass(p.mass()), volume(fixed) {
    for (std::size_t d = 0; d < Dim; ++d) {
      x[d] = p.column(Field::position, static_cast<int>(d));
      v[d] = p.column(Field::velocity, static_cast<int>(d));
    }
    if (how.pressure) pressure = p.column(Field::pressure);
    if (how.pressure && !how.fixed_volume) density = p.column(Field::density);
  }
  void pack(double* r, std::size_t k) const {
    using R = MotionRecord<static_cast<int>(Dim)>;
    for (std::size_t d = 0; d < Dim; ++d) {
      r[R::position + d] = x[d][k];
      r[R::velocity + d] = v[d][k];
    }
    r[R::pressure] = pressure ? pressure[k] : 0.0;
    r[R::volume] = density ? mass / density[k] : volume;
  }
  /// Particles k to k + 3, records side by side.
  BARCHAN_SIMD_INLINE void pack_four(double* r, std::size_t k) const {
    using R = MotionRecord<static_cast<int>(Dim)>;
    std::array<Four, 2 * Dim + 2> values;
    for (std::size_t d = 0; d < Dim; ++d) {
      values[R::position + d] = Four::load(x[d] + k);
      values[R::velocity + d] = Four::load(v[d] + k);
    }
    values[R::pressure] = pressure ? Four::load(pressure + k) : Four(0.0);
    values[R::volume] = density ? Four(mass) / Four::load(density + k) : Four(volume);
    store_records(values, r, R::size);
  }
};

template <std::size_t Dim>
void pack_all(const PhaseParticles& p, RecordArray& records, const MotionPacking& how, double volume) {
  const Source<Dim> source(p, how, volume);
  const std::size_t n = p.size();
  const auto fours = static_cast<std::int64_t>(n / 4);
#pragma omp parallel for schedule(static)
  for (std::int64_t q = 0; q < fours; ++q) {
    const std::size_t k = 4 * static_cast<std::size_t>(q);
    source.pack_four(records[k], k);
  }
  for (std::size_t k = n / 4 * 4; k < n; ++k) source.pack(records[k], k);
}

template <std::size_t Dim>
void pack_all(const PhaseParticles& p, CompactRecords& records, const MotionPacking& how, double volume) {
  const Source<Dim> source(p, {.pressure = true, .fixed_volume = how.fixed_volume}, volume);
  const auto n = static_cast<std::int64_t>(p.size());
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < n; ++i) {
    const auto k = static_cast<std::size_t>(i);
    std::array<double, Dim> at, speed;
    for (std::size_t d = 0; d < Dim; ++d) {
      at[d] = source.x[d][k];
      speed[d] = source.v[d][k];
    }
    records.write<static_cast<int>(Dim)>(k, at, speed, source.pressure[k],
                                         source.density ? source.mass / source.density[k] : volume);
  }
}

}  // namespace

void pack_motion(const PhaseParticles& p, RecordArray& records, const MotionPacking& how, double volume) {
  p.dimensions() == 2 ? pack_all<2>(p, records, how, volume) : pack_all<3>(p, records, how, volume);
}

void pack_compact(const PhaseParticles& p, CompactRecords& records, const MotionPacking& how, double volume) {
  p.dimensions() == 2 ? pack_all<2>(p, records, how, volume) : pack_all<3>(p, records, how, volume);
}

}  // namespace barchan::BARCHAN_TARGET
