// What a fluid does to a sphere that turns in it: a force across the flow (Magnus), and a torque that takes the sphere
// along with the fluid's own rotation.
//
//   dv/dt = 3/4 rho_f/rho_s C W x (v - u),   W = w - curl u/2   (C = 1, Re -> 0: Rubinow & Keller 1961)
//   C = 1 - [0.675 + 0.15 (1 + tanh(0.28 (S - 2)))] tanh(0.18 sqrt(Re)),   S = |W| d/|v - u|   (Loth 2008)
//   dw/dt = -W/tau,   tau = rho_s d^2/(60 rho_f nu)   (Stokes's torque pi rho_f nu d^3 W)
//
// Saltating grains turn some hundred times a second, and rise higher for it (White & Schulz 1977).
#pragma once

#include <array>
#include <cmath>

namespace barchan {

/// Numbers of a spin: in 2D the one about z.
constexpr std::size_t spins(std::size_t dimensions) { return dimensions == 2 ? 1 : 3; }

struct TurningSphere {
  double lightness;  // rho_f/rho_s
  double viscosity;  // m2/s, of the fluid
  double diameter;   // m
  double rotation;   // 1/s, of the fluid about z, half of its curl

  /// C above; re: |v - u| d/nu, spin_ratio: S.
  static double share(double re, double spin_ratio) {
    return 1.0 - (0.675 + 0.15 * (1.0 + std::tanh(0.28 * (spin_ratio - 2.0)))) * std::tanh(0.18 * std::sqrt(re));
  }

  /// The spin (1/s) goes on by a time (s), in which the fluid's rotation stays. Returns the acceleration (m/s2) by the
  /// spin then; `through`: v - u (m/s).
  template <std::size_t Dim>
  std::array<double, Dim> turn(std::array<double, spins(Dim)>& spin, const std::array<double, Dim>& through,
                               double time) const {
    const double fade = std::exp(-60.0 * lightness * viscosity * time / (diameter * diameter));
    std::array<double, 3> w{}, v{};
    for (std::size_t c = 0; c < Dim; ++c) v[c] = through[c];
    for (std::size_t c = 0; c < spins(Dim); ++c) {
      const std::size_t axis = Dim == 2 ? 2 : c;
      const double own = axis == 2 ? rotation : 0.0;
      w[axis] = fade * (spin[c] - own);
      spin[c] = own + w[axis];
    }
    const double speed = std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]),
                 rate = std::sqrt(w[0] * w[0] + w[1] * w[1] + w[2] * w[2]);
    std::array<double, Dim> pushed{};
    if (speed == 0.0) return pushed;
    const double f = 0.75 * lightness * share(speed * diameter / viscosity, rate * diameter / speed);
    for (std::size_t c = 0; c < Dim; ++c) {
      const std::size_t a = (c + 1) % 3, b = (c + 2) % 3;
      pushed[c] = f * (w[a] * v[b] - w[b] * v[a]);
    }
    return pushed;
  }
};

/// The columns of the spins of a phase.
template <std::size_t Dim, class Particles, class Field>
std::array<double*, spins(Dim)> spin_columns(Particles& p, Field spin) {
  std::array<double*, spins(Dim)> columns{};
  for (std::size_t c = 0; c < columns.size(); ++c) columns[c] = p.column(spin, static_cast<int>(c));
  return columns;
}

}  // namespace barchan
