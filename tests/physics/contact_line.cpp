// Where a level surface meets a wall (models/walls/contact_line.hpp): a tank is still in its corners, in 3D too, and a
// wave between walls loses what it loses among periodic sides. The same at full size: bench/accuracy/cases.py
// (still-tank, sloshing).
#include <algorithm>
#include <cmath>
#include <numbers>

#include "physics/drive.hpp"
#include "physics/small_scenes.hpp"

namespace barchan {
namespace {

using testing::Drive;
using testing::report;

/// Water 6 spacings wide and deep, between four walls.
const std::string tank = R"toml(
dimensions = 3
spacing = 0.1
[domain]
size = [0.6, 0.9, 0.6]
gravity = [0, -9.81, 0]
[phases.water]
kind = "fluid"
density = 1000
viscosity = 1e-6
sound-speed = 48.5
scheme = "consistent"
enclosed = false
[phases.tank]
kind = "wall"
slip = "free-slip"
[interactions]
kernel = "wendland-c2"
water-water = 2.6
water-tank = 2.6
[[fill]]
phase = "tank"
shape = { sides = ["bottom", "left", "right", "back", "front"], layers = 3 }
[[fill]]
phase = "water"
shape = { box = { min = [0, 0, 0], max = [0.6, 0.6, 0.6] } }
pressure = "hydrostatic"
[time]
end = 1
largest-speed = 0.2
)toml";

/// With the whole wall beside the surface it moves at 1.2e-3 sqrt(gH), in the corners.
TEST(ContactLine, ATankIn3DIsStill) {
  const auto simulation = small::simulation(tank);
  const auto& p = simulation->phases()[0];
  double fastest = 0;
  while (simulation->time() < 0.25) {  // 20 crossings of sound
    simulation->step(0.25 - simulation->time());
    for (std::size_t k = 0; k < p.size(); ++k)
      fastest = std::max(fastest, norm(Vec3{p.column(Field::velocity, 0)[k], p.column(Field::velocity, 1)[k],
                                            p.column(Field::velocity, 2)[k]}));
  }
  const double speed = fastest / std::sqrt(9.81 * 0.6);
  report("largest speed/sqrt(gH)", speed, 5e-5);
  EXPECT_LE(speed, 5e-5);
  EXPECT_GT(speed, 0.0);
}

/// A small wave between walls, 12 rows deep: it lost 3.5 % a period, and a wave of the same length among periodic sides
/// 0.33 %. The amplitude is that of the velocity, the largest about four periods.
TEST(ContactLine, AWaveBetweenWallsLives) {
  Drive drive("verification/sloshing_tank", {"constants.rows=12", "constants.start=0.0159", "constants.shake=0"});
  const auto& p = drive.phase(0);
  const double k = std::numbers::pi, period = 2 * k / std::sqrt(9.81 * k * std::tanh(0.5 * k));
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
  double late = 0;
  for (int step = -4; step <= 8; ++step) {
    drive.to((4 + step / 40.0) * period);
    late = std::max(late, amplitude());
  }
  const double loss = 1 - std::pow(late / start, 0.25);
  report("amplitude that a period takes", loss, 0.012);
  EXPECT_LE(loss, 0.012);
  EXPECT_GE(loss, -0.002);
}

}  // namespace
}  // namespace barchan
