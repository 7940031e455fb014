// Between the records of spheres and vectors of their pairs: asking for records in time, and the sums of the forces.
#pragma once

#include <algorithm>
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

/// Adds the forces of a vector of pairs to both sides, pair after pair.
template <int Dim, bool Rubs>
BARCHAN_SIMD_INLINE void add_up(Sums<Dim>& sums, const ContactForces<V, Dim>& f, const std::uint32_t* a,
                                const std::uint32_t* b, std::size_t begin, std::uint32_t count) {
  static constexpr std::uint32_t rows[4] = {0, 1, 2, 3};
  const auto slot = [&](std::uint32_t sphere) {
    return static_cast<std::size_t>(std::min(sphere - static_cast<std::uint32_t>(begin), count)) * Sums<Dim>::size;
  };
  constexpr std::size_t sets = Dim == 2 ? 2 : Rubs ? 3 : 1;
  alignas(64) double lanes[sets][4][width];
  const auto put = [&](std::size_t set, V x, V y, V z) {
    x.store(lanes[set][0]);
    y.store(lanes[set][1]);
    z.store(lanes[set][2]);
    V(0.0).store(lanes[set][3]);
  };
  if constexpr (Dim == 2) {
    put(0, f.force[0], f.force[1], f.torque_a[0]);
    put(1, f.force[0], f.force[1], -f.torque_b[0]);
  } else {
    put(0, f.force[0], f.force[1], f.force[2]);
    if constexpr (Rubs) {
      put(1, f.torque_a[0], f.torque_a[1], f.torque_a[2]);
      put(2, f.torque_b[0], f.torque_b[1], f.torque_b[2]);
    }
  }
  Four of[sets][width];
  for (std::size_t set = 0; set < sets; ++set)
    for (std::size_t q = 0; q < width; q += 4)  // four pairs at once
      simd::load_transposed<4>(&lanes[set][0][q], width, rows, of[set] + q);
  for (std::size_t k = 0; k < width; ++k) {
    double *to_a = sums.of + slot(a[k]), *to_b = sums.of + slot(b[k]);
    (Four::load(to_a) + of[0][k]).store(to_a);
    (Four::load(to_b) - of[Dim == 2 ? 1 : 0][k]).store(to_b);
    if constexpr (Dim == 3 && Rubs) {
      (Four::load(to_a + 4) + of[1][k]).store(to_a + 4);
      (Four::load(to_b + 4) + of[2][k]).store(to_b + 4);
    }
  }
}

}  // namespace barchan::BARCHAN_TARGET::sphere_vectors
