// Air over water at rest stays at rest: scenes/verification/two_phase_column.toml, ten crossings of sound.
#include <cmath>

#include "physics/drive.hpp"

namespace barchan::of_columns_two_phase {
namespace {

using testing::Drive;
using testing::report;

constexpr double gravity = 9.81, height = 0.1, sound = 20;  // as the scene has them
constexpr std::size_t water = 0, air = 1;

/// Exact compressible column under `depth` of a fluid with this pressure at its surface: p = c^2 (rho - rho0).
double pressure(double depth, double density, double surface) {
  return surface + (density * sound * sound + surface) * std::expm1(gravity * depth / (sound * sound));
}

struct Rest {
  double fastest = 0;               // of any particle at any time looked at, over sqrt(gH)
  double of_water = 0, of_air = 0;  // largest error of the pressure then, over that at the bottom of each
};

Rest watch(double ratio, double perturb) {
  const double light = 1.225, heavy = ratio * light, middle = pressure(height / 2, light, 0);
  const std::string by = "perturb=" + std::to_string(perturb);
  Drive drive("verification/two_phase_column",
              {"phases.water.density=" + std::to_string(heavy), "fill.1." + by, "fill.2." + by});
  Rest rest;
  for (int step = 0; step <= 20; ++step) {
    drive.to(0.5 * step * height / sound);
    for (const std::size_t phase : {water, air}) {
      const auto& p = drive.phase(phase);
      for (std::size_t k = 0; k < p.size(); ++k) {
        const double y = p.column(Field::position, 1)[k], got = p.column(Field::pressure)[k];
        rest.fastest =
            std::max(rest.fastest, std::hypot(p.column(Field::velocity, 0)[k], p.column(Field::velocity, 1)[k]) /
                                       std::sqrt(gravity * height));
        if (phase == air) rest.of_air = std::max(rest.of_air, std::abs(got - pressure(height - y, light, 0)) / middle);
        else
          rest.of_water = std::max(rest.of_water, std::abs(got - pressure(height / 2 - y, heavy, middle)) /
                                                      pressure(height / 2, heavy, middle));
      }
    }
  }
  return rest;
}

void expect_rest(double ratio, double perturb) {
  const Rest rest = watch(ratio, perturb);
  report("largest speed/sqrt(gH)", rest.fastest, 1e-3);
  report("pressure error of the water/that at the bottom", rest.of_water, 5e-3);
  report("pressure error of the air/its weight", rest.of_air, 5e-3);
  EXPECT_LE(rest.fastest, 1e-3);
  EXPECT_LE(rest.of_water, 5e-3);
  EXPECT_LE(rest.of_air, 5e-3);
}

TEST(TwoPhaseColumn, OneToThousandStaysStill) { expect_rest(1000, 0); }
TEST(TwoPhaseColumn, OneToThousandDisturbedStaysStill) { expect_rest(1000, 0.2); }
TEST(TwoPhaseColumn, OneToTwoThousandStaysStill) { expect_rest(2000, 0); }
TEST(TwoPhaseColumn, OneToTwoThousandDisturbedStaysStill) { expect_rest(2000, 0.2); }

}  // namespace
}  // namespace barchan::of_columns_two_phase
