// Scene -> Plan: the only place that decides what is needed. Everything after it obeys.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "base/fields.hpp"
#include "engine/neighbours.hpp"
#include "measure/instrument.hpp"
#include "scene/generate.hpp"
#include "scene/scene.hpp"

namespace barchan {

/// What an entry of the matrix does; it follows from the kinds of its two phases.
enum class Law {
  fluid,      // fluid-fluid: pressure, viscosity, density diffusion
  boundary,   // fluid-wall: pressure and velocity extended into the wall (Adami et al. 2012)
  repulsive,  // fluid-wall: one row of ghosts that push (Halik et al. 2015, section 6; Monaghan 1994)
  coupling,   // fluid-grains, fluid-elastic: the solid is a moving wall and feels the reaction
  contact,    // grains with grains, walls or bodies
  elastic,    // elastic-elastic: stress
};
std::string to_string(Law law);

/// The kernel sums of an entry on a regular lattice of the scene's spacing; 1 and 1 are the truth.
struct Consistency {
  int neighbours = 0;
  double volume_sum = 0;    // sum V W, the particle itself included
  double gradient_sum = 0;  // -sum V x dW/dx
  /// Within 3 % of the truth without any correction.
  bool consistent() const { return std::abs(volume_sum - 1) < 0.03 && std::abs(gradient_sum - 1) < 0.03; }
};
Consistency lattice_consistency(KernelKind kernel, double radius_in_spacings, int dimensions);

struct PlanEntry {
  std::size_t a = 0, b = 0;  // phase numbers, a <= b
  std::string name;          // "air-sand"
  Law law = Law::fluid;
  KernelKind kernel = KernelKind::cubic_spline;
  double radius = 0;  // m
  Consistency consistency;
  bool corrected = false;           // the consistent scheme divides by these sums: exact to first order all the same
  double drag = 0;                  // drag coefficient, 0: none
  int forward = -1, backward = -1;  // directions: a looks for b, b looks for a; -1: not needed
};

struct PlanPhase {
  std::string name;
  PhaseKind kind = PhaseKind::fluid;
  std::size_t count = 0;
  double mass = 0;              // kg a particle (per metre of depth in 2D)
  double sound_speed = 0;       // m/s: of the equation of state, of compression waves, of a contact; 0 for walls
  double smoothing_length = 0;  // m
  bool held = false;            // a fluid whose bulk speed is held
  bool free_surface = false;    // a fluid that does not fill its space
  bool eddies = false;          // a fluid whose viscosity varies, or with a wall whose stress is given
  bool enclosed = false;        // a fluid whose mean density is kept
  std::string enclosure = "";   // why it is enclosed or not, of a fluid
  std::vector<Field> fields;
};

/// A bound on the time step. `value` is at the start; limits that follow the motion are renewed every step.
struct StepLimit {
  std::string name;  // "acoustic air", "viscous air", "force", "elastic a", "contact sand"
  double value = 0;  // s
  std::string reason;
};

struct Plan {
  int dimensions = 2;
  double spacing = 0;        // m
  double largest_speed = 0;  // m/s, what the automatic sound speed is ten times of
  Bounds bounds;
  std::vector<PlanPhase> phases;
  std::vector<PlanEntry> entries;
  std::vector<Direction> directions;
  std::vector<StepLimit> limits;
  std::vector<std::string> passes, skipped;  // by the names of the timers
  std::vector<Instrument> instruments;       // what is measured
  double skin = 0.1;
  double particles() const;
  double step() const;                ///< the smallest limit, s (or the fixed step)
  double fixed_step = 0;              // s, 0: none
  std::vector<std::string> warnings;  // what the scene may mean otherwise, one sentence each
};

/// Decides. What no law can do was refused when the scene was read (scene/check_physics.cpp). Throws SceneError where
/// only the particles show a mistake: no speed to choose a sound speed from.
Plan make_plan(const Scene& scene, const std::vector<ParticleBlock>& blocks);

/// Fills Plan::warnings; the last work of make_plan.
void add_warnings(const Scene& scene, Plan& plan);

/// The plan as a person reads it (estimate.hpp has it as JSON).
std::string to_text(const Plan& plan, const Scene& scene);

}  // namespace barchan
