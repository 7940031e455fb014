// What a laminar fluid of the consistent scheme does at a place of a border, from the fluid before it.
#pragma once

#include "models/coupling/border_fit.hpp"
#include "models/coupling/border_search.hpp"

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
/// m, the largest skin of the lists.
double widest_skin(const Layout& layout);
/// Length of the pieces of a border, at most, in spacings of the fluid.
constexpr double piece_width(int dimensions) { return dimensions == 2 ? 0.5 : 0.7; }

/// A place of the border of a solid.
struct BorderPlace {
  std::size_t anchor;   // where the particle of the solid stands from which it is found
  Vec3 beside;          // m, from that particle to it
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
/// that of the surface (BorderSample). `slack` (m): the largest skin of the lists.
template <int Dim>
BorderStress border_stress(const Workspace& w, const BorderFluid& fluid, std::size_t solid, const BorderPlace& place,
                           double slack) {
  using Vector = typename BorderSample<Dim>::Vector;
  const PhaseParticles& p = w.state.phases[fluid.phase];
  const auto along = along_border(place.normal, Dim);
  std::array<const double*, Dim> x{}, v{};
  for (std::size_t d = 0; d < Dim; ++d) {
    x[d] = p.column(Field::position, static_cast<int>(d));
    v[d] = p.column(Field::velocity, static_cast<int>(d));
  }
  const double* pressure = p.column(Field::pressure);
  BorderSample<Dim> sample;
  BorderFit<Dim + 1, 1> parting;
  double lowest = 0.0;
  each_near<Dim>(w, fluid.phase, solid, place.anchor, place.beside, fluid.radius, slack,
                 [&](std::size_t b, const Vec3& at) {
                   Vec3 r{}, u{};
                   for (std::size_t d = 0; d < Dim; ++d) r[d] = x[d][b] - at[d];
                   const double share = 1.0 - dot(r, r) / (fluid.radius * fluid.radius);
                   const double distance = dot(place.normal, r);
                   if (!(share > 0.0) || !(distance > 0.0)) return;
                   const Vec3 carried = place.velocity + cross(place.spin, r);
                   Vector scaled, relative;
                   for (std::size_t d = 0; d < Dim; ++d) {
                     const auto c = static_cast<Eigen::Index>(d);
                     u[d] = v[d][b] - carried[d];
                     scaled[c] = r[d] / fluid.spacing;
                     relative[c] = u[d];
                   }
                   const double weight = share * share;
                   lowest = std::min(lowest, pressure[b]);
                   sample.press(scaled, weight, pressure[b] - fluid.density * dot(w.scene.domain.gravity, r));
                   Eigen::Matrix<double, Dim + 1, 1> linear;
                   linear << 1.0, scaled.transpose();
                   parting.add(linear, weight, Eigen::Matrix<double, 1, 1>(dot(place.normal, u)));
                   Eigen::Matrix<double, Dim - 1, 1> beside;
                   for (std::size_t d = 0; d + 1 < Dim; ++d)
                     beside[static_cast<Eigen::Index>(d)] = dot(along[d], r) / fluid.spacing;
                   sample.rub(distance / fluid.spacing, beside, weight, relative);
                 });
  if (!sample.any()) return {};
  BorderStress s{true, sample.pressure(), {}, 0.0};
  if (const auto fitted = parting.first()) s.parting = (*fitted)(0);
  if (fluid.free_surface) s.pressure = std::max(s.pressure, lowest);
  const Vector rise = sample.rise();
  for (std::size_t d = 0; d < Dim; ++d)
    s.friction[d] = fluid.viscosity / fluid.spacing * rise[static_cast<Eigen::Index>(d)];
  s.friction = s.friction - dot(s.friction, place.normal) * place.normal;
  return s;
}

}  // namespace barchan
