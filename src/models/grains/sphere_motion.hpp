// What the forces of a step do to the spheres of a chunk: their motion, what the phase gets after the last step, and
// who wakes. Internal to sphere_forces.cpp.
#pragma once

#include <algorithm>
#include <cmath>

#include "models/grains/sphere_vectors.hpp"

namespace barchan::BARCHAN_TARGET::sphere_motion {

using namespace sphere_vectors;

/// v += dt a, x += dt v for the chunk's spheres; in the last step half of the kick and no drift.
template <int Dim>
void move_on(const SphereStep& step, SphereChunk& chunk, const Sums<Dim>& sums) {
  using R = SphereRecord<Dim>;
  const double dt = step.dt;
  float farthest = 0.0f;
  double fastest2 = 0.0;
  chunk.gone.clear();
  chunk.each_moving([&](std::size_t k) {
    const double *from = step.records + k * R::size, *passive = step.passive + k * passive_size;
    const double* force = sums.of + (k - chunk.begin) * Sums<Dim>::size;
    double* to = step.next + k * R::size;
    const double inverse_mass = passive[passive_mass], radius = from[R::radius];
    const double inverse_inertia = 2.5 * inverse_mass / (radius * radius);
    double v2 = 0.0;
    for (std::size_t d = 0; d < Dim; ++d) {
      const double v = from[R::velocity + d] + dt * (passive[d] + inverse_mass * force[d]);
      to[d] = from[d] + dt * v;
      to[R::velocity + d] = v;
      v2 += v * v;
      set_way<Dim>(to, d, way_of<Dim>(from, d) + static_cast<float>(dt * v));
    }
    fastest2 = std::max(fastest2, v2);
    to[R::radius] = radius;
    for (std::size_t d = 0; d < R::spins; ++d)
      to[R::spin + d] = from[R::spin + d] + dt * inverse_inertia * force[(Dim == 2 ? 2 : 4) + d];
    const float used = next_way2<Dim>(to, dt) * step.tightness[k];
    farthest = std::max(farthest, used);
    if (static_cast<double>(used) >= SphereChunk::used_up) chunk.gone.push_back(static_cast<std::uint32_t>(k));
  });
  chunk.farthest = static_cast<double>(farthest);
  chunk.fastest = std::sqrt(fastest2);
}

template <int Dim>
void leave(const SphereStep& step, SphereChunk& chunk, const Sums<Dim>& sums) {
  using R = SphereRecord<Dim>;
  const SphereColumns& c = step.columns[chunk.phase];
  const double half = 0.5 * step.dt;
  chunk.each_moving([&](std::size_t k) {
    const double *from = step.records + k * R::size, *passive = step.passive + k * passive_size;
    const double* force = sums.of + (k - chunk.begin) * Sums<Dim>::size;
    const double inverse_mass = passive[passive_mass], radius = from[R::radius];
    const std::size_t at = k - c.first;
    for (std::size_t d = 0; d < Dim; ++d) {
      const double a = inverse_mass * force[d];
      c.acceleration[d][at] = a;
      c.position[d][at] = from[d];
      c.velocity[d][at] = from[R::velocity + d] + half * (passive[d] + a);
    }
    if (!c.spin[0]) return;
    for (std::size_t d = 0; d < R::spins; ++d) {
      const double rate = 2.5 * inverse_mass / (radius * radius) * force[(Dim == 2 ? 2 : 4) + d];
      c.spin_rate[d][at] = rate;
      c.spin[d][at] = from[R::spin + d] + half * rate;
    }
  });
}

/// How far the forces on the border's spheres are out of the balance in which they fell asleep: those of spheres that
/// are awake, which alone change. Means over `lag`, so that what only vibrates wakes nobody: a force F that lasts a
/// time t much shorter counts as F t/lag. Who feels more than `tolerance` wakes.
template <int Dim>
void watch_border(const SleepStep& sleep, const SphereStep& step, SphereChunk& chunk, const Sums<Dim>& sums) {
  constexpr std::size_t spins = SphereRecord<Dim>::spins, numbers = Dim + spins, torque = Dim == 2 ? 2 : 4;
  const double share = step.dt / (sleep.lag + step.dt);
  for (const std::uint32_t k : chunk.border) {
    const double* force = sums.of + (k - chunk.begin) * Sums<Dim>::size;
    double *offset = sleep.offset + sleep.numbers[k] * numbers, *unrest = sleep.unrest + sleep.numbers[k] * numbers;
    const bool fresh = sleep.fresh[sleep.numbers[k]] != 0;
    sleep.fresh[sleep.numbers[k]] = 0;
    double push2 = 0.0, turn2 = 0.0;
    for (std::size_t d = 0; d < numbers; ++d) {
      const double now = force[d < Dim ? d : torque + d - Dim];
      if (fresh) offset[d] -= now;
      unrest[d] += share * (now + offset[d] - unrest[d]);
      (d < Dim ? push2 : turn2) += unrest[d] * unrest[d];
    }
    const double most = sleep.tolerance / step.passive[k * passive_size + passive_mass],
                 lever = step.records[k * SphereRecord<Dim>::size + SphereRecord<Dim>::radius];
    if (push2 <= most * most && turn2 <= most * most * lever * lever) continue;
    sleep.wakes[sleep.numbers[k]] = 1;
    chunk.wakes = true;
  }
}

}  // namespace barchan::BARCHAN_TARGET::sphere_motion
