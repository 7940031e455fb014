// Particles of a fluid in a box of a wall that moves are put back to its nearest face, and stop relative to it.
#include "models/fluid/moving_boxes.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace barchan {
namespace {

/// Goes with 1 m/s along x and turns with `rate` (1/s) about (0.5, 0.5).
Motion motion_of(const std::string& rate) {
  Motion motion;
  motion.velocity[0].formula = "1";
  motion.about = Vec3{0.5, 0.5, 0};
  motion.angular_velocity = AxialExpression{};
  motion.angular_velocity->about[2].formula = rate;
  return motion;
}

PhaseParticles particle(const Vec3& x, const Vec3& v) {
  PhaseParticles p("water", 2, 1, 1.0, 0);
  p.add(Field::position);
  p.add(Field::velocity);
  for (int d = 0; d < 2; ++d) {
    p.column(Field::position, d)[0] = x[static_cast<std::size_t>(d)];
    p.column(Field::velocity, d)[0] = v[static_cast<std::size_t>(d)];
  }
  return p;
}

const Bounds bounds{2, {0, 0, 0}, {4, 1, 0}, {true, false, false}};

TEST(MovingBoxes, PutParticlesBackWhereTheyCameFrom) {
  WallMotion motion(motion_of("0"), 2, {});
  motion.advance(0.0, 1.0);
  const MovingBox box{{0.3, 0.2, 0}, {0.7, 0.8, 0}, &motion};  // now from 1.3 to 1.7
  PhaseParticles slow = particle({1.69, 0.5, 0}, {0.4, 0.3, 0}), fast = particle({1.69, 0.5, 0}, {1.5, 0.3, 0}),
                 outside = particle({1.71, 0.5, 0}, {0.4, 0.3, 0}), image = particle({5.69, 0.5, 0}, {0.4, 0.3, 0});
  for (PhaseParticles* p : {&slow, &fast, &outside, &image}) hold_outside(*p, box, bounds, 1.0);
  EXPECT_DOUBLE_EQ(slow.column(Field::position, 0)[0], 1.7);
  EXPECT_DOUBLE_EQ(slow.column(Field::velocity, 0)[0], 1.0) << "it goes with the wall";
  EXPECT_DOUBLE_EQ(slow.column(Field::velocity, 1)[0], 0.3) << "and slips along it";
  EXPECT_DOUBLE_EQ(fast.column(Field::velocity, 0)[0], 1.5) << "it leaves by itself";
  EXPECT_EQ(outside.column(Field::position, 0)[0], 1.71);
  EXPECT_EQ(outside.column(Field::velocity, 0)[0], 0.4);
  EXPECT_DOUBLE_EQ(image.column(Field::position, 0)[0], 5.7);
}

TEST(MovingBoxes, TurnWithTheWall) {
  WallMotion motion(motion_of("1.5707963267948966"), 2, {});
  motion.advance(0.0, 1.0);  // a quarter of a turn: the box is now from 1.2 to 1.8 and from 0.3 to 0.7
  const MovingBox box{{0.3, 0.2, 0}, {0.7, 0.8, 0}, &motion};
  PhaseParticles p = particle({1.6, 0.69, 0}, {0, 0, 0});
  hold_outside(p, box, bounds, 1.0);
  EXPECT_NEAR(p.column(Field::position, 0)[0], 1.6, 1e-12);
  EXPECT_NEAR(p.column(Field::position, 1)[0], 0.7, 1e-12);
  EXPECT_NEAR(p.column(Field::velocity, 1)[0], 1.5707963267948966 * 0.1, 1e-12) << "as fast as the face there";
}

TEST(MovingBoxes, DoNotPutParticlesOutOfTheDomain) {
  WallMotion motion(motion_of("0"), 2, {});
  motion.advance(0.0, 1.0);
  const MovingBox box{{0.3, 0, 0}, {0.7, 0.8, 0}, &motion};  // it stands on the bottom
  PhaseParticles p = particle({1.5, 0.01, 0}, {0, -1, 0});
  hold_outside(p, box, bounds, 1.0);
  EXPECT_GT(p.column(Field::position, 1)[0], 0.0);
  EXPECT_TRUE(std::abs(p.column(Field::position, 0)[0] - 1.5) > 0.199) << "sideways";
}

}  // namespace
}  // namespace barchan
