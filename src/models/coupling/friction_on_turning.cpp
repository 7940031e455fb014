#include "engine/pair_pass.hpp"
#include "laws/turning_friction.hpp"
#include "models/coupling/rigid_in_fluid.hpp"

namespace barchan::BARCHAN_TARGET {

namespace {

template <int Dim>
void friction(const RecordArray& own, std::span<const FluidNeighbour> fluids, std::span<const Vec3> rate,
              std::span<Vec3> area, std::span<Vec3> couple) {
  using R = MotionRecord<Dim>;
  std::array<PairEntry<TurningFriction>, most_entries> entries{};
  for (std::size_t c = 0; c < fluids.size(); ++c) {
    const FluidNeighbour& e = fluids[c];
    entries[c] = {e.list, e.records, e.kernel, e.radius, TurningFriction{{}, e.viscosity}};
  }
  pair_pass<Dim, TurningFriction>(
      area.size(), 64, own, {entries.data(), fluids.size()}, [](std::size_t, auto&) {},
      [&](std::size_t k, const auto& sums, bool met) __attribute__((always_inline)) {
        area[k] = couple[k] = Vec3{};
        if (!met) return;
        const double volume = own[k][R::volume];
        Vec3 twist{};
        for (std::size_t d = 0; d < twists(Dim); ++d) twist[Dim == 2 ? 2 : d] = simd::sum(sums.twist[d]);
        double moment[3][3] = {}, trace = 0.0;
        std::size_t m = 0;
        for (std::size_t d = 0; d < Dim; ++d) {
          area[k][d] = 2.0 * volume * simd::sum(sums.area[d]);
          for (std::size_t e = 0; e <= d; ++e, ++m) moment[d][e] = moment[e][d] = simd::sum(sums.moment[m]);
          trace += moment[d][d];
        }
        const Vec3& w = rate[k];
        for (std::size_t d = 0; d < 3; ++d)  // r x (w x r) = w r^2 - r (r.w)
          couple[k][d] =
              -volume * (twist[d] - trace * w[d] + moment[d][0] * w[0] + moment[d][1] * w[1] + moment[d][2] * w[2]);
      });
}

}  // namespace

void turning_friction(const RecordArray& own, std::span<const FluidNeighbour> fluids, std::span<const Vec3> rate,
                      std::span<Vec3> area, std::span<Vec3> couple, int dimensions) {
  dimensions == 2 ? friction<2>(own, fluids, rate, area, couple) : friction<3>(own, fluids, rate, area, couple);
}

}  // namespace barchan::BARCHAN_TARGET
