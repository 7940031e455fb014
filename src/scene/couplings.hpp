// Who acts on whom in a scene: questions that the checks and the plan share.
#pragma once

#include "scene/scene.hpp"

namespace barchan {

/// The entry of two phases in either order; null when there is none.
const Interaction* entry_between(const Scene& scene, const Phase& a, const Phase& b);

/// The phase of this name; null when there is none.
const Phase* find_phase(const Scene& scene, const std::string& name);

/// The spacing (m) of the particles of a fill: that of its phase.
double spacing_of(const Scene& scene, const Fill& fill);

/// The spacing (m) that a pair's radius counts in: that of its coarser phase.
double spacing_of(const Scene& scene, const Interaction& pair);

/// Whether the phase has an entry with another phase of this kind.
bool meets(const Scene& scene, const Phase& phase, PhaseKind kind);

/// Whether the phase has an entry with a fluid whose internal energy is asked for.
bool rubs_on_energy(const Scene& scene, const Phase& phase);

/// Whether the entry is a contact of spheres: touching decides, and its radius is not read.
inline bool of_spheres(const Interaction& pair) { return of_spheres(pair.law); }

/// Whether the phase has an entry with this law of contact.
bool touches_by(const Scene& scene, const Phase& phase, ContactLaw law);

/// Whether the phase has an entry of a fluid and grains with a law of drag by name.
bool drags_by_law(const Scene& scene, const Phase& phase);

/// The share of gravity that grains feel: 1 - rho_fluid/rho_grain with the fluids of entries with buoyancy, else 1.
double weight_share(const Scene& scene, const Phase& grains);

/// Whether particles of grains or bodies are moving walls in the fluid and may leave holes in it.
bool solids_move_in(const Scene& scene, const Phase& fluid);

/// A wall, an elastic or a rigid body.
bool is_wall_or_body(const Phase& phase);

/// Whether fluids end at the border of an elastic body, as it is deformed, and load that border
/// (models/coupling/elastic_in_fluid.hpp): a total Lagrangian body whose fills all have a surface, in laminar fluids of
/// the consistent scheme. Every other elastic body is a wall of particles to a fluid.
bool ends_at_border(const Scene& scene, const Phase& body);

/// The [[motion]] of a phase; of several the first; null: none.
const Motion* motion_of(const Scene& scene, const Phase& phase);

/// The force along x (Pa, on the area of the ground) with which walls with `shear-stress` pull a fluid: of the sides
/// bottom and top that they fill.
double wall_pull(const Scene& scene, const Phase& fluid);

/// Whether the fluid's viscosity varies or a wall that it feels says how it rubs: `turbulence`, or a wall with
/// `roughness` or `shear-stress`.
bool has_eddies(const Scene& scene, const Phase& fluid);

/// An elastic body whose strain comes from its first shape.
bool is_total(const Phase& phase);
/// Whether an updated Lagrangian body has artificial stress: then all of them have records of it.
bool has_artificial_stress(const Scene& scene);
/// Whether the two can have a contact of bodies: a body with another body or a wall; rigid bodies of one phase.
bool bodies_may_touch(const Phase& a, const Phase& b);
/// Whether they touch by their surfaces, not by their particles: rigid bodies with rigid bodies and walls.
bool touch_by_surfaces(const Phase& a, const Phase& b);
/// Dimensions of the facets of a shape: 2 of segments, 3 of triangles; 0 of shapes without facets.
int facet_dimensions(const Shape& shape);
/// Whether the shape says where its surface lies.
bool has_surface(const Shape& shape, int dimensions);
/// Whether all shapes of a wall say where their surfaces lie: a body then touches those, not the wall's particles.
bool has_surfaces(const Scene& scene, const Phase& wall);
/// Whether this entry is one: it says restitution, or a total Lagrangian or rigid body has no other.
bool touch_as_bodies(const Interaction& pair, const Phase& a, const Phase& b);
/// Whether the own entry of a total Lagrangian body says restitution: parts of it that are far apart in its first shape
/// touch each other.
bool touches_itself(const Interaction& pair, const Phase& a, const Phase& b);
/// Whether the phase has an entry of one of these two.
bool touches_as_body(const Scene& scene, const Phase& phase);

}  // namespace barchan
