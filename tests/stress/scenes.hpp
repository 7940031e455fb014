// Scenes made to break.
#pragma once

#include <string>

namespace barchan::stress {

/// Taylor-Green vortices on 25 x 25 disturbed particles.
inline const std::string vortices = R"toml(
spacing = 0.04
[domain]
size = [1, 1]
periodic = ["x", "y"]
[phases.fluid]
kind = "fluid"
density = 1
viscosity = 0.01
sound-speed = 10
scheme = "consistent"
[interactions]
kernel = "wendland-c2"
fluid-fluid = 2.6
[[fill]]
phase = "fluid"
shape = "the-rest"
perturb = 0.2
velocity = ["-cos(2*pi*x)*sin(2*pi*y)", "sin(2*pi*x)*cos(2*pi*y)"]
[[forcing]]
phase = "fluid"
acceleration = [0, 0]
[time]
end = 2
largest-speed = 1
[output]
every = 0.02
)toml";

/// Grains over a floor one grain thick in the middle of the domain.
inline const std::string over_a_floor = R"toml(
spacing = 0.001
[domain]
size = [0.02, 0.05]
periodic = ["x"]
gravity = [0, -9.81]
[phases.sand]
kind = "grains"
density = 2650
restitution = 0.7
contact-speed = 20
[phases.floor]
kind = "wall"
[interactions]
sand-sand = 1.1
sand-floor = 1.1
[[fill]]
phase = "floor"
shape = { box = { min = [0, 0.020], max = [0.02, 0.021] } }
[[fill]]
phase = "sand"
shape = { points = [[0.005, 0.045], [0.01, 0.045], [0.0147, 0.045]] }
velocity = [0, -1]
[time]
end = 0.2
[output]
every = 0.005
)toml";

/// A deep pile on a floor behind the domain's lower side.
inline const std::string pile = R"toml(
spacing = 0.001
[domain]
size = [0.01, 0.06]
periodic = ["x"]
gravity = [0, -9.81]
[phases.sand]
kind = "grains"
density = 2650
restitution = 0.5
[phases.floor]
kind = "wall"
[interactions]
sand-sand = 1.1
sand-floor = 1.1
[[fill]]
phase = "floor"
shape = { sides = ["bottom"], layers = 1 }
[[fill]]
phase = "sand"
shape = { box = { min = [0, 0], max = [0.01, 0.05] } }
[time]
end = 1
[output]
every = 0.005
)toml";

/// Two elastic two_squares that meet.
inline const std::string two_squares = R"toml(
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
end = 0.02
largest-speed = 8
[output]
every = 0.0005
)toml";

/// Two bodies of one particle each, in two dimensions.
inline const std::string single_particles = R"toml(
spacing = 1e-3
[domain]
size = [0.010, 0.004]
[phases.a]
kind = "elastic"
formulation = "updated-lagrangian"
density = 1000
young = 1e3
poisson = 0.3
[phases.b]
kind = "elastic"
formulation = "updated-lagrangian"
density = 1000
young = 1e3
poisson = 0.3
[interactions]
a-a = 2.4
b-b = 2.4
a-b = 1.0
[[fill]]
phase = "a"
shape = { points = [[0.003, 0.002]] }
velocity = [0.9, 0]
[[fill]]
phase = "b"
shape = { points = [[0.005, 0.002]] }
velocity = [-0.9, 0]
[time]
end = 0.01
[output]
every = 5e-4
)toml";

/// Water in a closed tank under air.
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
[phases.air]
kind = "fluid"
density = 1
viscosity = 1e-3
sound-speed = 20
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
[[fill]]
phase = "air"
shape = "the-rest"
perturb = 0.1
velocity = ["1 + sin(2*pi*x/0.3)", 0]
[time]
end = 2
largest-speed = 2
[output]
every = 0.01
)toml";

}  // namespace barchan::stress
