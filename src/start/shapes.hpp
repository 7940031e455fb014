// Shape -> places of particles. Internal to src/start.
#pragma once

#include <functional>
#include <optional>

#include "scene/scene.hpp"
#include "start/generate.hpp"
#include "start/places.hpp"
#include "start/shared_start.hpp"

namespace barchan {

/// Particles that earlier fills have put somewhere: those inside the domain, and wall layers outside of it.
struct Occupied {
  Occupied(const PeriodicSpace& space, double widest)
      : inside(space, widest), outside(space, widest), fluids(space, widest), of_fluids(space, widest) {}

  Places inside, outside;
  // Where ranks share fluids out `inside` lacks these.
  PlacesOfFluids fluids;
  Places of_fluids;     // those that this rank asks for the fill that is made now
  bool by_all = false;  // they are this rank's alone, and the places of the fill are the same on all ranks

  /// For a fill, or a part of it, whose places are the same on all ranks.
  void ask_own() {
    if (fluids.empty()) return;
    of_fluids = fluids.own();
    by_all = true;
  }
  /// For this rank's part of a fill; all ranks call it. `reach` (m): how far others may be from these places.
  void ask_near(const std::vector<Vec3>& places, double reach) {
    if (fluids.empty()) return;
    of_fluids = fluids.near(places, reach);
    by_all = false;
  }
  /// Whether a particle inside the domain is nearer to x than `distance`, in spacings.
  bool is_taken(const Vec3& x, double spacing, double distance, int except = -1) const {
    return inside.owner_near(x, spacing, distance, except) >= 0 ||
           of_fluids.owner_near(x, spacing, distance, except) >= 0;
  }
};

/// Where a fill may have particles.
struct ShapeRegion {
  Vec3 lower{}, upper{};                    // m, of all places that could be inside
  Vec3 anchor{};                            // m, a place of the lattice
  std::function<bool(const Vec3&)> inside;  // of those between the two
};
/// Without what earlier fills hold. Nothing is bounded of a cube, points, a file and sides, which place their particles
/// themselves.
ShapeRegion region_of_shape(const Scene& scene, const Fill& fill);

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
/// `share`: of a fill that comes in rows, the part of them that is made.
/// Throws SceneError when the shape would need more than 10^9 places.
std::vector<Vec3> places_of(const Scene& scene, std::size_t k, Occupied& occupied,
                            const std::optional<ranks::Share>& share = {});

/// m, how far from a place of the k-th fill others can be that are too near it.
double reach_of_overlaps(const Scene& scene, std::size_t k);

/// Leaves out the grains that are outside the shape of the k-th fill, and their contacts.
void keep_inside(const Scene& scene, std::size_t k, SettledGrains& grains);

}  // namespace barchan
