// Displacements of a total Lagrangian body: less those of each part's first particle and, in mixed precision, in whole
// units and without the turn of the part.
#include <algorithm>
#include <cmath>

#include "engine/pair_loop.hpp"
#include "models/bodies/total_lagrangian.hpp"

namespace barchan::BARCHAN_TARGET {

namespace {

/// Whole numbers that a displacement may be: the difference of two is one that 32 bits hold. Beyond it the unit grows;
/// below `few_units` it shrinks. The unit is set to the middle of the two, so that it seldom changes.
constexpr double most_units = 1073741824.0, few_units = 67108864.0;  // 2^30, 2^26

/// The power of two (m) of which `largest` (m) holds 2^28 to 2^29; not finer than what a double tells of a place.
double unit_of(double largest, double diameter) {
  int exponent = 0, finest = 0;
  std::frexp(largest, &exponent);
  std::frexp(diameter, &finest);
  return std::ldexp(1.0, std::max(exponent - 29, finest - 70));
}

/// Displacements of an interval of ids that stand in order, less `mean`; returns the largest.
template <class T>
double write_in_order(const double* x, const double* start, std::size_t begin, std::size_t end, double mean,
                      double inverse, typename TotalWork<T>::Place* to) {
  using Place = typename TotalWork<T>::Place;
  using Wide = LanesOf<double>;
  constexpr std::size_t width = static_cast<std::size_t>(Wide::width);
  Wide most(0.0);
  const auto write = [&]<class V>(std::size_t k, V u, V & largest) __attribute__((always_inline)) {
    largest = simd::max(largest, simd::max(u, -u));
    if constexpr (std::is_integral_v<Place>) {
      const V q = u * V(inverse);
      const V rounded = simd::min(simd::max(q + select(q < V(0.0), V(-0.5), V(0.5)), V(-most_units)), V(most_units));
      simd::convert<Place>(rounded).store(to + k);
    } else {
      u.store(to + k);
    }
  };
  std::size_t k = begin;
  for (; k + width <= end; k += width) write(k, Wide::load(x + k) - Wide::load(start + k) - Wide(mean), most);
  simd::Vec<double, 1> last(0.0);
  for (; k < end; ++k) write(k, simd::Vec<double, 1>(x[k] - start[k] - mean), last);
  double largest = last.v;
  for (int lane = 0; lane < Wide::width; ++lane) largest = std::max(largest, most[lane]);
  return largest;
}

/// Sorting puts particles back into a periodic domain: displacements go on from where they were.
template <class T>
void unwrap(const PhaseParticles& body, const ReferenceBody<T>& reference, TotalWork<T>& work,
            const TotalParameters& q) {
  const auto n = static_cast<std::int64_t>(reference.size);
  for (std::size_t d = 0; d < static_cast<std::size_t>(reference.dimensions); ++d) {
    if (!(q.period[d] > 0.0)) continue;
    const double* x = body.column(Field::position, static_cast<int>(d));
#pragma omp parallel for schedule(static)
    for (std::int64_t i = 0; i < n; ++i) {
      const auto k = static_cast<std::size_t>(i);
      const double u = x[work.at[k]] - reference.place[d][k];
      work.displaced[d][k] = u + q.period[d] * std::nearbyint((work.displaced[d][k] - u) / q.period[d]);
    }
  }
}

/// Displacements (and velocities) of a piece that has turned: R^T (x - x_a) - (X - X_a) and R^T (v - v_a), a its
/// anchor. Returns the largest component, m.
template <int Dim, class T>
double write_turned(const PhaseParticles& body, const ReferenceBody<T>& reference, TotalWork<T>& work,
                    const TotalParameters& q, std::size_t piece) {
  using Place = typename TotalWork<T>::Place;
  const auto& [begin, end, anchor] = reference.pieces[piece];
  const PartTurns::Rotation& rotation = work.turns.rotation(piece);
  const double inverse = 1.0 / work.unit;
  const std::uint32_t* at = work.at;
  std::array<const double*, Dim> x{}, v{};
  for (std::size_t d = 0; d < Dim; ++d) {
    x[d] = body.column(Field::position, static_cast<int>(d));
    v[d] = body.column(Field::velocity, static_cast<int>(d));
  }
  const auto displacement = [&](std::size_t d, std::size_t k) {
    return q.period[d] > 0.0 ? work.displaced[d][k] : x[d][at[k]] - reference.place[d][k];
  };
  double most = 0.0;
  for (std::size_t k = begin; k < end; ++k) {
    Vec3 apart{}, first{}, speed{};
    for (std::size_t d = 0; d < Dim; ++d) {
      first[d] = reference.place[d][k] - reference.place[d][anchor];
      apart[d] = first[d] + (displacement(d, k) - displacement(d, anchor));
      speed[d] = v[d][at[k]] - v[d][at[anchor]];
    }
    const Vec3 u = turn_back(rotation, apart) - first;
    const Vec3 w = turn_back(rotation, speed);
    for (std::size_t d = 0; d < Dim; ++d) {
      most = std::max(most, std::abs(u[d]));
      Place* to = work.displacement[d].data() + TotalWork<T>::margin;
      if constexpr (std::is_integral_v<Place>)
        to[k] = static_cast<Place>(std::clamp(u[d] * inverse + std::copysign(0.5, u[d]), -most_units, most_units));
      else to[k] = u[d];
      if (!work.velocity[d].empty()) work.velocity[d][TotalWork<T>::margin + k] = static_cast<T>(w[d]);
    }
  }
  return most;
}

template <int Dim, class T>
double pack(const PhaseParticles& body, const ReferenceBody<T>& reference, TotalWork<T>& work,
            const TotalParameters& q) {  // returns the largest component, m
  using Place = typename TotalWork<T>::Place;
  constexpr bool whole = std::is_integral_v<Place>;
  std::array<const double*, Dim> x{}, v{};
  for (int d = 0; d < Dim; ++d) {
    x[static_cast<std::size_t>(d)] = body.column(Field::position, d);
    v[static_cast<std::size_t>(d)] = body.column(Field::velocity, d);
  }
  const std::uint32_t* at = work.at;
  const double inverse = 1.0 / work.unit;
  double most = 0.0;
  const auto pieces = static_cast<std::int64_t>(reference.pieces.size());
  work.largest.resize(reference.pieces.size());
#pragma omp parallel for schedule(static) reduction(max : most)
  for (std::int64_t number = 0; number < pieces; ++number) {
    const auto piece = static_cast<std::size_t>(number);
    double& largest = work.largest[piece] = 0.0;
    if (work.turns.turned(piece)) {
      largest = write_turned<Dim>(body, reference, work, q, piece);
      most = std::max(most, largest);
      continue;
    }
    const auto& [begin, end, anchor] = reference.pieces[piece];
    for (std::size_t d = 0; d < Dim; ++d) {
      Place* to = work.displacement[d].data() + TotalWork<T>::margin;
      const double* start = reference.place[d].data();
      const auto write = [&](std::size_t k, double u) __attribute__((always_inline)) {
        const double size = std::abs(u);
        largest = size > largest ? size : largest;
        if constexpr (whole)
          to[k] = static_cast<Place>(std::clamp(u * inverse + std::copysign(0.5, u), -most_units, most_units));
        else to[k] = u;
      };
      if (q.period[d] > 0.0) {
        const double mean = work.displaced[d][anchor];
        for (std::size_t k = begin; k < end; ++k) write(k, work.displaced[d][k] - mean);
      } else if (work.in_order) {
        const double mean = x[d][anchor] - start[anchor];
        largest = std::max(largest, write_in_order<T>(x[d], start, begin, end, mean, inverse, to));
      } else {
        const double mean = x[d][at[anchor]] - start[anchor];
        for (std::size_t k = begin; k < end; ++k) write(k, x[d][at[k]] - start[k] - mean);
      }
      if (work.velocity[d].empty()) continue;
      T* speed = work.velocity[d].data() + TotalWork<T>::margin;
      for (std::size_t k = begin; k < end; ++k) speed[k] = static_cast<T>(v[d][at[k]] - v[d][at[anchor]]);
    }
    most = std::max(most, largest);
  }
  return most;
}

}  // namespace

void pack_displacements(const PhaseParticles& body, const ReferenceBody<float>& reference, TotalWork<float>& work,
                        const TotalParameters& q) {
  const auto pack_all = [&] {
    return body.dimensions() == 2 ? pack<2>(body, reference, work, q) : pack<3>(body, reference, work, q);
  };
  unwrap(body, reference, work, q);
  const PartTurns::Places places{body, work.at, reference, work.displaced};
  work.turns.follow(places);
  double largest = pack_all();
  if (work.turns.choose(places, work.largest)) {
    largest = pack_all();
    if (work.turns.keep(reference, work.largest)) largest = pack_all();
  }
  const double units = largest / work.unit;
  if (!(largest > 0.0) || !std::isfinite(largest) || (units >= few_units && units <= most_units)) return;
  const double unit = unit_of(largest, reference.diameter);
  if (unit == work.unit) return;
  work.unit = unit;
  pack_all();
}
void pack_displacements(const PhaseParticles& body, const ReferenceBody<double>& reference, TotalWork<double>& work,
                        const TotalParameters& q) {
  unwrap(body, reference, work, q);
  body.dimensions() == 2 ? pack<2>(body, reference, work, q) : pack<3>(body, reference, work, q);
}

}  // namespace barchan::BARCHAN_TARGET
