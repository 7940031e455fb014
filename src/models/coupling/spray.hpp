// Spray: particles of a fluid with a free surface that are alone, or in small groups, at the border of a body.
//
// A border has the pressure that the fluid about a place has there, as if that fluid covered it. A drop of one particle
// would press on all pieces within the radius of the fit, with the pressure and the sound of a whole fluid: a drop of
// 12 g m/s gave a flap 146, and 1.6 times its energy. So a particle counts in the fit by its wholeness chi
// (fluid_finish.hpp; one alone 0, at a wall -0.19, two there -0.11, a row on a wall or the top row of a pool 0.08,
// inside 0.95), and what it does not count acts on the nearest piece as the reaction to its own acceleration, across
// the border. What the border takes from such a particle that comes too near goes to the body as well; of whole fluid
// it does not: in single steps it broke up a rubber gate.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "base/vec3.hpp"
#include "engine/exchange.hpp"

namespace barchan {

struct Spray {
  static constexpr double alone = 0.0, whole = 0.07;  // wholeness

  /// How much a particle counts in the fit; 1 without a free surface.
  static double share(double wholeness) {
    const double t = std::clamp((wholeness - alone) / (whole - alone), 0.0, 1.0);
    return t * t * (3.0 - 2.0 * t);
  }

  /// How much of a place of a border is wet, by the distance of the nearest particle (spacings): fluid at a border has
  /// one within 0.9; beside the edge of a drop there is none.
  static double wet(double nearest) {
    const double t = std::clamp((dry_from - nearest) / (dry_from - wet_to), 0.0, 1.0);
    return t * t * (3.0 - 2.0 * t);
  }
  static constexpr double wet_to = 1.0, dry_from = 1.6;

  /// A force on a piece of a border.
  struct Push {
    std::uint32_t body, piece;  // number among the bodies; of the piece
    std::uint32_t held;         // 1: of a particle that came too near, 0: a reaction
    std::uint32_t none = 0;
    Vec3 arm, force;  // m, from the body's place; N (by metre of depth in 2D)
  };
  /// Of each thread, in the order of the particles; on several ranks of each rank its own.
  std::vector<std::vector<Push>> of_threads;
  std::vector<Push> all;

  /// A step begins, in which so many threads may push.
  void begin(std::size_t threads) {
    make_room(threads);
    for (auto& pushes : of_threads) pushes.clear();
  }
  void make_room(std::size_t threads) { of_threads.resize(std::max(of_threads.size(), threads)); }
  /// In the order of one process: `all` of every rank. Every rank calls it.
  void gather() {
    all.clear();
    for (const auto& pushes : of_threads) all.insert(all.end(), pushes.begin(), pushes.end());
    Exchange().join(all);
    std::stable_sort(all.begin(), all.end(), [](const Push& a, const Push& b) { return a.held > b.held; });
  }
};

}  // namespace barchan
