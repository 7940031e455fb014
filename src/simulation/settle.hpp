// Fills with packing = "settled": grains that fell and came to rest before the run begins.
#pragma once

#include <map>
#include <ostream>

#include "start/generate.hpp"
#include "state/archive.hpp"

namespace barchan {

/// The grains of every settled fill, at rest. A checkpoint keeps them, so that a continued run takes them from there.
struct SettledBeds {
  std::map<std::size_t, SettledGrains> of_fill;

  /// Nothing is saved or loaded for a scene without settled fills. Throws SceneError.
  void archive(Archive& a, const Scene& scene);
};

/// The initial particles of a scene, its settled fills included: generate() with settle(). Fills that `beds` holds
/// are taken from there, the others are added to it. `words`, if any, is told what settles: deep beds take minutes.
std::vector<ParticleBlock> make_particles(const Scene& scene, std::ostream* words = nullptr,
                                          SettledBeds* beds = nullptr);

/// Lets the grains of a fill fall into the box about its shape, over the walls that are there, with the contact laws of
/// the scene and a restitution of 0.2, until they rest; keeps those whose centres are inside the shape. The box is as
/// wide as the shape and stays periodic where the shape fills a periodic axis; its other sides hold the grains.
/// Those of a file rest where it has them; all are kept.
/// Uses at most the threads that OpenMP is set to. Throws SceneError when they do not come to rest.
SettledGrains settle(const Scene& scene, std::size_t fill, std::ostream* words = nullptr);

}  // namespace barchan
