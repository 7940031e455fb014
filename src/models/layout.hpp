// What the models of a scene made of its phases and entries: the sizes and rules that all later work takes from here.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <initializer_list>
#include <string>
#include <vector>

#include "base/fields.hpp"
#include "engine/neighbours.hpp"
#include "scene/scene.hpp"
#include "start/flow_ends.hpp"
#include "state/access.hpp"
#include "state/rigid_body.hpp"

namespace barchan {

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
  double surface_sum = 0;   // -dx sum V dW/dy over all rows below that of the particle
  /// Within 3 % of the truth without any correction.
  bool consistent() const { return std::abs(volume_sum - 1) < 0.03 && std::abs(gradient_sum - 1) < 0.03; }
};
Consistency lattice_consistency(KernelKind kernel, double radius_in_spacings, int dimensions);

/// Who finds the pairs of an entry, and when they act.
enum class Pairs {
  searched,             // the engine makes lists of them
  own,                  // its model finds them: winds over grains, surfaces of elastic bodies
  first_shape,          // those of the body's first shape, found once: total Lagrangian
  outlines,             // outlines of rigid bodies touch, and no particle feels anything by itself
  spheres,              // models/grains/spheres.hpp, in steps of its own
  spheres_and_outlines  // the same, of spheres on outlines of walls and bodies
};

/// An entry of the matrix. Its numbers are those of the scene; its model declares the rest (a `describe_...` function
/// that models/catalogue.cpp chooses). Where nothing is declared, the defaults hold.
struct PlanEntry {
  std::size_t a = 0, b = 0;          // phase numbers, a <= b
  std::string name;                  // "air-sand"
  std::size_t fluid = 0, other = 0;  // of a law between a fluid or a wind and another phase: which is which
  Interaction given;                 // the entry of the scene
  KernelKind kernel = KernelKind::cubic_spline;
  double radius = 0;   // m; where sizes decide who touches, the distance at which the largest particles touch
  double spacing = 0;  // m, of its coarser phase
  Consistency consistency;
  bool corrected = false;           // its law divides by these sums: it is exact to first order all the same
  int forward = -1, backward = -1;  // directions: a looks for b, b looks for a; -1: not needed

  // What the plan prints. The model of every law sets both.
  std::string law;      // its word, "coupling"; of a contact of spheres that of the scene, "hertz"
  std::string meaning;  // what its kernel sums mean, or what decides in their place

  // What the engine and other models ask. In brackets: which laws set it.
  Pairs pairs = Pairs::searched;
  bool continues_fluid = false;  // a fluid sums its rates over these pairs [fluid, boundary, coupling]
  bool extends = false;          // the fluid is extended into the other phase: extended records [boundary, coupling]
  bool reads_stress = false;     // its law reads the stress records of both phases [bodies, updated Lagrangian]
  bool self_contact = false;     // parts of one body touch that are far apart in its first shape [contact of bodies]
  bool gives_length = false;    // half of its radius is the smoothing length of a phase that has none [grains, spheres]
  bool blows = false;           // `fluid` is a wind over grains: it drives them, and they brake it [winds over grains]
  bool wind_by_height = false;  // the same by its height (State::air): no other particle loses what it gives [column]

  // What the watch, the budget and the warnings ask.
  bool keeps_apart = false;   // two particles never stand in one place: the watch looks at its lists [contacts, bodies]
  double stopping_depth = 0;  // m: it stops grains up to sound speed times this over the distance of two that touch;
                              // 0: the watch has no such bound [contact through a kernel]
  bool feels_lattice = false;  // bodies touch the particles of a wall, whose lattice is rough [contact of bodies]

  bool has(std::size_t phase) const { return a == phase || b == phase; }
  bool own_steps() const { return pairs == Pairs::spheres || pairs == Pairs::spheres_and_outlines; }
  bool by_outlines() const { return pairs == Pairs::outlines || pairs == Pairs::spheres_and_outlines; }
  std::size_t partner(std::size_t phase) const { return a == phase ? b : a; }
  /// The direction in which this phase looks for its partner.
  int direction(std::size_t phase) const { return a == phase ? forward : backward; }
};

/// Declares that the law of an entry weighs with the kernel of the scene, and what its sums on a lattice are.
void describe_kernel_sums(const Interaction& pair, int dimensions, PlanEntry& e);
/// The same of a law that approximates integrals by these sums. `correction`: what makes it exact to first order, "by
/// the consistent scheme"; empty: nothing does.
void describe_approximation(const Interaction& pair, int dimensions, const std::string& correction, PlanEntry& e);

/// What is wrong with a particle.
enum class Fault { not_finite, passed_wall, density, too_fast, too_far, too_near };

/// How the watch guards the particles of a phase (simulation/watch.hpp), and the words in which it tells of them.
struct PhaseRules {
  double way = 0;               // m a step; 0: two smoothing lengths
  double signal_speed = 0;      // m/s; what is faster is wrong; 0: what its contacts can stop, by the energy they store
  double density_share = 0;     // |rho/rho0 - 1| at most; 0: the density must be above zero only
  double idle = 0.1;            // of the sound speed: motion that disorder alone may cause
  bool stops_at_sides = false;  // a centre beyond a closed side is in the wall
  std::string one = "particle";  // of it
  /// What to change, "raise ...", of a particle too fast or too far with its speed and the bound (m/s); too fast:
  /// "than" what, first. Not finite, too near: the key of what to raise.
  std::function<std::string(Fault fault, double speed, double bound)> remedy;
};

/// Whether output.fields names the field.
bool is_output(const Scene& scene, Field field);

/// What moves the particles of a phase.
enum class Mover {
  nothing,   // they stay, as those of a wall; or there are none, as in a column
  motion,    // a [[motion]] carries a wall as a rigid whole, which nothing pushes
  fluid,     // its pressure: it fills its room and gives way
  elastic,   // the stress of the body that they are
  rigid,     // the body that they are, as a whole
  contacts,  // of grains without a diameter
  spheres    // models/grains/spheres.hpp, in steps of its own
};

/// What a phase is to a fluid that flows along it.
struct Surface {
  Friction friction = Friction::smooth;  // of a turbulent fluid on it [fluid, grains, wall]
  double roughness = 0;                  // m, z0 of the logarithmic law; 0: smooth [grains, wall]
  Vec3 stress{};                         // Pa, with which it pulls a fluid [wall]
  double speed = 0;                      // m/s, the largest with which the scene lets it slide [wall]
};

/// What drives a wind over grains.
struct Wind {
  bool held = false;            // the bulk speed is held [fluid]
  bool driven = false;          // the scene says what drives it: the flux of grains is measured [fluid, column]
  double largest_speed = 0;     // m/s, that a column of air can reach: a bound for the watch [column]
  std::string beyond_measured;  // the warning of a wind beyond measurements; empty: the wind is within them [column]
  /// m/s at a time (s), the friction velocity that the scene states; empty: it states none [fluid, column].
  std::function<double(double time)> friction_velocity;
};

/// A phase as its model declares it: first what others ask while they describe themselves (`declare_...`), then all
/// else (`describe_...`). models/catalogue.cpp calls both. Where nothing is declared, the defaults hold.
struct PlanPhase {
  std::string name;
  std::string kind;  // as the scene calls it, for frames and the plan's text
  std::size_t count = 0;
  double spacing = 0;           // m, of its particles at the start
  double mass = 0;              // kg a particle (per metre of depth in 2D); of spheres that of the mean diameter
  double sound_speed = 0;       // m/s: of the equation of state, of compression waves, of a contact; 0 for walls
  double smoothing_length = 0;  // m

  // Declared first. In brackets: which kinds set it.
  Mover mover = Mover::nothing;
  bool sphere_records = false;  // its particles have records of contacts of spheres [grains and walls with a diameter]
  double diameter = 0;          // m, mean, that the scene gives grains; 0: it gives none [grains]
  double largest_size = 0;      // m, across the largest particle [grains], else the spacing
  double weight_share = 1.0;    // of gravity, that grains feel: less than 1 with buoyancy [grains]
  Surface surface;

  // A fluid.
  bool free_surface = false;  // a fluid that does not fill its space
  std::array<std::array<bool, 2>, 3>
      open{};                      // sides of the domain behind which its particles are gone, by axis: {lower, upper}
  std::vector<FlowEnd> flow_ends;  // sides through which it enters or leaves, with their zones
  bool eddies = false;             // a fluid whose viscosity varies, or with a wall whose stress is given
  bool heats = false;              // a solid in a fluid whose internal energy is asked for [models/catalogue.cpp]
  bool enclosed = false;           // a fluid whose mean density is kept
  std::string enclosure = "";      // why a fluid is enclosed or not; empty: nobody asks

  Wind wind;
  std::vector<RigidBody> rigid_bodies;  // at the start [rigid]

  std::string physics = "";  // its name in the stability atlas (plan/stable_ranges.cpp); none: ""
  std::vector<Field> fields;
  std::vector<void (*)(PhaseParticles&)> derivations;  // of fields that only outputs read, before a frame and a row
  PhaseRules rules;

  /// Whether its particles are integrated in time; false: they stay in place, or a [[motion]] carries them.
  bool moves() const { return mover >= Mover::fluid; }
  bool travels() const { return mover == Mover::motion; }
  bool flows() const { return mover == Mover::fluid; }
  bool deforms() const { return mover == Mover::elastic; }
  bool own_steps() const { return mover == Mover::spheres; }
  /// Its particles move one by one: a fluid follows their velocities, not their blows.
  bool separate() const { return mover == Mover::contacts || own_steps(); }
  /// CommonWork ends its step, v += dt/2 a; false: its own model does.
  bool kicked() const { return flows() || deforms() || mover == Mover::contacts; }
  /// Its own model fills Workspace::carried, from which a fluid knows its motion.
  bool tells_motion() const { return mover == Mover::rigid; }
  /// A contact can push single particles; false: it is as hard as a wall.
  bool yields() const { return kicked() || own_steps(); }
  /// What pushes it loses momentum that no particle gets: a wall, a fluid that enters or leaves.
  bool takes_momentum() const { return !moves() || !flow_ends.empty(); }
  /// Its surface slides or pulls, or a fluid enters or leaves: the others get energy.
  bool gives_energy() const {
    return travels() || surface.friction == Friction::driven || surface.speed > 0.0 || !flow_ends.empty();
  }
  /// m, across a particle: the mean diameter, else the spacing.
  double size() const { return diameter > 0.0 ? diameter : spacing; }

  /// Fields that only outputs read: the phase has those that output.fields names, and `derive` makes them from the
  /// others.
  void derive_for_output(const Scene& scene, std::initializer_list<Field> of, void (*derive)(PhaseParticles&));

  /// For a task that touches all of them.
  Touch all_fields() const { return {name, FieldSet(fields), FieldSet(fields)}; }
};

struct Layout {
  int dimensions = 2;
  double largest_speed = 0;  // m/s; the automatic sound speed is ten times this
  double slab = 1;    // m, in 2D the thickness of the slab of the spheres: the largest mean diameter; 1 without spheres
  double skin = 0.1;  // of the lists, in their radii; the widest
  Bounds domain;      // that of the scene
  Bounds bounds;      // where particles may be: the domain, and the zones beyond sides through which a fluid flows
  std::vector<PlanPhase> phases;
  std::vector<PlanEntry> entries;
  std::vector<Direction> directions;
  bool leaves(std::size_t phase) const {  // some side is open to it
    const auto& o = phases[phase].open;
    return std::any_of(o.begin(), o.end(), [](const auto& ends) { return ends[0] || ends[1]; });
  }
  /// Whether some fluid flows through a side: then particles stand beyond the domain.
  bool flows_through() const {
    return std::any_of(phases.begin(), phases.end(), [](const PlanPhase& p) { return !p.flow_ends.empty(); });
  }
  /// Whether a particle stands in the domain, and not in a zone beyond a side through which a fluid flows.
  bool in_domain(const PhaseParticles& p, std::size_t k) const {
    for (const PlanPhase& phase : phases)
      for (const FlowEnd& end : phase.flow_ends)
        if (end.beyond(p.column(Field::position, static_cast<int>(end.axis()))[k]) > 0.0) return false;
    return true;
  }
  /// Whether some fluid is extended into the phase, which then has extended records.
  bool is_extended(std::size_t phase) const {
    return std::any_of(entries.begin(), entries.end(),
                       [&](const PlanEntry& e) { return e.extends && e.other == phase; });
  }
  /// m, at which the largest particles of an entry touch.
  double touching_distance(const PlanEntry& e) const {
    return 0.5 * (phases[e.a].largest_size + phases[e.b].largest_size);
  }
  double particles() const;
  /// Whether every rank of a run holds all particles of a phase and moves them: what is no fluid, and no wall that
  /// others look for.
  bool is_whole(std::size_t phase) const {
    const PlanPhase& p = phases[phase];
    return (p.moves() && !p.flows()) || std::none_of(directions.begin(), directions.end(),
                                                     [&](const Direction& d) { return d.a == phase || d.b == phase; });
  }
  /// For a task that touches these of all phases.
  Touches of_all(const FieldSet& reads, const FieldSet& writes) const {
    Touches all;
    for (const auto& p : phases) all.push_back({p.name, reads, writes});
    return all;
  }
};

/// Sums of a fluid's entry with itself, on a lattice.
const Consistency& own_consistency(const Layout& layout, std::size_t fluid);

}  // namespace barchan
