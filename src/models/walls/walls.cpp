#include "models/walls/walls.hpp"

#include "engine/pair_pass.hpp"

namespace barchan::BARCHAN_TARGET {

namespace {

template <int Dim, bool Curved, bool OneSided = false>
void extend(const PhaseParticles& solid, RecordArray& own, std::span<const ExtensionSource> fluids, const Vec3& gravity,
            const ExtensionRule& rule, const SurfaceBend& bend, std::span<const double> forced) {
  using Law = Extension<Curved, OneSided>;
  using R = MotionRecord<Dim>;
  std::array<PairEntry<Law>, most_entries> entries{};
  double alone = 0.0;
  for (std::size_t c = 0; c < fluids.size(); ++c) {
    const ExtensionSource& e = fluids[c];
    entries[c] = {e.list, e.records, e.kernel, e.radius, Law{{}, e.density, e.compression}};
    alone += e.alone;
  }
  const double* depth = solid.has(Field::wall_depth) ? solid.column(Field::wall_depth) : nullptr;
  std::array<const double*, Dim> velocity{}, normal{}, acceleration{};
  const bool rigid = solid.has(Field::surface_velocity);
  for (std::size_t d = 0; d < Dim; ++d) {
    const int axis = static_cast<int>(d);
    velocity[d] = solid.column(rigid ? Field::surface_velocity : Field::velocity, axis);
    if (depth) normal[d] = solid.column(Field::wall_normal, axis);
    if (rule.accelerates)
      acceleration[d] = solid.column(rigid ? Field::surface_acceleration : Field::acceleration, axis);
  }
  const auto prepare = [&](std::size_t k, typename Law::template Own<Dim, Lanes> & w) __attribute__((always_inline)) {
    for (std::size_t d = 0; d < Dim; ++d) {
      w.velocity[d] = Lanes(velocity[d][k]);
      w.normal[d] = Lanes(depth ? normal[d][k] : 0.0);
      w.pull[d] = Lanes(gravity[d] - (acceleration[d] ? acceleration[d][k] : 0.0));
      if (!forced.empty()) w.pull[d] += Lanes(forced[k * Dim + d]);
    }
    w.behind = Lanes(-(depth ? depth[k] : 0.0));
    const double inside = depth ? depth[k] + rule.least_phi : 0.0;
    w.inside2 = Lanes(inside * inside);
  };
  const auto finish = [&](std::size_t k, const typename Law::template Sums<Dim, Lanes>& s, bool) {
    double* record = own[k];
    ExtendedState<Dim> state{simd::sum(s.weight),    simd::sum(s.depth2), {}, {}, {}, {},
                             depth ? depth[k] : 0.0, rule.least_phi};
    for (std::size_t d = 0; d < Dim; ++d) {
      state.wall[d] = velocity[d][k];
      if (depth) state.normal[d] = normal[d][k];
    }
    if (!(state.weight > 0.0)) {
      for (std::size_t d = 0; d < Dim; ++d) record[R::velocity + d] = state.wall[d];
      record[R::pressure] = 0.0;
      return;
    }
    for (std::size_t d = 0; d < Dim; ++d) {
      state.mean[d] = simd::sum(s.velocity[d]) / state.weight;
      state.sloped[d] = simd::sum(s.sloped[d]);
    }
    record[R::pressure] = simd::sum(s.pressure) / state.weight;
    if constexpr (Curved) {
      const auto at = static_cast<std::size_t>(solid.id()[k] - bend.first) * SurfaceBend::components(Dim);
      record[R::pressure] += state.turning_pressure(&bend.values[at], simd::sum(s.lever));
    }
    const auto stuck = rule.own_velocity ? state.grain(alone) : state.no_slip();
    auto v = rule.slip == Slip::no_slip ? state.rubbed(stuck, rule.rub) : state.free_slip(stuck);
    if (rule.lets_go) state.let_go(record[R::pressure], v);
    for (std::size_t d = 0; d < Dim; ++d) record[R::velocity + d] = v[d];
  };
  pair_pass<Dim, Law>(solid.size(), 64, own, {entries.data(), fluids.size()}, prepare, finish);
}

}  // namespace

void extend_into_solid(const PhaseParticles& solid, RecordArray& own, std::span<const ExtensionSource> fluids,
                       const Vec3& gravity, const ExtensionRule& rule, const SurfaceBend& bend,
                       std::span<const double> forced) {
  const bool curved = rule.slip == Slip::free_slip && !bend.values.empty();
  const auto one_sided = solid.dimensions() == 2 ? extend<2, false, true> : extend<3, false, true>;
  const auto extended = rule.one_sided            ? one_sided
                        : solid.dimensions() == 2 ? (curved ? extend<2, true> : extend<2, false>)
                                                  : (curved ? extend<3, true> : extend<3, false>);
  extended(solid, own, fluids, gravity, rule, bend, forced);
}

}  // namespace barchan::BARCHAN_TARGET
