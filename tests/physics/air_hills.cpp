// Air over ground that is not flat: potential flow over a low hill, the logarithmic layer where rows of the lattice
// would not end at the ground.
#include <cmath>

#include "physics/drive.hpp"

namespace barchan {
namespace {

using testing::Drive;
using testing::report;

/// Linear fit with Wendland C2 weights: the fluid's velocity along x at a place.
double fitted_speed(const PhaseParticles& p, double x, double y, double radius) {
  std::array<std::array<double, 4>, 3> m{};  // normal equations
  for (std::size_t k = 0; k < p.size(); ++k) {
    const double a = p.column(Field::position, 0)[k] - x, b = p.column(Field::position, 1)[k] - y;
    const double q = std::hypot(a, b) / radius;
    if (q >= 1.0) continue;
    const double w = std::pow(1.0 - q, 4) * (4.0 * q + 1.0);
    const std::array<double, 4> row{1.0, a, b, p.column(Field::velocity, 0)[k]};
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = 0; j < 4; ++j) m[i][j] += w * row[i] * row[j];
  }
  for (std::size_t i = 2; i > 0; --i)
    for (std::size_t r = 0; r < i; ++r) {
      const double f = m[r][i] / m[i][i];
      for (std::size_t j = 0; j < 4; ++j) m[r][j] -= f * m[i][j];
    }
  return m[0][3] / m[0][0];
}

/// A tenth of the half width a spacing: the crest is one spacing high. The truth is that of bench/accuracy/cases.py, in
/// this channel: +0.1066 and -0.0097.
TEST(LowHill, SpeedsUpAsPotentialFlow) {
  Drive drive("verification/low_hill", {"spacing=0.1"});
  const auto ground = [](double x) { return 0.1 / (1.0 + (x - 10.0) * (x - 10.0)); };
  drive.to(4.4);
  double crest = 0.0, foot = 0.0, far = 0.0;
  for (int m = 1; m <= 6; ++m) {
    drive.to(4.4 + 0.1 * m);
    const auto at = [&](double x) { return fitted_speed(drive.phase(0), x, ground(x), 0.26) / 6.0; };
    crest += at(10.0);
    foot += 0.5 * (at(8.3) + at(11.7));
    far += 0.5 * (at(0.5) + at(19.5));
  }
  const double up = crest / far - 1.0, down = foot / far - 1.0;
  report("speed-up at the crest, error", std::abs(up / 0.1066 - 1.0), 0.05);
  report("slow-down at the foot, error over the speed-up", std::abs(down + 0.0097) / 0.1066, 0.05);
  EXPECT_NEAR(up, 0.1066, 0.05 * 0.1066);
  EXPECT_NEAR(down, -0.0097, 0.05 * 0.1066);
}

TEST(LogarithmicLayer, StaysOverFittedGroundBetweenRows) {
  const double bed = 0.0117, dx = 2.5e-3;
  Drive drive("verification/logarithmic_layer", {"fill.0.shape={ bed = 0.0117 }", "fill.0.packing=fitted",
                                                 "fill.2.packing=fitted", "domain.size=[0.05, 0.1117]"});
  std::vector<double> error(40, 0.0), weight(40, 0.0);
  for (int m = 1; m <= 5; ++m) {
    drive.to(0.1 + 0.02 * m);
    const auto& p = drive.phase(0);
    for (std::size_t k = 0; k < p.size(); ++k) {
      const double y = p.column(Field::position, 1)[k] - bed;
      const auto row = std::min(static_cast<std::size_t>(y / dx), std::size_t{39});
      error[row] += p.column(Field::velocity, 0)[k] / std::log(y / 1e-4) - 1.0;
      weight[row] += 1.0;
      EXPECT_NEAR(p.column(Field::ground_distance)[k], y, 2e-6);
    }
  }
  double high = 0.0, low = 0.0;
  for (std::size_t k = 0; k < 40; ++k)
    (k < 2 ? low : high) = std::max(k < 2 ? low : high, std::abs(error[k] / weight[k]));
  report("profile above the second row", high, 0.01);
  report("profile in the first two rows", low, 0.05);
  EXPECT_LE(high, 0.01);
  EXPECT_LE(low, 0.05);
}

}  // namespace
}  // namespace barchan
