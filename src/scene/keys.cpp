#include "scene/keys.hpp"

#include <cstdio>

#include "base/fields.hpp"
#include "scene/nearest.hpp"

namespace barchan {
namespace {

constexpr NumberBounds positive{.above = 0.0};
constexpr NumberBounds not_negative{.at_least = 0.0};

// Columns: section, name, what it accepts, unit, default, meaning; then bounds, words, variables and kinds where they
// apply.
// clang-format off
constexpr Key table[] = {
    {"", "title", as_text, "", "the file's name", "What the scene shows, in a few words."},
    {"", "state", as_text, "", "none", "Name of the ParaView state (in pvstate/) that renders this scene."},
    {"", "dimensions", as_integer, "", "2", "Dimensions of space, 2 or 3; vectors have as many components.",
     {.at_least = 2, .at_most = 3}},
    {"", "spacing", as_number, "m", "required", "Distance between neighbouring particles, dx.", positive},
    {"", "precision", as_word, "", "mixed", "Arithmetic of the pair loops; the state is always kept in double precision.",
     {}, "double|mixed"},
    {"", "domain", as_section, "", "required", "The box of the computation."},
    {"", "phases", as_named_sections, "", "required",
     "One section a phase; a name is a letter followed by letters, digits and underscores."},
    {"", "interactions", as_section, "", "required",
     "The matrix of kernel radii, Halik et al. 2015 eq. (15)-(17): one entry a pair of phases, as in air-sand = 2.5. "
     "A pair without an entry does not interact."},
    {"", "fill", as_sections, "", "required", "What is where at the beginning; fills are carried out in order."},
    {"", "forcing", as_sections, "", "none", "Body forces on single phases."},
    {"", "probe", as_sections, "", "none", "Places at which a fluid is followed in time."},
    {"", "profile", as_sections, "", "none", "Averages over time along a line."},
    {"", "grid", as_sections, "", "none", "Averages over time on a regular grid."},
    {"", "wall-shear", as_sections, "", "none", "Shear stress and pressure along a no-slip wall, averaged over time."},
    {"", "time", as_section, "", "required", "How long, and in which steps."},
    {"", "output", as_section, "", "first and last frame", "What is written, and how often."},

    {"domain", "origin", as_vector, "m", "zero", "Lower corner."},
    {"domain", "size", as_vector, "m", "required",
     "Lengths along x, y (and z). Along a periodic axis a whole number of spacings, and more than two kernel radii.", positive},
    {"domain", "periodic", as_words, "", "none", "Axes along which the domain repeats itself.", {}, "x|y|z"},
    {"domain", "gravity", as_vector, "m/s2", "zero", "Acceleration of gravity, on every phase but walls."},

    {"phases", "kind", as_word, "", "required", "What the phase is made of.", {}, "fluid|elastic|grains|wall"},
    {"phases", "density", as_number, "kg/m3", "required; of a wall: that of a phase it interacts with",
     "Density at rest. Of grains: that of the grain's material.", positive, "", "", "", "wall"},
    {"phases", "viscosity", as_number, "m2/s", "0", "Kinematic viscosity.", not_negative, "", "", "fluid"},
    {"phases", "sound-speed", as_number, "m/s", "10 times the largest speed",
     "Numerical speed of sound; ten times the largest speed keeps the density within a percent.", positive, "", "", "fluid"},
    {"phases", "equation-of-state", as_word, "", "linear", "Pressure as a function of density.", {}, "linear|tait", "", "fluid"},
    {"phases", "tait-exponent", as_number, "", "7", "Exponent of Tait's equation of state, only with equation-of-state = \"tait\".", positive, "", "", "fluid"},
    {"phases", "artificial-viscosity", as_number, "", "0", "Monaghan's alpha.", not_negative, "", "", "fluid|elastic"},
    {"phases", "artificial-viscosity-beta", as_number, "", "0", "Monaghan's beta.", not_negative, "", "", "elastic"},
    {"phases", "density-diffusion", as_number, "", "0.05", "Delta of delta-SPH; 0 switches it off.", not_negative, "", "", "fluid"},
    {"phases", "enclosed", as_boolean, "", "true of a fluid that is shut in",
     "The fluid fills a closed space: its mean density is kept. barchan plan says what it is and why.", {}, "", "", "fluid"},
    {"phases", "shifting", as_number, "", "1", "Strength of particle shifting; 0 switches it off.", not_negative, "", "", "fluid"},
    {"phases", "background-pressure", as_number, "rho c2", "0", "Pressure at rest, in units of density times sound speed squared.",
     not_negative, "", "", "fluid"},
    {"phases", "scheme", as_word, "", "consistent", "Gradient operators: as they are, or corrected to first order (docs/method.md).", {},
     "plain|consistent", "", "fluid"},
    {"phases", "turbulence", as_word, "", "none",
     "Eddy viscosity of the unresolved turbulence: (0.4 d)^2 |S| with d the distance to the ground, or (C_s dx)^2 |S|.", {},
     "none|mixing-length|smagorinsky", "", "fluid"},
    {"phases", "smagorinsky", as_number, "", "0.15", "C_s, only with turbulence = \"smagorinsky\".", positive, "", "", "fluid"},
    {"phases", "young", as_number, "Pa", "required", "Young's modulus.", positive, "", "", "elastic"},
    {"phases", "poisson", as_number, "", "0", "Poisson's ratio.", {.above = -1.0, .below = 0.5}, "", "", "elastic"},
    {"phases", "energy", as_boolean, "", "false", "Integrate the internal energy, Halik et al. 2015 eq. (13). Of a fluid: only with scheme = \"plain\".", {}, "", "",
     "fluid|elastic"},
    {"phases", "restitution", as_number, "", "0.7",
     "Speed after over speed before a head-on collision of two grains. Quartz: 0.7 to 0.8; with 1 a bed never comes to rest.",
     {.at_most = 1.0, .above = 0.0}, "", "", "grains"},
    {"phases", "contact-speed", as_number, "m/s", "chosen by the plan", "Square root of a contact's stiffness over density.",
     positive, "", "", "grains"},
    {"phases", "law", as_word, "", "adami", "How the wall acts: Adami et al. 2012, or one row of ghosts that repel (Halik et al. 2015).",
     {}, "adami|repulsive", "", "wall"},
    {"phases", "slip", as_word, "", "no-slip", "Whether the fluid sticks to the wall; only with law = \"adami\".", {}, "no-slip|free-slip", "", "wall"},
    {"phases", "velocity", as_formulas, "m/s", "zero",
     "Velocity at which the surface of a no-slip wall slides along itself, a function of time. Only fluids feel it; the wall stays where it is.", {}, "", "t", "wall"},
    {"phases", "roughness", as_number, "m", "smooth; of grains in turbulent air: a thirtieth of the spacing",
     "Roughness length z0: the wall's shear stress is that of the logarithmic law at the particles next to it.", positive, "", "",
     "wall|grains"},
    {"phases", "shear-stress", as_vector, "Pa", "none",
     "Force by area of the wall on the fluid, instead of no slip; its part along the wall counts.", {}, "", "", "wall"},

    {"interactions", "kernel", as_word, "", "wendland-c2 with a fluid, else cubic-spline", "Kernel of every pair that does not name its own.", {},
     "cubic-spline|wendland-c2"},
    {"interactions.pair", "radius", as_number, "spacings", "2.1 with a fluid, 1.1 of a contact; of bodies and repulsive walls required",
     "Kernel radius (support).", {.at_most = 8.0, .above = 0.0}},
    {"interactions.pair", "drag", as_number, "", "0", "Fluid with grains: drag coefficient of a grain, for the form drag that one spacing cannot resolve.", not_negative},
    {"interactions.pair", "kernel", as_word, "", "that of [interactions]", "Kernel of this pair.", {}, "cubic-spline|wendland-c2"},

    {"fill", "phase", as_text, "", "required", "Phase of the particles."},
    {"fill", "shape", as_word | as_section, "", "required",
     "Where: one shape, or \"the-rest\" for what earlier fills left free (above the ground, if there is a bed).", {}, "the-rest"},
    {"fill", "packing", as_word, "", "rows",
     "Square lattice, close-packed lattice, random without overlap (up to 0.5 of the area or 0.35 of the volume), or rows that "
     "follow the ground: a bed of a wall, and the fluid above it. Fluids and elastic bodies take rows or fitted.", {},
     "rows|staggered|random|fitted"},
    {"fill", "perturb", as_number, "spacings", "0", "Every coordinate is moved by a random number of at most this size.",
     {.at_least = 0.0, .at_most = 0.5}},
    {"fill", "seed", as_integer, "", "1", "Seed of the random numbers, of perturb and of the random packing.", {.at_least = 0, .at_most = 4294967295.0}},
    {"fill", "velocity", as_formulas | as_section, "m/s", "zero", "Initial velocity: components, or { log-profile = ... }.", {}, "",
     "x y z"},
    {"fill", "pressure", as_formula | as_word, "Pa", "0",
     "Initial pressure of a fluid; \"hydrostatic\": the weight of what lies above.", {}, "hydrostatic", "x y z"},

    {"fill.shape", "bed", as_number, "m", "", "Depth of a bed on the bottom of the domain.", not_negative},
    {"fill.shape", "from", as_number, "m", "0", "Only with bed: nothing below this height, where another fill made a floor.", not_negative},
    {"fill.shape", "dune", as_section, "", "none", "Only with bed: a dune on it."},
    {"fill.shape", "box", as_section, "", "", "Box."},
    {"fill.shape", "disc", as_section, "", "", "Disc; in 3D a cylinder along z."},
    {"fill.shape", "sphere", as_section, "", "", "Sphere; in 2D a disc."},
    {"fill.shape", "ring", as_section, "", "", "Ring; in 3D a tube along z."},
    {"fill.shape", "polygon", as_corners, "m", "", "Corners [x, y]; in 3D a prism along z."},
    {"fill.shape", "cube", as_section, "", "", "Square or cube of so many particles along each side."},
    {"fill.shape", "points", as_points, "m", "", "Single particles."},
    {"fill.shape", "formula", as_formula, "", "", "Particles where the formula is above zero.", {}, "", "x y z"},
    {"fill.shape", "sides", as_words, "", "",
     "Layers of wall particles outside the domain. bottom and top: y; left and right: x; back and front: z.", {},
     "bottom|top|left|right|front|back"},
    {"fill.shape", "layers", as_integer, "", "3; of a bed 4", "Only with sides or a fitted bed: number of layers.", {.at_least = 1, .at_most = 16}},
    {"fill.shape.dune", "form", as_word, "", "cosine",
     "cosine: H/2 (1 + cos(2 pi (x - at)/L)); gaussian: L is the width at half height; asymmetric: windward half cosine, straight slip "
     "face, L from toe to toe; rushil: the hills of Khurshudyan et al. 1981, L from toe to toe; formula.", {},
     "cosine|gaussian|asymmetric|rushil|formula"},
    {"fill.shape.dune", "height", as_number, "m", "required but for a formula", "Height H of the crest over the bed.", positive},
    {"fill.shape.dune", "length", as_number, "m", "required but for a formula", "Length L.", positive},
    {"fill.shape.dune", "at", as_number, "m", "required but for a formula", "x of the crest."},
    {"fill.shape.dune", "slip-face-angle", as_number, "degrees", "33", "Asymmetric only: angle of the lee side.",
     {.above = 0.0, .below = 90.0}},
    {"fill.shape.dune", "formula", as_formula, "m", "", "Form formula only: height over the bed.", {}, "", "x z"},
    {"fill.shape.box", "min", as_vector, "m", "required", "Lower corner."},
    {"fill.shape.box", "max", as_vector, "m", "required", "Upper corner."},
    {"fill.shape.disc", "centre", as_vector, "m", "required", "Centre; a particle sits on it."},
    {"fill.shape.disc", "radius", as_number, "m", "required", "Radius.", positive},
    {"fill.shape.sphere", "centre", as_vector, "m", "required", "Centre; a particle sits on it."},
    {"fill.shape.sphere", "radius", as_number, "m", "required", "Radius.", positive},
    {"fill.shape.ring", "centre", as_vector, "m", "required", "Centre."},
    {"fill.shape.ring", "inner", as_number, "m", "required", "Inner radius.", not_negative},
    {"fill.shape.ring", "outer", as_number, "m", "required", "Outer radius.", positive},
    {"fill.shape.cube", "centre", as_vector, "m", "required", "Centre."},
    {"fill.shape.cube", "count", as_integer, "", "required", "Particles along each side.", {.at_least = 1, .at_most = 4096}},

    {"fill.velocity", "log-profile", as_section, "", "required", "Logarithmic wind along x, Halik et al. 2015 eq. (18)."},
    {"fill.velocity.log-profile", "friction-velocity", as_number, "m/s", "required", "Friction velocity u*.", not_negative},
    {"fill.velocity.log-profile", "roughness", as_number, "m", "required", "Roughness length; no wind below it.", positive},
    {"fill.velocity.log-profile", "over-ground", as_boolean, "", "true",
     "Count the height from the ground (bed and dune) rather than from the bottom of the domain."},

    {"forcing", "phase", as_text, "", "required", "Phase that feels the force."},
    {"forcing", "acceleration", as_formulas, "m/s2", "none", "Acceleration; this or hold.", {}, "", "x y z t"},
    {"forcing", "hold", as_word, "", "none",
     "bulk-speed: the uniform acceleration that keeps the fluid's initial mean velocity along the periodic axes, as in a channel of "
     "constant mass flux. history.csv has it.", {}, "bulk-speed"},

    {"probe", "name", as_text, "", "required", "Letters, digits and underscores: it is written to probe_NAME.csv."},
    {"probe", "phase", as_text, "", "required", "Fluid that is followed."},
    {"probe", "at", as_vector, "m", "required", "Place."},
    {"probe", "every", as_number, "s", "that of history.csv", "Time between samples.", positive},
    {"probe", "start", as_number, "s", "0", "Time from which means and fluctuations are taken.", not_negative},

    {"profile", "name", as_text, "", "required",
     "Letters, digits and underscores: it is written to profile_NAME.csv and .vtp."},
    {"profile", "phase", as_text, "", "required", "Fluid that is measured; with box also grains."},
    {"profile", "from", as_vector, "m", "", "First point of a line on which the fluid is interpolated."},
    {"profile", "to", as_vector, "m", "", "Its last point."},
    {"profile", "box", as_section, "", "", "In place of from and to: bins, slices of this box, in which particles are averaged."},
    {"profile", "along", as_word, "", "y", "Only with box: axis along which the bins follow each other.", {}, "x|y|z"},
    {"profile", "count", as_integer, "", "one a spacing", "Number of points or bins.", {.at_least = 1, .at_most = 1000000}},
    {"profile", "every", as_number, "s", "that of history.csv", "Time between samples.", positive},
    {"profile", "start", as_number, "s", "0", "Time of the first sample.", not_negative},
    {"profile.box", "min", as_vector, "m", "required", "Lower corner."},
    {"profile.box", "max", as_vector, "m", "required", "Upper corner."},

    {"grid", "name", as_text, "", "required", "Letters, digits and underscores: it is written to grid_NAME.vti."},
    {"grid", "phase", as_text, "", "required", "Fluid that is measured."},
    {"grid", "min", as_vector, "m", "that of the domain", "Lower corner."},
    {"grid", "max", as_vector, "m", "that of the domain", "Upper corner; in 3D min and max with the same z (or x, y) make a plane."},
    {"grid", "spacing", as_number, "m", "that of the scene", "Distance between points, adjusted so that it divides the sides.", positive},
    {"grid", "every", as_number, "s", "that of history.csv", "Time between samples.", positive},
    {"grid", "start", as_number, "s", "0", "Time of the first sample.", not_negative},

    {"wall-shear", "name", as_text, "", "required",
     "Letters, digits and underscores: it is written to wall_shear_NAME.csv and .vtp."},
    {"wall-shear", "phase", as_text, "", "required", "Fluid that shears the wall."},
    {"wall-shear", "wall", as_text, "", "required", "No-slip wall, a fill with sides."},
    {"wall-shear", "side", as_word, "", "bottom", "Side of the domain on which the wall stands.", {}, "bottom|top"},
    {"wall-shear", "count", as_integer, "", "one a spacing", "Number of columns along x.", {.at_least = 1, .at_most = 1000000}},
    {"wall-shear", "every", as_number, "s", "that of history.csv", "Time between samples.", positive},
    {"wall-shear", "start", as_number, "s", "0", "Time of the first sample.", not_negative},

    {"time", "end", as_number, "s", "required", "Time at which the run ends.", positive},
    {"time", "step", as_number, "s", "from the stability limits", "Fixed time step.", positive},
    {"time", "safety", as_number, "", "1", "Factor on every stability limit; not with a fixed step.", {.at_most = 10.0, .above = 0.0}},
    {"time", "largest-speed", as_number, "m/s", "from the fills", "Largest speed that will occur; sets automatic sound speeds.",
     not_negative},

    {"output", "every", as_number, "s", "first and last only", "Time between frames.", not_negative},
    {"output", "history-every", as_number, "s", "a hundredth of the end time", "Time between rows of history.csv.", not_negative},
    {"output", "checkpoint-every", as_number, "s", "600", "Wall time between checkpoints; 0: at the end and at signals only.", not_negative},
    {"output", "fields", as_words, "", "none",
     "Fields beside id, phase, velocity, smoothing_length, density and pressure.", {}, "@fields"},
    {"output", "format", as_word, "", "vtp", "File format of the frames.", {}, "vtp|vtu"},
    {"output", "compress", as_boolean, "", "true", "Compress the frames."},
    {"output", "walls", as_boolean, "", "true", "Write wall particles too."},
};
// clang-format on

bool listed(std::string_view list, std::string_view word) {
  while (!list.empty()) {
    const std::size_t bar = list.find('|');
    if (list.substr(0, bar) == word) return true;
    if (bar == std::string_view::npos) break;
    list.remove_prefix(bar + 1);
  }
  return false;
}

std::string number_text(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.10g", value);
  return text;
}

std::string bounds_text(const NumberBounds& b) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  std::string text;
  const auto add = [&](const char* sign, double value, double absent) {
    if (value != absent) text += (text.empty() ? " " : " and ") + std::string(sign) + " " + number_text(value);
  };
  add(">", b.above, -infinity);
  add(">=", b.at_least, -infinity);
  add("<", b.below, infinity);
  add("<=", b.at_most, infinity);
  return text;
}

}  // namespace

std::span<const Key> all_keys() { return table; }

const Key* find_key(std::string_view section, std::string_view name) {
  for (const Key& key : table)
    if (key.section == section && key.name == name) return &key;
  return nullptr;
}

std::vector<const Key*> keys_of(std::string_view section) {
  std::vector<const Key*> keys;
  for (const Key& key : table)
    if (key.section == section) keys.push_back(&key);
  return keys;
}

std::vector<std::string> choices(const Key& key) {
  std::vector<std::string> words;
  if (key.words == "@fields") {
    for (const FieldInfo& field : field_table) words.emplace_back(field.name);
    words.insert(words.end(), {"id", "phase"});
    return words;
  }
  std::string_view rest = key.words;
  while (!rest.empty()) {
    const std::size_t bar = rest.find('|');
    words.emplace_back(rest.substr(0, bar));
    rest = bar == std::string_view::npos ? "" : rest.substr(bar + 1);
  }
  return words;
}

bool belongs_to_kind(const Key& key, std::string_view kind) { return key.kinds.empty() || listed(key.kinds, kind); }

std::string expected(const Key& key, int dimensions) {
  const std::string bounds = bounds_text(key.bounds);
  const std::string unit = key.unit.empty() ? "" : " (" + std::string(key.unit) + ")";
  const std::string count = std::to_string(dimensions);
  std::string variables;
  for (const char c : key.variables) variables += c == ' ' ? std::string(", ") : std::string(1, c);
  std::vector<std::string> ways;
  if (key.accepts & as_number) ways.push_back("a number" + bounds + unit);
  if (key.accepts & as_integer) ways.push_back("a whole number" + bounds + unit);
  if (key.accepts & as_boolean) ways.emplace_back("true or false");
  if (key.accepts & as_text) ways.emplace_back("a string");
  if (key.accepts & as_vector) ways.push_back("an array of " + count + " numbers" + bounds + unit);
  if (key.accepts & as_formula) ways.push_back("a number" + unit + " or a formula in " + variables);
  if (key.accepts & as_formulas)
    ways.push_back("an array of " + count + " numbers" + unit + " or formulas in " + variables);
  if (key.accepts & as_points) ways.push_back("an array of points of " + count + " numbers" + unit);
  if (key.accepts & as_corners) ways.push_back("an array of three or more corners [x, y]" + unit);
  if (key.accepts & as_words) ways.push_back("an array of " + one_of(choices(key)));
  if (key.accepts & as_word) ways.push_back(one_of(choices(key)));
  if (key.accepts & (as_section | as_named_sections)) {
    const std::string path = std::string(key.section) + "." + std::string(key.name);
    const auto inner = ways.empty() ? std::vector<const Key*>{} : keys_of(path);
    if (inner.empty()) ways.emplace_back("a section");
    else
      ways.push_back("{ " + std::string(inner.front()->name) + " = ... }" + (inner.size() > 1 ? " and the like" : ""));
  }
  if (key.accepts & as_sections) ways.push_back("sections [[" + std::string(key.name) + "]]");
  std::string text;
  for (const std::string& way : ways) text += (text.empty() ? "" : " or ") + way;
  return text;
}

}  // namespace barchan
