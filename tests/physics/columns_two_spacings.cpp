// One fluid of two spacings joined by an entry, sheared under gravity: scenes/verification/two_spacings.toml.
#include <cmath>

#include "physics/drive.hpp"

namespace barchan {
namespace {

using testing::Drive;
using testing::report;

// Exact: u = y of the lid's speed, p = rho g (H - y) of the incompressible column, both to the transient's exp(-pi^2 nu
// t/H^2) = 4e-4. The kernel of the joint is that of the coarse spacing on both sides.
TEST(TwoSpacings, AShearedColumnIsThatOfOneSpacing) {
  Drive drive("verification/two_spacings");
  drive.to(drive.scene().time.end);
  double speed = 0, across = 0, pressure = 0;
  for (const std::size_t phase : {0, 1}) {
    const auto& p = drive.phase(phase);
    for (std::size_t k = 0; k < p.size(); ++k) {
      const double y = p.column(Field::position, 1)[k];
      speed = std::max(speed, std::abs(p.column(Field::velocity, 0)[k] - y));
      across = std::max(across, std::abs(p.column(Field::velocity, 1)[k]));
      pressure = std::max(pressure, std::abs(p.column(Field::pressure)[k] / 1000.0 - (1.0 - y)));
    }
  }
  report("largest |u - y| over the lid's speed", speed, 1e-3);
  report("largest speed across over the lid's", across, 1e-4);
  report("largest pressure error over rho g H", pressure, 0.005);
  EXPECT_LE(speed, 1e-3);
  EXPECT_LE(across, 1e-4);
  EXPECT_LE(pressure, 0.005);
  EXPECT_EQ(drive.plan().phases[0].spacing, 0.025);
  EXPECT_NEAR(drive.plan().phases[0].mass * 4.0, drive.plan().phases[1].mass, 1e-12);
}

}  // namespace
}  // namespace barchan
