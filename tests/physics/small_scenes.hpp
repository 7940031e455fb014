// Small scenes that several tests of the step run.
#pragma once

#include <memory>
#include <ostream>
#include <string>

#include "checks/reader.hpp"
#include "simulation/settle.hpp"
#include "simulation/simulation.hpp"
#include "start/generate.hpp"

namespace barchan::small {

/// Rigid bodies on a floor, among grains.
inline const std::string rigid = R"toml(
spacing = 0.02
[domain]
size = [2, 1]
gravity = [0, -9.81]
[phases.a]
kind = "rigid"
density = 1000
largest-overlap = 0.2
[phases.sand]
kind = "grains"
density = 1000
contact-speed = 20
[phases.floor]
kind = "wall"
[interactions]
a-a = { restitution = 0.5, friction = 0.5 }
a-floor = { restitution = 0.5, friction = 0.5 }
a-sand = {}
sand-floor = {}
[[fill]]
phase = "a"
shape = { polygon = [[0.5, 0.01], [0.7, 0.01], [0.6, 0.21]] }
velocity = [3, 0]
[[fill]]
phase = "a"
shape = { disc = { centre = [1.4, 0.11], radius = 0.1 } }
velocity = [-2, 0]
[[fill]]
phase = "sand"
shape = { box = { min = [0.9, 0], max = [1.2, 0.1] } }
velocity = ["5*sin(30*x)", 0]
[[fill]]
phase = "floor"
shape = { sides = ["bottom", "left", "right"] }
[[motion]]
phase = "a"
box = { min = [1.3, 0], max = [1.5, 0.3] }
about = [1.4, 0.11]
torque = "t"
friction = 0.1
[time]
end = 1
)toml";

/// Rigid bodies in a periodic fluid that whirls; two of them touch.
inline const std::string drowned = R"toml(
precision = "double"
spacing = 0.05
[domain]
size = [2, 2]
periodic = ["x", "y"]
[phases.water]
kind = "fluid"
density = 1000
viscosity = 1e-2
sound-speed = 20
scheme = "plain"
energy = true
[phases.ball]
kind = "rigid"
density = 1500
largest-overlap = 0.2
[phases.block]
kind = "rigid"
density = 700
[interactions]
water-water = 2.6
water-ball = 2.6
water-block = 2.6
ball-block = { restitution = 0.5, friction = 0.3 }
[[fill]]
phase = "ball"
shape = { disc = { centre = [0.5, 0.5], radius = 0.2 } }
velocity = [1, 0]
angular-velocity = 3
[[fill]]
phase = "ball"
shape = { disc = { centre = [1.5, 1.6], radius = 0.15 } }
[[fill]]
phase = "block"
shape = { box = { min = [0.75, 0.4], max = [1.05, 0.55] } }
[[fill]]
phase = "water"
shape = "the-rest"
velocity = ["sin(pi*x)*cos(pi*y)", "-cos(pi*x)*sin(pi*y)"]
[time]
end = 1
largest-speed = 2
)toml";

/// A scene with some words of it changed.
inline std::string changed(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  if (at == std::string::npos) throw std::logic_error("no \"" + from + "\" in the scene");
  return text.replace(at, from.size(), to);
}
/// The same in a fluid of the consistent scheme.
inline const std::string drowned_consistent =
    changed(drowned, "scheme = \"plain\"\nenergy = true", "scheme = \"consistent\"");

/// A ball in a periodic fluid, in three dimensions.
inline const std::string drowned_ball = R"toml(
precision = "double"
dimensions = 3
spacing = 0.1
[domain]
size = [1.5, 1.5, 1.5]
periodic = ["x", "y", "z"]
[phases.water]
kind = "fluid"
density = 1000
viscosity = 1e-2
sound-speed = 20
scheme = "plain"
energy = true
[phases.ball]
kind = "rigid"
density = 1500
[interactions]
water-water = 2.6
water-ball = 2.6
[[fill]]
phase = "ball"
shape = { sphere = { centre = [0.7, 0.7, 0.7], radius = 0.3 } }
velocity = [0.3, 0.15, 0]
angular-velocity = [0, 1, 0.3]
[[fill]]
phase = "water"
shape = "the-rest"
[time]
end = 1
largest-speed = 2
)toml";

/// The same in a fluid of the consistent scheme.
inline const std::string drowned_ball_consistent =
    changed(drowned_ball, "scheme = \"plain\"\nenergy = true", "scheme = \"consistent\"");

/// Spheres that fall on a free body from two sides, without weight.
inline const std::string spheres_on_block = R"toml(
spacing = 0.01
[domain]
origin = [-0.5, -0.5]
size = [1, 1]
[phases.sand]
kind = "grains"
density = 2500
diameter = { mean = 0.02, spread = 0.2 }
restitution = 0.6
friction = 0.4
rolling-friction = 0.05
[phases.block]
kind = "rigid"
density = 2000
[interactions]
sand-sand = { law = "linear" }
sand-block = { law = "hertz" }
[[fill]]
phase = "block"
shape = { polygon = [[-0.1, -0.05], [0.12, -0.06], [0.1, 0.06], [-0.08, 0.05]] }
velocity = [0, 0.2]
angular-velocity = 2
[[fill]]
phase = "sand"
shape = { box = { min = [-0.25, 0.1], max = [0.2, 0.16] } }
velocity = [0.3, -1]
[time]
end = 0.3
largest-speed = 1.5
)toml";

/// The same in three dimensions, on a box.
inline const std::string spheres_on_block_3d = R"toml(
dimensions = 3
spacing = 0.01
[domain]
origin = [-0.5, -0.5, -0.5]
size = [1, 1, 1]
periodic = ["x", "y", "z"]
[phases.sand]
kind = "grains"
density = 2500
diameter = { mean = 0.02, spread = 0.2 }
restitution = 0.6
friction = 0.4
rolling-friction = 0.05
[phases.block]
kind = "rigid"
density = 2000
[interactions]
sand-sand = { law = "linear" }
sand-block = { law = "linear" }
[[fill]]
phase = "block"
shape = { box = { min = [-0.06, -0.04, -0.05], max = [0.06, 0.04, 0.05] } }
velocity = [0, 0.2, 0]
angular-velocity = [1, 2, 0]
[[fill]]
phase = "sand"
shape = { box = { min = [-0.06, 0.09, -0.06], max = [0.07, 0.12, 0.04] } }
velocity = [0.2, -1, 0.1]
[time]
end = 0.3
largest-speed = 1.5
)toml";

/// A fluid with a wall below, in wind; nothing else.
inline const std::string channel = R"toml(
spacing = 0.01
[domain]
size = [0.3, 0.2]
periodic = ["x"]
gravity = [0.1, -9.81]
[phases.water]
kind = "fluid"
density = 1000
viscosity = 1e-3
sound-speed = 20
scheme = "plain"
enclosed = false
[phases.floor]
kind = "wall"
[interactions]
kernel = "wendland-c2"
water-water = 3.0
water-floor = 3.0
[[fill]]
phase = "floor"
shape = { sides = ["bottom", "top"], layers = 3 }
[[fill]]
phase = "water"
shape = "the-rest"
perturb = 0.1
velocity = ["2 + sin(2*pi*x/0.3)", "0.5*sin(2*pi*x/0.3)*sin(pi*y/0.2)"]
[time]
end = 10
largest-speed = 3
)toml";

/// Wind over a little dune on a floor of fixed grains, with a lid: every kind of coupling at once.
inline const std::string dune = R"toml(
spacing = 1e-3
[domain]
size = [0.06, 0.03]
periodic = ["x"]
gravity = [0, -9.81]
[phases.air]
kind = "fluid"
density = 1.225
viscosity = 1.48e-5
sound-speed = 200
enclosed = true
scheme = "consistent"
artificial-viscosity = 0.02
[phases.sand]
kind = "grains"
density = 2650
restitution = 0.7
[phases.floor]
kind = "wall"
[phases.lid]
kind = "wall"
slip = "free-slip"
[interactions]
kernel = "cubic-spline"
air-air = { radius = 3.0, kernel = "wendland-c2" }
air-sand = 2.5
sand-sand = 1.1
sand-floor = 1.1
air-lid = 3.0
[[fill]]
phase = "floor"
shape = { box = { min = [0, 0], max = [0.06, 0.002] } }
packing = "staggered"
[[fill]]
phase = "sand"
shape = { bed = 0.004, from = 0.002, dune = { form = "cosine", height = 0.006, length = 0.04, at = 0.03 } }
packing = "staggered"
[[fill]]
phase = "lid"
shape = { sides = ["top"], layers = 3 }
[[fill]]
phase = "air"
shape = "the-rest"
velocity = { log-profile = { friction-velocity = 0.8, roughness = 3.3e-5 } }
[time]
end = 10
)toml";

/// The same in turbulent air.
inline const std::string turbulent_dune = [] {
  std::string text = dune;
  const std::string scheme = "scheme = \"consistent\"\n";
  return text.insert(text.find(scheme), "turbulence = \"mixing-length\"\n");
}();

/// The same dune under air whose bulk speed is held, with a form drag on the grains.
inline const std::string held_dune = [] {
  std::string text = dune;
  const std::string coupling = "air-sand = 2.5\n";
  text.replace(text.find(coupling), coupling.size(), "air-sand = { radius = 2.5, drag = 0.44 }\n");
  return text + "[[forcing]]\nphase = \"air\"\nhold = \"bulk-speed\"\n";
}();

/// A column of water that breaks into a tank: a free surface, and spray.
inline const std::string dam = R"toml(
spacing = 0.01
[domain]
size = [0.4, 0.4]
gravity = [0, -9.81]
[phases.water]
kind = "fluid"
density = 1000
viscosity = 1e-6
sound-speed = 40
scheme = "consistent"
artificial-viscosity = 0.02
[phases.tank]
kind = "wall"
slip = "free-slip"
[interactions]
kernel = "wendland-c2"
water-water = 3.0
water-tank = 3.0
[[fill]]
phase = "tank"
shape = { sides = ["left", "right", "bottom"], layers = 3 }
[[fill]]
phase = "water"
shape = { box = { min = [0, 0], max = [0.15, 0.3] } }
perturb = 0.1
velocity = ["4*x", "-4*y"]
pressure = "hydrostatic"
[time]
end = 10
largest-speed = 3
)toml";

inline const std::string plain_dam = [] {
  std::string text = dam;
  const std::string scheme = "scheme = \"consistent\"";
  return text.replace(text.find(scheme), scheme.size(), "scheme = \"plain\"");
}();

/// Air that blows over water in a channel.
inline const std::string two_fluids = R"toml(
spacing = 0.01
[domain]
size = [0.3, 0.2]
periodic = ["x"]
gravity = [0, -9.81]
[phases.water]
kind = "fluid"
density = 1000
viscosity = 1e-3
sound-speed = 20
scheme = "consistent"
[phases.air]
kind = "fluid"
density = 1
viscosity = 1e-3
sound-speed = 20
scheme = "consistent"
[phases.wall]
kind = "wall"
[interactions]
kernel = "wendland-c2"
water-water = 2.6
air-air = 2.6
water-air = 2.6
water-wall = 2.6
air-wall = 2.6
[[fill]]
phase = "wall"
shape = { sides = ["bottom", "top"], layers = 3 }
[[fill]]
phase = "water"
shape = { box = { min = [0, 0], max = [0.3, 0.1] } }
perturb = 0.1
velocity = ["0.5*sin(2*pi*x/0.3)", 0]
pressure = "hydrostatic"
[[fill]]
phase = "air"
shape = "the-rest"
perturb = 0.1
velocity = ["1 + sin(2*pi*x/0.3)", 0]
pressure = "hydrostatic"
[time]
end = 10
largest-speed = 2
)toml";

/// Two elastic squares that collide.
inline const std::string squares = R"toml(
spacing = 1e-3
[domain]
size = [0.04, 0.03]
[phases.a]
kind = "elastic"
formulation = "updated-lagrangian"
density = 1000
young = 1e7
poisson = 0.3
artificial-viscosity = 0.5
[phases.b]
kind = "elastic"
formulation = "updated-lagrangian"
density = 1000
young = 1e7
poisson = 0.3
artificial-viscosity = 0.5
[interactions]
a-a = 2.4
b-b = 2.4
a-b = 2.4
[[fill]]
phase = "a"
shape = { box = { min = [0.005, 0.010], max = [0.014, 0.020] } }
velocity = [4, 0.5]
[[fill]]
phase = "b"
shape = { box = { min = [0.016, 0.008], max = [0.026, 0.018] } }
velocity = [-4, 0]
[time]
end = 10
largest-speed = 8
)toml";

/// Grains that fall into a heap in a periodic channel with a floor.
inline const std::string grains = R"toml(
spacing = 1e-3
[domain]
size = [0.04, 0.06]
periodic = ["x"]
gravity = [0.5, -9.81]
[phases.sand]
kind = "grains"
density = 2650
restitution = 0.6
[phases.floor]
kind = "wall"
density = 2650
[interactions]
sand-sand = 1.1
sand-floor = 1.1
[[fill]]
phase = "floor"
shape = { sides = ["bottom"], layers = 1 }
[[fill]]
phase = "sand"
shape = { box = { min = [0.0, 0.002], max = [0.04, 0.02] } }
packing = "random"
velocity = ["0.2*sin(2*pi*x/0.04)", "-0.3*y/0.02"]
[time]
end = 10
)toml";

/// The same grains in air without particles, which they slow down.
inline const std::string blown_grains = [] {
  std::string text = grains;
  text.replace(text.find("[0.5, -9.81]"), 12, "[0, -9.81]");
  text.insert(text.find("[phases.floor]"),
              "[phases.air]\nkind = \"column\"\ndensity = 1.2\nviscosity = 1.5e-5\nfriction-velocity = 1\n");
  text.insert(text.find("sand-sand"), "air-sand = {}\n");
  return text;
}();

/// Spheres of two phases and many sizes, with friction and rolling resistance, that are shaken over a side of the
/// domain and fixed spheres.
inline const std::string spheres = R"toml(
spacing = 1e-3
[domain]
size = [0.04, 0.06]
periodic = ["x"]
gravity = [0.5, -9.81]
[phases.stones]
kind = "grains"
density = 2000
diameter = 2e-3
friction = 0.3
rolling-friction = 0.05
[phases.base]
kind = "wall"
diameter = { mean = 1e-3, spread = 0.2 }
[phases.sand]
kind = "grains"
density = 2650
diameter = { mean = 1e-3, spread = 0.2 }
friction = 0.5
rolling-friction = 0.1
[phases.floor]
kind = "wall"
[interactions]
stones-stones = { law = "linear" }
stones-sand = { law = "linear" }
stones-floor = { law = "linear" }
sand-sand = { law = "linear" }
sand-floor = { law = "linear" }
sand-base = { law = "linear" }
base-stones = { law = "linear" }
[[fill]]
phase = "base"
shape = { box = { min = [0.01, 0.0], max = [0.02, 0.003] } }
[[fill]]
phase = "floor"
shape = { sides = ["bottom"], layers = 1 }
[[fill]]
phase = "sand"
shape = { box = { min = [0.0, 0.004], max = [0.04, 0.03] } }
packing = "staggered"
velocity = ["0.5*sin(2*pi*x/0.04)", "-0.8*y/0.02"]
seed = 3
[[fill]]
phase = "stones"
shape = { box = { min = [0.0, 0.034], max = [0.04, 0.04] } }
velocity = ["1", "-1"]
[[forcing]]
phase = "sand"
acceleration = ["3*sin(400*t)", "2*cos(300*t)"]
[time]
end = 10
largest-speed = 2
[[force]]
name = "base"
phase = "base"
[[force]]
name = "floor"
phase = "floor"
[[force]]
name = "stones_on_floor"
phase = "floor"
by = "stones"
)toml";

/// Hertzian spheres that move about in a periodic box with a floor.
inline const std::string hertzian_spheres = R"toml(
dimensions = 3
spacing = 1e-3
[domain]
size = [0.012, 0.02, 0.011]
periodic = ["x", "z"]
gravity = [0.5, -9.81, 0]
[phases.sand]
kind = "grains"
density = 2650
diameter = { mean = 1e-3, spread = 0.1 }
friction = 0.5
young = 1e8
poisson = 0.3
[phases.floor]
kind = "wall"
[interactions]
sand-sand = { law = "hertz" }
sand-floor = { law = "hertz" }
[[fill]]
phase = "floor"
shape = { sides = ["bottom"], layers = 1 }
[[fill]]
phase = "sand"
shape = { box = { min = [0, 0, 0], max = [0.012, 0.012, 0.011] } }
velocity = ["0.5*sin(600*x)", "-0.8*y/0.02", "0.4*cos(700*x)*sin(600*z)"]
[time]
end = 10
largest-speed = 2
)toml";

/// A paddle that turns and sways in water with a surface.
inline const std::string paddle = R"toml(
spacing = 0.02
[domain]
size = [1, 0.8]
periodic = ["x"]
gravity = [0, -9.81]
[phases.water]
kind = "fluid"
density = 1000
viscosity = 1e-3
sound-speed = 40
scheme = "consistent"
[phases.tank]
kind = "wall"
[phases.paddle]
kind = "wall"
[interactions]
kernel = "wendland-c2"
water-water = 2.6
water-tank = 2.6
water-paddle = 2.6
[[fill]]
phase = "tank"
shape = { sides = ["bottom", "top"], layers = 3 }
[[fill]]
phase = "paddle"
shape = { box = { min = [0.7, 0.2], max = [0.8, 0.5] } }
[[fill]]
phase = "water"
shape = { box = { min = [0, 0], max = [1, 0.5] } }
leave-out = "earlier-fills"
[[motion]]
phase = "paddle"
about = [0.75, 0.3]
velocity = ["cos(20*t)", "0.4*sin(20*t)"]
angular-velocity = "2*sin(30*t)"
[[force]]
name = "paddle"
phase = "paddle"
[time]
end = 10
largest-speed = 3
)toml";

/// Spheres in a drum that turns and shakes, some of them asleep.
inline const std::string drum = R"toml(
spacing = 1e-3
[domain]
size = [0.02, 0.02]
gravity = [0, -9.81]
[phases.sand]
kind = "grains"
density = 2650
diameter = { mean = 1e-3, spread = 0.1 }
friction = 0.5
rolling-friction = 0.1
stiffness = 500
sleep = true
[phases.drum]
kind = "wall"
diameter = 1e-3
[interactions]
sand-sand = { law = "linear" }
sand-drum = { law = "linear" }
[[fill]]
phase = "drum"
shape = { ring = { centre = [0.01, 0.01], inner = 0.008, outer = 0.01 } }
[[fill]]
phase = "sand"
shape = { formula = "min(0.007^2 - (x - 0.01)^2 - (y - 0.01)^2, 0.012 - y)" }
packing = "staggered"
[[motion]]
phase = "drum"
about = [0.01, 0.01]
velocity = [0, "0.05*cos(200*t)"]
angular-velocity = "20*t"
[time]
end = 10
largest-speed = 1
)toml";

/// A scene as the parameter of a test.
struct Named {
  const char* name;
  const std::string* text;
};
inline void PrintTo(const Named& scene, std::ostream* out) { *out << scene.name; }

inline std::unique_ptr<Simulation> simulation(const std::string& text, const std::vector<std::string>& overrides = {}) {
  const Scene scene = parse_scene(text, "test.toml", overrides);
  const auto blocks = make_particles(scene);
  return std::make_unique<Simulation>(scene, make_plan(scene, blocks), blocks);
}

}  // namespace barchan::small
