// Shape -> places of particles. Internal to src/scene.
#pragma once

#include "scene/generate.hpp"
#include "scene/places.hpp"
#include "scene/scene.hpp"

namespace barchan {

/// Particles that earlier fills have put somewhere: those inside the domain, and wall layers outside of it.
struct Occupied {
  Places inside, outside;
};

/// Least distance, in the mean spacing of the two, that "the-rest" keeps from earlier particles. Below one, so that the
/// first row over a bed whose rows do not line up is not lost; a bed of rows lines up with the rest and is exactly one
/// spacing away.
inline constexpr double rest_distance = 0.75;

/// Particles of different fills may not be closer than this, in the mean spacing of the two.
inline constexpr double overlap_distance = 0.5;

/// Places of the k-th fill, wrapped into the domain along periodic axes, before `perturb`.
///   rows and staggered: lattice places inside the shape; a place on the lower bound is inside, on the upper one
///   outside. random: random sequential addition, 200 trials a spacing^d, no two nearer than a spacing; reaches 0.5
///   (2D, area) or
///           0.35 (3D, volume), close to the limits 0.547 and 0.384 (Feder 1980; Meakin and Jullien 1992).
/// Throws SceneError when the shape would need more than 10^9 places.
std::vector<Vec3> places_of(const Scene& scene, std::size_t k, const Occupied& occupied);

/// Leaves out the grains that are outside the shape of the k-th fill, and their contacts.
void keep_inside(const Scene& scene, std::size_t k, SettledGrains& grains);

}  // namespace barchan
