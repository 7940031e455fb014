// What the models of a scene made of its phases and entries: the sizes and rules that all later work takes from here.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "base/fields.hpp"
#include "engine/neighbours.hpp"
#include "scene/scene.hpp"
#include "state/access.hpp"
#include "state/rigid_body.hpp"

namespace barchan {

/// What an entry of the matrix does; it follows from the kinds of its two phases (models/catalogue.cpp).
enum class EntryKind {
  fluid,      // fluid-fluid: pressure, viscosity, density diffusion
  boundary,   // fluid-wall: pressure and velocity extended into the wall (Adami et al. 2012)
  repulsive,  // fluid-wall: one row of ghosts that push (Halik et al. 2015, section 6; Monaghan 1994)
  coupling,   // fluid-grains, fluid-elastic: the solid is a moving wall and feels the reaction
  column,     // column-grains: drag in a wind by height
  drag,       // fluid-spheres: wind over sand, in layers near the ground (models/coupling/sand_layer.hpp)
  contact,    // grains with grains, walls or bodies
  elastic,    // elastic-elastic: stress
};
inline std::string to_string(EntryKind kind) {
  switch (kind) {
    case EntryKind::fluid: return "fluid";
    case EntryKind::boundary: return "boundary";
    case EntryKind::repulsive: return "repulsive";
    case EntryKind::coupling: return "coupling";
    case EntryKind::column: return "column";
    case EntryKind::drag: return "drag";
    case EntryKind::contact: return "contact";
    case EntryKind::elastic: return "elastic";
  }
  return "";
}

/// How a turbulent fluid rubs on the other side of an entry (models/fluid/turbulence.hpp).
enum class Friction {
  fluid,   // through the viscosity of both particles
  smooth,  // no slip: eddies vanish at the surface
  slip,    // free slip
  rough,   // the logarithmic law
  driven,  // a given stress
  grains,  // the logarithmic law, as a viscosity of the pair, so that the grain feels it too
};

/// The kernel sums of an entry on a regular lattice of its spacing; 1 and 1 are the truth.
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
  EntryKind kind = EntryKind::fluid;
  std::size_t fluid = 0, other = 0;         // of laws between a fluid and something else: which is which
  ContactLaw contact = ContactLaw::kernel;  // of EntryKind::contact
  KernelKind kernel = KernelKind::cubic_spline;
  double radius = 0;   // m; of spheres the distance at which the largest touch
  double spacing = 0;  // m, of its coarser phase
  Consistency consistency;
  bool corrected = false;            // the consistent scheme divides by these sums: exact to first order all the same
  double drag = 0;                   // drag coefficient, 0: none
  DragLaw drag_law = DragLaw::none;  // of grains in a column
  double lift = 0.0, gusts = 0.0;    // of grains by such a law in a fluid
  bool of_bodies = false;            // of EntryKind::contact: bodies that touch at their spacings
  bool of_surfaces = false;          // of these: their outlines touch, not their particles
  bool of_many_elastic = false;      // of these: an elastic body of several particles is in it
  double restitution = 1, friction = 0;  // of such
  int forward = -1, backward = -1;       // directions: a looks for b, b looks for a; -1: not needed
  bool has(std::size_t phase) const { return a == phase || b == phase; }
  std::size_t partner(std::size_t phase) const { return a == phase ? b : a; }
  /// The direction in which this phase looks for its partner.
  int direction(std::size_t phase) const { return a == phase ? forward : backward; }
  bool of_spheres() const { return kind == EntryKind::contact && barchan::of_spheres(contact); }
  bool sees_solid() const { return kind == EntryKind::boundary || kind == EntryKind::coupling; }
  /// The other phase is part of the neighbourhood in which a fluid sums its rates.
  bool continues_fluid() const { return kind == EntryKind::fluid || sees_solid(); }
};

/// How the watch guards the particles of a phase (simulation/watch.hpp), and the words in which it tells of them.
struct PhaseRules {
  double way = 0;                       // m a step
  double signal_speed = 0;              // m/s; what is faster is wrong
  bool contacts_limit_speed = false;    // the energy that its contacts can store bounds the speed
  double density_share = 0;             // |rho/rho0 - 1| at most; 0: the density must be above zero only
  double idle = 0.1;                    // of the sound speed: motion that disorder alone may cause
  bool pressure_stores_energy = false;  // the pressure of the start may become motion
  bool pairs_up = false;                // its own particles may stand in pairs: they are searched
  bool stops_at_sides = false;          // a centre beyond a closed side is in the wall
  bool solid = false;                   // its contacts must be looked at the sooner, the faster it is
  std::string one = "particle";         // of it
  std::string if_not_finite;            // "raise ...", for each fault what to change
  std::string if_passed, if_dense;
  std::function<std::string(double speed, double bound)> if_fast;  // "is faster than" what, and what to change
  std::function<std::string(double speed)> if_far;                 // moves too far in one step
  std::string stiffness_key;                                       // of its contacts
};

struct PlanPhase {
  std::string name;
  std::string kind;  // as the scene calls it
  std::size_t count = 0;
  double spacing = 0;           // m, of its particles at the start
  double diameter = 0;          // m, mean, of spheres; 0: its particles are not spheres
  double largest_diameter = 0;  // m
  double mass = 0;              // kg a particle (per metre of depth in 2D); of spheres that of the mean diameter
  double sound_speed = 0;       // m/s: of the equation of state, of compression waves, of a contact; 0 for walls
  double smoothing_length = 0;  // m
  Friction friction = Friction::smooth;       // of a turbulent fluid on it
  bool moves = true;                          // false: its particles stay in place
  bool flows = false;                         // a fluid: has a pressure of its own
  bool held = false;                          // a fluid whose bulk speed is held
  bool free_surface = false;                  // a fluid that does not fill its space
  std::array<std::array<bool, 2>, 3> open{};  // sides of the domain through which it leaves, by axis: {lower, upper}
  bool eddies = false;                        // a fluid whose viscosity varies, or with a wall whose stress is given
  bool body = false;                          // elastic
  bool fixed_neighbours = false;        // a body whose neighbours are those of its first shape: nobody searches them
  bool heats = false;                   // a solid in a fluid whose internal energy is asked for
  bool enclosed = false;                // a fluid whose mean density is kept
  double wind = 0;                      // m/s, what a column of air can reach: a bound for the watch
  std::string enclosure = "";           // why it is enclosed or not, of a fluid
  std::string physics = "";             // its name in the stability atlas (plan/stable_ranges.cpp); none: ""
  std::vector<RigidBody> rigid_bodies;  // at the start; none of a phase of another kind
  double weight_share = 1.0;            // of gravity, that grains feel: less than 1 with buoyancy
  double contact_stiffness = 0;         // N/m, of a rigid body with another (2D: N/m a metre)
  std::vector<Field> fields;
  PhaseRules rules;

  /// For a task that touches all of them.
  Touch all_fields() const { return {name, FieldSet(fields), FieldSet(fields)}; }
};

struct Layout {
  int dimensions = 2;
  double largest_speed = 0;  // m/s; the automatic sound speed is ten times this
  double slab = 1;    // m, in 2D the thickness of the slab of the spheres: the largest mean diameter; 1 without spheres
  double skin = 0.1;  // of the lists, in their radii; the widest
  Bounds bounds;
  std::vector<PlanPhase> phases;
  std::vector<PlanEntry> entries;
  std::vector<Direction> directions;
  bool leaves(std::size_t phase) const {  // some side is open to it
    const auto& o = phases[phase].open;
    return std::any_of(o.begin(), o.end(), [](const auto& ends) { return ends[0] || ends[1]; });
  }
  double particles() const;
  /// For a task that touches these of all phases.
  Touches of_all(const FieldSet& reads, const FieldSet& writes) const {
    Touches all;
    for (const auto& p : phases) all.push_back({p.name, reads, writes});
    return all;
  }
};

}  // namespace barchan
