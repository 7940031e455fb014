// Laws of pairs on two particles, against numbers that were worked out by hand.
#include <gtest/gtest.h>

#include "laws/eddy_fluid.hpp"
#include "laws/eddy_friction.hpp"
#include "laws/extension.hpp"
#include "laws/plain_energy.hpp"

namespace barchan {
namespace {

using One = simd::Vec<double, 1>;

/// r = (3, 4), so that r2 = 25.
template <class Law>
Pair<2, One> apart(double w, double f) {
  return {{One(3.0), One(4.0)}, One(25.0), One(w), One(f)};
}

/// v_ab = (1, 2): v.r = 11, v^2 = 5. V F = 0.5 * -2 = -1; 1/2 (p_a + p_b) = 10. -1 (10*11 - 3*5) = -95 W/m3.
/// The force on a: -1 (2*3 (1, 2) - 20 (3, 4)) = (54, 68) N/m3.
TEST(PairLaws, EnergyIsTheWorkOfPressureLessThatOfFriction) {
  PlainEnergy::Own<2, One> a{}, b{};
  a.v = {One(1.5), One(2.0)};
  b.v = {One(0.5), One(0.0)};
  a.p = One(8.0);
  b.p = One(12.0);
  b.volume = One(0.5);
  PlainEnergy::Sums<2, One> s{};
  const PlainEnergy law{{}, 3.0};
  law.add(a, b, apart<PlainEnergy>(0.0, -2.0), s);
  EXPECT_EQ(s.work[0], -95.0);
  EXPECT_EQ(s.force[0][0], 54.0);
  EXPECT_EQ(s.force[1][0], 68.0);
  PlainEnergy::close_entry(s);
  law.add(a, b, apart<PlainEnergy>(0.0, -2.0), s);
  PlainEnergy::close_entry(s);
  EXPECT_EQ(s.total, -190.0);
  EXPECT_EQ(s.work[0], 0.0);
}

/// The same two, b of a body: u_b = (0.5, 1), of which turning gives c = (0.25, 1.5); w = 2, w0 = 3. The power of the
/// force is (54, 68).(1, 1) = 122; w x r = (-8, 6), w0 x r = (-12, 9). Turning: mu V F = -3 times
/// [(-8, 6).(1, 2) - (-12, 9).(2 c + (-8, 6))] = 4 - (-12*-7.5 + 9*9) = -167: 501 W/m3.
TEST(PairLaws, EnergyOfASolidIsThatOfItsOwnMotion) {
  SolidEnergy::Own<2, One> a{};
  Particle<2, One, SolidEnergy::Reads> b{};
  a.v = {One(1.5), One(2.0)};
  b.v = {One(0.5), One(0.0)};
  a.p = One(8.0);
  b.p = One(12.0);
  b.volume = One(0.5);
  b.u = {One(0.5), One(1.0)};
  b.c = {One(0.25), One(1.5)};
  b.rate = {One(2.0)};
  b.old_rate = {One(3.0)};
  SolidEnergy::Sums<2, One> s{};
  SolidEnergy{{}, 3.0}.add(a, b, apart<SolidEnergy>(0.0, -2.0), s);
  EXPECT_EQ(s.work[0], -122.0 + 501.0);
  EXPECT_EQ(s.force[0][0], 54.0);
}

/// V (mu_b - mu) F = 0.5 * (0.7 - 0.2) * -2 = -0.5, times v_ab = (1, 2).
TEST(PairLaws, FrictionOfEddiesIsThatBeyondTheMolecularOne) {
  EddyFriction::Own<2, One> a{}, b{};
  a.v = {One(1.5), One(2.0)};
  b.v = {One(0.5), One(0.0)};
  b.volume = One(0.5);
  b.beside = One(0.7);
  EddyFriction::Sums<2, One> s{};
  EddyFriction{{}, 0.2}.add(a, b, apart<EddyFriction>(0.0, -2.0), s);
  EXPECT_DOUBLE_EQ(s.drawn[0][0], -0.5);
  EXPECT_DOUBLE_EQ(s.drawn[1][0], -1.0);
}

/// n = (0, -1), x_w - x_a = (3, 4), phi_w = 1: phi_a = -n.r - phi_w = 4 - 1 = 3. V W = 0.5 * 0.2 = 0.1.
/// p = 7 + 2 (0*3 - 10*4) = -73. Lever: rho (phi_a + phi_w) = 2 * 4 = 8.
TEST(PairLaws, ExtensionSumsPressureAndVelocity) {
  using Law = Extension<true>;
  Law::Own<2, One> w{};
  w.velocity = {One(1.0), One(0.0)};
  w.normal = {One(0.0), One(-1.0)};
  w.pull = {One(0.0), One(-10.0)};
  w.behind = One(-1.0);
  Particle<2, One, Law::Reads> a{};
  a.v = {One(4.0), One(5.0)};
  a.p = One(7.0);
  a.volume = One(0.5);
  Law::Sums<2, One> s{};
  Law{{}, 2.0, {}}.add(w, a, apart<Law>(0.2, -1.0), s);
  EXPECT_DOUBLE_EQ(s.weight[0], 0.1);
  EXPECT_DOUBLE_EQ(s.pressure[0], -7.3);
  EXPECT_DOUBLE_EQ(s.depth2[0], 0.9);
  EXPECT_DOUBLE_EQ(s.lever[0], 0.8);
  EXPECT_DOUBLE_EQ(s.velocity[0][0], 0.4);
  EXPECT_DOUBLE_EQ(s.velocity[1][0], 0.5);
  EXPECT_DOUBLE_EQ(s.sloped[0][0], 0.9);  // 0.1 * 3 * (4 - 1)
  EXPECT_DOUBLE_EQ(s.sloped[1][0], 1.5);  // 0.1 * 3 * 5
}

/// The same fluid with rest = 3 Pa, 1/c^2 = 0.25: rho = 2 + 0.25 (7 - 3) = 3, p = 7 + 3 (0*3 - 10*4) = -113.
TEST(PairLaws, ExtensionKnowsTheDensityAtThePressure) {
  using Law = Extension<false>;
  Law::Own<2, One> w{};
  w.pull = {One(0.0), One(-10.0)};
  Particle<2, One, Law::Reads> a{};
  a.p = One(7.0);
  a.volume = One(0.5);
  Law::Sums<2, One> s{};
  Law{{}, 2.0, {3.0, 0.25}}.add(w, a, apart<Law>(0.2, -1.0), s);
  EXPECT_DOUBLE_EQ(s.pressure[0], -11.3);
}

/// The fluid moves with (3, 0.5) on average and the wall with (1, 0); n = (0, 1).
TEST(PairLaws, ExtensionClosesAsTheWallSays) {
  ExtendedState<2> s{};
  s.weight = 0.75;
  s.depth2 = 2.0;
  s.mean = {3.0, 0.5};
  s.sloped = {4.0, 1.0};
  s.wall = {1.0, 0.0};
  s.normal = {0.0, 1.0};
  EXPECT_EQ(s.no_slip(), (std::array<double, 2>{-1.0, -0.5})) << "2 v_wall - mean, depth unknown";
  s.depth = 0.5;
  EXPECT_EQ(s.no_slip(), (std::array<double, 2>{0.0, -0.25})) << "v_wall - 0.5 sloped / 2";
  EXPECT_EQ(s.free_slip({0.0, -0.25}), (std::array<double, 2>{3.0, -0.25})) << "tangential part of the fluid's mean";
  EXPECT_EQ(s.grain(0.0), s.wall) << "no form drag: its own velocity";
  // 0.775 of the fluid about a lone grain is half way from 0.65 to 0.9: the half of 3 x^2 - 2 x^3.
  const auto half = s.grain(0.75 / 0.775);
  EXPECT_NEAR(half[0], 2.0, 1e-12);
  EXPECT_NEAR(half[1], 0.25, 1e-12);
  // Along the wall the fluid slips with u = 2: u.H.u = 0.25 * 4 = 1, times the lever 1.5 over 0.75.
  const double bend = 0.25;
  EXPECT_DOUBLE_EQ(s.turning_pressure(&bend, 1.5), 2.0);
}

/// B = (0, -2): n = (0, 1) where the kernel's constant is positive. M n = (xy, yy) = (3, 5), C.n = 7, tau = (2, 0).
TEST(EddyWalls, AStressRubsAlongTheNormal) {
  using Law = EddyFluid<2>;
  ConsistentFluid<2>::Sums<One> raw{};
  raw.concentration = {One(0.0), One(-2.0)};
  raw.moment = {One(1.0), One(3.0), One(5.0)};
  raw.weighted = {One(4.0), One(7.0)};
  const auto normal = Law::normal_of<One>(raw, 0.5);
  EXPECT_EQ(normal[0][0], 0.0);
  EXPECT_EQ(normal[1][0], 1.0);
  EXPECT_EQ(Law::normal_of<One>(raw, -0.5)[1][0], -1.0);
  EXPECT_EQ(Law::normal_of<One>(ConsistentFluid<2>::Sums<One>{}, 0.5)[1][0], 0.0) << "no neighbour, no normal";
  const auto s = Law::with_stress<One>(raw, normal, {One(2.0), One(0.0)});
  EXPECT_EQ(s.viscous[0][0], 14.0);
  EXPECT_EQ(s.viscous[1][0], 0.0);
  EXPECT_EQ(s.flux[0][0], 6.0);
  EXPECT_EQ(s.flux[1][0], 10.0);
  EXPECT_EQ(s.flux[2][0], 0.0);
}

TEST(EddyWalls, AViscosityScalesTheSumsOfTheVelocity) {
  ConsistentFluid<2>::Sums<One> raw{};
  raw.viscous = {One(2.0), One(3.0)};
  raw.velocity = {One(1.0), One(2.0), One(3.0), One(4.0)};
  const auto s = EddyFluid<2>::with_viscosity<One>(raw, One(0.5));
  EXPECT_EQ(s.viscous[1][0], 1.5);
  EXPECT_EQ(s.flux[2][0], 1.5);
}

/// M^-1 = 1, T' = (0 4; 0 0), C = (0, 1), L_v = (10, 0): friction (6, 0). |T + T^T|^2/2 = 16; grad v = (0 2; 0 0): 4.
TEST(EddyWalls, FrictionIsWhatALinearFieldDoesNotMake) {
  EddyFluid<2>::Sums<One> s{};
  s.viscous = {One(10.0), One(0.0)};
  s.flux = {One(0.0), One(4.0), One(0.0), One(0.0)};
  s.weighted = {One(0.0), One(1.0)};
  EddyFluid<2>::Stress<One> stress{s};
  const std::array<One, 4> one{One(1.0), One(0.0), One(0.0), One(1.0)};
  const std::array<std::array<One, 2>, 2> grad_v{{{One(0.0), One(2.0)}, {One(0.0), One(0.0)}}};
  const auto friction = stress(one, grad_v);
  EXPECT_EQ(friction[0][0], 6.0);
  EXPECT_EQ(friction[1][0], 0.0);
  EXPECT_EQ(stress.phi2[0], 16.0);
  EXPECT_EQ(stress.shear2[0], 4.0);
}

/// mu = rho (kappa/ln 10)^2 u (d + dx/2) = 1.2 * 0.0301779 * 3 * 0.025.
TEST(EddyWalls, RoughViscosityGivesTheStressOfTheLogarithmicLaw) {
  EXPECT_NEAR(rough_viscosity(1.2, 0.02, 0.002, 0.01, 3.0), 2.716008e-3, 1e-9);
}

}  // namespace
}  // namespace barchan
