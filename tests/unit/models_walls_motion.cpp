// Walls that a [[motion]] carries: the pose against the exact integral of the velocities, and in a checkpoint.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "models/walls/wall_motion.hpp"

namespace barchan {
namespace {

VectorExpression formulas(const std::string& x, const std::string& y, const std::string& z) {
  VectorExpression e;
  e[0].formula = x;
  e[1].formula = y;
  e[2].formula = z;
  return e;
}

/// Turns about (1, 2, 3) with 3 cos(7t) about z, while that place goes with (2 sin(5t), exp(-t), 0).
Motion swaying() {
  Motion motion;
  motion.velocity = formulas("2*sin(5*t)", "exp(-t)", "0");
  motion.about = Vec3{1, 2, 3};
  motion.angular_velocity = AxialExpression{formulas("0", "0", "3*cos(7*t)")};
  return motion;
}

Vec3 place_after(const WallMotion& motion, const Vec3& start) {
  return motion.now().now.place + OwnAxes(motion.now()).to_space(motion.arm(start));
}

/// The largest error of a place after 1 s in `steps` steps.
double error_of(int dimensions, int steps) {
  WallMotion motion(swaying(), dimensions, {});
  for (int k = 0; k < steps; ++k) motion.advance(static_cast<double>(k) / steps, 1.0 / steps);
  const double angle = 3.0 / 7.0 * std::sin(7.0), c = std::cos(angle), s = std::sin(angle);
  const Vec3 about{1 + 0.4 * (1 - std::cos(5.0)), 2 + 1 - std::exp(-1.0), 3},
      exact = about + Vec3{0.5 * c - 0.25 * s, 0.5 * s + 0.25 * c, 0.125};
  return norm(place_after(motion, {1.5, 2.25, 3.125}) - exact);
}

TEST(WallMotion, IsTheIntegralToTheFourthOrder) {
  for (const int dimensions : {2, 3}) {
    EXPECT_LT(error_of(dimensions, 100), 1e-6);
    EXPECT_NEAR(std::log2(error_of(dimensions, 20) / error_of(dimensions, 40)), 4.0, 0.2) << dimensions << "D";
  }
}

TEST(WallMotion, AConstantMotionIsExactAndKeepsTheShape) {
  Motion motion;
  motion.velocity = formulas("0.25", "0", "0");
  motion.angular_velocity = AxialExpression{formulas("0", "0", "2")};
  WallMotion drum(motion, 2, {0.5, 0.5, 0});
  constexpr int steps = 100000;
  for (int k = 0; k < steps; ++k) drum.advance(k * 1e-3, 1e-3);
  const Vec3 a = place_after(drum, {1.5, 0.5, 0}), b = place_after(drum, {0.5, 0.5, 0});
  EXPECT_NEAR(norm(a - b), 1.0, 1e-15) << "nothing drifts";
  EXPECT_NEAR(b[0], 25.5, 1e-9);
  EXPECT_NEAR(a[0] - b[0], std::cos(200.0), 1e-8);
  EXPECT_NEAR(a[1] - b[1], std::sin(200.0), 1e-8);
}

/// An axis that turns itself: w = (cos t, sin t, 0). In the frame that turns with it the axis stands still.
TEST(WallMotion, FollowsAnAxisThatTurns) {
  Motion motion;
  motion.velocity = formulas("0", "0", "0");
  motion.angular_velocity = AxialExpression{formulas("cos(t)", "sin(t)", "0")};
  const auto after = [&](int steps) {
    WallMotion body(motion, 3, {0, 0, 0});
    for (int k = 0; k < steps; ++k) body.advance(2.0 * k / steps, 2.0 / steps);
    return place_after(body, {0, 0, 1});
  };
  // Exact: turned by 2 about z, after sqrt(2) 2 about (1, 0, -1)/sqrt(2).
  const double angle = 2.0 * std::numbers::sqrt2, c = std::cos(angle), s = std::sin(angle), r = std::numbers::sqrt2 / 2;
  const Vec3 axis{r, 0, -r}, z{0, 0, 1};
  const Vec3 turned = c * z + s * cross(axis, z) + (1 - c) * dot(axis, z) * axis;
  const Vec3 exact{std::cos(2.0) * turned[0] - std::sin(2.0) * turned[1],
                   std::sin(2.0) * turned[0] + std::cos(2.0) * turned[1], turned[2]};
  EXPECT_LT(norm(after(200) - exact), 1e-8);
  EXPECT_NEAR(std::log2(norm(after(20) - exact) / norm(after(40) - exact)), 4.0, 0.3);
}

TEST(WallMotion, WithinAStepItIsBetweenTheBeginningAndTheEnd) {
  WallMotion motion(swaying(), 2, {});
  motion.advance(0.0, 0.01);
  const Vec3 before = motion.now().now.place;
  motion.advance(0.01, 0.01);
  EXPECT_EQ(motion.within_step(0.0).now.place, before);
  EXPECT_EQ(motion.within_step(0.01).now.place, motion.now().now.place);
  EXPECT_NEAR(motion.within_step(0.005).now.angle, 3.0 / 7.0 * std::sin(7.0 * 0.015), 1e-8);
}

TEST(WallMotion, AJumpOfTheVelocityIsSpreadOverTheSpan) {
  Motion motion;
  motion.velocity = formulas("t < 0.5 ? 0 : 3", "0", "0");
  const WallMotion gate(motion, 2, {});
  EXPECT_DOUBLE_EQ(gate.gain(0.5, 0.1)[0][0], 30.0);
  EXPECT_EQ(gate.gain(0.6, 0.1)[0][0], 0.0);
  EXPECT_EQ(gate.gain(0.0, 0.1)[0][0], 0.0) << "there is no time before the start";
}

TEST(WallMotion, GoesOnFromACheckpointWithTheSameBits) {
  WallMotion one(swaying(), 3, {}), other(swaying(), 3, {});
  one.advance(0.0, 0.1);
  Archive saved;
  one.archive(saved, "wall");
  Archive loaded(saved.bytes());
  other.archive(loaded, "wall");
  one.advance(0.1, 0.05);
  other.advance(0.1, 0.05);
  EXPECT_EQ(one.now().now.place, other.now().now.place);
  EXPECT_EQ(one.now().now.turn, other.now().now.turn);
  EXPECT_EQ(one.within_step(0.02).now.place, other.within_step(0.02).now.place);
}

}  // namespace
}  // namespace barchan
