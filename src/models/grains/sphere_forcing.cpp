#include "models/grains/sphere_forcing.hpp"

#include <omp.h>

#include <algorithm>
#include <cmath>

namespace barchan {

namespace {

Vec3 place_of(const SphereColumns& c, std::size_t sphere, std::size_t dimensions) {
  Vec3 x{};
  for (std::size_t d = 0; d < dimensions; ++d) x[d] = c.position[d][sphere - c.first];
  return x;
}

}  // namespace

void SphereForcing::add(const Scene& scene, std::size_t phase) {
  Forces forces(scene, scene.phases[phase].name);
  if (!forces.varies()) return;
  scene_ = &scene;
  dimensions_ = scene.dimensions;
  phases_.push_back({phase, {}});
  phases_.back().of_thread.push_back(std::move(forces));
}

void SphereForcing::make_room(std::size_t moving) {
  if (!any()) return;
  fit(steady_, moving * static_cast<std::size_t>(dimensions_));
  const auto threads = static_cast<std::size_t>(std::max(omp_get_num_procs(), omp_get_max_threads()));
  for (Forced& forced : phases_)
    while (forced.of_thread.size() < threads) forced.of_thread.emplace_back(*scene_, scene_->phases[forced.phase].name);
}

/// Of the present thread; null: the forcing of the phase is the same everywhere and always.
Forces* SphereForcing::of(std::size_t phase) {
  for (Forced& forced : phases_)
    if (forced.phase == phase) return &forced.of_thread[static_cast<std::size_t>(omp_get_thread_num())];
  return nullptr;
}

/// Calls f(chunk, forces) for the chunks whose phase is forced, in parallel.
template <class F>
void SphereForcing::each_chunk(std::span<const SphereChunk> chunks, F&& f) {
  const auto n = static_cast<std::int64_t>(chunks.size());
#pragma omp parallel for schedule(static)
  for (std::int64_t c = 0; c < n; ++c) {
    const SphereChunk& chunk = chunks[static_cast<std::size_t>(c)];
    if (const Forces* forces = of(chunk.phase)) f(chunk, *forces);
  }
}

double SphereForcing::stiffest(std::span<const SphereChunk> chunks, const SphereColumns* columns, double time,
                               double apart) {
  double stiffest = 0.0;
  each_chunk(chunks, [&](const SphereChunk& chunk, const Forces& forces) {
    double most = 0.0;
    for (std::size_t k = chunk.begin; k < chunk.end; ++k) {
      const Vec3 x = place_of(columns[chunk.phase], k, static_cast<std::size_t>(dimensions_));
      most = std::max(most, forces.stiffness(x, time, dimensions_, apart));
    }
#pragma omp critical(sphere_forcing)
    stiffest = std::max(stiffest, most);
  });
  return stiffest;
}

void SphereForcing::begin(std::span<const SphereChunk> chunks, const SphereColumns* columns, const double* passive,
                          double time) {
  const auto dimensions = static_cast<std::size_t>(dimensions_);
  each_chunk(chunks, [&](const SphereChunk& chunk, const Forces& forces) {
    for (std::size_t k = chunk.begin; k < chunk.end; ++k) {
      const Vec3 a = forces.varying(place_of(columns[chunk.phase], k, dimensions), time, dimensions_);
      for (std::size_t d = 0; d < dimensions; ++d) steady_[k * dimensions + d] = passive[k * passive_size + d] - a[d];
    }
  });
}

void SphereForcing::push(const SphereChunk& chunk, const double* records, double* passive, double time) {
  const Forces* const forces = of(chunk.phase);
  if (!forces) return;
  const auto dimensions = static_cast<std::size_t>(dimensions_);
  const std::size_t stride = dimensions == 2 ? SphereRecord<2>::size : SphereRecord<3>::size;
  chunk.each_moving([&](std::size_t k) {
    Vec3 x{};
    for (std::size_t d = 0; d < dimensions; ++d) x[d] = records[k * stride + d];
    const Vec3 a = forces->varying(x, time, dimensions_);
    for (std::size_t d = 0; d < dimensions; ++d) passive[k * passive_size + d] = steady_[k * dimensions + d] + a[d];
  });
}

}  // namespace barchan
