// Turbulent air over rough ground: the logarithmic layer stays what it is, and a wrong one becomes it.
#include <cmath>

#include "physics/drive.hpp"

namespace barchan {
namespace {

using testing::Drive;
using testing::report;

constexpr double friction_velocity = 0.4, roughness = 1e-4, height = 0.1, density = 1.225;  // as the scene has them

double law(double y) { return friction_velocity / 0.4 * std::log(y / roughness); }

struct Layer {
  double high, low, stress,
      noise;  // worst row from the third on, worst of the first two; tau/rho u*^2 - 1; rms p/rho U^2
};

/// Means over `frames` moments from now to `end`.
Layer watch(Drive& drive, double end, int moments) {
  const double dx = drive.scene().spacing, begin = drive.simulation().time();
  const auto rows = static_cast<std::size_t>(std::lround(height / dx));
  std::vector<double> error(rows, 0.0), weight(rows, 0.0);
  double stress = 0.0, near = 0.0, variance = 0.0;
  for (int m = 1; m <= moments; ++m) {
    drive.to(begin + (end - begin) * m / moments);
    const auto& p = drive.phase(0);
    double mean = 0.0, square = 0.0;
    for (std::size_t k = 0; k < p.size(); ++k) {
      const double y = p.column(Field::position, 1)[k], u = p.column(Field::velocity, 0)[k];
      const auto row = std::min(static_cast<std::size_t>(y / dx), rows - 1);
      error[row] += u / law(y) - 1.0;
      weight[row] += 1.0;
      if (row == 0) {
        stress += std::pow(0.4 * u / std::log(y / roughness) / friction_velocity, 2);
        near += 1.0;
      }
      const double pressure = p.column(Field::pressure)[k];
      mean += pressure;
      square += pressure * pressure;
    }
    mean /= static_cast<double>(p.size());
    variance += (square / static_cast<double>(p.size()) - mean * mean) / moments;
  }
  Layer l{0.0, 0.0, stress / near - 1.0, std::sqrt(variance) / (density * law(height) * law(height))};
  for (std::size_t k = 0; k < rows; ++k) {
    double& worst = k < 2 ? l.low : l.high;
    worst = std::max(worst, std::abs(error[k] / weight[k]));
  }
  return l;
}

void expect_layer(const Layer& l) {
  report("profile above the second row", l.high, 0.01);
  report("profile in the first two rows", l.low, 0.05);
  report("stress at the wall", l.stress, 0.02);
  report("pressure noise", l.noise, 0.003);
  EXPECT_LE(l.high, 0.01);
  EXPECT_LE(l.low, 0.05);
  EXPECT_LE(std::abs(l.stress), 0.02);
  EXPECT_LE(l.noise, 0.003);
}

TEST(LogarithmicLayer, Stays) {
  Drive drive("verification/logarithmic_layer");
  drive.to(0.2);
  expect_layer(watch(drive, 0.3, 20));
}

/// The same with k and omega: besides, they stay those of the layer.
TEST(LogarithmicLayer, StaysWithTwoEquations) {
  Drive drive("verification/logarithmic_layer", {"phases.air.turbulence=k-omega"});
  drive.to(0.2);
  expect_layer(watch(drive, 0.3, 20));
  const auto& p = drive.phase(0);
  double energy = 0.0, rate = 0.0;
  for (std::size_t i = 0; i < p.size(); ++i) {
    const double y = std::max(p.column(Field::position, 1)[i], 0.25 * drive.scene().spacing);
    energy += p.column(Field::turbulent_kinetic_energy)[i] / (friction_velocity * friction_velocity / 0.3);
    rate += p.column(Field::specific_dissipation_rate)[i] / (friction_velocity / (0.3 * 0.4 * y));
  }
  energy = energy / static_cast<double>(p.size()) - 1.0;
  rate = rate / static_cast<double>(p.size()) - 1.0;
  report("k over u*^2/0.3, less 1", energy, 0.03);
  report("omega over u*/(0.12 y), less 1", rate, 0.03);
  EXPECT_LE(std::abs(energy), 0.03);
  EXPECT_LE(std::abs(rate), 0.03);
}

}  // namespace
}  // namespace barchan
