#include "models/coupling/border_stress.hpp"

#include <algorithm>
#include <cmath>

#include "models/coupling/border_fit.hpp"
#include "models/coupling/spray.hpp"
#include "models/fluid/fluid_phase.hpp"

namespace barchan {

namespace {

template <int Dim>
BorderStress stress_at(const Vec3& gravity, const BorderFluid& fluid, const std::vector<BorderNeighbour>& about,
                       const BorderMotion& border) {
  using Vector = typename BorderSample<Dim>::Vector;
  const auto along = along_border(border.normal, Dim);
  BorderSample<Dim> sample;
  BorderFit<Dim + 1, 1> parting;
  double lowest = 0.0, weights = 0.0, counted = 0.0, nearest = fluid.radius * fluid.radius;
  for (const BorderNeighbour& near : about) {
    const Vec3& r = near.from;
    const double share = 1.0 - dot(r, r) / (fluid.radius * fluid.radius);
    const double distance = dot(border.normal, r);
    if (!(share > 0.0) || !(distance > 0.0)) continue;
    nearest = std::min(nearest, dot(r, r));
    weights += share * share;
    counted += share * share * near.share;
    if (!(near.share > 0.0)) continue;
    const Vec3 carried = border.velocity + cross(border.spin, r);
    Vec3 u{};
    Vector scaled, relative;
    for (std::size_t d = 0; d < Dim; ++d) {
      const auto c = static_cast<Eigen::Index>(d);
      u[d] = near.velocity[d] - carried[d];
      scaled[c] = r[d] / fluid.spacing;
      relative[c] = u[d];
    }
    const double weight = share * share * near.share;
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
  BorderStress s{true, sample.pressure(), {}, 1.0, 0.0};
  if (const auto fitted = parting.first()) s.parting = (*fitted)(0);
  if (fluid.free_surface) s.pressure = std::max(s.pressure, lowest);
  const Vector rise = sample.rise();
  for (std::size_t d = 0; d < Dim; ++d)
    s.friction[d] = fluid.viscosity / fluid.spacing * rise[static_cast<Eigen::Index>(d)];
  s.friction = s.friction - dot(s.friction, border.normal) * border.normal;
  s.share = counted / weights;
  if (fluid.free_surface) s.share *= Spray::wet(std::sqrt(nearest) / fluid.spacing);
  s.pressure *= s.share;
  s.friction = s.share * s.friction;
  return s;
}

}  // namespace

BorderFluid border_fluid(const Scene& scene, const Layout& layout, const PlanEntry& entry) {
  const PlanPhase& fluid = layout.phases[entry.fluid];
  return {entry.fluid,
          fluid.free_surface,
          fluid.spacing,
          border_fit_radius * fluid.spacing,
          pair_viscosity(scene, layout, entry.other, entry.fluid),
          scene.phases[entry.fluid].density,
          fluid.sound_speed};
}

BorderStress border_stress(int dimensions, const Vec3& gravity, const BorderFluid& fluid,
                           const std::vector<BorderNeighbour>& about, const BorderMotion& border) {
  return dimensions == 2 ? stress_at<2>(gravity, fluid, about, border) : stress_at<3>(gravity, fluid, about, border);
}

}  // namespace barchan
