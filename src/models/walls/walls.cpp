#include "models/walls/walls.hpp"

#include <algorithm>

#include "engine/shares.hpp"
#include "kernels/kernel.hpp"

namespace barchan::BARCHAN_TARGET {

namespace {

template <int Dim>
struct Sums {
  Lanes weight{0.0}, pressure{0.0}, depth2{0.0};  // sum W, sum W (p + rho (g-a).r), sum W phi_a^2
  Lanes lever{0.0};                               // curved walls: sum W rho (phi_a + phi_w)
  std::array<Lanes, Dim> velocity{}, sloped{};    // sum W v, sum W phi_a (v - v_wall)
};

/// Acceleration towards the fluid of what follows the surface at the velocity u: u.H.u.
template <std::size_t Dim>
double turn(const double* bend, const std::array<double, Dim>& u) {
  if constexpr (Dim == 2) return bend[0] * u[0] * u[0];
  else return bend[0] * u[0] * u[0] + 2.0 * bend[1] * u[0] * u[2] + bend[2] * u[2] * u[2];
}

/// 3 x^2 - 2 x^3 of x held in [0, 1].
double smooth_share(double x) {
  const double t = std::clamp(x, 0.0, 1.0);
  return t * t * (3.0 - 2.0 * t);
}

template <int Dim, bool Curved>
void extend(const PhaseParticles& solid, RecordArray& own, std::span<const ExtensionSource> fluids, const Vec3& gravity,
            const ExtensionRule& rule, const SurfaceBend& bend) {
  const Slip slip = rule.slip;
  using R = MotionRecord<Dim>;
  const bool has_depth = solid.has(Field::wall_depth), accelerates = rule.accelerates;
  const bool is_grain = rule.own_velocity;
  const double* depth = has_depth ? solid.column(Field::wall_depth) : nullptr;
  const auto n = static_cast<std::int64_t>(solid.size());
  Shares shares(n, 64);
#pragma omp parallel
  for (const std::int64_t i : shares) {
    const auto k = static_cast<std::size_t>(i);
    double* record = own[k];
    std::array<double, Dim> v_wall{}, normal{}, pull{};
    for (int d = 0; d < Dim; ++d) {
      const auto c = static_cast<std::size_t>(d);
      v_wall[c] = solid.column(Field::velocity, d)[k];
      if (has_depth) normal[c] = solid.column(Field::wall_normal, d)[k];
      pull[c] = gravity[c] - (accelerates ? solid.column(Field::acceleration, d)[k] : 0.0);
    }
    const double phi_w = has_depth ? depth[k] : 0.0;
    Sums<Dim> s;
    for (std::size_t d = 0; d < Dim; ++d) s.velocity[d] = s.sloped[d] = Lanes(0.0);
    for (const auto& fluid : fluids) {
      const auto row = fluid.list->row(k);
      if (row.begin == row.end) continue;
      std::array<Lanes, Dim> x, lift, toward, wall;
      for (std::size_t d = 0; d < Dim; ++d) {
        x[d] = Lanes(record[R::position + d]);
        lift[d] = Lanes(fluid.density * pull[d]);
        toward[d] = Lanes(normal[d]);
        wall[d] = Lanes(v_wall[d]);
      }
      const Lanes behind(-phi_w);
      with_kernel<double>(fluid.kernel, fluid.radius, Dim, [&](const auto& kernel) {
        for_each_neighbour<R::size>(
            row, *fluid.records, [&](const Lanes* b) __attribute__((always_inline)) {
              std::array<Lanes, Dim> r;
              const Lanes r2 = separation<Dim>(x, b + R::position, r);
              Lanes w, f;
              kernel.value_and_gradient(r2, w, f);
              w = w * b[R::volume];
              Lanes p = b[R::pressure], phi = behind;
              for (std::size_t d = 0; d < Dim; ++d) {
                p = simd::fma(lift[d], r[d], p);
                phi = simd::fnma(toward[d], r[d], phi);  // phi_a = n.(x_a - x_w) - depth
              }
              const Lanes w_phi = w * phi;
              s.weight += w;
              if constexpr (Curved) s.lever = simd::fma(w * Lanes(fluid.density), phi - behind, s.lever);
              s.pressure = simd::fma(w, p, s.pressure);
              s.depth2 = simd::fma(w_phi, phi, s.depth2);
              for (std::size_t d = 0; d < Dim; ++d) {
                s.velocity[d] = simd::fma(w, b[R::velocity + d], s.velocity[d]);
                s.sloped[d] = simd::fma(w_phi, b[R::velocity + d] - wall[d], s.sloped[d]);
              }
            });
      });
    }
    const double weight = simd::sum(s.weight);
    if (!(weight > 0.0)) {
      for (std::size_t d = 0; d < Dim; ++d) record[R::velocity + d] = v_wall[d];
      record[R::pressure] = 0.0;
      continue;
    }
    record[R::pressure] = simd::sum(s.pressure) / weight;
    const double depth2 = simd::sum(s.depth2);
    double alone = 0.0;
    for (const auto& fluid : fluids) alone += fluid.alone;
    const double open = alone > 0.0 ? smooth_share((weight / alone - solid_share) / (open_share - solid_share)) : 0.0;
    std::array<double, Dim> mean, stuck;
    double mean_normal = 0.0, stuck_normal = 0.0, wall_normal = 0.0;
    for (std::size_t d = 0; d < Dim; ++d) {
      mean[d] = simd::sum(s.velocity[d]) / weight;
      stuck[d] = is_grain                      ? v_wall[d] + open * (mean[d] - v_wall[d])
                 : phi_w > 0.0 && depth2 > 0.0 ? v_wall[d] - phi_w * simd::sum(s.sloped[d]) / depth2
                                               : 2.0 * v_wall[d] - mean[d];
      mean_normal += mean[d] * normal[d];
      stuck_normal += stuck[d] * normal[d];
      wall_normal += v_wall[d] * normal[d];
    }
    if constexpr (Curved) {
      std::array<double, Dim> along;
      for (std::size_t d = 0; d < Dim; ++d) along[d] = mean[d] - v_wall[d] - (mean_normal - wall_normal) * normal[d];
      const auto at = static_cast<std::size_t>(solid.id()[k] - bend.first) * SurfaceBend::components(Dim);
      record[R::pressure] += turn<Dim>(&bend.values[at], along) * simd::sum(s.lever) / weight;
    }
    for (std::size_t d = 0; d < Dim; ++d)
      record[R::velocity + d] = slip == Slip::no_slip ? stuck[d] : mean[d] + (stuck_normal - mean_normal) * normal[d];
  }
}

}  // namespace

void extend_into_solid(const PhaseParticles& solid, RecordArray& own, std::span<const ExtensionSource> fluids,
                       const Vec3& gravity, const ExtensionRule& rule, const SurfaceBend& bend) {
  const bool curved = rule.slip == Slip::free_slip && !bend.values.empty();
  const auto extended = solid.dimensions() == 2 ? (curved ? extend<2, true> : extend<2, false>)
                                                : (curved ? extend<3, true> : extend<3, false>);
  extended(solid, own, fluids, gravity, rule, bend);
}

}  // namespace barchan::BARCHAN_TARGET
