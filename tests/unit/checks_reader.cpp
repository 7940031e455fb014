// The reader: the design's example, every key, overrides, the schema.
#include "checks/reader.hpp"
#include "scene/schema.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "base/errors.hpp"
#include "scene/constants.hpp"
#include "scene/document.hpp"
#include "scene/keys.hpp"
#include "scene/nearest.hpp"
#include "scene/toml.hpp"
#include "scene/validate.hpp"
#include "unit/scene_texts.hpp"

namespace barchan {
namespace {

using testing::dune_text;
using testing::square_text;
using testing::with;

std::string problem_of(const std::string& text, const std::vector<std::string>& overrides = {}) {
  try {
    parse_scene(text, "s.toml", overrides);
  } catch (const SceneError& error) { return error.what(); }
  return "";
}

TEST(SceneReader, ReadsTheDesignsExample) {
  const Scene scene = parse_scene(dune_text, "some/where/dune.toml");
  EXPECT_EQ(scene.file, "some/where/dune.toml");
  EXPECT_EQ(scene.name, "dune");
  EXPECT_EQ(scene.title, "Wind over a small dune");
  EXPECT_EQ(scene.dimensions, 2);
  EXPECT_DOUBLE_EQ(scene.spacing, 1e-3);
  EXPECT_EQ(scene.domain.size, (Vec3{0.4, 0.1, 0.0}));
  EXPECT_EQ(scene.domain.periodic, (std::array<bool, 3>{true, false, false}));
  EXPECT_EQ(scene.domain.gravity, (Vec3{0.0, -9.81, 0.0}));
  ASSERT_EQ(scene.phases.size(), 2u);
  EXPECT_EQ(scene.phases[0].name, "air");
  EXPECT_EQ(scene.phases[0].kind(), PhaseKind::fluid);
  EXPECT_DOUBLE_EQ(scene.phases[0].fluid().viscosity, 1.48e-5);
  EXPECT_EQ(scene.phases[0].fluid().turbulence, Turbulence::mixing_length);
  EXPECT_FALSE(scene.phases[0].fluid().sound_speed.has_value());
  EXPECT_EQ(scene.phases[1].kind(), PhaseKind::grains);
  EXPECT_DOUBLE_EQ(scene.phases[1].density, 2650);
  EXPECT_DOUBLE_EQ(scene.phases[1].grains().restitution, 0.7);
  ASSERT_EQ(scene.interactions.size(), 3u);
  EXPECT_EQ(scene.interactions[1].a, "air");
  EXPECT_EQ(scene.interactions[1].b, "sand");
  EXPECT_DOUBLE_EQ(scene.interactions[1].radius, 2.5);
  EXPECT_EQ(scene.interactions[1].kernel, KernelKind::wendland_c2);
  ASSERT_EQ(scene.fills.size(), 2u);
  const auto& bed = std::get<BedShape>(scene.fills[0].shape);
  EXPECT_DOUBLE_EQ(bed.depth, 0.01);
  ASSERT_TRUE(bed.dune.has_value());
  EXPECT_DOUBLE_EQ(bed.dune->height, 0.02);
  EXPECT_DOUBLE_EQ(bed.dune->length, 0.12);
  EXPECT_DOUBLE_EQ(bed.dune->at, 0.15);
  EXPECT_TRUE(std::holds_alternative<RemainderShape>(scene.fills[1].shape));
  ASSERT_TRUE(scene.fills[1].log_profile.has_value());
  EXPECT_DOUBLE_EQ(scene.fills[1].log_profile->friction_velocity, 0.4);
  EXPECT_DOUBLE_EQ(scene.fills[1].log_profile->roughness, 8.3e-6);
  EXPECT_TRUE(scene.fills[1].log_profile->over_ground);
  EXPECT_DOUBLE_EQ(scene.time.end, 0.07);
  EXPECT_DOUBLE_EQ(scene.output.every, 1e-3);
  EXPECT_EQ(scene.output.fields, (std::vector<std::string>{"velocity", "phase", "smoothing_length"}));
}

/// The defaults are the best we know: docs/accuracy.md for fluids, eq. (16) of Halik et al. 2015 for contacts.
TEST(SceneReader, DefaultsAreTheBestWeKnow) {
  const Scene scene =
      parse_scene(dune_text, "s.toml",
                  {"interactions.air-air={}", "interactions.sand-sand={}", "interactions.air-sand={ drag = 1 }"});
  EXPECT_EQ(scene.phases[0].fluid().scheme, FluidScheme::consistent);
  EXPECT_FALSE(scene.phases[0].fluid().enclosed.has_value()) << "the plan decides";
  EXPECT_EQ(parse_scene(with(dune_text, "restitution = 0.7", ""), "s.toml").phases[1].grains().restitution, 0.7)
      << "a bed comes to rest";
  for (const Interaction& pair : scene.interactions) {
    const bool contact = pair.a == "sand" && pair.b == "sand";
    EXPECT_EQ(pair.kernel, contact ? KernelKind::cubic_spline : KernelKind::wendland_c2) << pair.a << "-" << pair.b;
    EXPECT_EQ(pair.radius, contact ? 1.1 : 2.1) << pair.a << "-" << pair.b;
  }
  const Scene told =
      parse_scene(dune_text, "s.toml",
                  {"interactions.kernel=cubic-spline", "phases.air.turbulence=none", "phases.air.scheme=plain"});
  for (const Interaction& pair : told.interactions) EXPECT_EQ(pair.kernel, KernelKind::cubic_spline);
}

TEST(SceneReader, KeepsTheOrderOfPhasesAndPairsInTheFile) {
  const std::string text =
      with(with(square_text, "[phases.air]", "[phases.zinc]\nkind = \"grains\"\ndensity = 70\n[phases.air]"),
           "air-air = 3.0", "zinc-zinc = 1.1\nair-zinc = 2\nair-air = 3.0") +
      "[[fill]]\nphase = \"zinc\"\nshape = { points = [[0.5, 0.5]] }\n";
  const Scene scene = parse_scene(text, "s.toml");
  ASSERT_EQ(scene.phases.size(), 2u);
  EXPECT_EQ(scene.phases[0].name, "zinc");
  EXPECT_EQ(scene.interactions[0].a, "zinc");
  EXPECT_EQ(scene.interactions[2].b, "air");
}

/// A three-dimensional scene that sets every key of every section but the shapes, each to something else than its
/// default.
const std::string every_key = R"toml(
title = "All keys"
state = "airflow"
dimensions = 3
spacing = 0.1
precision = "mixed"
[domain]
origin = [-1, 0, 0.5]
size = [2, 1, 1]
periodic = ["x", "z"]
gravity = [0.5, -9, 0.25]
[phases.water]
kind = "fluid"
density = 1000
viscosity = 1e-6
sound-speed = 20
equation-of-state = "tait"
tait-exponent = 6
artificial-viscosity = 0.02
density-diffusion = 0.2
shifting = 0.5
background-pressure = 0.05
enclosed = true
scheme = "consistent"
turbulence = "smagorinsky"
smagorinsky = 0.1
[phases.oil]
kind = "fluid"
density = 900
sound-speed = 20
scheme = "plain"
energy = true
[phases.steel]
kind = "elastic"
formulation = "updated-lagrangian"
density = 7870
young = 206e9
poisson = 0.3
artificial-viscosity = 1
artificial-viscosity-beta = 2
energy = true
[phases.sand]
kind = "grains"
density = 26500
restitution = 0.8
contact-speed = 12
spacing = 0.05
[phases.floor]
kind = "wall"
law = "repulsive"
[phases.lid]
kind = "wall"
velocity = [0.25, 0, "sin(t)"]
roughness = 1e-4
[phases.belt]
kind = "wall"
slip = "free-slip"
[phases.roof]
kind = "wall"
shear-stress = [0.5, 0, -0.25]
[interactions]
kernel = "wendland-c2"
water-water = 3
water-sand = { radius = 2, kernel = "cubic-spline", drag = 0.5 }
floor-water = { radius-in-metres = 0.25 }
lid-water = 2.5
water-belt = 2.1
roof-water = {}
oil-oil = 2.1
[[fill]]
phase = "floor"
shape = { sides = ["bottom"], layers = 2 }
[[fill]]
phase = "sand"
shape = { points = [[0, 0.5, 1], [0.5, 0.5, 1]] }
[[fill]]
phase = "steel"
shape = { cube = { centre = [0.25, 0.25, 0.75], count = 2 } }
velocity = [1, 2, 3]
[[fill]]
phase = "water"
shape = "the-rest"
packing = "rows"
perturb = 0.2
seed = 7
velocity = { log-profile = { friction-velocity = 0.5, roughness = 1e-5, over-ground = false, along-ground = false } }
pressure = "1000*y"
[[fill]]
phase = "oil"
shape = { points = [[0.05, 0.95, 1.45]] }
[[fill]]
phase = "lid"
shape = { sides = ["top"] }
[[fill]]
phase = "belt"
shape = { points = [[0.05, -0.95, 1.45]] }
[[fill]]
phase = "roof"
shape = { points = [[0.05, 1.95, 1.45]] }
[[forcing]]
phase = "water"
acceleration = [0.1, "t", "x*y*z"]
[[forcing]]
phase = "oil"
hold = "bulk-speed"
[[probe]]
name = "crest"
phase = "water"
at = [0, 0.5, 1]
every = 0.01
start = 0.5
[[profile]]
name = "line"
phase = "water"
from = [0, 0, 1]
to = [0, 1, 1]
count = 11
every = 0.02
start = 0.25
[[profile]]
name = "slices"
phase = "sand"
box = { min = [-1, 0, 0.5], max = [1, 0.5, 1.5] }
along = "z"
[[grid]]
name = "plane"
phase = "water"
min = [-1, 0, 1]
max = [1, 1, 1]
spacing = 0.2
every = 0.03
start = 0.75
[[wall-shear]]
name = "lid"
phase = "water"
wall = "lid"
side = "top"
count = 7
every = 0.04
start = 1
[time]
end = 2
safety = 0.5
largest-speed = 3
[output]
every = 0.25
history-every = 0.125
checkpoint-every = 60
fields = ["density_rate"]
format = "vtu"
compress = false
walls = false
)toml";

TEST(SceneReader, TakesEveryKey) {
  const Scene scene = parse_scene(every_key, "all.toml");
  EXPECT_EQ(scene.state, "airflow");
  EXPECT_EQ(scene.dimensions, 3);
  EXPECT_EQ(scene.precision, Precision::mixed);
  EXPECT_EQ(scene.domain.origin, (Vec3{-1, 0, 0.5}));
  EXPECT_EQ(scene.domain.gravity, (Vec3{0.5, -9, 0.25}));
  EXPECT_EQ(scene.domain.periodic, (std::array<bool, 3>{true, false, true}));
  const FluidKeys& water = scene.phases.at(0).fluid();
  EXPECT_EQ(water.sound_speed, 20);
  EXPECT_EQ(water.equation_of_state, EquationOfState::tait);
  EXPECT_EQ(water.tait_exponent, 6);
  EXPECT_EQ(water.artificial_viscosity, 0.02);
  EXPECT_EQ(water.density_diffusion, 0.2);
  EXPECT_EQ(water.shifting, 0.5);
  EXPECT_EQ(water.background_pressure, 0.05);
  EXPECT_EQ(water.scheme, FluidScheme::consistent);
  EXPECT_EQ(water.enclosed, true);
  EXPECT_EQ(water.turbulence, Turbulence::smagorinsky);
  EXPECT_EQ(water.smagorinsky, 0.1);
  EXPECT_EQ(scene.phases.at(1).fluid().scheme, FluidScheme::plain);
  EXPECT_TRUE(scene.phases.at(1).fluid().energy);
  const ElasticKeys& steel = scene.phases.at(2).elastic();
  EXPECT_EQ(steel.young, 206e9);
  EXPECT_EQ(steel.poisson, 0.3);
  EXPECT_EQ(steel.artificial_viscosity, 1);
  EXPECT_EQ(steel.artificial_viscosity_beta, 2);
  const GrainsKeys& sand = scene.phases.at(3).grains();
  EXPECT_EQ(sand.restitution, 0.8);
  EXPECT_EQ(sand.contact_speed, 12);
  EXPECT_EQ(scene.phases.at(3).spacing, 0.05);
  EXPECT_EQ(scene.phases.at(2).spacing, 0.1) << "a phase without a spacing has that of the scene";
  const Phase& floor = scene.phases.at(4);
  EXPECT_EQ(floor.wall().law, WallLaw::repulsive);
  const WallKeys& lid = scene.phases.at(5).wall();
  EXPECT_EQ(lid.velocity[0].value, 0.25);
  EXPECT_EQ(lid.velocity[2].formula, "sin(t)");
  EXPECT_EQ(lid.roughness, 1e-4);
  EXPECT_EQ(scene.phases.at(6).wall().slip, Slip::free_slip);
  EXPECT_EQ(scene.phases.at(7).wall().shear_stress, (Vec3{0.5, 0, -0.25}));
  EXPECT_EQ(floor.density, 1000) << "a wall without a density has that of the phase it interacts with";
  EXPECT_EQ(scene.interactions.at(0).kernel, KernelKind::wendland_c2);
  EXPECT_EQ(scene.interactions.at(1).kernel, KernelKind::cubic_spline);
  EXPECT_EQ(scene.interactions.at(1).radius, 2);
  EXPECT_EQ(scene.interactions.at(1).drag, 0.5);
  EXPECT_EQ(scene.interactions.at(2).kernel, KernelKind::wendland_c2);
  EXPECT_EQ(scene.interactions.at(2).radius, 2.5) << "0.25 m in spacings of 0.1 m";
  EXPECT_EQ(std::get<SidesShape>(scene.fills.at(0).shape).layers, 2);
  EXPECT_EQ(std::get<PointsShape>(scene.fills.at(1).shape).at.at(1), (Vec3{0.5, 0.5, 1}));
  EXPECT_EQ(std::get<CubeShape>(scene.fills.at(2).shape).count, 2);
  EXPECT_EQ(scene.fills.at(2).velocity[2].value, 3);
  EXPECT_EQ(scene.fills.at(3).perturb, 0.2);
  EXPECT_EQ(scene.fills.at(3).seed, 7u);
  EXPECT_FALSE(scene.fills.at(3).log_profile->over_ground);
  EXPECT_EQ(scene.fills.at(3).pressure.formula, "1000*y");
  EXPECT_EQ(scene.forcings.at(0).phase, "water");
  EXPECT_EQ(scene.forcings.at(0).acceleration[1].formula, "t");
  EXPECT_EQ(scene.forcings.at(0).hold, Hold::none);
  EXPECT_EQ(scene.forcings.at(1).hold, Hold::bulk_speed);
  const Probe& probe = scene.measuring.probes.at(0);
  EXPECT_EQ(probe.name, "crest");
  EXPECT_EQ(probe.phase, "water");
  EXPECT_EQ(probe.at, (Vec3{0, 0.5, 1}));
  EXPECT_EQ(probe.every, 0.01);
  EXPECT_EQ(probe.start, 0.5);
  const Profile& line = scene.measuring.profiles.at(0);
  EXPECT_EQ(line.from, (Vec3{0, 0, 1}));
  EXPECT_EQ(line.to, (Vec3{0, 1, 1}));
  EXPECT_EQ(line.count, 11);
  EXPECT_FALSE(line.box.has_value());
  const Profile& slices = scene.measuring.profiles.at(1);
  EXPECT_EQ(slices.box->min, (Vec3{-1, 0, 0.5}));
  EXPECT_EQ(slices.box->max, (Vec3{1, 0.5, 1.5}));
  EXPECT_EQ(slices.along, 2u);
  const Grid& grid = scene.measuring.grids.at(0);
  EXPECT_EQ(*grid.min, (Vec3{-1, 0, 1}));
  EXPECT_EQ(*grid.max, (Vec3{1, 1, 1}));
  EXPECT_EQ(grid.spacing, 0.2);
  const WallShear& shear = scene.measuring.wall_shears.at(0);
  EXPECT_EQ(shear.wall, "lid");
  EXPECT_TRUE(shear.top);
  EXPECT_EQ(shear.count, 7);
  EXPECT_EQ(shear.every, 0.04);
  EXPECT_EQ(shear.start, 1);
  EXPECT_EQ(scene.time.safety, 0.5);
  EXPECT_EQ(scene.time.largest_speed, 3);
  EXPECT_EQ(scene.output.history_every, 0.125);
  EXPECT_EQ(scene.output.checkpoint_every, 60);
  EXPECT_EQ(scene.output.format, FrameFormat::vtu);
  EXPECT_FALSE(scene.output.compress);
  EXPECT_FALSE(scene.output.walls);
}

const std::string sphere_keys = R"toml(
spacing = 1e-3
[domain]
size = [0.1, 0.1]
gravity = [0, -10]
[phases.sand]
kind = "grains"
density = 2650
diameter = { mean = 1e-3, spread = 0.2 }
friction = 0.5
rolling-friction = 0.1
sleep = true
stiffness = 300
[phases.stones]
kind = "grains"
density = 2500
diameter = 2e-3
largest-overlap = 0.03
[phases.ground]
kind = "wall"
diameter = { mean = 3e-3, spread = 0.1 }
[interactions]
sand-sand = { law = "linear" }
sand-ground = { law = "linear" }
stones-stones = { law = "hertz" }
[[fill]]
phase = "ground"
shape = { box = { min = [0, 0], max = [0.1, 0.004] } }
[[fill]]
phase = "sand"
shape = { bed = 0.01, from = 0.004 }
packing = "settled"
[[fill]]
phase = "stones"
shape = { points = [[0.05, 0.05]] }
[time]
end = 1
)toml";

TEST(SceneReader, ReadsTheKeysOfSpheres) {
  const Scene scene = parse_scene(sphere_keys, "s.toml");
  const GrainsKeys &sand = scene.phases.at(0).grains(), &stones = scene.phases.at(1).grains();
  EXPECT_EQ(sand.diameter->mean, 1e-3);
  EXPECT_EQ(sand.diameter->spread, 0.2);
  EXPECT_EQ(sand.friction, 0.5);
  EXPECT_EQ(sand.rolling_friction, 0.1);
  EXPECT_FALSE(sand.tangential_stiffness);
  EXPECT_TRUE(sand.sleep);
  EXPECT_FALSE(stones.sleep);
  EXPECT_EQ(sand.stiffness, 300);
  EXPECT_EQ(stones.diameter->mean, 2e-3);
  EXPECT_EQ(stones.diameter->spread, 0.0);
  EXPECT_EQ(stones.largest_overlap, 0.03);
  EXPECT_EQ(scene.phases.at(2).wall().diameter->mean, 3e-3);
  EXPECT_EQ(scene.interactions.at(0).law, ContactLaw::linear);
  EXPECT_EQ(scene.interactions.at(2).law, ContactLaw::hertz);
  EXPECT_EQ(scene.fills.at(1).packing, Packing::settled);
}

TEST(SceneReader, AMaterialGivesWhatTheSceneLeavesOut) {
  std::string text = sphere_keys;
  text.replace(text.find("density = 2650\n"), 15, "material = \"glass-beads\"\n");
  const Scene scene = parse_scene(text, "s.toml", {"phases.sand.restitution=0.8"});
  const Phase& phase = scene.phases.at(0);
  EXPECT_EQ(phase.density, 2500.0);
  EXPECT_EQ(phase.grains().restitution, 0.8) << "the scene says it";
  EXPECT_EQ(phase.grains().friction, 0.5) << "the scene says it";
  EXPECT_EQ(phase.grains().rolling_friction, 0.1) << "the scene says it";
  ASSERT_TRUE(phase.grains().tangential_stiffness);
  EXPECT_LT(*phase.grains().tangential_stiffness, 0.2);
  text.replace(text.find("glass-beads"), 11, "none");
  EXPECT_THROW(parse_scene(text, "s.toml"), SceneError) << "nobody says the density";
}

/// The keys that only a column of air and what measures sand in flight have.
const std::string column_keys = R"toml(
spacing = 0.1
[domain]
size = [1, 1]
periodic = ["x"]
gravity = [0, -9.81]
[phases.air]
kind = "column"
density = 1.2
viscosity = 1.5e-5
friction-velocity = "0.4*t"
height = 0.5
resolution = 0.01
mixing-length = "none"
averaging = 0.02
[phases.calm]
kind = "column"
density = 1.2
viscosity = 1.5e-5
speed = 2
slip = "free-slip"
[phases.still]
kind = "column"
density = 1.2
viscosity = 1.5e-5
speed = 0
held = true
[phases.silt]
kind = "grains"
density = 2650
[phases.sand]
kind = "grains"
density = 2650
[phases.dust]
kind = "grains"
density = 2650
[interactions]
air-sand = { drag = "cheng" }
calm-dust = {}
still-silt = {}
[[fill]]
phase = "sand"
shape = { points = [[0.5, 0.5]] }
[[fill]]
phase = "dust"
shape = { points = [[0.5, 0.8]] }
[[fill]]
phase = "silt"
shape = { points = [[0.5, 0.2]] }
[[saltation]]
name = "layer"
phase = "sand"
flight = 4
count = 20
[time]
end = 1
)toml";

TEST(SceneReader, ReadsTheKeysOfColumns) {
  const Scene scene = parse_scene(column_keys, "s.toml");
  const ColumnKeys &air = scene.phases.at(0).column(), &calm = scene.phases.at(1).column();
  EXPECT_EQ(air.friction_velocity.formula, "0.4*t");
  EXPECT_EQ(air.height, 0.5);
  EXPECT_EQ(air.resolution, 0.01);
  EXPECT_EQ(air.mixing_length, MixingLength::none);
  EXPECT_EQ(calm.slip, Slip::free_slip);
  EXPECT_EQ(air.averaging, 0.02);
  EXPECT_FALSE(air.held);
  EXPECT_EQ(calm.speed, 2.0);
  EXPECT_TRUE(scene.phases.at(2).column().held);
  EXPECT_EQ(scene.interactions.at(0).drag_law, DragLaw::cheng);
  EXPECT_EQ(scene.interactions.at(1).drag_law, DragLaw::duran);
  EXPECT_EQ(scene.measuring.saltation.at(0).flight, 4);
  EXPECT_EQ(scene.measuring.saltation.at(0).count, 20);
}

const std::string body_keys = R"toml(
spacing = 0.1
[domain]
size = [2, 1]
[phases.a]
kind = "elastic"
formulation = "total-lagrangian"
density = 1000
young = 1e6
elasticity = "saint-venant-kirchhoff"
hourglass = 0.2
retardation = 1e-5
[phases.b]
kind = "elastic"
density = 1000
young = 1e6
[interactions]
a-a = {}
a-b = { restitution = 0.5, friction = 0.25 }
[[fill]]
phase = "a"
shape = { cube = { centre = [0.5, 0.5], count = 4 } }
[[fill]]
phase = "b"
shape = { cube = { centre = [1.3, 0.5], count = 4 } }
[[motion]]
phase = "a"
box = { min = [0, 0], max = [0.4, 1] }
velocity = [0, "sin(t)"]
[[marker]]
name = "end"
phase = "b"
[time]
end = 1
)toml";

TEST(SceneReader, ReadsTheKeysOfBodies) {
  const Scene s = parse_scene(body_keys, "s.toml");
  const ElasticKeys& a = s.phases.at(0).elastic();
  EXPECT_EQ(a.formulation, Formulation::total_lagrangian);
  EXPECT_EQ(s.phases.at(1).elastic().formulation, Formulation::total_lagrangian) << "the default";
  EXPECT_EQ(a.elasticity, Elasticity::saint_venant_kirchhoff);
  EXPECT_EQ(a.hourglass, 0.2);
  EXPECT_EQ(a.retardation, 1e-5);
  EXPECT_EQ(s.interactions.at(0).radius, 1.6) << "recommended for a total Lagrangian body";
  EXPECT_EQ(s.interactions.at(0).kernel, KernelKind::wendland_c2);
  EXPECT_EQ(s.interactions.at(1).restitution, 0.5);
  EXPECT_EQ(s.interactions.at(1).friction, 0.25);
  EXPECT_EQ(s.motions.at(0).box->max[0], 0.4);
  EXPECT_EQ(s.motions.at(0).velocity[1].formula, "sin(t)");
  EXPECT_EQ(s.markers.at(0).name, "end");
  EXPECT_FALSE(s.markers.at(0).box.has_value());
}

const std::string rigid_keys = R"toml(
spacing = 0.1
[domain]
size = [3, 2]
[phases.a]
kind = "rigid"
density = 1000
stiffness = 5e6
[phases.b]
kind = "rigid"
density = 1000
[interactions]
a-b = { restitution = 0.5 }
[[fill]]
phase = "a"
shape = { disc = { centre = [0.6, 1], radius = 0.5 } }
angular-velocity = "2*pi"
[[fill]]
phase = "b"
shape = { box = { min = [1.5, 0.5], max = [2.5, 1.5] } }
[[motion]]
phase = "a"
about = [0.6, 1]
torque = "sin(t)"
friction = 0.25
[[motion]]
phase = "b"
angular-velocity = 3
[time]
end = 1
)toml";

TEST(SceneReader, ReadsTheKeysOfRigidBodies) {
  const Scene s = parse_scene(rigid_keys, "s.toml");
  EXPECT_EQ(s.phases.at(0).rigid().stiffness, 5e6);
  EXPECT_FALSE(s.phases.at(1).rigid().largest_overlap) << "left to what is between";
  EXPECT_EQ(s.fills.at(0).angular_velocity->about[2].formula, "2*pi");
  EXPECT_FALSE(s.fills.at(1).angular_velocity.has_value());
  EXPECT_EQ((*s.motions.at(0).about)[1], 1.0);
  EXPECT_EQ(s.motions.at(0).torque->about[2].formula, "sin(t)");
  EXPECT_EQ(s.motions.at(0).friction, 0.25);
  EXPECT_FALSE(s.motions.at(0).angular_velocity.has_value());
  EXPECT_EQ(s.motions.at(1).angular_velocity->about[2].value, 3.0);
  EXPECT_FALSE(s.motions.at(1).about.has_value());
}

TEST(SceneReader, TakesZonesAndForces) {
  const Scene s = parse_scene(with(square_text, "[time]",
                                   "[[forcing]]\nphase = \"air\"\nrate = \"x\"\nvelocity = [1, \"t\"]\n"
                                   "box = { min = [0.5, 0], max = [1, 1] }\n[time]"),
                              "s.toml");
  EXPECT_TRUE(s.forcings.at(0).relaxes());
  EXPECT_EQ(s.forcings.at(0).rate.formula, "x");
  EXPECT_EQ(s.forcings.at(0).velocity[0].value, 1);
  EXPECT_EQ(s.forcings.at(0).velocity[1].formula, "t");
  EXPECT_EQ(s.forcings.at(0).box->min[0], 0.5);
  const Scene b =
      parse_scene(std::string(body_keys) + "[[force]]\nname = \"left\"\nphase = \"a\"\nabout = [1, 2]\n", "s.toml");
  EXPECT_EQ(b.force_meters.at(0).name, "left");
  EXPECT_EQ(b.force_meters.at(0).about, (Vec3{1, 2, 0}));
  EXPECT_FALSE(b.force_meters.at(0).box.has_value());
}

/// Of every key of a phase: the kinds that have it have a member for it, and no two keys have the same member. That a
/// document's value arrives there and counts is what tests/cli/key_consumers.cpp shows of every key.
TEST(SceneReader, EveryKeyOfAPhaseHasAMemberOfItsOwn) {
  const Slot& chooses = find_key("phases", "kind")->slot;
  for (const Word& kind : chooses.words) {
    Phase phase;
    chooses.choose(&phase, kind.meaning);
    EXPECT_EQ(phase.kind_word(), kind.word);
    std::map<const void*, std::string_view> owners;
    for (const Key* key : keys_of("phases")) {
      if (!key->slot.member || (key->slot.accepts & as_section)) continue;
      const void* member = std::visit(
          [](auto target) -> const void* {
            if constexpr (std::is_same_v<decltype(target), std::monostate>) return nullptr;
            else return target;
          },
          key->slot.member(&phase));
      const bool belongs = belongs_to_kind(*key, kind.word);
      if (belongs)
        EXPECT_TRUE(member && owners.emplace(member, key->name).second)
            << key->name << " of " << kind.word << (member ? " writes what another key writes" : " has no member");
      else EXPECT_TRUE(!member || key->name == "spacing") << key->name << " of " << kind.word;
    }
  }
}

TEST(SceneReader, TakesEveryShape) {
  const auto shape = [](const std::string& text) {
    return parse_scene(with(square_text, "\"the-rest\"", text), "s.toml").fills.at(0).shape;
  };
  EXPECT_EQ(std::get<BoxShape>(shape("{ box = { min = [0, 0.1], max = [1, 0.5] } }")).max, (Vec3{1, 0.5, 0}));
  EXPECT_EQ(std::get<DiscShape>(shape("{ disc = { centre = [0.5, 0.4], radius = 0.2 } }")).radius, 0.2);
  EXPECT_EQ(std::get<SphereShape>(shape("{ sphere = { centre = [0.5, 0.4], radius = 0.2 } }")).centre,
            (Vec3{0.5, 0.4, 0}));
  EXPECT_EQ(std::get<RingShape>(shape("{ ring = { centre = [0.5, 0.4], inner = 0.2, outer = 0.3 } }")).outer, 0.3);
  EXPECT_EQ(std::get<PolygonShape>(shape("{ polygon = [[0, 0], [1, 0], [0, 1]] }")).corners.at(2),
            (std::array<double, 2>{0, 1}));
  const auto moved = std::get<PolygonShape>(
      shape("{ polygon = [[0, 0], [1, 0], [0, 1]], scale = 0.5, turn = 30, move = [0.25, 0.125] }"));
  EXPECT_EQ(moved.placement.scale, 0.5);
  EXPECT_EQ(moved.placement.turn, 30);
  EXPECT_EQ(moved.placement.move, (Vec3{0.25, 0.125, 0}));
  EXPECT_EQ(std::get<CubeShape>(shape("{ cube = { centre = [0.5, 0.5], count = 3 } }")).count, 3);
  EXPECT_EQ(std::get<PointsShape>(shape("{ points = [[0.5, 0.5]] }")).at.size(), 1u);
  const std::string bed =
      with(sphere_keys, "{ bed = 0.01, from = 0.004 }\npacking = \"settled\"", "{ file = \"bed.vtp\" }");
  EXPECT_EQ(std::get<FileShape>(parse_scene(bed, "s.toml").fills.at(1).shape).file, "bed.vtp");
  EXPECT_EQ(std::get<FormulaShape>(shape("{ formula = \"x - y\" }")).inside.formula, "x - y");
  EXPECT_EQ(std::get<BedShape>(shape("{ bed = 0.25 }")).depth, 0.25);
  EXPECT_EQ(std::get<BedShape>(shape("{ bed = 0.25, from = 0.125 }")).from, 0.125);
  const auto dune = [&](const std::string& text) {
    return *std::get<BedShape>(shape("{ bed = 0.25, dune = " + text + " }")).dune;
  };
  EXPECT_EQ(dune("{ form = \"gaussian\", height = 0.1, length = 0.3, at = 0.5 }").form, DuneShape::Form::gaussian);
  EXPECT_EQ(dune("{ form = \"asymmetric\", height = 0.1, length = 0.5, at = 0.5 }").slip_face_angle, 33);
  EXPECT_EQ(
      dune("{ form = \"asymmetric\", height = 0.1, length = 0.5, at = 0.5, slip-face-angle = 30 }").slip_face_angle,
      30);
  EXPECT_EQ(dune("{ form = \"formula\", formula = \"0.1*sin(x)\" }").formula.formula, "0.1*sin(x)");
}

TEST(SceneReader, OverridesReplaceAddAndMake) {
  const Scene scene = parse_scene(
      dune_text, "dune.toml",
      {"time.end=0.01", "spacing=5e-4", "title=Calm", "phases.air.scheme=consistent", "output.format=vtu",
       "fill.0.shape.dune.height=0.03", "fill.1.velocity=[1, 0]", "time.safety=.5", "domain.periodic=[\"x\"]",
       "output.walls=false", "fill.1.pressure=100*y", "interactions.kernel=wendland-c2", "output.every=0.5"});
  EXPECT_EQ(parse_scene(dune_text, "dune.toml", {"time.step=1e-4"}).time.fixed_step, 1e-4);
  EXPECT_EQ(scene.time.end, 0.01);
  EXPECT_EQ(scene.spacing, 5e-4);
  EXPECT_EQ(scene.title, "Calm");
  EXPECT_EQ(scene.phases.at(0).fluid().scheme, FluidScheme::consistent);
  EXPECT_EQ(scene.output.format, FrameFormat::vtu);
  EXPECT_EQ(std::get<BedShape>(scene.fills.at(0).shape).dune->height, 0.03);
  EXPECT_FALSE(scene.fills.at(1).log_profile.has_value());
  EXPECT_EQ(scene.fills.at(1).velocity[0].value, 1.0);
  EXPECT_EQ(scene.fills.at(1).pressure.formula, "100*y");
  EXPECT_EQ(scene.time.safety, 0.5);
  EXPECT_FALSE(scene.output.walls);
  EXPECT_EQ(scene.interactions.at(0).kernel, KernelKind::wendland_c2);
}

TEST(SceneReader, AnOverrideMakesASectionAndTurnsAPairRound) {
  EXPECT_EQ(parse_scene(square_text, "s.toml", {"output.every=0.5"}).output.every, 0.5);
  const Scene scene = parse_scene(dune_text, "s.toml", {"interactions.sand-air=2.0"});
  ASSERT_EQ(scene.interactions.size(), 3u);
  EXPECT_EQ(scene.interactions.back().a, "sand");
  EXPECT_EQ(scene.interactions.back().b, "air");
}

TEST(SceneReader, TellsWhatIsWrongWithAnOverride) {
  EXPECT_EQ(problem_of(square_text, {"time.edn=2"}),
            "--set time.edn=2: time.edn: unknown key; expected a key of [time]; did you mean \"end\"?");
  EXPECT_EQ(problem_of(square_text, {"time.end=-2"}),
            "--set time.end=-2: time.end: -2 is out of range; expected a number > 0 (s)");
  EXPECT_EQ(problem_of(square_text, {"time.end"}),
            "--set time.end: not an override; expected KEY=VALUE, as in time.end=0.01");
  EXPECT_EQ(problem_of(square_text, {"fill.3.seed=1"}),
            "--set fill.3.seed=1: fill.3.seed: there is no fill.3; expected a number from 0 to 0 after \"fill\"");
  EXPECT_EQ(problem_of(square_text, {"spacing.x=1"}),
            "--set spacing.x=1: spacing.x: spacing is a value, not a section");
  EXPECT_EQ(problem_of(square_text, {"domain.size=[1, 2"}),
            "--set domain.size=[1, 2: domain.size: the value is malformed; expected a value as in a scene file");
}

TEST(SceneReader, CollectsAllProblemsInTheOrderOfTheFile) {
  const std::string text = with(with(with(square_text, "spacing = 0.1", "spacing = 0"), "density = 1", "denisty = 1"),
                                "end = 1", "end = \"x\"");
  EXPECT_EQ(problem_of(text, {"output.evry=1"}),
            "s.toml:1:11: spacing: 0 is out of range; expected a number > 0 (m)\n"
            "s.toml:6:1: phases.air.denisty: unknown key; expected a key of [phases.air]; did you mean \"density\"?\n"
            "s.toml:13:7: time.end: found \"x\"; expected a number > 0 (s)\n"
            "--set output.evry=1: output.evry: unknown key; expected a key of [output]; did you mean \"every\"?");
}

TEST(SceneReader, FileThatIsNotThere) {
  try {
    read_scene("/nowhere/at/all.toml");
    FAIL();
  } catch (const SceneError& error) {
    EXPECT_STREQ(error.what(),
                 "/nowhere/at/all.toml: cannot be read: No such file or directory; expected a scene file (.toml)");
  }
}

TEST(SceneSchema, DescribesEveryKeyWithItsUnit) {
  const auto schema = nlohmann::json::parse(scene_schema());
  EXPECT_EQ(schema["$schema"], "http://json-schema.org/draft-04/schema#");
  EXPECT_EQ(schema["properties"]["spacing"]["minimum"], 0.0);
  EXPECT_EQ(schema["properties"]["spacing"]["exclusiveMinimum"], true);
  EXPECT_NE(schema["properties"]["spacing"]["description"].get<std::string>().find("Unit: m."), std::string::npos);
  EXPECT_EQ(schema["required"], (nlohmann::json{"spacing", "domain", "phases", "interactions", "fill", "time"}));
  const auto& phase = schema["properties"]["phases"]["patternProperties"]["^[A-Za-z][A-Za-z0-9_]*$"];
  EXPECT_EQ(phase["properties"]["kind"]["enum"], nlohmann::json(choices(*find_key("phases", "kind"))));
  EXPECT_EQ(phase["additionalProperties"], false);
  for (const Key& key : all_keys()) {
    EXPECT_FALSE(key.meaning.empty()) << key.name;
    EXPECT_NE(scene_schema().find("\"" + std::string(key.name) + "\""), std::string::npos) << key.name;
  }
}

/// The lines of a document in which the example of a key stands at its place, and the dotted name of the key there.
std::pair<std::string, std::string> document_with_example(const Key& key) {
  const std::string user = key.name == "constants"  ? "spacing = \"d\"\n"  // a constant must be used
                           : key.name == "controls" ? "forcing = [{ acceleration = [\"pull\", 0] }]\n"
                                                    : "";
  if (key.section.empty()) return {user + example_of(key), std::string(key.name)};
  std::string path, dotted, text;
  std::istringstream parts{std::string(key.section)};
  for (std::string part; std::getline(parts, part, '.');) {
    const bool first = path.empty();
    path += (first ? "" : ".") + part;
    dotted += (first ? "" : ".") + part;
    if (path == "phases") path += ".air", dotted += ".air";
    else if (path == "interactions.pair") path = dotted = "interactions.air-sand";
    else if (first && (find_key("", part)->slot.accepts & as_sections)) text = "[[" + part + "]]\n", dotted += ".0";
  }
  if (text.empty() || path.find('.') != std::string::npos) text += "[" + path + "]\n";
  return {text + example_of(key), dotted + "." + std::string(key.name)};
}

/// Every key has an example that its own row accepts: its type, its range, its words, the variables of a formula, and
/// the keys of a section.
TEST(SceneExamples, AreAcceptedByTheRowsOfTheirKeys) {
  for (const Key& key : all_keys()) {
    const auto [text, dotted] = document_with_example(key);
    Problems problems("example");  // other keys are missing there; this one is not
    toml::table document = parse_document(text, "example", {}, problems);
    replace_constants(document, problems);
    validate(document, problems);
    EXPECT_FALSE(problems.touch(dotted)) << text;
  }
}

/// Each key has one row in the tables of docs/scenes.md, and none of the six cells of a row is empty.
TEST(SceneExamples, StandInTheReferenceWithUnitRangeAndDefault) {
  std::istringstream tables(scene_tables());
  std::size_t rows = 0;
  for (std::string line; std::getline(tables, line);) {
    if (!line.starts_with("| `")) continue;
    ++rows;
    std::size_t cells = 0;
    for (std::size_t at = 0, end; (end = line.find(" |", at + 1)) != std::string::npos; at = end, ++cells)
      EXPECT_GT(end - at, 2u) << line;
    EXPECT_EQ(cells, 6u) << line;
  }
  EXPECT_EQ(rows, all_keys().size());
}

TEST(Nearest, FindsWhatWasMeant) {
  EXPECT_EQ(edit_distance("kitten", "sitting"), 3);
  EXPECT_EQ(edit_distance("desnity", "density"), 1);
  EXPECT_EQ(edit_distance("sound_speed", "sound-speed"), 0);
  EXPECT_EQ(nearest("viscocity", {"density", "viscosity"}), "viscosity");
  EXPECT_EQ(nearest("banana", {"density", "viscosity"}), "");
}

}  // namespace
}  // namespace barchan
