// Laws of drag: terminal speeds of spheres of quartz in air against a table, limits, and a crowd.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>

#include "laws/drag_coefficients.hpp"
#include "laws/turning_sphere.hpp"

namespace barchan {
namespace {

constexpr double rho = 1.225, viscosity = 1.81e-5 / 1.225, rho_p = 2650.0, gravity = 9.81;

/// v of excess(Re) v / tau_S = g, by bisection.
template <class LawOfDrag>
double terminal_speed(double d) {
  const double tau = rho_p * d * d / (18.0 * rho * viscosity);
  double low = 0.0, high = 1e3;
  for (int k = 0; k < 200; ++k) {
    const double v = 0.5 * (low + high);
    (LawOfDrag::excess(v * d / viscosity) * v / tau < gravity ? low : high) = v;
  }
  return low;
}

struct Row {
  double d, stokes, schiller_naumann, cheng;  // mm, m/s
};
// Integrations and bisections apart from this program (1.81e-5 Pa s, 1.225 kg/m3).
constexpr Row table[] = {{.05, .1994, .18016, .1371},   {.10, .7976, .57694, .4502},   {.15, 1.7945, 1.02542, .8091},
                         {.20, 3.190, 1.46987, 1.1587}, {.25, 4.985, 1.89803, 1.4846}, {.50, 19.94, 3.81355, 2.7946},
                         {1.0, 79.76, 7.02329, 4.5812}};

TEST(DragLaws, TerminalSpeedsAreThoseOfTheTable) {
  for (const Row& row : table) {
    const double d = 1e-3 * row.d;
    EXPECT_NEAR(terminal_speed<StokesDrag>(d) / row.stokes, 1.0, 0.003) << row.d;
    EXPECT_NEAR(terminal_speed<SchillerNaumannDrag>(d) / row.schiller_naumann, 1.0, 0.003) << row.d;
    EXPECT_NEAR(terminal_speed<ChengDrag>(d) / row.cheng, 1.0, 0.003) << row.d;
  }
}

TEST(DragLaws, AreTheirCoefficients) {
  for (const double re : {0.01, 1.0, 30.0, 300.0}) {
    const double duran = std::pow(std::sqrt(0.5) + std::sqrt(24.0 / re), 2),
                 difelice = std::pow(0.63 + 4.8 / std::sqrt(re), 2);
    EXPECT_NEAR(DuranDrag::excess(re) / (duran * re / 24.0), 1.0, 1e-12);
    EXPECT_NEAR(DiFeliceDrag::excess(re) / (difelice * re / 24.0), 1.0, 1e-12);
    EXPECT_NEAR(ChengDrag::excess(re) / (std::pow(std::pow(32.0 / re, 2.0 / 3.0) + 1.0, 1.5) * re / 24.0), 1.0, 1e-12);
  }
  EXPECT_NEAR(SchillerNaumannDrag::excess(5000.0), 0.44 * 5000.0 / 24.0, 1e-9);
  EXPECT_NEAR(DuranDrag::excess(0.0), 1.0, 1e-12);
  EXPECT_NEAR(SchillerNaumannDrag::excess(0.0), 1.0, 1e-12);
}

/// Robinson et al. 2014: f = 1/8 C_D e^-xi pi d^2 rho |u_s| u_s with u_s = e (u - v).
TEST(DragLaws, DiFeliceInACrowdIsTheForceOfRobinson) {
  const double d = 2.5e-4, difference = 1.3;
  for (const double e : {0.4, 0.7, 1.0}) {
    const double through = e * difference, re = through * d / viscosity;
    const double xi = 3.7 - 0.65 * std::exp(-0.5 * std::pow(1.5 - std::log10(re), 2));
    const double force = std::pow(0.63 + 4.8 / std::sqrt(re), 2) / 8.0 * std::pow(e, -xi) * std::numbers::pi * d * d *
                         rho * through * through;
    const double stokes = 3.0 * std::numbers::pi * rho * viscosity * d * difference;
    EXPECT_NEAR(DiFeliceDrag::excess_in_crowd(difference * d / viscosity, e) / (force / stokes), 1.0, 1e-12) << e;
  }
  EXPECT_GT(DiFeliceDrag::excess_in_crowd(10.0, 0.4), 5.0 * DiFeliceDrag::excess(10.0)) << "a crowd hinders";
}

TEST(DragLaws, AreFoundByName) {
  const auto at_ten = [](DragLaw law) { return with_drag_law(law, [](auto l) { return decltype(l)::excess(10.0); }); };
  EXPECT_EQ(at_ten(DragLaw::stokes), StokesDrag::excess(10.0));
  EXPECT_EQ(at_ten(DragLaw::schiller_naumann), SchillerNaumannDrag::excess(10.0));
  EXPECT_EQ(at_ten(DragLaw::cheng), ChengDrag::excess(10.0));
  EXPECT_EQ(at_ten(DragLaw::duran), DuranDrag::excess(10.0));
  EXPECT_EQ(at_ten(DragLaw::di_felice), DiFeliceDrag::excess(10.0));
}

/// A ball that rolls along x in air at rest is pushed down, as one with topspin; in faster air it is pushed up.
TEST(TurningSpheres, ArePushedAcrossTheirWay) {
  const TurningSphere sphere{5e-4, 1.5e-5, 2.5e-4, 0.0};
  std::array<double, 1> spin{-2000.0};
  EXPECT_LT((sphere.turn<2>(spin, {2.0, 0.0}, 0.0)[1]), 0.0);
  EXPECT_GT((sphere.turn<2>(spin, {-2.0, 0.0}, 0.0)[1]), 0.0);
  std::array<double, 3> same{0.0, 0.0, -2000.0};
  EXPECT_EQ((sphere.turn<3>(same, {-2.0, 0.0, 0.0}, 0.0)[1]), (sphere.turn<2>(spin, {-2.0, 0.0}, 0.0)[1]));
  // About the other axes the same, turned.
  std::array<double, 3> x{-2000.0, 0.0, 0.0};
  EXPECT_EQ((sphere.turn<3>(x, {0.0, -2.0, 0.0}, 0.0)[2]), (sphere.turn<2>(spin, {-2.0, 0.0}, 0.0)[1]));
}

/// 3/4 rho_f/rho_s W v as Re goes to zero (Rubinow & Keller), and Loth's share of it: at Re 50 and S 0.16 0.356.
TEST(TurningSpheres, HaveLothsForce) {
  const TurningSphere sphere{5e-4, 1.5e-5, 2.5e-4, 0.0};
  std::array<double, 1> spin{-10.0};
  EXPECT_NEAR((sphere.turn<2>(spin, {-1e-9, 0.0}, 0.0)[1]) / (0.75 * 5e-4 * 10.0 * 1e-9), 1.0, 1e-4);
  EXPECT_NEAR(TurningSphere::share(50.0, 0.16), 0.356, 5e-4);
  EXPECT_NEAR(TurningSphere::share(1e6, 100.0), 1.0 - 0.975, 1e-12);
}

/// Stokes's torque: the spin goes to that of the fluid, by exp(-60 rho_f nu t/(rho_s d^2)).
TEST(TurningSpheres, AreTakenAlong) {
  const TurningSphere sphere{5e-4, 1.5e-5, 2.5e-4, -300.0};
  std::array<double, 3> spin{0.0, 400.0, 500.0};
  const double time = 0.05, fade = std::exp(-60.0 * 5e-4 * 1.5e-5 * time / (2.5e-4 * 2.5e-4));
  sphere.turn<3>(spin, {0.0, 0.0, 0.0}, time);
  EXPECT_NEAR(spin[1], 400.0 * fade, 1e-9);
  EXPECT_NEAR(spin[2], -300.0 + 800.0 * fade, 1e-9);
}

}  // namespace
}  // namespace barchan
