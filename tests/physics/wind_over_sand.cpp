// Wind over grains finer than the air's particles (scenes/wind_over_sand.toml): what the layers near the ground leave
// of the logarithmic profile in the first hundredth of a second, before many grains fly.
#include <algorithm>
#include <cmath>

#include "physics/drive.hpp"

namespace barchan {
namespace {

using testing::Drive;
using testing::report;

TEST(WindOverSand, KeepsTheLogarithmicProfile) {
  Drive drive("wind_over_sand", {"time.end=0.01"});
  drive.to(0.01);
  constexpr double friction_velocity = 0.4, roughness = 8.3e-6, bed = 0.003;  // as the scene has them
  const auto& air = drive.phase(0);
  double worst = 0;
  for (std::size_t k = 0; k < air.size(); ++k) {
    const double height = air.column(Field::position, 1)[k] - bed;
    if (height < 4e-3) continue;  // above the second row
    const double wind = friction_velocity / 0.4 * std::log(height / roughness);
    worst = std::max(worst, std::abs(air.column(Field::velocity, 0)[k] / wind - 1));
  }
  report("largest error of the wind over 4 mm", worst, 0.02);
  EXPECT_LE(worst, 0.02);
  const auto columns = drive.simulation().history_columns();
  const auto row = drive.simulation().history_row();
  const auto at = std::find(columns.begin(), columns.end(), "air-sand_ground_stress [Pa]") - columns.begin();
  ASSERT_LT(static_cast<std::size_t>(at), row.size());
  const double share = row[static_cast<std::size_t>(at)] / (1.225 * friction_velocity * friction_velocity);
  report("stress on the ground over rho u*^2", share, 2.0);
  EXPECT_GE(share, 0.9);
  EXPECT_LE(share, 2.0);
}

/// Without grains in flight nothing but the bed takes the wind's momentum: that of a smooth sheet would be less.
TEST(WindOverSand, AHeavyBedIsAsRoughAsItsGrains) {
  Drive drive("wind_over_sand", {"phases.sand.density=2.65e6", "time.end=0.004"});
  drive.to(0.004);
  const auto columns = drive.simulation().history_columns();
  const auto row = drive.simulation().history_row();
  const auto at = std::find(columns.begin(), columns.end(), "air-sand_ground_stress [Pa]") - columns.begin();
  const double share = row[static_cast<std::size_t>(at)] / (1.225 * 0.4 * 0.4);
  report("stress on the ground over rho u*^2", share, 1.2);
  EXPECT_NEAR(share, 1.05, 0.15);
}

}  // namespace
}  // namespace barchan
