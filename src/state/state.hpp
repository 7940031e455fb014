// What a step starts from: the particles, the clock and the step's own numbers. The epoch of the lists
// (engine/neighbours.hpp) and the models' few numbers belong to it too and are saved with it
// (simulation/simulation.hpp, archive).
#pragma once

#include <algorithm>
#include <deque>
#include <map>
#include <string>
#include <vector>

#include "state/air_profile.hpp"
#include "state/archive.hpp"
#include "state/particles.hpp"
#include "state/rigid_body.hpp"

namespace barchan {

/// What has been written so far; a run that is continued goes on from here.
struct OutputClock {
  long frames = 0;            // written
  long last_frame_step = -1;  // the step of the last frame
  double last_frame_time = 0.0;
  void archive(Archive& a);
};

/// Smaller steps for a while, after a step that failed (app/run.cpp).
struct Retreat {
  long count = 0;      // how often the run went back
  double share = 1.0;  // of the step that the limits allow
  double until = 0.0;  // s, from then on all of it
  void archive(Archive& a);
};

/// What left the run, of one phase: as it was when it left (SI; by metre of depth in 2D). Who makes particles books
/// them with the opposite sign.
struct Departed {
  std::int64_t phase = 0, particles = 0;
  double first = 0.0;  // s, when the first one left
  double mass = 0.0, kinetic = 0.0, potential = 0.0, stored = 0.0;
  Vec3 momentum{};
};

struct State {
  std::vector<PhaseParticles> phases;
  std::deque<AirProfile> air;      // wind by height: of phases that are air without particles, of layers over sand
  std::vector<RigidBody> bodies;   // rigid, in the order of their phases and fills
  std::vector<Departed> departed;  // of the models that take particles away or make them
  IdSource ids;                    // of the particles that will be made
  double time = 0.0, dt = 0.0;     // s
  long steps = 0;
  double largest_acceleration = 0.0;         // m/s2, of the last kick
  std::string ruling_limit;                  // of the last step
  std::map<std::string, long> limit_counts;  // steps by the limit that ruled
  OutputClock outputs;
  Retreat retreat;

  /// Particles of the same phases and counts must be there: loading overwrites their values.
  void archive(Archive& a);
};

/// Whether the phase consists of rigid bodies: its mass and its momentum are theirs, not those of its particles.
inline bool has_bodies(const State& state, std::size_t phase) {
  return std::any_of(state.bodies.begin(), state.bodies.end(),
                     [&](const RigidBody& body) { return body.phase == phase; });
}

}  // namespace barchan
