#include "models/bodies/stress_fields.hpp"

#include <Eigen/Eigenvalues>
#include <cmath>

namespace barchan {

namespace {

/// Places of the components (d, e) in a Symmetric.
constexpr std::size_t place_of[3][3] = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}};

template <int Dim, class Law>
SolidState state_of(const std::array<AlignedVector<double>, 9>& gradient, std::size_t k, const ElasticModuli& m) {
  hyperelastic::Matrix<Dim, double> h;
  for (std::size_t d = 0; d < Dim; ++d)
    for (std::size_t e = 0; e < Dim; ++e) h[d][e] = gradient[d * Dim + e][k];
  const double jacobian = hyperelastic::dilation<Dim>(h);
  const auto p = Law::template stress<Dim>(h, jacobian, m.lambda, m.mu);
  const auto strain = hyperelastic::green_strain<Dim>(h);
  SolidState s;
  double trace = 0.0, square = 0.0;
  for (std::size_t d = 0; d < Dim; ++d)
    for (std::size_t e = 0; e < Dim; ++e) {
      double sum = p[d][e];  // (P F^T)_de
      for (std::size_t f = 0; f < Dim; ++f) sum += p[d][f] * h[e][f];
      s.stress[place_of[d][e]] = sum / (1.0 + jacobian);
      s.strain[place_of[d][e]] = strain[d][e];
      if (d == e) trace += strain[d][e];
      square += strain[d][e] * strain[d][e];
    }
  if (Dim == 2) s.stress[2] = Law::across(trace, jacobian, m) / (1.0 + jacobian);
  s.energy = Law::energy(trace, square, jacobian, m);
  return s;
}

}  // namespace

SolidState solid_of(const std::array<AlignedVector<double>, 9>& gradient, std::size_t k, int dimensions, Elasticity law,
                    const ElasticModuli& moduli) {
  if (law == Elasticity::neo_hookean)
    return dimensions == 2 ? state_of<2, NeoHookean>(gradient, k, moduli)
                           : state_of<3, NeoHookean>(gradient, k, moduli);
  return dimensions == 2 ? state_of<2, SaintVenantKirchhoff>(gradient, k, moduli)
                         : state_of<3, SaintVenantKirchhoff>(gradient, k, moduli);
}

std::array<double, 3> principal_stresses(const Symmetric& s) {
  Eigen::Matrix3d m;
  for (std::size_t d = 0; d < 3; ++d)
    for (std::size_t e = 0; e < 3; ++e) m(static_cast<int>(d), static_cast<int>(e)) = s[place_of[d][e]];
  const Eigen::Vector3d v = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(m, Eigen::EigenvaluesOnly).eigenvalues();
  return {v[2], v[1], v[0]};
}

double von_mises_stress(const Symmetric& s) {
  const double a = s[0] - s[1], b = s[1] - s[2], c = s[2] - s[0];
  return std::sqrt(0.5 * (a * a + b * b + c * c) + 3.0 * (s[3] * s[3] + s[4] * s[4] + s[5] * s[5]));
}

SolidFields::SolidFields(PhaseParticles& p) {
  if (p.has(Field::pressure)) pressure_ = p.column(Field::pressure);
  if (p.has(Field::von_mises_stress)) mises_ = p.column(Field::von_mises_stress);
  for (int c = 0; c < 6; ++c) {
    if (p.has(Field::stress)) stress_[static_cast<std::size_t>(c)] = p.column(Field::stress, c);
    if (p.has(Field::strain)) strain_[static_cast<std::size_t>(c)] = p.column(Field::strain, c);
  }
  for (int c = 0; c < 3; ++c)
    if (p.has(Field::principal_stress)) principal_[static_cast<std::size_t>(c)] = p.column(Field::principal_stress, c);
}

void SolidFields::write_stress(std::size_t k, const Symmetric& stress) const {
  if (mises_) mises_[k] = von_mises_stress(stress);
  if (!principal_[0]) return;
  const auto values = principal_stresses(stress);
  for (std::size_t c = 0; c < 3; ++c) principal_[c][k] = values[c];
}

void SolidFields::write(std::size_t k, const SolidState& s) const {
  const double pressure = -(s.stress[0] + s.stress[1] + s.stress[2]) / 3.0;
  if (pressure_) pressure_[k] = pressure;
  for (std::size_t c = 0; c < 6; ++c) {
    if (stress_[c]) stress_[c][k] = s.stress[c] + (c < 3 ? pressure : 0.0);
    if (strain_[c]) strain_[c][k] = s.strain[c];
  }
  write_stress(k, s.stress);
}

void SolidFields::write_from_stress(std::size_t k) const {
  Symmetric stress;
  for (std::size_t c = 0; c < 6; ++c) stress[c] = stress_[c][k] - (c < 3 ? pressure_[k] : 0.0);
  write_stress(k, stress);
}

}  // namespace barchan
