// Small scenes of elastic bodies at whose borders a fluid ends.
#pragma once

#include <string>

#include "physics/small_scenes.hpp"

namespace barchan::small {

/// A plate and a free disc in a periodic fluid that whirls; the plate lies across the side of the domain and is clamped
/// at one end.
inline const std::string flag = R"toml(
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
[phases.plate]
kind = "elastic"
spacing = 0.025
density = 1100
young = 1e5
poisson = 0.3
[phases.disc]
kind = "elastic"
density = 900
young = 1e5
[interactions]
water-water = 2.1
water-plate = 2.1
water-disc = 2.1
plate-plate = { radius = 1.6, kernel = "wendland-c2" }
disc-disc = { radius = 1.6, kernel = "wendland-c2" }
[[fill]]
phase = "plate"
shape = { box = { min = [1.3, 0.9], max = [1.9, 1] } }
[[fill]]
phase = "disc"
shape = { disc = { centre = [0.5, 0.4], radius = 0.2 } }
packing = "relaxed"
[[fill]]
phase = "water"
shape = "the-rest"
velocity = ["sin(pi*x)*cos(pi*y)", "-cos(pi*x)*sin(pi*y)"]
[[motion]]
phase = "plate"
box = { min = [1.3, 0.9], max = [1.4, 1] }
[time]
end = 1
largest-speed = 2
)toml";

/// A block in a periodic fluid, in three dimensions.
inline const std::string jelly = R"toml(
precision = "double"
dimensions = 3
spacing = 0.1
[domain]
size = [1.2, 1.2, 1.2]
periodic = ["x", "y", "z"]
[phases.water]
kind = "fluid"
density = 1000
viscosity = 1e-2
sound-speed = 20
[phases.jelly]
kind = "elastic"
density = 1500
young = 1e5
[interactions]
water-water = 2.1
water-jelly = 2.1
jelly-jelly = { radius = 1.6, kernel = "wendland-c2" }
[[fill]]
phase = "jelly"
shape = { box = { min = [0.4, 0.4, 0.4], max = [0.8, 0.8, 0.8] } }
velocity = [0.3, 0.15, 0]
[[fill]]
phase = "water"
shape = "the-rest"
[time]
end = 1
largest-speed = 2
)toml";

}  // namespace barchan::small
