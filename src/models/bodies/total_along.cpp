#include "models/bodies/total_along.hpp"

#include "engine/shares.hpp"
#include "laws/stray_length.hpp"
#include "models/bodies/total_sums.hpp"

namespace barchan::BARCHAN_TARGET {

namespace {

/// Calls f(w, X, u, load) for every slot of a group; lanes without a pair have w = 0, X = u = 0.
template <int Dim, class T, class F>
BARCHAN_SIMD_INLINE void each_pair(const ReferenceBody<T>& reference, const TotalWork<T>& work, std::size_t group,
                                   F&& f) {
  using V = LanesOf<T>;
  using Place = simd::Vec<typename TotalWork<T>::Place, V::width>;
  const std::size_t first = group * static_cast<std::size_t>(V::width);
  const V unit(static_cast<T>(work.unit)), none(T(0));
  std::array<Place, Dim> own;
  for (std::size_t d = 0; d < Dim; ++d) own[d] = Place::load(from<T>(work.displacement[d]) + first);
  sweep<Dim>(
      reference, group, [&](V w, const std::array<V, Dim>& wx, auto&& load) __attribute__((always_inline)) {
        const auto there = w > none;
        const V inverse = select(there, V(T(1)) / select(there, w, V(T(1))), none);
        std::array<V, Dim> x, u;
        for (std::size_t d = 0; d < Dim; ++d) {
          x[d] = wx[d] * inverse;
          u[d] = select(there, unit * apart<T>(own[d], load(from<T>(work.displacement[d]))), none);
        }
        f(w, x, u, load);
      });
}

template <int Dim, class T>
void stress_of(const ReferenceBody<T>& reference, TotalWork<T>& work, const TotalParameters& q) {
  using V = LanesOf<T>;
  constexpr std::size_t width = static_cast<std::size_t>(V::width);
  const V unit(static_cast<T>(work.unit)), kappa(static_cast<T>(q.along));
  Shares shares(static_cast<std::int64_t>(reference.groups.size()), 64);
#pragma omp parallel
  for (const std::int64_t g : shares) {
    const auto group = static_cast<std::size_t>(g);
    const std::size_t first = group * width;
    const Matrix<Dim, V> inverse = inverse_of<Dim>(reference, first);
    const Matrix<Dim, V> h = gradient_of<Dim>(gradient_sum<Dim>(reference, group, work.displacement), inverse, unit);
    Matrix<Dim, V> s{};
    each_pair<Dim>(
        reference, work, group,
        [&](V w, const std::array<V, Dim>& x, const std::array<V, Dim>& u, auto&&) __attribute__((always_inline)) {
          const StrayLength<Dim, V> pair(x, u, h);
          const V pull = w * pair.stray * pair.inverse_z;
          for (std::size_t d = 0; d < Dim; ++d)
            for (std::size_t e = 0; e < Dim; ++e) s[d][e] = simd::fma(pull * pair.z[d], x[e], s[d][e]);
        });
    const Matrix<Dim, V> t = hyperelastic::product<Dim>(s, inverse);
    for (std::size_t d = 0; d < Dim; ++d)
      for (std::size_t e = 0; e < Dim; ++e) {
        T* reach = work.reach[d * Dim + e].data() + margin<T> + first;
        h[d][e].store(work.gradient[d * Dim + e].data() + margin<T> + first);
        simd::fma(kappa, t[d][e], V::load(reach)).store(reach);
      }
  }
}

template <int Dim, class T>
void forces_along(PhaseParticles& body, const ReferenceBody<T>& reference, const TotalWork<T>& work,
                  const TotalParameters& q) {
  using V = LanesOf<T>;
  constexpr std::size_t width = static_cast<std::size_t>(V::width);
  std::array<double*, Dim> a{};
  for (std::size_t d = 0; d < Dim; ++d) a[d] = body.column(Field::acceleration, static_cast<int>(d));
  const double scale = -q.along / q.density;
  Shares shares(static_cast<std::int64_t>(reference.groups.size()), 64);
#pragma omp parallel
  for (const std::int64_t g : shares) {
    const auto group = static_cast<std::size_t>(g);
    const std::size_t first = group * width, count = std::min(width, reference.size - first);
    Matrix<Dim, V> own;
    for (std::size_t d = 0; d < Dim; ++d)
      for (std::size_t e = 0; e < Dim; ++e) own[d][e] = V::load(from<T>(work.gradient[d * Dim + e]) + first);
    std::array<V, Dim> sum{};
    each_pair<Dim>(
        reference, work, group,
        [&](V w, const std::array<V, Dim>& x, const std::array<V, Dim>& u, auto&& load) __attribute__((always_inline)) {
          Matrix<Dim, V> other;
          for (std::size_t d = 0; d < Dim; ++d)
            for (std::size_t e = 0; e < Dim; ++e) other[d][e] = load(from<T>(work.gradient[d * Dim + e]));
          const StrayLength<Dim, V> pair(x, u, own), back(x, u, other);
          const V pull = w * (pair.stray + back.stray) * pair.inverse_y;
          for (std::size_t d = 0; d < Dim; ++d) sum[d] = simd::fma(pull, pair.y[d], sum[d]);
        });
    for (std::size_t d = 0; d < Dim; ++d)
      for (std::size_t k = 0; k < count; ++k)
        a[d][work.at[first + k]] += scale * static_cast<double>(sum[d][static_cast<int>(k)]);
  }
}

template <int Dim, class T>
void energy_of(const ReferenceBody<T>& reference, const TotalWork<T>& work, const TotalParameters& q,
               TotalDetail& detail) {
  using V = LanesOf<T>;
  constexpr std::size_t width = static_cast<std::size_t>(V::width);
  const V unit(static_cast<T>(work.unit)), half(static_cast<T>(0.5 * q.along));
  const auto groups = static_cast<std::int64_t>(reference.groups.size());
#pragma omp parallel for schedule(static)
  for (std::int64_t g = 0; g < groups; ++g) {
    const auto group = static_cast<std::size_t>(g);
    const std::size_t first = group * width;
    const Matrix<Dim, V> h = gradient_of<Dim>(gradient_sum<Dim>(reference, group, work.displacement),
                                              inverse_of<Dim>(reference, first), unit);
    V energy(T(0));
    each_pair<Dim>(
        reference, work, group,
        [&](V w, const std::array<V, Dim>& x, const std::array<V, Dim>& u, auto&&) __attribute__((always_inline)) {
          const StrayLength<Dim, V> pair(x, u, h);
          energy = simd::fma(w * pair.stray, pair.stray, energy);
        });
    const V more = half * energy;
    for (std::size_t k = 0; k < width; ++k)
      detail.hourglass[first + k] += static_cast<double>(more[static_cast<int>(k)]);
  }
}

}  // namespace

void along_stress(const ReferenceBody<float>& reference, TotalWork<float>& work, const TotalParameters& q) {
  reference.dimensions == 2 ? stress_of<2>(reference, work, q) : stress_of<3>(reference, work, q);
}
void along_stress(const ReferenceBody<double>& reference, TotalWork<double>& work, const TotalParameters& q) {
  reference.dimensions == 2 ? stress_of<2>(reference, work, q) : stress_of<3>(reference, work, q);
}

void along_forces(PhaseParticles& body, const ReferenceBody<float>& reference, const TotalWork<float>& work,
                  const TotalParameters& q) {
  body.dimensions() == 2 ? forces_along<2>(body, reference, work, q) : forces_along<3>(body, reference, work, q);
}
void along_forces(PhaseParticles& body, const ReferenceBody<double>& reference, const TotalWork<double>& work,
                  const TotalParameters& q) {
  body.dimensions() == 2 ? forces_along<2>(body, reference, work, q) : forces_along<3>(body, reference, work, q);
}

void along_energy(const ReferenceBody<float>& reference, const TotalWork<float>& work, const TotalParameters& q,
                  TotalDetail& detail) {
  reference.dimensions == 2 ? energy_of<2>(reference, work, q, detail) : energy_of<3>(reference, work, q, detail);
}
void along_energy(const ReferenceBody<double>& reference, const TotalWork<double>& work, const TotalParameters& q,
                  TotalDetail& detail) {
  reference.dimensions == 2 ? energy_of<2>(reference, work, q, detail) : energy_of<3>(reference, work, q, detail);
}

}  // namespace barchan::BARCHAN_TARGET
