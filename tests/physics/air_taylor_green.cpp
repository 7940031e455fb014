// Taylor-Green vortices at Re = 100: particles that start disturbed by 0.2 spacings against the exact decay.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <sstream>

#include "physics/drive.hpp"

namespace barchan {
namespace {

using std::numbers::pi;
using testing::Drive;
using testing::report;

struct Errors {
  double velocity;  // L1 = sum ||u| - |u_exact|| / sum |u_exact|, each particle at its own place
  double decay;     // (max |u| - U e^(bt)) / U e^(bt)
  double pressure;  // mean |p - p_exact| / max |p_exact|, less the mean
};

Errors errors(Drive& drive) {
  const auto& p = drive.phase(0);
  const double t = drive.simulation().time(), decay = std::exp(-8 * pi * pi / 100 * t);
  double difference = 0, sum = 0, fastest = 0, mean = 0;
  const auto exact_pressure = [&](std::size_t k) {
    const double x = p.column(Field::position, 0)[k], y = p.column(Field::position, 1)[k];
    return -0.25 * decay * decay * (std::cos(4 * pi * x) + std::cos(4 * pi * y));
  };
  for (std::size_t k = 0; k < p.size(); ++k) {
    const double x = p.column(Field::position, 0)[k], y = p.column(Field::position, 1)[k];
    const double exact =
        decay * std::hypot(std::cos(2 * pi * x) * std::sin(2 * pi * y), std::sin(2 * pi * x) * std::cos(2 * pi * y));
    const double size = std::hypot(p.column(Field::velocity, 0)[k], p.column(Field::velocity, 1)[k]);
    difference += std::abs(size - exact);
    sum += exact;
    fastest = std::max(fastest, size);
    mean += (p.column(Field::pressure)[k] - exact_pressure(k)) / static_cast<double>(p.size());
  }
  double pressure = 0;
  for (std::size_t k = 0; k < p.size(); ++k)
    pressure += std::abs(p.column(Field::pressure)[k] - exact_pressure(k) - mean) / static_cast<double>(p.size());
  return {difference / sum, fastest / decay - 1, pressure / (0.5 * decay * decay)};
}

Errors after_a_second(const std::vector<std::string>& overrides, double bound) {
  Drive drive("verification/taylor_green", overrides);
  drive.to(1.0);
  const Errors e = errors(drive);
  report("L1 of speed at t = 1 s", e.velocity, bound);
  report("decay of the largest speed", e.decay, bound);
  report("L1 of pressure", e.pressure, 0.1);
  EXPECT_LE(std::abs(e.decay), bound);
  EXPECT_LE(e.pressure, 0.1);
  return e;
}

/// Enclosed flows without friction, disordered as they are, never meet the treatment of voids.
TEST(WholeFluids, HaveNoVoid) {
  for (const char* scene : {"verification/taylor_green", "verification/gresho", "verification/vortex_box"}) {
    Drive drive(scene, {"phases.fluid.viscosity=0", "spacing=0.025"});
    for (int k = 0; k < 600; ++k) {
      drive.simulation().step(1e300);
      const auto& p = drive.phase(0);
      const double* near = p.column(Field::near_void);
      ASSERT_TRUE(std::all_of(near, near + p.size(), [](double x) { return x == 0.0; })) << scene << " step " << k;
    }
  }
}

/// A start that is disturbed by 0.3 spacings has broken neighbourhoods for some steps, but no void.
TEST(WholeFluids, ADisturbedStartHasNoVoid) {
  Drive drive("verification/taylor_green", {"spacing=0.04", "fill.0.perturb=0.3"});
  for (int k = 0; k < 100; ++k) {
    drive.simulation().step(1e300);
    const auto& p = drive.phase(0);
    const double* near = p.column(Field::near_void);
    ASSERT_TRUE(std::all_of(near, near + p.size(), [](double x) { return x == 0.0; })) << "step " << k;
  }
}

/// Gresho's vortex in the plain scheme, whose sums pull where the pressure is below zero: without a constant in them
/// particles clump, the more the finer they are. With 100 a side the error was 0.32 with 0.3 rho0 U^2 as the constant,
/// and is 0.11 with 0.45 rho0 U^2.
TEST(WholeFluids, PlainSumsDoNotClump) {
  Drive drive("verification/gresho",
              {"phases.fluid.scheme=plain", "interactions.fluid-fluid=2.6", "spacing=0.01", "precision=mixed"});
  drive.to(0.5);
  const auto& p = drive.phase(0);
  double difference = 0, sum = 0;
  for (std::size_t k = 0; k < p.size(); ++k) {
    const double x = p.column(Field::position, 0)[k] - 0.5, y = p.column(Field::position, 1)[k] - 0.5;
    const double r = std::hypot(x, y), turn = r < 0.2 ? 5.0 : r < 0.4 ? 2.0 / r - 5.0 : 0.0;
    difference += std::hypot(p.column(Field::velocity, 0)[k] + y * turn, p.column(Field::velocity, 1)[k] - x * turn);
    sum += r * turn;
  }
  report("L1 of the velocity at t = 0.5 s", difference / sum, 0.12);
  EXPECT_LE(difference / sum, 0.12);
}

TEST(TaylorGreen, ConsistentScheme) {
  const Errors e = after_a_second({}, 0.004);
  EXPECT_LE(e.velocity, 0.004);
}

TEST(TaylorGreen, PlainScheme) {
  const Errors e = after_a_second({"phases.fluid.scheme=plain", "interactions.fluid-fluid=3.0"}, 0.03);
  EXPECT_LE(e.velocity, 0.03);
}

/// The error falls with the spacing, at the lattice's start disturbed alike.
TEST(TaylorGreen, ConsistentSchemeConverges) {
  const std::string radius = "interactions.fluid-fluid=2.6";
  const Errors coarse = after_a_second({"spacing=0.04", radius}, 0.02);
  const Errors fine = after_a_second({radius}, 0.004);
  report("error at 25 over error at 50 a side", coarse.velocity / fine.velocity, 1.5);
  EXPECT_GT(coarse.velocity, 1.5 * fine.velocity);
}

/// Coarse and without viscosity for thirty turns: what remains is slow, and the mean density does not drift away (it
/// did, by 12 % in 30 s, and the run ended in pairs with ten particles a side).
TEST(TaylorGreen, KeepsItsMeanDensityForLong) {
  Drive drive("verification/taylor_green", {"spacing=0.1", "phases.fluid.viscosity=0"});
  drive.to(30.0);
  const auto& p = drive.phase(0);
  double mean = 0, worst = 0;
  for (std::size_t k = 0; k < p.size(); ++k) {
    mean += p.column(Field::density)[k] / static_cast<double>(p.size());
    worst = std::max(worst, std::abs(p.column(Field::density)[k] - 1.0));
  }
  report("error of the mean density", std::abs(mean - 1.0), 1e-3);
  report("largest density error", worst, 0.02);
  EXPECT_LE(std::abs(mean - 1.0), 1e-3);
  EXPECT_LE(worst, 0.02);
}

/// Vortices that ten to fourteen particles a side cannot resolve, without viscosity: the energy does not grow. With
/// corrected operators alone it did, five times in 1.2 s, and four of eight runs ended with status 3.
TEST(TaylorGreen, UnresolvedVorticesGainNoEnergy) {
  for (const int side : {10, 12, 14})
    for (const int seed : {1, 2, 4}) {
      std::ostringstream spacing;
      spacing.precision(17);
      spacing << 1.0 / side;
      Drive drive("verification/taylor_green",
                  {"spacing=" + spacing.str(), "phases.fluid.viscosity=0", "fill.0.seed=" + std::to_string(seed)});
      const auto energy = [&] {
        const auto& p = drive.phase(0);
        double sum = 0.0;
        for (int d = 0; d < 2; ++d)
          for (std::size_t k = 0; k < p.size(); ++k)
            sum += 0.5 * p.mass() * std::pow(p.column(Field::velocity, d)[k], 2);
        return sum;
      };
      const double before = energy();
      ASSERT_NO_THROW(drive.to(5.0)) << side << " a side, seed " << seed;
      EXPECT_LE(energy(), before) << side << " a side, seed " << seed;
    }
}

}  // namespace
}  // namespace barchan
