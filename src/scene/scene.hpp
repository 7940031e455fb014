// A scene as plain data: what the user said, checked, in SI units. No behaviour.
//
// checks/reader.hpp makes one from a TOML document, start/generate.hpp makes particles from it, plan/plan.hpp decides
// what will run. Defaults stand in the rows of the table of keys (scene/rows.cpp), so that nobody but the reader makes
// a Scene. Lengths are metres, times seconds, unless a comment says "spacings" (multiples of `spacing`).
#pragma once

#include <map>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "base/vec3.hpp"
#include "scene/contact_words.hpp"
#include "scene/words.hpp"

namespace barchan {

/// A number or a formula in x, y, z, t (muParser syntax; constants pi and e). Formulas were compiled once by the
/// reader, so they are known to be well formed.
struct Expression {
  std::string formula;  // empty: `value` holds
  double value = 0.0;
  bool is_formula() const { return !formula.empty(); }
};
using VectorExpression = std::array<Expression, 3>;
/// What has an axis, as an angular velocity or a torque: in 2D a document gives the number about z alone.
struct AxialExpression {
  VectorExpression about;
};

// ---- phases ---------------------------------------------------------------------------------------------------------

enum class PhaseKind { fluid, elastic, rigid, grains, wall, column };

/// u(y) = (u*/kappa) ln(y/y0) above the ground, zero below y0; eq. (18) in SI units, kappa = 0.4.
struct LogProfile {
  double friction_velocity{};  // m/s
  double roughness{};          // m
  double kappa = 0.4;
  bool over_ground{};   // height counted from the ground under the point (bed and dune)
  bool along_ground{};  // on streamlines that divide the height over the ground evenly
};

/// Sizes of the spheres of a phase, by number or by mass. At most one of spread, log_normal and sieve is given.
struct SphereSize {
  double mean{};        // m; of a sieve curve without it the diameter that half of the mass passes
  double spread{};      // diameters spread evenly, by number, over mean (1 - spread) .. mean (1 + spread)
  double log_normal{};  // standard deviation of ln d, by number, about ln(mean); cut at two of them
  std::vector<std::array<double, 2>> sieve;  // diameters (m), ascending, and the share of the mass that is smaller

  /// Whether a sphere of the distribution may have a diameter (m).
  bool has(double diameter) const { return diameter >= least() - 1e-6 * mean && diameter <= largest() + 1e-6 * mean; }
  bool differ() const { return spread > 0.0 || log_normal > 0.0 || !sieve.empty(); }
  double least() const { return mean * least_share(); }      ///< m
  double largest() const { return mean * largest_share(); }  ///< m
  double least_share() const;                                ///< of the mean
  double largest_share() const;
  double mean_cube() const;  ///< mean of (d/mean)^3, by number
  /// d/mean below which a share (0 to 1) of all spheres are, by number.
  double quantile(double share) const;
};

// The keys of each kind of phase: a key that a kind does not have does not exist in its type. `word` is what a document
// calls the kind.

struct FluidKeys {
  static constexpr PhaseKind kind = PhaseKind::fluid;
  static constexpr const char* word = "fluid";
  static constexpr bool has_particles = true;
  double viscosity{};                 // m2/s, kinematic
  std::optional<double> sound_speed;  // m/s; empty: 10 times the largest speed that the scene promises
  EquationOfState equation_of_state{};
  double tait_exponent{};
  double artificial_viscosity{};  // Monaghan's alpha
  double density_diffusion{};     // delta of delta-SPH, 0 switches it off
  double shifting{};              // strength of particle shifting, 0 switches it off
  double background_pressure{};   // in rho0 c^2
  FluidScheme scheme{};
  std::optional<bool> enclosed;  // its mean density is kept; empty: the plan sees whether it is shut in
  Turbulence turbulence{};
  double smagorinsky{};  // C_s of nu_t = (C_s dx)^2 |S|
  bool energy{};         // integrate the internal energy (eq. 13)
  bool energy_budget{};  // history.csv has what took its energy, by name
};

struct ElasticKeys {
  static constexpr PhaseKind kind = PhaseKind::elastic;
  static constexpr const char* word = "elastic";
  static constexpr bool has_particles = true;
  Formulation formulation{};
  double young{};  // Pa
  double poisson{};
  Elasticity elasticity{};                                     // of total-lagrangian bodies, as the next three
  double hourglass{};                                          // strength of the hourglass control, of Young's modulus
  double retardation{};                                        // s, of Kelvin and Voigt's damping
  bool wave_correction{};                                      // short waves of compression keep their speed
  double artificial_viscosity{}, artificial_viscosity_beta{};  // Monaghan's alpha and beta
  double artificial_stress{};  // epsilon of Gray, Monaghan & Swift; updated Lagrangian bodies
  bool energy{};               // integrate the internal energy (eq. 13)
};

/// Each [[fill]] of such a phase is a body that moves as a whole.
struct RigidKeys {
  static constexpr PhaseKind kind = PhaseKind::rigid;
  static constexpr const char* word = "rigid";
  static constexpr bool has_particles = true;
  std::optional<double> stiffness;        // N/m, of a contact (per metre of depth in 2D)
  std::optional<double> largest_overlap;  // of the spacing, at the largest speed of the scene: makes the stiffness
  /// Without the key; wet: where a fluid is between. A body that is stopped as fast as a dry one hammers the water.
  static constexpr double dry_overlap = 0.02, wet_overlap = 0.5;
};

struct GrainsKeys : SphereMaterial {
  static constexpr PhaseKind kind = PhaseKind::grains;
  static constexpr const char* word = "grains";
  static constexpr bool has_particles = true;
  std::optional<double> contact_speed;  // m/s, sqrt(stiffness/density) of a contact; empty: chosen by the plan
  std::optional<double> roughness;      // m, z0 of the logarithmic law; empty: a thirtieth of its spacing
  std::optional<SphereSize> diameter;   // m; empty: particles of one spacing, whose contacts are kernels
  bool sleep{};                         // spheres that nothing disturbs are left out of the steps
};

struct WallKeys {
  static constexpr PhaseKind kind = PhaseKind::wall;
  static constexpr const char* word = "wall";
  static constexpr bool has_particles = true;
  WallLaw law{};
  Slip slip{};
  VectorExpression velocity;           // m/s, a function of time: the surface slides, the particles stay in place
  std::optional<double> roughness;     // m, z0 of the logarithmic law; empty: a smooth wall
  std::optional<Vec3> shear_stress;    // Pa, on the fluid, instead of no slip
  std::optional<SphereSize> diameter;  // m, of its particles as grains feel them; empty: one spacing
};

/// Air as a profile by height, without particles.
struct ColumnKeys {
  static constexpr PhaseKind kind = PhaseKind::column;
  static constexpr const char* word = "column";
  static constexpr bool has_particles = false;
  double viscosity{};                // m2/s, kinematic
  Expression friction_velocity;      // m/s, a function of time: rho u*^2 is the stress on the column's top
  std::optional<double> height;      // m; empty: the domain's
  std::optional<double> resolution;  // m, of the cells among the grains; empty: a quarter of a diameter
  MixingLength mixing_length{};
  Slip slip{};                            // on the bottom of the domain
  std::optional<double> averaging;        // s, of the grains' drag on air without inertia; empty: it has inertia
  bool held{};                            // the profile of the start stays: the air does not feel the grains
  std::optional<double> speed;            // m/s, the same at all heights at the start
  std::optional<LogProfile> log_profile;  // at the start
};

struct Phase {
  std::string name;
  double density{};                                                                       // kg/m3, at rest
  double spacing{};                                                                       // m, of its particles
  std::variant<FluidKeys, ElasticKeys, RigidKeys, GrainsKeys, WallKeys, ColumnKeys> own;  // in the order of PhaseKind

  PhaseKind kind() const { return static_cast<PhaseKind>(own.index()); }
  const char* kind_word() const {
    return std::visit([](const auto& keys) { return keys.word; }, own);
  }
  bool has_particles() const {
    return std::visit([](const auto& keys) { return keys.has_particles; }, own);
  }
  // The keys of its kind; std::bad_variant_access when it is of another kind.
  const FluidKeys& fluid() const { return std::get<FluidKeys>(own); }
  const ElasticKeys& elastic() const { return std::get<ElasticKeys>(own); }
  const RigidKeys& rigid() const { return std::get<RigidKeys>(own); }
  const GrainsKeys& grains() const { return std::get<GrainsKeys>(own); }
  const WallKeys& wall() const { return std::get<WallKeys>(own); }
  const ColumnKeys& column() const { return std::get<ColumnKeys>(own); }
  const ColumnKeys* if_column() const { return std::get_if<ColumnKeys>(&own); }  ///< null of another kind
  const WallKeys* if_wall() const { return std::get_if<WallKeys>(&own); }        ///< null of another kind
  const GrainsKeys* if_grains() const { return std::get_if<GrainsKeys>(&own); }
  /// The sizes of its spheres, if it says them.
  std::optional<SphereSize> diameter() const {
    if (const GrainsKeys* grains = if_grains()) return grains->diameter;
    return if_wall() ? if_wall()->diameter : std::nullopt;
  }
};

// ---- the interaction matrix ----------------------------------------------------------------------------------------

/// One entry of the matrix: an unordered pair of phases. A pair without an entry does not interact.
struct Interaction {
  std::string a, b;                        // phase names as written, "air-sand"
  double radius{};                         // kernel radius (support) in spacings of the coarser phase, eq. (15)-(17)
  std::optional<double> radius_in_metres;  // m; empty: `radius` says it
  bool states_radius{};                    // else it is the default
  KernelKind kernel{};
  double drag{};                            // fluid-grains: drag coefficient of a grain, 0 switches it off
  DragLaw drag_law{};                       // column-grains: drag of a grain
  double lift{};                            // with drag_law and a fluid: lift of a grain on the bed over its drag
  double gusts{};                           // the same: standard deviation of the wind at the bed over its mean
  std::optional<double> coupling_interval;  // s, the same: between two exchanges of momentum
  bool buoyancy{};                          // with drag_law: grains weigh less by the fluid that they displace
  bool magnus{};                            // with drag_law: the force on grains that turn, and the torque on them
  Expression border{};                      // fluid-fluid: above zero the coarser particles; a number: none is given
  ContactLaw law{};                         // of grains with grains, walls and bodies
  std::optional<double> restitution;        // contact of bodies: of two particles that meet
  std::optional<double> friction;           // contact of bodies: Coulomb's coefficient
  bool surfaces{};                          // contact of elastic bodies: by their surfaces, not particle by particle
};

// ---- fills: what is where at the beginning -------------------------------------------------------------------------

struct BoxShape {
  Vec3 min{}, max{};
};  // m
struct DiscShape {
  Vec3 centre{};
  double radius{};
};  // disc in 2D (cylinder along z in 3D)
struct SphereShape {
  Vec3 centre{};
  double radius{};
};
struct RingShape {
  Vec3 centre{};
  double inner{}, outer{};
};  // 2D ring (tube along z in 3D)
/// Of what stands in numbers or in a file: scaled about the origin, turned about z through it, then moved.
struct Placement {
  double scale{};
  double turn{};  // degrees, anticlockwise
  Vec3 move{};    // m
};
struct PolygonShape {
  std::vector<std::array<double, 2>> corners;
  Placement placement;
};                                  // in x, y; at least three corners
using Facet = std::array<Vec3, 3>;  // corners of a triangle; a segment has its end twice
struct SurfaceShape {
  std::string file;  // as written: relative to the scene's file
  Placement placement;
  std::vector<Facet> facets;  // as the file has them; read with the scene
  bool triangles{};           // else segments in x, y
  int part{};                 // of a VTK file: the cells of this number; 0: all
};
struct CubeShape {
  Vec3 centre{};
  int count{};
};  // count particles along each side, spacing apart
struct PointsShape {
  std::vector<Vec3> at;
};  // single particles
struct FileShape {
  std::string file;
};  // spheres where a frame of an earlier run has them
struct FormulaShape {
  Expression inside;
};                                 // particles where it is > 0
struct SidesShape {                // layers of wall particles outside the domain
  std::vector<std::string> sides;  // "bottom","top","left","right","front","back"
  int layers{};
};
struct RemainderShape {};  // the domain less what earlier fills hold

/// Height of the ground above the bed as a function of x (and z in 3D), in metres.
struct DuneShape {
  using Form = DuneForm;
  Form form{};
  double height{}, length{}, at{};  // m; `at` is the crest's x
  double slip_face_angle{};         // degrees, asymmetric only
  Expression formula;               // formula only: height over the bed, m
};
struct BedShape {
  double depth{};  // m, from the domain's bottom
  double from{};   // m over the bottom: nothing below it (a floor that another fill made)
  int layers{};    // of fitted rows
  std::optional<DuneShape> dune;
};

using Shape = std::variant<BoxShape, DiscShape, SphereShape, RingShape, PolygonShape, CubeShape, PointsShape,
                           FormulaShape, SidesShape, BedShape, FileShape, RemainderShape, SurfaceShape>;

struct Fill {
  std::string phase;
  Shape shape = RemainderShape{};
  Packing packing{};
  LeaveOut leave_out{};
  double perturb{};  // spacings of its phase: each coordinate moved by a uniform number in +-perturb
  unsigned seed{};
  VectorExpression velocity;                        // m/s, formulas in x, y, z
  std::optional<AxialExpression> angular_velocity;  // 1/s, of a rigid body about its centre; added to `velocity`
  std::optional<double> mass;                       // kg, of a rigid body; empty: density times what the shape holds
  std::optional<Vec3> centre;                       // m, its centre of mass; empty: that of the shape
  std::optional<AxialExpression> inertia;           // kg m2, about axes through its centre; empty: that of the shape
  std::optional<LogProfile> log_profile;            // added to `velocity`, along x
  Expression pressure;                              // Pa, fluid phases: initial pressure
  bool hydrostatic{};                               // fluid phases: start from the hydrostatic pressure instead
};

// ---- the rest ------------------------------------------------------------------------------------------------------

struct Domain {
  Vec3 origin{};  // m
  Vec3 size{};    // m
  std::array<bool, 3> periodic{};
  Vec3 gravity{};                 // m/s2
  std::vector<std::string> open;  // sides through which fluids leave, or "none"; empty: as the scene shows
};

/// What a [[forcing]] with `hold` keeps.
enum class Hold {
  none,
  bulk_speed,  // the mean velocity of the start, along periodic axes
  stress,      // the force along x on an area of ground, rho u*^2: walls with shear-stress, and the rest in the bulk
  pressure_gradient  // the same, all of it in the bulk
};

struct Forcing {
  std::string phase;              // body force on this phase
  VectorExpression acceleration;  // m/s2, formulas in x, y, z, t
  Hold hold = Hold::none;         // instead: what drives a fluid
  Expression friction_velocity;   // m/s, of the holds of a force; a formula in t
  VectorExpression velocity;      // m/s, instead: a fluid is brought to it,
  Expression rate;                // 1/s: dv/dt = rate (velocity - v); both formulas in x, y, z, t
  std::optional<BoxShape> box;    // where the phase feels it; empty: everywhere
  bool relaxes() const { return rate.is_formula() || rate.value > 0.0; }
  bool holds_force() const { return hold == Hold::stress || hold == Hold::pressure_gradient; }
};

/// A side of the domain through which a fluid enters (start/flow_ends.hpp).
/// Synthetic turbulence on top of the velocity of an inflow (models/fluid/inflow_fluctuations.hpp).
struct Fluctuations {
  double length{};        // m, longitudinal integral length
  Vec3 rms{};             // m/s, of the components
  double shear_stress{};  // Pa, - density <u'v'>
  unsigned seed = 1;
};
struct Inflow {
  std::string phase;
  Side side{};
  VectorExpression velocity;              // m/s, formulas in x, y, z, t
  std::optional<LogProfile> log_profile;  // added to `velocity`, along x
  std::string profile;                    // file of a velocity by height, added to `velocity`; empty: none
  double layer{};                         // m, in which sound is absorbed beyond the side
  std::optional<Fluctuations> fluctuations;
};
/// A side through which it leaves, and enters again where the flow turns.
struct Outflow {
  std::string phase;
  Side side{};
  Expression pressure;          // Pa, beyond the side; a formula in x, y, z, t
  std::optional<double> layer;  // m, in which sound is absorbed beyond the side; empty: 20 spacings
};

/// A side through which grains with a diameter enter (models/grains/grain_source.hpp).
struct Influx {
  std::string phase;
  std::optional<Flank> side;    // through which they enter; empty: they are poured into the box
  std::optional<BoxShape> box;  // in which they begin
  Vec3 velocity;                // m/s, with which they begin in the box
  double start{};               // s, when the first may come
  std::optional<double> end;    // s, when the last may; empty: the end of the run
  double flux{};                // kg/(m s), mass that enters by metre of width and second; into a box in 3D kg/s
  std::string file;  // frame of another run, from whose grains in flight those that enter are drawn; empty: none
  std::optional<double> above;         // m, y from which on grains enter; empty: the bottom of the domain
  std::optional<double> decay_height;  // m, over which the flux falls by a factor e
  std::optional<double> speed;         // m/s, mean, through the side
  double speed_spread{};               // m/s, standard deviation
  double angle{}, angle_spread{};      // degrees, upwards from the horizontal; standard deviation
  unsigned seed{};
};

/// A set of particles of an elastic body, by their places at the start; or the rigid bodies whose centres stand there.
struct BodySet {
  std::string phase;
  std::optional<BoxShape> box;  // empty: all of them
};
/// A set that is held or driven; or a wall, as a whole.
struct Motion : BodySet {
  VectorExpression velocity;  // m/s, formulas in t
  // Of rigid bodies, the first two of walls too:
  std::optional<Vec3> about;                        // m, the place about which they turn; empty: their centres
  std::optional<AxialExpression> angular_velocity;  // 1/s, formulas in t; beside `about`: empty: they turn freely
  std::optional<AxialExpression> torque;            // N m, formulas in t, on bodies that turn freely about a place
  double friction{};                                // N m, the largest torque of the dry friction there
};
/// A wall, a body or a part of one, whose force, torque and impulse are written to history.csv.
struct ForceMeter : BodySet {
  std::string name;
  std::string by;  // of a wall: the phase whose force it is; empty: all that touch it
  Vec3 about{};    // m, of the torque
};
/// A set whose mean place is written to history.csv.
struct Marker : BodySet {
  std::string name;
};

// ---- what is measured ----------------------------------------------------------------------------------------------

/// What all instruments have.
struct Measured {
  std::string name;   // unique among its kind; part of a file's name
  std::string phase;  // what is measured
  double every{};     // s between samples; 0: that of history.csv
  double start{};     // s, when averaging begins
};
struct Probe : Measured {
  Vec3 at{};  // m
};
struct Gauge : Measured {
  Vec3 at{};  // m; its height does not count
};
struct Profile : Measured {
  Vec3 from{}, to{};            // m: points on a line,
  std::optional<BoxShape> box;  // or slices of a box
  std::size_t along{};          // axis of the slices
  int count{};                  // points or slices; 0: one a spacing
};
struct Grid : Measured {
  std::optional<Vec3> min, max;  // m; empty: the domain
  double spacing{};              // m; 0: the scene's
};
struct WallShear : Measured {
  std::string wall;  // phase
  bool top{};        // the upper side of the domain
  int count{};       // columns along x; 0: one a spacing
};
struct SaltationLayer : Measured {
  double flight{};  // of the mean diameter, over the bed: what is higher is in flight
  int count{};      // slices of the domain's height; 0: one a diameter
};
struct Measuring {
  std::vector<Probe> probes;
  std::vector<Gauge> gauges;
  std::vector<Profile> profiles;
  std::vector<Grid> grids;
  std::vector<WallShear> wall_shears;
  std::vector<SaltationLayer> saltation;
};

struct TimeControl {
  double end{};                      // s
  std::optional<double> fixed_step;  // s
  double safety{};                   // factor on every stability limit
  double largest_speed{};            // m/s, a promise used for the automatic sound speed; 0: from the fills
};

struct OutputControl {
  double every{};                   // s between frames; 0: first and last only
  double history_every{};           // s between rows of history.csv; 0: see row_interval()
  std::vector<std::string> fields;  // beside id, phase, velocity, smoothing_length, density, pressure
  FrameFormat format{};
  bool compress{};
  bool walls{};               // write wall particles too
  double checkpoint_every{};  // s of wall time between checkpoints; 0: at the end and at signals only
  int pieces_from{};          // particles: frames of as many or more are written in pieces, one a rank
};

struct Scene {
  std::string file;                    // as given, for messages
  std::vector<std::string> overrides;  // KEY=VALUE of --set, in their order
  std::string name;                    // file name without directory and suffix
  std::string
      identity;  // its document with the overrides, less what a run that goes on may change (scene/identity.hpp)
  std::map<std::string, std::string> places;  // dotted key -> FILE:LINE:COLUMN, for messages (scene/located.hpp)
  std::string title;
  std::string state;  // pvstate that scripts/run renders; empty: none
  int dimensions{};
  double spacing{};  // m, dx: of the phases that do not say their own
  Precision precision{};
  Domain domain;
  std::vector<Phase> phases;
  std::vector<Interaction> interactions;
  std::vector<std::array<std::string, 2>> apart;  // pairs of phases that do not interact, as the scene says
  std::vector<Fill> fills;
  std::vector<Forcing> forcings;
  std::vector<Inflow> inflows;
  std::vector<Outflow> outflows;
  std::vector<Influx> influxes;
  std::vector<Motion> motions;
  std::vector<Marker> markers;
  std::vector<ForceMeter> force_meters;
  Measuring measuring;
  TimeControl time;
  OutputControl output;
};

/// Seconds between rows of history.csv: as given, or a hundredth of the end time. Where it is not given, rows do not
/// cut steps, so that a run that goes on to a later end takes the same ones.
inline double row_interval(const Scene& scene) {
  return scene.output.history_every > 0.0 ? scene.output.history_every : scene.time.end / 100.0;
}

}  // namespace barchan
