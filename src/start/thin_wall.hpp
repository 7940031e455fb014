// Walls between two spaces that are thinner than a kernel needs.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "scene/scene.hpp"
#include "start/generate.hpp"

namespace barchan {

/// Where a wall is thinnest.
struct ThinWall {
  Vec3 at{};          // m, one of its particles
  double rows = 0.0;  // between the two spaces
  bool wet[2]{};      // a fill of the fluid holds the nearest place on this side of it
};

/// The particles of a wall stand for a fluid on one side of it. One that has free space of two sides within the kernel
/// radius (m) of its entry with the fluid gets its pressure and velocity from both. Two places about such a particle
/// are of one side if a short way of free places joins them, as round an edge or a thin rod.
/// Layers outside the domain and beds have one side.
std::optional<ThinWall> thin_wall(const Scene& scene, const std::vector<ParticleBlock>& blocks, std::size_t wall,
                                  std::size_t fluid, double radius);

}  // namespace barchan
