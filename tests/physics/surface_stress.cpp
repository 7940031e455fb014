// A free surface bears no viscous stress: a film down a slope keeps its exact profile, and a standing wave in viscous
// water decays as linear theory says. The same at full size: bench/accuracy/cases.py (falling-film, viscous-wave).
#include <algorithm>
#include <cmath>
#include <numbers>

#include "physics/drive.hpp"

namespace barchan {
namespace {

using testing::Drive;
using testing::report;

/// Without the stress of the surface the top row ran away with g_x t: a tenth of the surface's speed within 1 s.
TEST(FallingFilm, KeepsItsProfile) {
  Drive drive("verification/falling_film");
  const auto& p = drive.phase(0);
  drive.to(1.0);
  double off = 0;
  for (std::size_t k = 0; k < p.size(); ++k) {
    const double y = p.column(Field::position, 1)[k];
    off = std::max(off, std::abs(p.column(Field::velocity, 0)[k] / 0.5 - (2 * y - y * y)));
  }
  report("speed, largest error/speed of the surface", off, 0.006);
  EXPECT_LE(off, 0.006);
}

/// A standing wave of Re = H sqrt(gH)/nu = 250 with 25 rows: after two periods linear theory leaves 0.6048 of the
/// velocity's amplitude (bench/accuracy/viscous_wave_reference.py); without the stress of the surface 0.98 was left.
TEST(ViscousWave, DecaysAsInTheory) {
  Drive drive("verification/standing_wave", {"spacing=0.04", "phases.water.viscosity=0.0125284"});
  const auto& p = drive.phase(0);
  const double k = std::numbers::pi;
  const auto amplitude = [&] {
    double along = 0, square = 0;
    for (std::size_t q = 0; q < p.size(); ++q) {
      const double x = p.column(Field::position, 0)[q], y = p.column(Field::position, 1)[q];
      const double u = -std::cosh(k * y) * std::sin(k * x), v = std::sinh(k * y) * std::cos(k * x);
      along += p.column(Field::velocity, 0)[q] * u + p.column(Field::velocity, 1)[q] * v;
      square += u * u + v * v;
    }
    return along / square;
  };
  const double start = amplitude();
  drive.to(2.268);
  const double left = amplitude() / start, theory = 0.6048;
  report("amplitude after two periods/start", left, theory);
  EXPECT_NEAR(left, theory, 0.01);
}

}  // namespace
}  // namespace barchan
