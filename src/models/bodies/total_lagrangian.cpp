#include "models/bodies/total_lagrangian.hpp"

#include <algorithm>
#include <cmath>

#include "engine/shares.hpp"
#include "models/bodies/total_along.hpp"
#include "models/bodies/total_sums.hpp"

namespace barchan::BARCHAN_TARGET {

namespace {

template <int Dim, class Law, bool Damped, class T>
void stress_of(PhaseParticles& body, const ReferenceBody<T>& reference, TotalWork<T>& work, const TotalParameters& q) {
  using V = LanesOf<T>;
  constexpr std::size_t width = static_cast<std::size_t>(V::width);
  const V lambda(static_cast<T>(q.moduli.lambda)), mu(static_cast<T>(q.moduli.mu));
  const V slow_lambda(static_cast<T>(q.moduli.lambda * q.moduli.retardation)),
      slow_mu(static_cast<T>(q.moduli.mu * q.moduli.retardation));
  const V unit(static_cast<T>(work.unit)), kappa(static_cast<T>(q.hourglass)), rho(static_cast<T>(q.density));
  double* density = body.column(Field::density);
  std::array<T*, Dim * Dim> reach{};
  for (std::size_t c = 0; c < Dim * Dim; ++c) reach[c] = work.reach[c].data() + margin<T>;
  Shares shares(static_cast<std::int64_t>(reference.groups.size()), 64);
  double stiffest = 1.0, least = 1.0;
#pragma omp parallel reduction(max : stiffest) reduction(min : least)
  {
    V stiff(T(1)), pressed(T(0));
    for (const std::int64_t g : shares) {
      const auto group = static_cast<std::size_t>(g);
      const std::size_t first = group * width, count = std::min(width, reference.size - first);
      const Matrix<Dim, V> inverse = inverse_of<Dim>(reference, first);
      const Matrix<Dim, V> h = gradient_of<Dim>(gradient_sum<Dim>(reference, group, work.displacement), inverse, unit);
      const V jacobian = hyperelastic::dilation<Dim>(h);
      Matrix<Dim, V> p = Law::template stress<Dim>(h, jacobian, lambda, mu);
      if constexpr (Damped) {
        const Matrix<Dim, V> rate =
            gradient_of<Dim>(gradient_sum<Dim>(reference, group, work.velocity), inverse, V(T(1)));
        const Matrix<Dim, V> more = hyperelastic::damping_stress<Dim>(h, rate, slow_lambda, slow_mu);
        for (std::size_t d = 0; d < Dim; ++d)
          for (std::size_t e = 0; e < Dim; ++e) p[d][e] += more[d][e];
      }
      const Matrix<Dim, V> t = hyperelastic::product<Dim>(p, inverse);
      for (std::size_t d = 0; d < Dim; ++d)
        for (std::size_t e = 0; e < Dim; ++e) (kappa * h[d][e] - t[d][e]).store(reach[d * Dim + e] + first);
      put(rho / (V(T(1)) + jacobian), work, first, count, density);
      stiff = simd::max(stiff, Law::template stiffening<Dim>(hyperelastic::green_strain<Dim>(h), jacobian, lambda, mu));
      pressed = simd::min(pressed, jacobian);
    }
    for (int lane = 0; lane < V::width; ++lane) {
      stiffest = std::max(stiffest, static_cast<double>(stiff[lane]));
      least = std::min(least, 1.0 + static_cast<double>(pressed[lane]));
    }
  }
  work.stiffening = stiffest;
  work.least_volume = least;
}

template <int Dim, class T>
void forces_of(PhaseParticles& body, const ReferenceBody<T>& reference, const TotalWork<T>& work,
               const TotalParameters& q) {
  using V = LanesOf<T>;
  using Place = simd::Vec<typename TotalWork<T>::Place, V::width>;
  constexpr std::size_t width = static_cast<std::size_t>(V::width);
  const V inverse_density(static_cast<T>(1.0 / q.density)),
      kappa(static_cast<T>(-2.0 * q.hourglass * work.unit / q.density));
  std::array<double*, Dim> a{};
  for (int d = 0; d < Dim; ++d) a[static_cast<std::size_t>(d)] = body.column(Field::acceleration, d);
  std::array<const T*, Dim * Dim> reach{};
  for (std::size_t c = 0; c < Dim * Dim; ++c) reach[c] = from<T>(work.reach[c]);
  Shares shares(static_cast<std::int64_t>(reference.groups.size()), 64);
#pragma omp parallel
  for (const std::int64_t g : shares) {
    const auto group = static_cast<std::size_t>(g);
    const std::size_t first = group * width, count = std::min(width, reference.size - first);
    std::array<Place, Dim> own;
    std::array<V, Dim> stress, strayed;
    for (std::size_t d = 0; d < Dim; ++d) {
      own[d] = Place::load(from<T>(work.displacement[d]) + first);
      stress[d] = strayed[d] = V(T(0));
      for (std::size_t e = 0; e < Dim; ++e)
        stress[d] = simd::fma(V::load(reach[d * Dim + e] + first), V::load(reference.sum[e].data() + first), stress[d]);
    }
    sweep<Dim>(
        reference, group, [&](V w, const std::array<V, Dim>& wx, auto&& load) __attribute__((always_inline)) {
          for (std::size_t d = 0; d < Dim; ++d) {
            for (std::size_t e = 0; e < Dim; ++e) stress[d] = simd::fma(load(reach[d * Dim + e]), wx[e], stress[d]);
            strayed[d] = simd::fma(w, apart<T>(own[d], load(from<T>(work.displacement[d]))), strayed[d]);
          }
        });
    for (std::size_t d = 0; d < Dim; ++d)
      put(simd::fma(kappa, strayed[d], simd::fma(inverse_density, stress[d], V(static_cast<T>(q.gravity[d])))), work,
          first, count, a[d]);
  }
}

/// Accelerations of pieces that have turned, from the axes of the piece to those of space.
template <int Dim, class T>
void turn_forces(PhaseParticles& body, const ReferenceBody<T>& reference, const TotalWork<T>& work,
                 const TotalParameters& q) {
  std::array<double*, Dim> a{};
  for (std::size_t d = 0; d < Dim; ++d) a[d] = body.column(Field::acceleration, static_cast<int>(d));
  const auto pieces = static_cast<std::int64_t>(reference.pieces.size());
#pragma omp parallel for schedule(static)
  for (std::int64_t number = 0; number < pieces; ++number) {
    const auto piece = static_cast<std::size_t>(number);
    if (!work.turns.turned(piece)) continue;
    for (std::size_t k = reference.pieces[piece].begin; k < reference.pieces[piece].end; ++k) {
      Vec3 own{};
      for (std::size_t d = 0; d < Dim; ++d) own[d] = a[d][work.at[k]] - q.gravity[d];
      const Vec3 turned = turn(work.turns.rotation(piece), own);
      for (std::size_t d = 0; d < Dim; ++d) a[d][work.at[k]] = turned[d] + q.gravity[d];
    }
  }
}

/// H = R (I + H') - I of pieces that have turned.
template <int Dim, class T>
void turn_gradients(const ReferenceBody<T>& reference, const TotalWork<T>& work, TotalDetail& detail) {
  for (std::size_t piece = 0; piece < reference.pieces.size(); ++piece) {
    if (!work.turns.turned(piece)) continue;
    for (std::size_t k = reference.pieces[piece].begin; k < reference.pieces[piece].end; ++k)
      for (std::size_t e = 0; e < Dim; ++e) {
        Vec3 column{};
        for (std::size_t d = 0; d < Dim; ++d) column[d] = detail.gradient[d * Dim + e][k] + (d == e ? 1.0 : 0.0);
        const Vec3 turned = turn(work.turns.rotation(piece), column);
        for (std::size_t d = 0; d < Dim; ++d) detail.gradient[d * Dim + e][k] = turned[d] - (d == e ? 1.0 : 0.0);
      }
  }
}

template <int Dim, class T>
void detail_of(const ReferenceBody<T>& reference, const TotalWork<T>& work, const TotalParameters& q,
               TotalDetail& detail) {
  using V = LanesOf<T>;
  using Place = simd::Vec<typename TotalWork<T>::Place, V::width>;
  using Wide = simd::Vec<double, V::width>;
  constexpr std::size_t width = static_cast<std::size_t>(V::width);
  const V unit(static_cast<T>(work.unit)), half(static_cast<T>(0.5 * q.hourglass));
  const auto groups = static_cast<std::int64_t>(reference.groups.size());
#pragma omp parallel for schedule(static)
  for (std::int64_t g = 0; g < groups; ++g) {
    const auto group = static_cast<std::size_t>(g);
    const std::size_t first = group * width;
    const Matrix<Dim, V> h = gradient_of<Dim>(gradient_sum<Dim>(reference, group, work.displacement),
                                              inverse_of<Dim>(reference, first), unit);
    for (std::size_t d = 0; d < Dim; ++d)
      for (std::size_t e = 0; e < Dim; ++e)
        simd::convert<double>(h[d][e]).store(detail.gradient[d * Dim + e].data() + first);
    std::array<Place, Dim> own;
    for (std::size_t d = 0; d < Dim; ++d) own[d] = Place::load(from<T>(work.displacement[d]) + first);
    V energy(T(0));  // sum w |u_ab - H X_ab|^2
    sweep<Dim>(
        reference, group, [&](V w, const std::array<V, Dim>& wx, auto&& load) __attribute__((always_inline)) {
          const V inverse = select(w > V(T(0)), V(T(1)) / simd::max(w, V(T(1e-30))), V(T(0)));
          for (std::size_t d = 0; d < Dim; ++d) {
            V e = unit * apart<T>(own[d], load(from<T>(work.displacement[d])));
            for (std::size_t c = 0; c < Dim; ++c) e = simd::fnma(h[d][c], wx[c] * inverse, e);
            energy = simd::fma(w * e, e, energy);
          }
        });
    const Wide result = simd::convert<double>(half * energy);
    result.store(detail.hourglass.data() + first);
  }
}

template <int Dim, class T>
void stress_by_law(PhaseParticles& body, const ReferenceBody<T>& reference, TotalWork<T>& work,
                   const TotalParameters& q) {
  const bool damped = q.moduli.retardation > 0.0;
  if (q.law == Elasticity::neo_hookean)
    damped ? stress_of<Dim, NeoHookean, true>(body, reference, work, q)
           : stress_of<Dim, NeoHookean, false>(body, reference, work, q);
  else
    damped ? stress_of<Dim, SaintVenantKirchhoff, true>(body, reference, work, q)
           : stress_of<Dim, SaintVenantKirchhoff, false>(body, reference, work, q);
}

}  // namespace

void total_stress(PhaseParticles& body, const ReferenceBody<float>& reference, TotalWork<float>& work,
                  const TotalParameters& q) {
  body.dimensions() == 2 ? stress_by_law<2>(body, reference, work, q) : stress_by_law<3>(body, reference, work, q);
  if (q.along > 0.0) along_stress(reference, work, q);
}
void total_stress(PhaseParticles& body, const ReferenceBody<double>& reference, TotalWork<double>& work,
                  const TotalParameters& q) {
  body.dimensions() == 2 ? stress_by_law<2>(body, reference, work, q) : stress_by_law<3>(body, reference, work, q);
  if (q.along > 0.0) along_stress(reference, work, q);
}

void total_forces(PhaseParticles& body, const ReferenceBody<float>& reference, const TotalWork<float>& work,
                  const TotalParameters& q) {
  body.dimensions() == 2 ? forces_of<2>(body, reference, work, q) : forces_of<3>(body, reference, work, q);
  if (q.along > 0.0) along_forces(body, reference, work, q);
  if (!work.turns.any()) return;
  body.dimensions() == 2 ? turn_forces<2>(body, reference, work, q) : turn_forces<3>(body, reference, work, q);
}
void total_forces(PhaseParticles& body, const ReferenceBody<double>& reference, const TotalWork<double>& work,
                  const TotalParameters& q) {
  body.dimensions() == 2 ? forces_of<2>(body, reference, work, q) : forces_of<3>(body, reference, work, q);
  if (q.along > 0.0) along_forces(body, reference, work, q);
}

void total_detail(const ReferenceBody<float>& reference, const TotalWork<float>& work, const TotalParameters& q,
                  TotalDetail& detail) {
  reference.dimensions == 2 ? detail_of<2>(reference, work, q, detail) : detail_of<3>(reference, work, q, detail);
  if (q.along > 0.0) along_energy(reference, work, q, detail);
  if (!work.turns.any()) return;
  reference.dimensions == 2 ? turn_gradients<2>(reference, work, detail) : turn_gradients<3>(reference, work, detail);
}
void total_detail(const ReferenceBody<double>& reference, const TotalWork<double>& work, const TotalParameters& q,
                  TotalDetail& detail) {
  reference.dimensions == 2 ? detail_of<2>(reference, work, q, detail) : detail_of<3>(reference, work, q, detail);
  if (q.along > 0.0) along_energy(reference, work, q, detail);
}

}  // namespace barchan::BARCHAN_TARGET
