// The rows of the table of keys: one a key, in the order of docs/scenes.md.
//
// To add a key: its member in scene.hpp, without a default; its row here; the model that consumes it; and a case in
// tests/cli/key_consumers_cases.inc, in which it changes the results. BARCHAN_WRITE_DOCS=1 test_unit brings
// docs/scenes.md up to date.
#include "scene/slots.hpp"

namespace barchan {
namespace slots {

// What the words of a document stand for.
template <class Enum>
constexpr Word word(std::string_view word, Enum meaning) {
  return {word, static_cast<int>(meaning)};
}
template <>
constexpr std::array words_of<PhaseKind>{word("fluid", PhaseKind::fluid), word("elastic", PhaseKind::elastic),
                                         word("grains", PhaseKind::grains), word("wall", PhaseKind::wall),
                                         word("column", PhaseKind::column)};
static_assert(words_of<PhaseKind>.size() == std::variant_size_v<decltype(Phase::own)>,
              "each alternative of Phase::own needs its word here");
template <>
constexpr std::array words_of<EquationOfState>{word("linear", EquationOfState::linear),
                                               word("tait", EquationOfState::tait)};
template <>
constexpr std::array words_of<FluidScheme>{word("plain", FluidScheme::plain),
                                           word("consistent", FluidScheme::consistent)};
template <>
constexpr std::array words_of<Turbulence>{word("none", Turbulence::none),
                                          word("mixing-length", Turbulence::mixing_length),
                                          word("smagorinsky", Turbulence::smagorinsky)};
template <>
constexpr std::array words_of<Formulation>{word("total-lagrangian", Formulation::total_lagrangian),
                                           word("updated-lagrangian", Formulation::updated_lagrangian)};
template <>
constexpr std::array words_of<Elasticity>{word("neo-hookean", Elasticity::neo_hookean),
                                          word("saint-venant-kirchhoff", Elasticity::saint_venant_kirchhoff)};
template <>
constexpr std::array words_of<MixingLength>{word("none", MixingLength::none), word("duran", MixingLength::duran)};
template <>
constexpr std::array words_of<DragLaw>{
    word("stokes", DragLaw::stokes), word("schiller-naumann", DragLaw::schiller_naumann), word("cheng", DragLaw::cheng),
    word("duran", DragLaw::duran), word("di-felice", DragLaw::di_felice)};
template <>
constexpr std::array words_of<WallLaw>{word("adami", WallLaw::adami), word("repulsive", WallLaw::repulsive)};
template <>
constexpr std::array words_of<ContactLaw>{word("kernel", ContactLaw::kernel), word("linear", ContactLaw::linear),
                                          word("hertz", ContactLaw::hertz)};
template <>
constexpr std::array words_of<Slip>{word("no-slip", Slip::no_slip), word("free-slip", Slip::free_slip)};
template <>
constexpr std::array words_of<KernelKind>{word("cubic-spline", KernelKind::cubic_spline),
                                          word("wendland-c2", KernelKind::wendland_c2)};
template <>
constexpr std::array words_of<Packing>{word("rows", Packing::square), word("staggered", Packing::hexagonal),
                                       word("random", Packing::random), word("fitted", Packing::fitted),
                                       word("settled", Packing::settled)};
template <>
constexpr std::array words_of<DuneShape::Form>{
    word("cosine", DuneShape::Form::cosine), word("gaussian", DuneShape::Form::gaussian),
    word("asymmetric", DuneShape::Form::asymmetric), word("rushil", DuneShape::Form::rushil),
    word("formula", DuneShape::Form::formula)};
template <>
constexpr std::array words_of<FrameFormat>{word("vtp", FrameFormat::vtp), word("vtu", FrameFormat::vtu)};
template <>
constexpr std::array words_of<Precision>{word("double", Precision::double_precision), word("mixed", Precision::mixed)};

/// Chooses the type of the phase: it comes first in its section, before the keys that only this type has.
constexpr Slot kind_of_phase() {
  return {
      .accepts = as_word, .otherwise = required, .words = words_of<PhaseKind>, .choose = [](void* object, int kind) {
        auto& own = static_cast<Phase*>(object)->own;
        switch (static_cast<PhaseKind>(kind)) {
          case PhaseKind::fluid: own.emplace<FluidKeys>(); break;
          case PhaseKind::elastic: own.emplace<ElasticKeys>(); break;
          case PhaseKind::grains: own.emplace<GrainsKeys>(); break;
          case PhaseKind::wall: own.emplace<WallKeys>(); break;
          case PhaseKind::column: own.emplace<ColumnKeys>(); break;
        }
      }};
}

constexpr std::array axes{Word{"x", 0}, Word{"y", 1}, Word{"z", 2}};
constexpr std::array sides_of_domain{Word{"bottom", 0}, Word{"top", 1},   Word{"left", 2},
                                     Word{"right", 3},  Word{"front", 4}, Word{"back", 5}};
constexpr std::array bottom_or_top{sides_of_domain[0], sides_of_domain[1]};
constexpr std::array rest_of_the_domain{Word{"the-rest", 0}};
constexpr std::array hydrostatic{Word{"hydrostatic", 1}};
constexpr std::array bulk_speed{Word{"bulk-speed", 1}};

// Slots of keys that are more than one member, or that have words for a member of another type.

/// The entries of [interactions] have names that the user chooses: read.cpp reads them, one by one, by the rows of
/// interactions.pair.
constexpr Slot pairs() { return {.accepts = as_section, .otherwise = required}; }

template <auto list>
constexpr Slot measured(const char* in_words) {
  Slot slot = at<list>(in_words);
  slot.open = [](void* scene) -> void* { return &(static_cast<Scene*>(scene)->measuring.*list).emplace_back(); };
  return slot;
}

constexpr Slot periodic(const char* in_words) {
  return {.accepts = as_words, .otherwise = otherwise(in_words), .words = axes, .choose = [](void* domain, int axis) {
            static_cast<Domain*>(domain)->periodic[static_cast<std::size_t>(axis)] = true;
          }};
}

/// Sizes of spheres: the mean alone, or a section.
inline std::optional<SphereSize>* sizes_of(void* object) {
  Phase& phase = *static_cast<Phase*>(object);
  auto* grains = member_of(phase, &GrainsKeys::diameter);
  return grains ? grains : member_of(phase, &WallKeys::diameter);
}
constexpr Slot sizes(const char* in_words) {
  Slot slot{.accepts = as_number | as_section, .otherwise = otherwise(in_words)};
  slot.member = [](void* object) -> Target {
    auto* size = sizes_of(object);
    return size ? Target{&size->emplace().mean} : Target{};
  };
  slot.open = [](void* object) -> void* {
    auto* size = sizes_of(object);
    return size ? &size->emplace() : nullptr;
  };
  slot.kinds = kinds_with<PhaseKind::grains, PhaseKind::wall>;
  return slot;
}

constexpr Slot fill_shape() {
  return {.accepts = as_word | as_section,
          .otherwise = required,
          .words = rest_of_the_domain,
          .choose = [](void* fill, int) { static_cast<Fill*>(fill)->shape = TheRestShape{}; },
          .open = [](void* fill) -> void* { return &static_cast<Fill*>(fill)->shape; }};
}

constexpr Slot fill_velocity(const char* in_words) {
  Slot slot = at<&Fill::velocity>(in_words);
  slot.accepts |= as_section;
  slot.open = [](void* fill) { return fill; };
  return slot;
}

constexpr Slot fill_pressure(const char* in_words) {
  Slot slot = at<&Fill::pressure>(in_words);
  slot.accepts |= as_word;
  slot.words = hydrostatic;
  slot.choose = [](void* fill, int) { static_cast<Fill*>(fill)->hydrostatic = true; };
  return slot;
}

/// Of all kinds of phases that have particles.
constexpr Slot spacing_of_particles(const char* in_words) {
  Slot slot = at<&Phase::spacing>(in_words);
  slot.kinds = kinds_with<PhaseKind::fluid, PhaseKind::elastic, PhaseKind::grains, PhaseKind::wall>;
  return slot;
}

/// A number, or the name of a law.
constexpr Slot drag(const char* in_words) {
  Slot slot = at<&Interaction::drag>(0.0, in_words);
  slot.accepts |= as_word;
  slot.words = words_of<DragLaw>;
  slot.choose = [](void* pair, int law) { static_cast<Interaction*>(pair)->drag_law = static_cast<DragLaw>(law); };
  return slot;
}

constexpr Slot sides() {
  Slot slot = in_shape<&SidesShape::sides>();
  slot.words = sides_of_domain;
  return slot;
}

constexpr Slot layers(const char* in_words) {
  return {.accepts = as_integer, .otherwise = otherwise(in_words), .member = [](void* shape) -> Target {
            if (auto* bed = shape_of<BedShape>(shape, belongs)) return &bed->layers;
            if (auto* sides = shape_of<SidesShape>(shape, belongs)) return &sides->layers;
            return {};
          }};
}

constexpr Slot hold(const char* in_words) {
  return {.accepts = as_word, .otherwise = otherwise(in_words), .words = bulk_speed, .choose = [](void* forcing, int) {
            static_cast<Forcing*>(forcing)->hold_bulk_speed = true;
          }};
}

constexpr Slot along(int axis) {
  return {.accepts = as_word, .otherwise = otherwise(axis), .words = axes, .choose = [](void* profile, int chosen) {
            static_cast<Profile*>(profile)->along = static_cast<std::size_t>(chosen);
          }};
}

constexpr Slot side(int side) {
  return {
      .accepts = as_word, .otherwise = otherwise(side), .words = bottom_or_top, .choose = [](void* shear, int chosen) {
        static_cast<WallShear*>(shear)->top = chosen == 1;
      }};
}

constexpr Slot fields(const char* in_words) {
  Slot slot = at<&OutputControl::fields>(in_words);
  slot.fields = true;
  return slot;
}

}  // namespace slots

namespace {

using namespace slots;

constexpr NumberBounds positive{.above = 0.0};
constexpr NumberBounds not_negative{.at_least = 0.0};

// Columns: section, name, the member that it is read into with its default, unit, meaning; then bounds, variables of a
// formula and the kind of phase that may leave it out, where they apply. A key of phases is a member of one kind or of
// several.
// clang-format off
constexpr Key table[] = {
    {"", "title", at<&Scene::title>("the file's name"), "", "What the scene shows, in a few words."},
    {"", "state", at<&Scene::state>("none"), "", "Name of the ParaView state (in pvstate/) that renders this scene."},
    {"", "dimensions", at<&Scene::dimensions>(2), "", "Dimensions of space, 2 or 3; vectors have as many components.", {.at_least = 2, .at_most = 3}},
    {"", "spacing", at<&Scene::spacing>(required), "m", "Distance between neighbouring particles, dx.", positive},
    {"", "precision", at<&Scene::precision>(Precision::mixed), "", "Arithmetic of the pair loops; the state is always kept in double precision."},
    {"", "domain", at<&Scene::domain>(required), "", "The box of the computation."},
    {"", "phases", at<&Scene::phases>(required), "", "One section a phase; a name is a letter followed by letters, digits and underscores."},
    {"", "interactions", pairs(), "",
     "The matrix of kernel radii, Halik et al. 2015 eq. (15)-(17): one entry a pair of phases, as in air-sand = 2.5. "
     "A pair without an entry does not interact."},
    {"", "fill", at<&Scene::fills>(required), "", "What is where at the beginning; fills are carried out in order."},
    {"", "forcing", at<&Scene::forcings>("none"), "", "Body forces on single phases."},
    {"", "motion", at<&Scene::motions>("none"), "", "Sets of particles of bodies that are clamped or driven."},
    {"", "marker", at<&Scene::markers>("none"), "", "Sets of particles of bodies whose mean place is written to history.csv."},
    {"", "probe", measured<&Measuring::probes>("none"), "", "Places at which a fluid is followed in time."},
    {"", "profile", measured<&Measuring::profiles>("none"), "", "Averages over time along a line."},
    {"", "grid", measured<&Measuring::grids>("none"), "", "Averages over time on a regular grid."},
    {"", "wall-shear", measured<&Measuring::wall_shears>("none"), "", "Shear stress and pressure along a no-slip wall, averaged over time."},
    {"", "saltation", measured<&Measuring::saltation>("none"), "", "Sand in flight by height over its bed: concentration, flux, stress, and the wind of a column."},
    {"", "time", at<&Scene::time>(required), "", "How long, and in which steps."},
    {"", "output", at<&Scene::output>("first and last frame"), "", "What is written, and how often."},

    {"domain", "origin", at<&Domain::origin>("zero"), "m", "Lower corner."},
    {"domain", "size", at<&Domain::size>(required), "m",
     "Lengths along x, y (and z). Along a periodic axis a whole number of spacings, and more than two kernel radii.", positive},
    {"domain", "periodic", periodic("none"), "", "Axes along which the domain repeats itself."},
    {"domain", "gravity", at<&Domain::gravity>("zero"), "m/s2", "Acceleration of gravity, on every phase but walls."},

    {"phases", "kind", kind_of_phase(), "", "What the phase is made of."},
    {"phases", "spacing", spacing_of_particles("that of the scene"), "m", "Distance between the particles of this phase.", positive},
    {"phases", "density", at<&Phase::density>(required, "required; of a wall: that of a phase it interacts with"), "kg/m3",
     "Density at rest. Of grains: that of the grain's material.", positive, "", "wall"},
    {"phases", "viscosity", of<&FluidKeys::viscosity, &ColumnKeys::viscosity>(0.0, "0; of a column required"), "m2/s", "Kinematic viscosity.", not_negative},
    {"phases", "sound-speed", of<&FluidKeys::sound_speed>("10 times the largest speed"), "m/s",
     "Numerical speed of sound; ten times the largest speed keeps the density within a percent.", positive},
    {"phases", "equation-of-state", of<&FluidKeys::equation_of_state>(EquationOfState::linear), "",
     "Pressure as a function of density."},
    {"phases", "tait-exponent", of<&FluidKeys::tait_exponent>(7.0), "",
     "Exponent of Tait's equation of state, only with equation-of-state = \"tait\".", positive},
    {"phases", "artificial-viscosity", of<&FluidKeys::artificial_viscosity, &ElasticKeys::artificial_viscosity>(0.0), "", "Monaghan's alpha.", not_negative},
    {"phases", "artificial-viscosity-beta", of<&ElasticKeys::artificial_viscosity_beta>(0.0), "", "Monaghan's beta.", not_negative},
    {"phases", "density-diffusion", of<&FluidKeys::density_diffusion>(0.05), "", "Delta of delta-SPH; 0 switches it off.", not_negative},
    {"phases", "enclosed", of<&FluidKeys::enclosed>("true of a fluid that is shut in"), "",
     "The fluid fills a closed space: its mean density is kept. barchan plan says what it is and why."},
    {"phases", "shifting", of<&FluidKeys::shifting>(1.0), "", "Strength of particle shifting; 0 switches it off.", not_negative},
    {"phases", "background-pressure", of<&FluidKeys::background_pressure>(0.0), "rho c2",
     "Pressure at rest, in units of density times sound speed squared.", not_negative},
    {"phases", "scheme", of<&FluidKeys::scheme>(FluidScheme::consistent), "",
     "Gradient operators: as they are, or corrected to first order (docs/method.md)."},
    {"phases", "turbulence", of<&FluidKeys::turbulence>(Turbulence::none), "",
     "Eddy viscosity of the unresolved turbulence: (0.4 d)^2 |S| with d the distance to the ground, or (C_s dx)^2 |S|."},
    {"phases", "smagorinsky", of<&FluidKeys::smagorinsky>(0.15), "", "C_s, only with turbulence = \"smagorinsky\".", positive},
    {"phases", "young", of<&ElasticKeys::young, &GrainsKeys::young>(required, "required; of grains: from largest-overlap"), "Pa",
     "Young's modulus; of grains for contacts with law = \"hertz\".", positive, "", "grains"},
    {"phases", "poisson", of<&ElasticKeys::poisson, &GrainsKeys::poisson>(0.0), "", "Poisson's ratio; of grains for contacts with law = \"hertz\".", {.above = -1.0, .below = 0.5}},
    {"phases", "formulation", of<&ElasticKeys::formulation>(Formulation::total_lagrangian), "",
     "Where the strain of a body comes from: from its first shape, whose neighbours stay neighbours; or step by step from the velocities of "
     "those that are near, as in Halik et al. 2015 (docs/method.md)."},
    {"phases", "elasticity", of<&ElasticKeys::elasticity>(Elasticity::neo_hookean), "",
     "Law of a body with formulation = \"total-lagrangian\"; both are Hooke's for small strains."},
    {"phases", "hourglass", of<&ElasticKeys::hourglass>(0.5), "Young's modulus",
     "Strength of the control of motions that the gradient does not see, of a body with formulation = \"total-lagrangian\".", not_negative},
    {"phases", "retardation", of<&ElasticKeys::retardation>(0.0), "s",
     "Damping of Kelvin and Voigt, of a body with formulation = \"total-lagrangian\": a vibration of angular frequency w has the damping ratio "
     "w retardation/2.", not_negative},
    {"phases", "energy", of<&FluidKeys::energy, &ElasticKeys::energy>(false), "",
     "Integrate the internal energy, Halik et al. 2015 eq. (13). Of a fluid: only with scheme = \"plain\"."},
    {"phases", "restitution", of<&GrainsKeys::restitution>(0.7), "",
     "Speed after over speed before a head-on collision of two grains. Quartz: 0.7 to 0.8; with 1 a bed never comes to rest.", {.at_most = 1.0, .above = 0.0}},
    {"phases", "contact-speed", of<&GrainsKeys::contact_speed>("chosen by the plan"), "m/s",
     "Square root of a contact's stiffness over density.", positive},
    {"phases", "diameter", sizes("none: particles of one spacing"), "m",
     "Grains as spheres, in 2D in a slab as thick as the mean diameter; needs contacts with law = \"linear\" or \"hertz\". Of a wall: what "
     "such grains feel of its particles.", positive},
    {"phases", "friction", of<&GrainsKeys::friction>(0.0), "", "Coulomb's coefficient of friction of spheres.", not_negative},
    {"phases", "rolling-friction", of<&GrainsKeys::rolling_friction>(0.0), "",
     "Rolling resistance of spheres: the largest torque over normal force and reduced radius.", not_negative},
    {"phases", "stiffness", of<&GrainsKeys::stiffness>("from largest-overlap"), "N/m",
     "Stiffness of a contact of two grains with law = \"linear\".", positive},
    {"phases", "largest-overlap", of<&GrainsKeys::largest_overlap>(0.02), "",
     "Overlap of two spheres that meet with the largest speed of the scene (time.largest-speed), in mean diameters: makes the stiffness.",
     {.at_most = 0.2, .above = 0.0}},
    {"phases", "law", of<&WallKeys::law>(WallLaw::adami), "",
     "How the wall acts: Adami et al. 2012, or one row of ghosts that repel (Halik et al. 2015)."},
    {"phases", "slip", of<&WallKeys::slip, &ColumnKeys::slip>(Slip::no_slip), "",
     "Whether the fluid sticks to the wall (only with law = \"adami\"), or a column's air to the bottom of the domain."},
    {"phases", "velocity", of<&WallKeys::velocity>("zero"), "m/s",
     "Velocity at which the surface of a no-slip wall slides along itself, a function of time. Only fluids feel it; the wall stays where it is.", {}, "t"},
    {"phases", "roughness", of<&WallKeys::roughness, &GrainsKeys::roughness>("smooth; of grains in turbulent air: a thirtieth of the spacing"), "m",
     "Roughness length z0: the wall's shear stress is that of the logarithmic law at the particles next to it.", positive},
    {"phases", "shear-stress", of<&WallKeys::shear_stress>("none"), "Pa",
     "Force by area of the wall on the fluid, instead of no slip; its part along the wall counts."},
    {"phases", "friction-velocity", of<&ColumnKeys::friction_velocity>("0"), "m/s",
     "u* of the wind, a number or a function of time: the stress on the top of the column is density times u*^2.", not_negative, "t"},
    {"phases", "height", of<&ColumnKeys::height>("the domain's"), "m", "Height of the column over the bottom of the domain; the air above is as that on its top.", positive},
    {"phases", "resolution", of<&ColumnKeys::resolution>("a quarter of the grains' diameter"), "m",
     "Height of the column's cells as far up as grains stand at the start, and 20 diameters more; above they grow by 5 % a cell.", positive},
    {"phases", "mixing-length", of<&ColumnKeys::mixing_length>(MixingLength::duran), "",
     "How the column's turbulence carries momentum down: Duran, Andreotti & Claudin 2012, which needs no bed surface; or not at all."},
    {"phases", "averaging", of<&ColumnKeys::averaging>("none: the air has inertia"), "s",
     "The wind is at every moment the steady one for the grains' drag averaged over this time: it follows a storm at once, where air with "
     "inertia takes a second or more.", positive},
    {"phases", "held", of<&ColumnKeys::held>(false), "", "The wind of the start stays as it is: the air does not feel the grains."},
    {"phases", "speed", of<&ColumnKeys::speed>("that of the steady wind over the grains at rest"), "m/s", "Speed of the air at the start, the same at all heights."},
    {"phases", "log-profile", of<&ColumnKeys::log_profile>("none"), "",
     "Wind at the start: Halik et al. 2015 eq. (18), from the bottom of the domain."},
    {"phases.log-profile", "friction-velocity", at<&LogProfile::friction_velocity>(required), "m/s", "Friction velocity u*.", not_negative},
    {"phases.log-profile", "roughness", at<&LogProfile::roughness>(required), "m", "Roughness length; no wind below it.", positive},

    {"phases.diameter", "mean", at<&SphereSize::mean>(required), "m", "Mean diameter.", positive},
    {"phases.diameter", "spread", at<&SphereSize::spread>(0.0), "",
     "Diameters are spread evenly over mean (1 - spread) to mean (1 + spread), by the seed of the fill.", {.at_least = 0.0, .at_most = 0.5}},

    {"interactions", "kernel", at<&MatrixDefaults::kernel>("wendland-c2 with a fluid, else cubic-spline"), "",
     "Kernel of every pair that does not name its own."},
    {"interactions.pair", "radius", at<&Interaction::radius>("2.1 with a fluid, 1.1 of a contact; of bodies and repulsive walls required; a column has none"), "spacings",
     "Kernel radius (support), in spacings of the coarser of the two phases.", {.at_most = 8.0, .above = 0.0}},
    {"interactions.pair", "radius-in-metres", at<&Interaction::radius_in_metres>("radius says it"), "m",
     "Kernel radius (support) as a length, in place of radius.", positive},
    {"interactions.pair", "law", at<&Interaction::law>(ContactLaw::kernel), "",
     "Contact of grains: through the kernel, or of spheres that touch (no radius): spring and dashpot, or Hertz and Mindlin (docs/method.md)."},
    {"interactions.pair", "drag", drag("0; duran with a column"), "",
     "Fluid with grains: drag coefficient of a grain, for the form drag that one spacing cannot resolve. Column with grains: the law of a "
     "grain's drag by name (docs/method.md).", not_negative},
    {"interactions.pair", "restitution", at<&Interaction::restitution>("1 of bodies that need it"), "",
     "Bodies with bodies and walls: the particles touch where their spacings end, and two that meet head-on keep this share of their relative "
     "speed (docs/method.md). Between two updated Lagrangian bodies it takes the place of the kernel's contact.", {.at_least = 0.05, .at_most = 1.0}},
    {"interactions.pair", "friction", at<&Interaction::friction>("0"), "", "Coulomb's coefficient of friction of such a contact.", not_negative},
    {"interactions.pair", "kernel", at<&Interaction::kernel>("that of [interactions]"), "", "Kernel of this pair."},

    {"fill", "phase", at<&Fill::phase>(required), "", "Phase of the particles."},
    {"fill", "shape", fill_shape(), "", "Where: one shape, or \"the-rest\" for what earlier fills left free (above the ground, if there is a bed)."},
    {"fill", "packing", at<&Fill::packing>(Packing::square), "",
     "Square lattice, close-packed lattice, random without overlap (up to 0.5 of the area or 0.35 of the volume), or rows that "
     "follow the ground: a bed of a wall, and the fluid above it. settled: a box or a bed of spheres that fell and came to rest before the run. Fluids and elastic bodies take rows or fitted."},
    {"fill", "perturb", at<&Fill::perturb>(0.0), "spacings",
     "Every coordinate is moved by a random number of at most this size.", {.at_least = 0.0, .at_most = 0.5}},
    {"fill", "seed", at<&Fill::seed>(1), "",
     "Seed of the random numbers, of perturb and of the random packing.", {.at_least = 0, .at_most = 4294967295.0}},
    {"fill", "velocity", fill_velocity("zero"), "m/s", "Initial velocity: components, or { log-profile = ... }.", {}, "x y z"},
    {"fill", "pressure", fill_pressure("0"), "Pa", "Initial pressure of a fluid; \"hydrostatic\": the weight of what lies above.", {}, "x y z"},
    {"fill.shape", "bed", in_shape<&BedShape::depth>(), "m", "Depth of a bed on the bottom of the domain.", not_negative},
    {"fill.shape", "from", in_shape<&BedShape::from, belongs>(0.0), "m",
     "Only with bed: nothing below this height, where another fill made a floor.", not_negative},
    {"fill.shape", "dune", in_shape<&BedShape::dune, belongs>("none"), "", "Only with bed: a dune on it."},
    {"fill.shape", "box", shape<BoxShape>(), "", "Box."},
    {"fill.shape", "disc", shape<DiscShape>(), "", "Disc; in 3D a cylinder along z."},
    {"fill.shape", "sphere", shape<SphereShape>(), "", "Sphere; in 2D a disc."},
    {"fill.shape", "ring", shape<RingShape>(), "", "Ring; in 3D a tube along z."},
    {"fill.shape", "polygon", in_shape<&PolygonShape::corners>(), "m", "Corners [x, y]; in 3D a prism along z."},
    {"fill.shape", "cube", shape<CubeShape>(), "", "Square or cube of so many particles along each side."},
    {"fill.shape", "points", in_shape<&PointsShape::at>(), "m", "Single particles."},
    {"fill.shape", "formula", in_shape<&FormulaShape::inside>(), "", "Particles where the formula is above zero.", {}, "x y z"},
    {"fill.shape", "sides", sides(), "",
     "Layers of wall particles outside the domain. bottom and top: y; left and right: x; back and front: z."},
    {"fill.shape", "layers", layers("3; of a bed 4"), "", "Only with sides or a fitted bed: number of layers.", {.at_least = 1, .at_most = 16}},
    {"fill.shape.dune", "form", at<&DuneShape::form>(DuneShape::Form::cosine), "",
     "cosine: H/2 (1 + cos(2 pi (x - at)/L)); gaussian: L is the width at half height; asymmetric: windward half cosine, straight slip "
     "face, L from toe to toe; rushil: the hills of Khurshudyan et al. 1981, L from toe to toe; formula."},
    {"fill.shape.dune", "height", at<&DuneShape::height>("required but for a formula"), "m", "Height H of the crest over the bed.", positive},
    {"fill.shape.dune", "length", at<&DuneShape::length>("required but for a formula"), "m", "Length L.", positive},
    {"fill.shape.dune", "at", at<&DuneShape::at>("required but for a formula"), "m", "x of the crest."},
    {"fill.shape.dune", "slip-face-angle", at<&DuneShape::slip_face_angle>(33.0), "degrees",
     "Asymmetric only: angle of the lee side.", {.above = 0.0, .below = 90.0}},
    {"fill.shape.dune", "formula", at<&DuneShape::formula>(), "m", "Form formula only: height over the bed.", {}, "x z"},
    {"fill.shape.box", "min", at<&BoxShape::min>(required), "m", "Lower corner."},
    {"fill.shape.box", "max", at<&BoxShape::max>(required), "m", "Upper corner."},
    {"fill.shape.disc", "centre", at<&DiscShape::centre>(required), "m", "Centre; a particle sits on it."},
    {"fill.shape.disc", "radius", at<&DiscShape::radius>(required), "m", "Radius.", positive},
    {"fill.shape.sphere", "centre", at<&SphereShape::centre>(required), "m", "Centre; a particle sits on it."},
    {"fill.shape.sphere", "radius", at<&SphereShape::radius>(required), "m", "Radius.", positive},
    {"fill.shape.ring", "centre", at<&RingShape::centre>(required), "m", "Centre."},
    {"fill.shape.ring", "inner", at<&RingShape::inner>(required), "m", "Inner radius.", not_negative},
    {"fill.shape.ring", "outer", at<&RingShape::outer>(required), "m", "Outer radius.", positive},
    {"fill.shape.cube", "centre", at<&CubeShape::centre>(required), "m", "Centre."},
    {"fill.shape.cube", "count", at<&CubeShape::count>(required), "", "Particles along each side.", {.at_least = 1, .at_most = 4096}},
    {"fill.velocity", "log-profile", at<&Fill::log_profile>(required), "", "Logarithmic wind along x, Halik et al. 2015 eq. (18)."},
    {"fill.velocity.log-profile", "friction-velocity", at<&LogProfile::friction_velocity>(required), "m/s", "Friction velocity u*.", not_negative},
    {"fill.velocity.log-profile", "roughness", at<&LogProfile::roughness>(required), "m", "Roughness length; no wind below it.", positive},
    {"fill.velocity.log-profile", "over-ground", at<&LogProfile::over_ground>(true), "",
     "Count the height from the ground (bed and dune) rather than from the bottom of the domain."},

    {"forcing", "phase", at<&Forcing::phase>(required), "", "Phase that feels the force."},
    {"forcing", "acceleration", at<&Forcing::acceleration>("none"), "m/s2", "Acceleration; this or hold.", {}, "x y z t"},
    {"forcing", "hold", hold("none"), "",
     "bulk-speed: the uniform acceleration that keeps the fluid's initial mean velocity along the periodic axes, as in a channel of "
     "constant mass flux. history.csv has it."},

    {"motion", "phase", at<&Motion::phase, Motion>(required), "", "Elastic phase."},
    {"motion", "box", at<&Motion::box, Motion>("all of it"), "", "Particles that stand in this box at the start."},
    {"motion", "velocity", at<&Motion::velocity>("zero: clamped"), "m/s", "Velocity of the set, a function of time. history.csv has the force on it.", {}, "t"},
    {"motion.box", "min", at<&BoxShape::min>(required), "m", "Lower corner."},
    {"motion.box", "max", at<&BoxShape::max>(required), "m", "Upper corner."},

    {"marker", "name", at<&Marker::name>(required), "", "Letters, digits and underscores: of the columns NAME_x, NAME_y (and NAME_z) in history.csv."},
    {"marker", "phase", at<&Marker::phase, Marker>(required), "", "Elastic phase."},
    {"marker", "box", at<&Marker::box, Marker>("all of it"), "", "Particles that stand in this box at the start."},
    {"marker.box", "min", at<&BoxShape::min>(required), "m", "Lower corner."},
    {"marker.box", "max", at<&BoxShape::max>(required), "m", "Upper corner."},

    {"probe", "name", at<&Probe::name, Probe>(required), "", "Letters, digits and underscores: it is written to probe_NAME.csv."},
    {"probe", "phase", at<&Probe::phase, Probe>(required), "", "Fluid that is followed."},
    {"probe", "at", at<&Probe::at>(required), "m", "Place."},
    {"probe", "every", at<&Probe::every, Probe>("that of history.csv"), "s", "Time between samples.", positive},
    {"probe", "start", at<&Probe::start, Probe>(0.0), "s", "Time from which means and fluctuations are taken.", not_negative},

    {"profile", "name", at<&Profile::name, Profile>(required), "", "Letters, digits and underscores: it is written to profile_NAME.csv and .vtp."},
    {"profile", "phase", at<&Profile::phase, Profile>(required), "", "Fluid that is measured; with box also grains."},
    {"profile", "from", at<&Profile::from>(), "m", "First point of a line on which the fluid is interpolated."},
    {"profile", "to", at<&Profile::to>(), "m", "Its last point."},
    {"profile", "box", at<&Profile::box>(), "", "In place of from and to: bins, slices of this box, in which particles are averaged."},
    {"profile", "along", along(1), "", "Only with box: axis along which the bins follow each other."},
    {"profile", "count", at<&Profile::count>("one a spacing"), "", "Number of points or bins.", {.at_least = 1, .at_most = 1000000}},
    {"profile", "every", at<&Profile::every, Profile>("that of history.csv"), "s", "Time between samples.", positive},
    {"profile", "start", at<&Profile::start, Profile>(0.0), "s", "Time of the first sample.", not_negative},
    {"profile.box", "min", at<&BoxShape::min>(required), "m", "Lower corner."},
    {"profile.box", "max", at<&BoxShape::max>(required), "m", "Upper corner."},

    {"grid", "name", at<&Grid::name, Grid>(required), "", "Letters, digits and underscores: it is written to grid_NAME.vti."},
    {"grid", "phase", at<&Grid::phase, Grid>(required), "", "Fluid that is measured."},
    {"grid", "min", at<&Grid::min>("that of the domain"), "m", "Lower corner."},
    {"grid", "max", at<&Grid::max>("that of the domain"), "m", "Upper corner; in 3D min and max with the same z (or x, y) make a plane."},
    {"grid", "spacing", at<&Grid::spacing>("that of the scene"), "m", "Distance between points, adjusted so that it divides the sides.", positive},
    {"grid", "every", at<&Grid::every, Grid>("that of history.csv"), "s", "Time between samples.", positive},
    {"grid", "start", at<&Grid::start, Grid>(0.0), "s", "Time of the first sample.", not_negative},

    {"wall-shear", "name", at<&WallShear::name, WallShear>(required), "",
     "Letters, digits and underscores: it is written to wall_shear_NAME.csv and .vtp."},
    {"wall-shear", "phase", at<&WallShear::phase, WallShear>(required), "", "Fluid that shears the wall."},
    {"wall-shear", "wall", at<&WallShear::wall>(required), "", "No-slip wall, a fill with sides."},
    {"wall-shear", "side", side(0), "", "Side of the domain on which the wall stands."},
    {"wall-shear", "count", at<&WallShear::count>("one a spacing"), "", "Number of columns along x.", {.at_least = 1, .at_most = 1000000}},
    {"wall-shear", "every", at<&WallShear::every, WallShear>("that of history.csv"), "s", "Time between samples.", positive},
    {"wall-shear", "start", at<&WallShear::start, WallShear>(0.0), "s", "Time of the first sample.", not_negative},

    {"saltation", "name", at<&SaltationLayer::name, SaltationLayer>(required), "", "Letters, digits and underscores: it is written to saltation_NAME.csv, .vtp and .json."},
    {"saltation", "phase", at<&SaltationLayer::phase, SaltationLayer>(required), "", "Grains that are measured."},
    {"saltation", "flight", at<&SaltationLayer::flight>(5.0), "diameters", "Height over the bed above which a grain is in flight.", positive},
    {"saltation", "count", at<&SaltationLayer::count>("one a diameter"), "", "Number of slices of the domain's height.", {.at_least = 1, .at_most = 100000}},
    {"saltation", "every", at<&SaltationLayer::every, SaltationLayer>("that of history.csv"), "s", "Time between samples.", positive},
    {"saltation", "start", at<&SaltationLayer::start, SaltationLayer>(0.0), "s", "Time from which averages are taken.", not_negative},

    {"time", "end", at<&TimeControl::end>(required), "s", "Time at which the run ends.", positive},
    {"time", "step", at<&TimeControl::fixed_step>("from the stability limits"), "s", "Fixed time step.", positive},
    {"time", "safety", at<&TimeControl::safety>(1.0), "", "Factor on every stability limit; not with a fixed step.", {.at_most = 10.0, .above = 0.0}},
    {"time", "largest-speed", at<&TimeControl::largest_speed>("from the fills"), "m/s",
     "Largest speed that will occur; sets automatic sound speeds.", not_negative},

    {"output", "every", at<&OutputControl::every>("first and last only"), "s", "Time between frames.", not_negative},
    {"output", "history-every", at<&OutputControl::history_every>("a hundredth of the end time"), "s",
     "Time between rows of history.csv.", not_negative},
    {"output", "checkpoint-every", at<&OutputControl::checkpoint_every>(600.0), "s",
     "Wall time between checkpoints; 0: at the end and at signals only.", not_negative},
    {"output", "fields", fields("none"), "", "Fields beside id, phase, velocity, smoothing_length, density and pressure."},
    {"output", "format", at<&OutputControl::format>(FrameFormat::vtp), "", "File format of the frames."},
    {"output", "compress", at<&OutputControl::compress>(true), "", "Compress the frames."},
    {"output", "walls", at<&OutputControl::walls>(true), "", "Write wall particles too."},
};
// clang-format on

}  // namespace

std::span<const Key> all_keys() { return table; }

}  // namespace barchan
