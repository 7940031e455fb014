// Scenes that several tests of src/scene start from.
#pragma once

#include <string>

namespace barchan::testing {

/// The example of the design: wind over a small dune.
inline const std::string dune_text = R"(# Wind over a small dune. Halik et al. 2015, section 6, figures 12-14.
title      = "Wind over a small dune"
dimensions = 2
spacing    = 1.0e-3                    # m, dx

[domain]
size     = [0.40, 0.10]                # m
periodic = ["x"]
gravity  = [0, -9.81]                  # m/s2

[phases.air]
kind      = "fluid"
density   = 1.225                      # kg/m3
viscosity = 1.48e-5                    # m2/s, kinematic
turbulence = "mixing-length"

[phases.sand]
kind        = "grains"
density     = 2650                     # kg/m3
restitution = 0.7

[interactions]                         # kernel radius in spacings, eq. (16)
air-air   = 3.0
air-sand  = 2.5
sand-sand = 1.1

[[fill]]
phase = "sand"
shape = { bed = 0.01, dune = { height = 0.02, length = 0.12, at = 0.15 } }   # m

[[fill]]
phase    = "air"
shape    = "the-rest"
velocity = { log-profile = { friction-velocity = 0.4, roughness = 8.3e-6 } } # m/s, m; eq. (18)

[time]
end = 0.07                             # s

[output]
every  = 1.0e-3                        # s
fields = ["velocity", "phase", "smoothing_length"]
)";

/// A unit square of one fluid, ten spacings wide; the smallest scene there is.
inline const std::string square_text = R"(spacing = 0.1
[domain]
size = [1, 1]
[phases.air]
kind = "fluid"
density = 1
[interactions]
air-air = 3.0
[[fill]]
phase = "air"
shape = "the-rest"
[time]
end = 1
largest-speed = 1
)";

/// `text` with the first `from` replaced by `to`.
inline std::string with(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  return at == std::string::npos ? "NOT FOUND: " + from : text.replace(at, from.size(), to);
}

}  // namespace barchan::testing
