// A scene as plain data: what the user said, checked, in SI units. No behaviour.
//
// scene/reader.hpp makes one from a TOML document, scene/generate.hpp makes particles from it, plan/plan.hpp decides
// what will run. Lengths are metres, times seconds, unless a comment says "spacings" (multiples of `spacing`).
#pragma once

#include <map>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "base/vec3.hpp"
#include "kernels/kernel_kind.hpp"

namespace barchan {

/// A number or a formula in x, y, z, t (muParser syntax; constants pi and e). Formulas were compiled once by the
/// reader, so they are known to be well formed.
struct Expression {
  std::string formula;  // empty: `value` holds
  double value = 0.0;
  bool is_formula() const { return !formula.empty(); }
};
using VectorExpression = std::array<Expression, 3>;

// ---- phases ---------------------------------------------------------------------------------------------------------

enum class PhaseKind { fluid, elastic, grains, wall };
enum class EquationOfState { linear, tait };
enum class WallLaw { adami, repulsive };  // Adami et al. 2012; Halik et al. 2015 section 6 (one row of ghosts)
enum class Slip { no_slip, free_slip };
enum class FluidScheme { plain, consistent };  // docs/method.md
enum class Turbulence { none, mixing_length, smagorinsky };

/// Per-phase parameters. Those of another kind keep their defaults and are not read.
struct Phase {
  std::string name;
  PhaseKind kind = PhaseKind::fluid;
  double density = 0.0;  // kg/m3, at rest

  // fluid
  double viscosity = 0.0;             // m2/s, kinematic
  std::optional<double> sound_speed;  // m/s; empty: 10 times the largest speed that the scene promises
  EquationOfState equation_of_state = EquationOfState::linear;
  double tait_exponent = 7.0;
  double artificial_viscosity = 0.0;       // Monaghan's alpha
  double artificial_viscosity_beta = 0.0;  // Monaghan's beta, elastic only
  double density_diffusion = 0.05;         // delta of delta-SPH, 0 switches it off
  double shifting = 1.0;                   // strength of particle shifting, 0 switches it off
  double background_pressure = 0.0;        // in rho0 c^2
  FluidScheme scheme = FluidScheme::consistent;
  std::optional<bool> enclosed;  // its mean density is kept; empty: the plan sees whether it is shut in
  Turbulence turbulence = Turbulence::none;
  double smagorinsky = 0.15;  // C_s of nu_t = (C_s dx)^2 |S|

  // elastic
  double young = 0.0;  // Pa
  double poisson = 0.0;
  bool energy = false;  // fluid and elastic: integrate the internal energy (eq. 13)

  // grains
  double restitution = 0.7;             // of quartz on quartz; of a head-on collision of two grains, 0 < e <= 1
  std::optional<double> contact_speed;  // m/s, sqrt(stiffness/density) of a contact; empty: chosen by the plan

  // wall
  WallLaw wall_law = WallLaw::adami;
  Slip slip = Slip::no_slip;
  VectorExpression wall_velocity;    // m/s, a function of time: the surface slides, the particles stay in place
  std::optional<Vec3> shear_stress;  // Pa, on the fluid, instead of no slip

  // wall and grains
  std::optional<double> roughness;  // m, z0 of the logarithmic law; empty: smooth wall, a thirtieth of a grain
};

// ---- the interaction matrix
// -------------------------------------------------------------------------------------------

/// One entry of the matrix: an unordered pair of phases. A pair without an entry does not interact.
struct Interaction {
  std::string a, b;     // phase names as written, "air-sand"
  double radius = 0.0;  // kernel radius (support) in spacings, eq. (15)-(17)
  KernelKind kernel = KernelKind::wendland_c2;
  double drag = 0.0;  // fluid-grains: drag coefficient of a grain, 0 switches it off
};

// ---- fills: what is where at the beginning
// ------------------------------------------------------------------------------

struct BoxShape {
  Vec3 min{}, max{};
};  // m
struct DiscShape {
  Vec3 centre{};
  double radius = 0;
};  // disc in 2D (cylinder along z in 3D)
struct SphereShape {
  Vec3 centre{};
  double radius = 0;
};
struct RingShape {
  Vec3 centre{};
  double inner = 0, outer = 0;
};  // 2D ring (tube along z in 3D)
struct PolygonShape {
  std::vector<std::array<double, 2>> corners;
};  // in x, y; at least three corners
struct CubeShape {
  Vec3 centre{};
  int count = 0;
};  // count particles along each side, spacing apart
struct PointsShape {
  std::vector<Vec3> at;
};  // single particles
struct FormulaShape {
  Expression inside;
};                                 // particles where it is > 0
struct SidesShape {                // layers of wall particles outside the domain
  std::vector<std::string> sides;  // "bottom","top","left","right","front","back"
  int layers = 3;
};
struct TheRestShape {};  // the domain less what earlier fills hold

/// Height of the ground above the bed as a function of x (and z in 3D), in metres.
struct DuneShape {
  enum class Form { cosine, gaussian, asymmetric, rushil, formula } form = Form::cosine;
  double height = 0, length = 0, at = 0;  // m; `at` is the crest's x
  double slip_face_angle = 33.0;          // degrees, asymmetric only
  Expression formula;                     // formula only: height over the bed, m
};
struct BedShape {
  double depth = 0;  // m, from the domain's bottom
  double from = 0;   // m over the bottom: nothing below it (a floor that another fill made)
  int layers = 4;    // of fitted rows
  std::optional<DuneShape> dune;
};

using Shape = std::variant<BoxShape, DiscShape, SphereShape, RingShape, PolygonShape, CubeShape, PointsShape,
                           FormulaShape, SidesShape, BedShape, TheRestShape>;

enum class Packing { square, hexagonal, random, fitted };  // rows, staggered rows, without overlap, along the ground

/// u(y) = (u*/kappa) ln(y/y0) above the ground, zero below y0; eq. (18) in SI units, kappa = 0.4.
struct LogProfile {
  double friction_velocity = 0;  // m/s
  double roughness = 0;          // m
  double kappa = 0.4;
  bool over_ground = true;  // height counted from the ground under the point (bed and dune)
};

struct Fill {
  std::string phase;
  Shape shape;
  Packing packing = Packing::square;
  double perturb = 0.0;  // spacings: each coordinate moved by a uniform number in +-perturb
  unsigned seed = 1;
  VectorExpression velocity;              // m/s, formulas in x, y, z
  std::optional<LogProfile> log_profile;  // added to `velocity`, along x
  Expression pressure;                    // Pa, fluid phases: initial pressure
  bool hydrostatic = false;               // fluid phases: start from the hydrostatic pressure instead
};

// ---- the rest
// -----------------------------------------------------------------------------------------------------------

struct Domain {
  Vec3 origin{};  // m
  Vec3 size{};    // m
  std::array<bool, 3> periodic{false, false, false};
  Vec3 gravity{};  // m/s2
};

struct Forcing {
  std::string phase;              // body force on this phase
  VectorExpression acceleration;  // m/s2, formulas in x, y, z, t
  bool hold_bulk_speed = false;   // instead: what keeps the initial mean velocity along periodic axes
};

// ---- what is measured
// -----------------------------------------------------------------------------------------------

/// What all instruments have.
struct Measured {
  std::string name;    // unique among its kind; part of a file's name
  std::string phase;   // what is measured
  double every = 0.0;  // s between samples; 0: that of history.csv
  double start = 0.0;  // s, when averaging begins
};
struct Probe : Measured {
  Vec3 at{};  // m
};
struct Profile : Measured {
  Vec3 from{}, to{};            // m: points on a line,
  std::optional<BoxShape> box;  // or slices of a box
  std::size_t along = 1;        // axis of the slices
  int count = 0;                // points or slices; 0: one a spacing
};
struct Grid : Measured {
  std::optional<Vec3> min, max;  // m; empty: the domain
  double spacing = 0.0;          // m; 0: the scene's
};
struct WallShear : Measured {
  std::string wall;  // phase
  bool top = false;  // the upper side of the domain
  int count = 0;     // columns along x; 0: one a spacing
};
struct Measuring {
  std::vector<Probe> probes;
  std::vector<Profile> profiles;
  std::vector<Grid> grids;
  std::vector<WallShear> wall_shears;
};

struct TimeControl {
  double end = 0.0;                  // s
  std::optional<double> fixed_step;  // s
  double safety = 1.0;               // factor on every stability limit
  double largest_speed = 0.0;        // m/s, a promise used for the automatic sound speed; 0: from the fills
};

enum class FrameFormat { vtp, vtu };

struct OutputControl {
  double every = 0.0;               // s between frames; 0: first and last only
  double history_every = 0.0;       // s between rows of history.csv; 0: a hundredth of the end time
  std::vector<std::string> fields;  // beside id, phase, velocity, smoothing_length, density, pressure
  FrameFormat format = FrameFormat::vtp;
  bool compress = true;
  bool walls = true;                // write wall particles too
  double checkpoint_every = 600.0;  // s of wall time between checkpoints; 0: at the end and at signals only
};

enum class Precision { double_precision, mixed };

struct Scene {
  std::string file;      // as given, for messages
  std::string name;      // file name without directory and suffix
  std::string identity;  // its document with the overrides, less what a run that goes on may change: title, state,
                         // time.end and output.checkpoint-every
  std::string title;
  std::string state = "";  // pvstate that scripts/run renders; empty: none
  int dimensions = 2;
  double spacing = 0.0;  // m, dx
  Precision precision = Precision::mixed;
  Domain domain;
  std::vector<Phase> phases;
  std::vector<Interaction> interactions;
  std::vector<Fill> fills;
  std::vector<Forcing> forcings;
  Measuring measuring;
  TimeControl time;
  OutputControl output;
};

}  // namespace barchan
