// Fluid and sand at rest stay at rest.
#include <cmath>

#include "physics/drive.hpp"

namespace barchan {
namespace {

using testing::Drive;
using testing::report;

constexpr double gravity = 9.81, height = 0.1, density = 1.225, sound = 20;  // as the scene has them

struct Rest {
  double fastest = 0;   // largest speed of any particle at any time looked at, over sqrt(gH)
  double pressure = 0;  // largest |p - p_exact| then, over rho g H
};

/// Exact compressible column with p = c^2 (rho - rho0): p = rho0 c^2 (exp(g (H - y)/c^2) - 1), less the mean of both.
double pressure_error(const PhaseParticles& air) {
  const auto exact = [&](std::size_t k) {
    return density * sound * sound *
           std::expm1(gravity * (height - air.column(Field::position, 1)[k]) / (sound * sound));
  };
  double worst = 0, mean = 0;
  for (std::size_t k = 0; k < air.size(); ++k)
    mean += (air.column(Field::pressure)[k] - exact(k)) / static_cast<double>(air.size());
  for (std::size_t k = 0; k < air.size(); ++k)
    worst = std::max(worst, std::abs(air.column(Field::pressure)[k] - exact(k) - mean));
  return worst / (density * gravity * height);
}

double largest_speed(const PhaseParticles& p) {
  double fastest = 0;
  for (std::size_t k = 0; k < p.size(); ++k)
    fastest = std::max(fastest, std::hypot(p.column(Field::velocity, 0)[k], p.column(Field::velocity, 1)[k]));
  return fastest;
}

/// Twenty passages of sound through the column, looked at every half passage.
Rest watch(const std::vector<std::string>& overrides) {
  Drive drive("verification/still_column", overrides);
  Rest rest;
  for (int k = 1; k <= 40; ++k) {
    drive.to(0.5 * k * height / sound);
    rest.fastest = std::max(rest.fastest, largest_speed(drive.phase(0)) / std::sqrt(gravity * height));
    rest.pressure = std::max(rest.pressure, pressure_error(drive.phase(0)));
  }
  return rest;
}

TEST(StillColumn, RegularStaysStill) {
  const Rest rest = watch({"fill.1.perturb=0"});
  report("largest speed/sqrt(gH)", rest.fastest, 1e-3);
  report("largest pressure error/(rho g H)", rest.pressure, 5e-3);
  EXPECT_LE(rest.fastest, 1e-3);
  EXPECT_LE(rest.pressure, 5e-3);
}

TEST(StillColumn, PerturbedStaysStill) {
  const Rest rest = watch({"fill.1.perturb=0.2"});
  report("largest speed/sqrt(gH)", rest.fastest, 1e-3);
  report("largest pressure error/(rho g H)", rest.pressure, 5e-3);
  EXPECT_LE(rest.fastest, 1e-3);
  EXPECT_LE(rest.pressure, 5e-3);
}

}  // namespace
}  // namespace barchan
