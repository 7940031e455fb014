// What a laminar fluid of the consistent scheme does at a place of a border, from the fluid before it.
#pragma once

#include "models/coupling/border_fit.hpp"
#include "models/coupling/border_neighbours.hpp"

namespace barchan {

/// A fluid that presses on a border.
struct BorderFluid {
  std::size_t phase;
  bool free_surface;          // beyond which nothing presses
  double spacing, radius;     // m; of the fit
  double viscosity, density;  // Pa s; kg/m3, at rest
  double sound_speed;         // m/s
};

/// As the entry of a solid with a fluid of the consistent scheme says.
BorderFluid border_fluid(const Scene& scene, const Layout& layout, const PlanEntry& entry);
/// Length of the pieces of a border, at most, in spacings of the fluid.
constexpr double piece_width(int dimensions) { return dimensions == 2 ? 0.5 : 0.7; }

/// How the border of a solid lies and moves at a piece.
struct BorderMotion {
  Vec3 normal;          // into the fluid
  Vec3 velocity, spin;  // m/s, 1/s: v + spin x r is the velocity of the surface about it
};

struct BorderStress {
  bool wet = false;       // some fluid is near
  double pressure = 0.0;  // Pa
  Vec3 friction{};        // Pa, along the border
  double parting = 0.0;   // m/s, with which the fluid goes off the border: zero but for the error of the scheme
};

/// Weighted least squares over the particles within the radius that stand before the border, (x - x_q).n > 0: behind a
/// thin plate is another fluid. Pressure: linear, less its hydrostatic part; friction mu du/dn: u is the velocity less
/// that of the surface (BorderSample). `gravity` in m/s2.
template <int Dim>
BorderStress border_stress(const Vec3& gravity, const BorderFluid& fluid, const std::vector<BorderNeighbour>& about,
                           const BorderMotion& border) {
  using Vector = typename BorderSample<Dim>::Vector;
  const auto along = along_border(border.normal, Dim);
  BorderSample<Dim> sample;
  BorderFit<Dim + 1, 1> parting;
  double lowest = 0.0;
  for (const BorderNeighbour& near : about) {
    const Vec3& r = near.from;
    const double share = 1.0 - dot(r, r) / (fluid.radius * fluid.radius);
    const double distance = dot(border.normal, r);
    if (!(share > 0.0) || !(distance > 0.0)) continue;
    const Vec3 carried = border.velocity + cross(border.spin, r);
    Vec3 u{};
    Vector scaled, relative;
    for (std::size_t d = 0; d < Dim; ++d) {
      const auto c = static_cast<Eigen::Index>(d);
      u[d] = near.velocity[d] - carried[d];
      scaled[c] = r[d] / fluid.spacing;
      relative[c] = u[d];
    }
    const double weight = share * share;
    lowest = std::min(lowest, near.pressure);
    sample.press(scaled, weight, near.pressure - fluid.density * dot(gravity, r));
    Eigen::Matrix<double, Dim + 1, 1> linear;
    linear << 1.0, scaled.transpose();
    parting.add(linear, weight, Eigen::Matrix<double, 1, 1>(dot(border.normal, u)));
    Eigen::Matrix<double, Dim - 1, 1> beside;
    for (std::size_t d = 0; d + 1 < Dim; ++d) beside[static_cast<Eigen::Index>(d)] = dot(along[d], r) / fluid.spacing;
    sample.rub(distance / fluid.spacing, beside, weight, relative);
  }
  if (!sample.any()) return {};
  BorderStress s{true, sample.pressure(), {}, 0.0};
  if (const auto fitted = parting.first()) s.parting = (*fitted)(0);
  if (fluid.free_surface) s.pressure = std::max(s.pressure, lowest);
  const Vector rise = sample.rise();
  for (std::size_t d = 0; d < Dim; ++d)
    s.friction[d] = fluid.viscosity / fluid.spacing * rise[static_cast<Eigen::Index>(d)];
  s.friction = s.friction - dot(s.friction, border.normal) * border.normal;
  return s;
}

}  // namespace barchan
