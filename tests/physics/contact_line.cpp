// Where a level surface meets a wall (models/walls/contact_line.hpp): a tank is still in its corners, in 3D too, and a
// wave between walls keeps its frequency and its amplitude. At full size: bench/accuracy/cases.py (still-tank,
// sloshing).
#include <algorithm>
#include <array>
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

/// Projection of the velocities on those of the first mode of the tank, of depth 0.5 m.
double mode(const PhaseParticles& p) {
  const double k = std::numbers::pi;
  double along = 0, square = 0;
  for (std::size_t q = 0; q < p.size(); ++q) {
    const double x = p.column(Field::position, 0)[q], y = p.column(Field::position, 1)[q];
    const double u = -std::cosh(k * y) * std::sin(k * x), v = std::sinh(k * y) * std::cos(k * x);
    along += p.column(Field::velocity, 0)[q] * u + p.column(Field::velocity, 1)[q] * v;
    square += u * u + v * v;
  }
  return along * std::sinh(0.5 * k) / square;
}

const double omega = std::sqrt(9.81 * std::numbers::pi * std::tanh(0.5 * std::numbers::pi)),
             period = 2 * std::numbers::pi / omega;

/// Where the mode is zero near `time`, on a line between values 2 % of a period before and behind.
double zero_near(Drive& drive, double time) {
  const double before = time - 0.02 * period;
  drive.to(before);
  const double first = mode(drive.phase(0)), from = drive.simulation().time();
  drive.to(time + 0.02 * period);
  const double second = mode(drive.phase(0)), to = drive.simulation().time();
  return from + (to - from) * first / (first - second);
}

/// A small wave between walls, 12 rows deep: it lost 0.76 % a period and was 0.87 % too slow; with the whole wall
/// beside the surface it lost 3.5 %. The amplitude is that of the velocity, the largest about four periods.
TEST(ContactLine, AWaveBetweenWallsLives) {
  Drive drive("verification/sloshing_tank", {"constants.rows=12", "constants.start=0.0159", "constants.shake=0"});
  const double start = mode(drive.phase(0)), first = zero_near(drive, 0.25 * period);
  double late = 0;
  for (int step = -4; step <= 4; ++step) {
    drive.to((4 + step / 40.0) * period);
    late = std::max(late, mode(drive.phase(0)));
  }
  const double frequency = 4 * period / (zero_near(drive, 4.25 * period) - first) - 1;
  report("frequency over that of linear theory, error", frequency, 0.003);
  EXPECT_LE(std::abs(frequency), 0.003);
  const double loss = 1 - std::pow(late / start, 0.25);
  report("amplitude that a period takes", loss, 0.005);
  EXPECT_LE(std::abs(loss), 0.005);
}

/// Water 8 spacings wide and deep that a [[forcing]] pulls down as a fifth of weight does.
const std::string pulled = R"toml(
dimensions = 2
spacing = 0.1
[domain]
size = [0.8, 1.2]
gravity = [0, -9.81]
[phases.water]
kind = "fluid"
density = 1000
viscosity = 0.05
sound-speed = 56
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
shape = { sides = ["bottom", "left", "right"], layers = 3 }
[[fill]]
phase = "water"
shape = { box = { min = [0, 0], max = [0.8, 0.8] } }
pressure = "hydrostatic"
[[forcing]]
phase = "water"
acceleration = [0, -1.962]
[time]
end = 4
largest-speed = 0.5
)toml";

/// The force goes on across the floor: the lowest rows differ by the pressure of a spacing. Where the wall knew weight
/// alone, they did by 18 % of it less.
TEST(ContactLine, AForceGoesOnAcrossTheFloor) {
  const auto simulation = small::simulation(pulled);
  while (simulation->time() < 4) simulation->step(4 - simulation->time());
  const auto& p = simulation->phases()[0];
  std::array<double, 2> pressure{}, height{};
  for (std::size_t k = 0; k < p.size(); ++k) {
    const double y = p.column(Field::position, 1)[k];
    if (y > 0.2) continue;
    pressure[y > 0.1] += p.column(Field::pressure)[k] / 8;
    height[y > 0.1] += y / 8;
  }
  const double error = (pressure[0] - pressure[1]) / (1000 * 11.772 * (height[1] - height[0])) - 1;
  report("pressure between the lowest rows, error", error, 0.03);
  EXPECT_NEAR(error, 0, 0.03);
}

}  // namespace
}  // namespace barchan
