// What a law sees of two particles. A law says as a type what it reads:
//
//   struct SomeLaw : PairLaw<Needs::gradient, Quantity::velocity, Quantity::volume> {
//     double constant;
//     template <int Dim, class T> struct Sums { ... };                   begins with zeros
//     template <int Dim, class T>
//     void add(const Particle<Dim, T, Reads>& a, const Particle<Dim, T, Reads>& b, const Pair<Dim, T>& ab,
//              Sums<Dim, T>& s) const;                                   adds the pair's part to the sums of a
//   };
//
// From that the engine makes the loop (engine/pair_pass.hpp): what it loads of a record, the separation, the kernel. A
// law that touches a quantity that it did not declare does not compile. T is a number or a SIMD vector.
#pragma once

#include <array>

#include "simd/vec.hpp"

namespace barchan {

/// What records hold of a particle beside its position.
enum class Quantity {
  velocity,  // m/s
  pressure,  // Pa; its meaning is the pass's own
  volume,    // m^dimensions; 0 marks the dummy that pads the rows of lists
  beside,    // of the second particle only: a number of the pass's own that stands beside the records
  carried    // of the second particle only, one of a solid: how its body carries it
};
template <Quantity... q>
struct Quantities {};

/// What a law needs of the kernel; a constant factor is left out of a slope, and the pass is told it (slope_factor).
enum class Needs { value_and_gradient, gradient, slope };

namespace detail {
template <Quantity q, int Dim, class T>
struct Has;
template <int Dim, class T>
struct Has<Quantity::velocity, Dim, T> {
  std::array<T, Dim> v;
};
template <int Dim, class T>
struct Has<Quantity::pressure, Dim, T> {
  T p;
};
template <int Dim, class T>
struct Has<Quantity::volume, Dim, T> {
  T volume;
};
template <int Dim, class T>
struct Has<Quantity::beside, Dim, T> {
  T beside;
};
template <int Dim, class T>
struct Has<Quantity::carried, Dim, T> {
  std::array<T, Dim> u;                            // m/s, its own velocity at the end of the step
  std::array<T, Dim> c;                            // m/s, of this what the turning of its rigid body gives it, w x x_b
  std::array<T, Dim == 2 ? 1 : 3> rate, old_rate;  // 1/s, w of its rigid body, and w when its torque was computed
};
}  // namespace detail

/// A particle as a law reads it.
template <int Dim, class T, class Reads>
struct Particle;
template <int Dim, class T, Quantity... q>
struct Particle<Dim, T, Quantities<q...>> : detail::Has<q, Dim, T>... {
  std::array<T, Dim> x;
};

/// Whether a law reads a quantity.
template <class Reads, Quantity wanted>
inline constexpr bool reads_quantity = false;
template <Quantity... q, Quantity wanted>
inline constexpr bool reads_quantity<Quantities<q...>, wanted> = ((q == wanted) || ...);

/// What a law says of itself: what it needs of the kernel, and what it reads of both particles beside their positions.
template <Needs n, Quantity... q>
struct PairLaw {
  static constexpr Needs needs = n;
  using Reads = Quantities<q...>;
  /// The first particle. A law that wants more of it than its record holds derives its own from this.
  template <int Dim, class T>
  using Own = Particle<Dim, T, Reads>;
  /// Whether close_entry(sums) follows the last pair of each entry.
  static constexpr bool closes_each_entry = false;
};

template <int Dim, class T>
struct Pair {
  std::array<T, Dim> r;  // x_a - x_b
  T r2;                  // r.r, above zero: particles in one place are 3e-19 m apart
  T w, f;                // kernel, and its gradient factor: grad_a W = f r
};

/// a - b by component.
template <class T, std::size_t Dim>
BARCHAN_SIMD_INLINE std::array<T, Dim> difference(const std::array<T, Dim>& a, const std::array<T, Dim>& b) {
  std::array<T, Dim> d;
  for (std::size_t k = 0; k < Dim; ++k) d[k] = a[k] - b[k];
  return d;
}

}  // namespace barchan
