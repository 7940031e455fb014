// Laminar flow over a backward-facing step, cut down: reattachment at Re = 100 against the literature.
#include <cmath>

#include "physics/drive.hpp"

namespace barchan {
namespace {

using testing::Drive;
using testing::report;

// At 16 spacings across the narrow part and after 50 s: see docs/accuracy.md. Here 8 spacings and 25 s.
TEST(BackwardStep, ReattachesWhereTheLiteratureSays) {
  Drive drive("verification/backward_step",
              {"spacing=0.125", "phases.fluid.viscosity=0.02", "forcing.0.acceleration=[0.138, 0]"});
  constexpr double step = 12.0, length = 14.0, dx = 0.125, viscosity = 0.02;
  constexpr std::size_t bins = 56;
  std::array<double, bins> along{}, count{};
  double flow = 0, weight = 0;
  for (int moment = 0; moment <= 10; ++moment) {
    drive.to(25.0 + moment);
    const auto& p = drive.phase(0);
    for (std::size_t k = 0; k < p.size(); ++k) {
      const double x = p.column(Field::position, 0)[k], y = p.column(Field::position, 1)[k];
      const double u = p.column(Field::velocity, 0)[k];
      if (x > step && y < dx) {
        const auto bin = std::min(static_cast<std::size_t>((x - step) / length * bins), bins - 1);
        along[bin] += u;
        count[bin] += 1;
      } else if (x > step - 3 && x < step - 1) {
        flow += u;
        weight += 1;
      }
    }
  }
  const double reynolds = 2.0 * flow / weight / viscosity;
  double reattachment = 0;
  for (std::size_t k = 2; k + 1 < bins && reattachment == 0; ++k) {  // the first half step: the eddy in the corner
    const double here = along[k] / count[k], next = along[k + 1] / count[k + 1];
    if (here < 0 && next >= 0)
      reattachment = (static_cast<double>(k) + 0.5 + here / (here - next)) * length / static_cast<double>(bins);
  }
  // Erturk 2008, expansion ratio 2: 2.922 at Re = 100, 4.982 at 200, 6.751 at 300, by a parabola.
  const double s = (reynolds - 100) / 100, literature = 2.922 + 2.060 * s + 0.5 * s * (s - 1) * (1.769 - 2.060);
  report("Re of the flow", reynolds, 100);
  report("reattachment against the literature, relative", std::abs(reattachment / literature - 1), 0.08);
  EXPECT_NEAR(reynolds, 100, 15);
  EXPECT_LE(std::abs(reattachment / literature - 1), 0.08);
}

}  // namespace
}  // namespace barchan
