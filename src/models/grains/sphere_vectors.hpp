// Between the records of spheres and vectors of their pairs: asking for records in time, and the sums of the forces.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>

#include "engine/pair_loop.hpp"
#include "models/grains/sphere_work.hpp"

namespace barchan::BARCHAN_TARGET::sphere_vectors {

constexpr std::size_t batch = SphereChunk::batch;
constexpr std::size_t width = Lanes::width < static_cast<int>(batch) ? static_cast<std::size_t>(Lanes::width) : batch;
using V = simd::Vec<double, static_cast<int>(width)>;
using Four = simd::Vec<double, 4>;

/// Sums of the forces on a chunk's spheres, and of one that takes what belongs to other chunks. 2D: fx fy t -; 3D: fx
/// fy fz - tx ty tz -.
template <int Dim>
struct Sums {
  static constexpr std::size_t size = Dim == 2 ? 4 : 8;
  alignas(64) double of[(SphereChunk::most + 1) * size];
  void clear(std::size_t spheres) { std::memset(of, 0, spheres * size * sizeof(double)); }
};

/// Asks for the records of a vector of pairs, which come from the second cache or further away: without it a bed of
/// 10^5 waits for them in a fifth of its time.
template <int Dim>
BARCHAN_SIMD_INLINE void fetch(const double* records, const std::uint32_t* a, const std::uint32_t* b) {
  constexpr std::size_t size = SphereRecord<Dim>::size, line = 8;
  for (const std::uint32_t* side : {a, b})
    for (std::size_t k = 0; k < width; ++k) {
      const double* record = records + side[k] * size;
      __builtin_prefetch(record);
      if constexpr (size > line) __builtin_prefetch(record + size - 1);
    }
}

/// Four numbers of each of a vector of pairs, pair by pair: of[k] is lane k of all four.
template <int W>
BARCHAN_SIMD_INLINE void by_pair(const std::array<simd::Vec<double, W>, 4>& x, Four* of) {
  if constexpr (W == 8) {
    for (std::size_t d = 0; d < 4; ++d) {
      of[d] = simd::lower(x[d]);
      of[4 + d] = simd::upper(x[d]);
    }
    simd::transpose(of[4], of[5], of[6], of[7]);
  } else
    for (std::size_t d = 0; d < 4; ++d) of[d] = x[d];
  simd::transpose(of[0], of[1], of[2], of[3]);
}

/// Adds the forces of a vector of pairs to both sides, pair after pair.
template <int Dim, bool Rubs>
BARCHAN_SIMD_INLINE void add_up(Sums<Dim>& sums, const ContactForces<V, Dim>& f, const std::uint32_t* a,
                                const std::uint32_t* b, std::size_t begin, std::uint32_t count) {
  const auto slot = [&](std::uint32_t sphere) {
    return static_cast<std::size_t>(std::min(sphere - static_cast<std::uint32_t>(begin), count)) * Sums<Dim>::size;
  };
  constexpr int W = static_cast<int>(width);
  Four force[width];
  [[maybe_unused]] Four torque_a[width], torque_b[width];
  // In 2D the fourth of a is the torque of b and the other way round: what stands there is nobody's.
  if constexpr (Dim == 2) by_pair<W>({f.force[0], f.force[1], f.torque_a[0], -f.torque_b[0]}, force);
  else {
    by_pair<W>({f.force[0], f.force[1], f.force[2], V(0.0)}, force);
    if constexpr (Rubs) {
      by_pair<W>({f.torque_a[0], f.torque_a[1], f.torque_a[2], V(0.0)}, torque_a);
      by_pair<W>({f.torque_b[0], f.torque_b[1], f.torque_b[2], V(0.0)}, torque_b);
    }
  }
  for (std::size_t k = 0; k < width; ++k) {
    double *to_a = sums.of + slot(a[k]), *to_b = sums.of + slot(b[k]);
    (Four::load(to_a) + force[k]).store(to_a);
    if constexpr (Dim == 2) force[k] = simd::swap_last(force[k]);
    (Four::load(to_b) - force[k]).store(to_b);
    if constexpr (Dim == 3 && Rubs) {
      (Four::load(to_a + 4) + torque_a[k]).store(to_a + 4);
      (Four::load(to_b + 4) + torque_b[k]).store(to_b + 4);
    }
  }
}

}  // namespace barchan::BARCHAN_TARGET::sphere_vectors
