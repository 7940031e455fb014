// Scene -> initial particles. One block a phase, in the order of scene.phases.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "scene/scene.hpp"
#include "start/content.hpp"

namespace barchan {

/// A contact of a sphere that rests: what its slips carry, and where the other is.
struct RestingContact {
  std::uint64_t sphere = 0;  // its number in its block
  Vec3 branch{};             // m, from its centre to that of the other, or to the nearest place of a side of the domain
  Vec3 force{};              // N, tangential, on it
  Vec3 torque{};             // N m, of the rolling resistance, on it
};

/// Which of the particles of a phase, or of a fill, a rank has: `first` and those that follow, of `total`.
struct ParticlePiece {
  std::size_t first = 0, total = 0;
};

struct ParticleBlock {
  std::vector<Vec3> position;      // m
  std::vector<Vec3> velocity;      // m/s
  std::vector<double> pressure{};  // Pa, initial; empty when no fill of the phase gives one
  struct Part {
    std::size_t fill, first;        // number of the fill; its first particle here, the others follow
    std::optional<Content> body{};  // of a rigid body: what its shape holds
  };
  std::vector<Part> parts{};               // by fill of the phase, in order
  std::vector<double> radius{};            // m, of spheres; empty when the phase gives no diameter
  std::vector<RestingContact> contacts{};  // of spheres that settled; each once
  std::vector<Vec3> normal{};  // of fitted and relaxed walls: towards the nearest place of the surface; zero: not known
  std::vector<double> depth{};  // m, the distance to it; both empty when no fill of the phase is such a wall
  std::vector<std::array<double, 3>>
      bend{};  // 1/m, of fitted walls: second derivatives of the height, over sqrt(1 + slope^2)
  std::optional<ParticlePiece> piece{};  // of a fluid whose particles ranks share out; else all are here

  /// Of the phase: particles, and the number of the first one here.
  std::size_t count() const { return piece ? piece->total : position.size(); }
  std::size_t first() const { return piece ? piece->first : 0; }
};

/// Carries out the fills of the scene in order. Two-dimensional scenes have z = 0. Particle k of the scene gets id k,
/// counted through the blocks in order; the same scene gives the same particles bit for bit. On ranks that share
/// particles out (ranks::active(), where why_start_is_whole() is empty) each makes a piece of the fluids' blocks.
/// Throws SceneError when a periodic bed's rows do not fit the domain (and names the nearest size that does), when a
/// fill makes no particle, or when particles of different fills overlap (closer than 0.5 spacings).
/// Fills with packing = "settled" and those of a file take their places from `settle`, which gets the number of the
/// fill and what is there; without one they are refused (simulation/settle.hpp).
struct SettledGrains {
  std::vector<Vec3> position;  // m; those outside the fill's shape are left out
  std::vector<double> radius;  // m
  std::vector<RestingContact> contacts{};
};
using Settle =
    std::function<SettledGrains(const Scene& scene, std::size_t fill, const std::vector<ParticleBlock>& before)>;
std::vector<ParticleBlock> generate(const Scene& scene, const Settle& settle = {});

/// Distance of the places of a phase's fills: of spheres the largest diameter, else the scene's spacing.

/// Height of the ground (bed and dune of the first fill that has one) over the domain's bottom at x, z; 0 without a
/// bed.
double ground_height(const Scene& scene, double x, double z);

/// Heights (m, as coordinates) of the ground that fitted rows follow, at the nodes of a grid over the domain: counts[0]
/// intervals along x, counts[1] along z (0 in two dimensions), x fastest, both ends. Empty without such a ground.
std::vector<double> fitted_heights(const Scene& scene, const std::array<int, 2>& counts);

}  // namespace barchan
